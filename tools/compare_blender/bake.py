"""Bakes colour and tangent-space normals of one pair in Blender: Cycles, selected to active.

Runs in a Python that has the module `bpy`. Prints one line of JSON: Blender's version, and the seconds that
both bakes took, without reading and writing files.

    python bake.py HIGH LOW COLOR.png NORMAL.png --size 512 --samples 4 --distance 0.05 --threads 2
"""

import argparse
import json
import os
import sys
import time

import bpy


def load(path):
    """Imports a model as one object; both importers turn +Y up into +Z up the same way."""
    before = set(bpy.data.objects)
    ending = os.path.splitext(path)[1].lower()
    if ending == ".obj":
        bpy.ops.wm.obj_import(filepath=path)
    elif ending in (".glb", ".gltf"):
        bpy.ops.import_scene.gltf(filepath=path)
    else:
        sys.exit(f"{path}: give a .obj, .glb or .gltf")
    meshes = [o for o in bpy.data.objects if o not in before and o.type == "MESH"]
    if not meshes:
        sys.exit(f"{path}: no mesh")
    bpy.ops.object.select_all(action="DESELECT")
    for o in meshes:
        o.select_set(True)
    bpy.context.view_layer.objects.active = meshes[0]
    bpy.ops.object.transform_apply(location=True, rotation=True, scale=True)
    if len(meshes) > 1:
        bpy.ops.object.join()
    loaded = bpy.context.view_layer.objects.active
    for slot in loaded.material_slots:
        drop_missing_images(slot.material)
    return loaded


def drop_missing_images(material):
    """A file that names a picture which is not there says nothing; Blender would show it pink."""
    if material is None or not material.use_nodes:
        return
    for node in list(material.node_tree.nodes):
        if node.type == "TEX_IMAGE" and (node.image is None or not node.image.size[0]):
            material.node_tree.nodes.remove(node)
    for node in list(material.node_tree.nodes):
        if node.type == "NORMAL_MAP" and not node.inputs["Color"].is_linked:
            material.node_tree.nodes.remove(node)


def paint(loaded, path):
    """Gives the model one material with this picture as its base colour."""
    material = bpy.data.materials.new("painted")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.load(os.path.abspath(path))
    material.node_tree.links.new(node.outputs["Color"], principled(material).inputs["Base Color"])
    loaded.data.materials.clear()
    loaded.data.materials.append(material)
    for polygon in loaded.data.polygons:
        polygon.material_index = 0


def principled(material):
    return next((n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED"), None)


def show_color(material):
    """Emission of the base colour instead of the surface; returns what puts the surface back."""
    if not material.use_nodes:
        material.use_nodes = True
    tree, shader = material.node_tree, principled(material)
    output = next((n for n in tree.nodes if n.type == "OUTPUT_MATERIAL"), None)
    if shader is None or output is None:
        return lambda: None
    emission = tree.nodes.new("ShaderNodeEmission")
    base = shader.inputs["Base Color"]
    if base.is_linked:
        tree.links.new(base.links[0].from_socket, emission.inputs["Color"])
    else:
        emission.inputs["Color"].default_value = base.default_value
    surface = output.inputs["Surface"]
    own = surface.links[0].from_socket if surface.is_linked else None
    tree.links.new(emission.outputs["Emission"], surface)

    def back():
        if own is not None:
            tree.links.new(own, surface)

    return back


def target(low, name, size, data):
    """An image that the low-poly's one material bakes into."""
    image = bpy.data.images.new(name, size, size, alpha=False)
    if data:
        image.colorspace_settings.name = "Non-Color"
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    material.node_tree.nodes.active = node
    low.data.materials.clear()
    low.data.materials.append(material)
    for polygon in low.data.polygons:
        polygon.material_index = 0
    return image


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("high", "low", "color", "normal"):
        parser.add_argument(name)
    parser.add_argument("--texture", help="base colour of the high-poly, where Blender does not find it by itself")
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--distance", type=float, default=0.05, help="share of the high-poly's longest side")
    parser.add_argument("--threads", type=int, default=0, help="0 is one a core")
    parser.add_argument("--cage", action="store_true", help="rays along smoothed normals (Blender's automatic cage)")
    arguments = parser.parse_args()

    bpy.ops.wm.read_factory_settings(use_empty=True)
    high, low = load(arguments.high), load(arguments.low)
    if arguments.texture:
        paint(high, arguments.texture)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = arguments.samples
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    if arguments.threads > 0:
        scene.render.threads_mode = "FIXED"
        scene.render.threads = arguments.threads
    distance = arguments.distance * max(high.dimensions)
    bake = dict(
        use_selected_to_active=True,
        use_cage=arguments.cage,
        cage_extrusion=distance,
        max_ray_distance=2.0 * distance,
        margin=16,
        margin_type="EXTEND",
        use_clear=True,
    )

    def run(kind, name, data, **more):
        image = target(low, name, arguments.size, data)
        bpy.ops.object.select_all(action="DESELECT")
        high.select_set(True)
        low.select_set(True)
        bpy.context.view_layer.objects.active = low
        begin = time.perf_counter()
        bpy.ops.object.bake(type=kind, **bake, **more)
        seconds = time.perf_counter() - begin
        return image, seconds

    def save(image, path):
        image.filepath_raw = os.path.abspath(path)
        image.file_format = "PNG"
        image.save()

    backs = [show_color(slot.material) for slot in high.material_slots if slot.material]
    image, color_seconds = run("EMIT", "color", False)
    save(image, arguments.color)
    for back in backs:
        back()
    image, normal_seconds = run("NORMAL", "normal", True, normal_space="TANGENT")
    save(image, arguments.normal)
    print(json.dumps({
        "blender": bpy.app.version_string,
        "color_seconds": color_seconds,
        "normal_seconds": normal_seconds,
        "bake_seconds": color_seconds + normal_seconds,
    }))


if __name__ == "__main__":
    main()
