"""Imports the levels of a lods.json that Parbake has written as one static mesh, and one for each part that stays apart.

In Unreal 5: Tools, Execute Python Script, this file; or `py "…/import_lods.py"` in the console. Needs the plug-ins
Python Editor Script and Interchange (glTF). Screen sizes are those of lods.json.
"""

import json
import os
import re

import unreal

FOLDER = os.path.dirname(os.path.abspath(__file__))
PLACE = "/Game/Parbake/@NAME@"


def imported(file):
    """The static meshes of a GLB file, by their names without the level's number."""
    task = unreal.AssetImportTask()
    task.filename = os.path.join(FOLDER, file)
    task.destination_path = PLACE + "/" + os.path.splitext(file)[0]
    task.automated = True
    task.replace_existing = True
    task.save = True
    unreal.AssetToolsHelpers.get_asset_tools().import_asset_tasks([task])
    paths = unreal.EditorAssetLibrary.list_assets(task.destination_path)
    assets = [unreal.EditorAssetLibrary.load_asset(path) for path in paths]
    meshes = [asset for asset in assets if isinstance(asset, unreal.StaticMesh)]
    if not meshes:
        raise RuntimeError("Parbake: %s holds no static mesh; is the glTF importer on?" % file)
    return {re.sub(r"_LOD\d+", "", mesh.get_name()): mesh for mesh in meshes}


def main():
    with open(os.path.join(FOLDER, "lods.json"), encoding="utf-8") as text:
        chain = json.load(text)
    editor = unreal.get_editor_subsystem(unreal.StaticMeshEditorSubsystem)
    levels = [imported(level["file"]) for level in chain["levels"]]
    # A screen size is the level's upper end: that of the first is 1.
    sizes = [1.0] + [level["min_coverage"] for level in chain["levels"][:-1]]
    for name, first in levels[0].items():
        for index, meshes in enumerate(levels[1:], 1):
            if name in meshes:
                editor.set_lod_from_static_mesh(first, index, meshes[name], 0, True)
        editor.set_lod_screen_sizes(first, sizes)
        unreal.EditorAssetLibrary.save_loaded_asset(first)
        unreal.log("Parbake: %s has %d levels" % (first.get_path_name(), len(levels)))


main()
