#!/usr/bin/env python3
"""Takes parallax maps out of a GLB, for engines whose importers do not know the extension.

For each material with PARBAKE_materials_parallax, version 2, it writes the images of the shift, the cutout, the base
colour and the normals, and a text of the numbers by the names that the shaders here have for them.

    python3 extract.py deep.glb folder
"""
import json
import struct
import sys
from pathlib import Path

NAME = "PARBAKE_materials_parallax"
ENDINGS = {"image/png": ".png", "image/jpeg": ".jpg", "image/webp": ".webp", "image/ktx2": ".ktx2"}


def read_glb(path):
    """The JSON of a GLB and its binary chunk."""
    data = Path(path).read_bytes()
    magic, version, _ = struct.unpack_from("<4sII", data)
    if magic != b"glTF" or version != 2:
        sys.exit(f"{path} is no GLB of glTF 2.0")
    length, _ = struct.unpack_from("<I4s", data, 12)
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def image_of(document, binary, info):
    """The bytes of a texture's image, and how its file name ends."""
    texture = document["textures"][info["index"]]
    basis = texture.get("extensions", {}).get("KHR_texture_basisu", texture)
    image = document["images"][basis["source"]]
    if "bufferView" not in image:
        sys.exit(f"{image.get('uri')} lies beside the file: only images inside of a GLB are taken out")
    view = document["bufferViews"][image["bufferView"]]
    start = view.get("byteOffset", 0)
    return binary[start : start + view["byteLength"]], ENDINGS.get(image["mimeType"], "")


def numbers_of(json_map):
    """Lines such as `ShiftScale0 = 0.2, 0.1, 0.1, 0.4`."""
    parts = [("Shift", json_map, 8)]
    if "cutout" in json_map:
        parts.append(("Cutout", json_map["cutout"], 12))
    for prefix, part, count in parts:
        for key in ["scale", "offset"]:
            if len(part[key]) != count:
                sys.exit(f"a map breaks the format: it has not {count} scales and offsets")
            for i in range(0, len(part[key]), 4):
                four = ", ".join(f"{x:.9g}" for x in part[key][i : i + 4])
                yield f"{prefix}{key.capitalize()}{i // 4} = {four}"
    yield f"Limit = {json_map.get('limit', 0.25)}"
    yield f"FadeFootprint = {json_map.get('fadeFootprint', 1e10)}"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    document, binary = read_glb(sys.argv[1])
    folder = Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    found = 0
    for index, material in enumerate(document.get("materials", [])):
        json_map = material.get("extensions", {}).get(NAME, {})
        if json_map.get("version") != 2:
            continue
        found += 1
        name = f"{Path(sys.argv[1]).stem}_{index}"
        color = material.get("pbrMetallicRoughness", {}).get("baseColorTexture")
        textures = {
            "shift": json_map["texture"],
            "cutout": json_map.get("cutout", {}).get("texture"),
            # If the extension has textures of its own, the material's are for viewers that do not know it.
            "color": json_map.get("baseColorTexture", color),
            "normal": json_map.get("normalTexture", material.get("normalTexture")),
        }
        for kind, info in textures.items():
            if info is not None:
                data, ending = image_of(document, binary, info)
                (folder / f"{name}_{kind}{ending}").write_bytes(data)
        (folder / f"{name}.txt").write_text("\n".join(numbers_of(json_map)) + "\n")
        print(f"{material.get('name', name)}: {folder / name}.txt and its images")
    if not found:
        sys.exit(f"{sys.argv[1]} has no material with {NAME}, version 2")


main()
