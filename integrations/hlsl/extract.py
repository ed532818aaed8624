#!/usr/bin/env python3
"""Takes parallax maps out of a GLB, for engines whose importers do not know the extension.

For each material with PARBAKE_materials_parallax, version 2, it writes the images of the shift, the cutout, the base
colour and the normals, and a text of the numbers by the names that the shaders here have for them. The model to import
is written as well: its vertices are where the maps have them, and its textures are those that the maps shift.

    python3 extract.py deep.glb folder
"""
import json
import math
import struct
import sys
from pathlib import Path

NAME = "PARBAKE_materials_parallax"
OFFSET = "_PARALLAX_OFFSET"
ENDINGS = {"image/png": ".png", "image/jpeg": ".jpg", "image/webp": ".webp", "image/ktx2": ".ktx2"}
# Of an accessor's numbers: how struct names them, and the greatest.
COMPONENTS = {5120: ("b", 127), 5121: ("B", 255), 5122: ("h", 32767), 5123: ("H", 65535), 5126: ("f", 1)}
JSON_CHUNK, BINARY_CHUNK = b"JSON", b"BIN\0"


def read_glb(path):
    """The JSON of a GLB and its binary chunk."""
    data = Path(path).read_bytes()
    if len(data) < 12 or struct.unpack_from("<4sI", data) != (b"glTF", 2):
        sys.exit(f"{path} is no GLB of glTF 2.0")
    chunks, at = {}, 12
    while at + 8 <= len(data):
        length, kind = struct.unpack_from("<I4s", data, at)
        chunks.setdefault(kind, data[at + 8 : at + 8 + length])
        at += 8 + length
    return json.loads(chunks[JSON_CHUNK]), chunks.get(BINARY_CHUNK, b"")


def write_glb(path, document, binary):
    """The opposite of read_glb."""
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    parts = [(JSON_CHUNK, text), (BINARY_CHUNK, binary + bytes(-len(binary) % 4))]
    chunks = b"".join(struct.pack("<I4s", len(data), kind) + data for kind, data in parts)
    Path(path).write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


def map_of(material):
    """What a material has of the extension, if it is of the version that is known here."""
    json_map = material.get("extensions", {}).get(NAME, {})
    return json_map if json_map.get("version") == 2 else None


def image_of(document, binary, info):
    """The bytes of a texture's image, and how its file name ends."""
    texture = document["textures"][info["index"]]
    extensions = texture.get("extensions", {})
    named = [extensions.get("KHR_texture_basisu"), extensions.get("EXT_texture_webp"), texture]
    source = next((holder["source"] for holder in named if holder and "source" in holder), None)
    if source is None:
        sys.exit(f"texture {info['index']} has no image that is known here")
    image = document["images"][source]
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


def vectors_of(document, binary, index):
    """The vectors of an accessor, as floats."""
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]] if "bufferView" in accessor else {"buffer": -1}
    if view["buffer"] != 0 or "uri" in document["buffers"][0] or "extensions" in view or "sparse" in accessor:
        sys.exit(f"accessor {index} is compressed, sparse or outside of the GLB: such vertices are not read")
    code, greatest = COMPONENTS[accessor["componentType"]]
    kind = struct.Struct(f"<3{code}")
    if accessor["type"] != "VEC3":
        sys.exit(f"accessor {index} does not have three components")
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    stride = view.get("byteStride", kind.size)
    rows = [kind.unpack_from(binary, start + i * stride) for i in range(accessor["count"])]
    if accessor.get("normalized") and code != "f":
        rows = [[max(x / greatest, -1.0) for x in row] for row in rows]
    return rows


def with_maps_vertices(document, binary):
    """The file with offsets added to positions, and with the extension's textures in the material's place. New
    positions go behind all other bytes, since primitives without maps may share the old ones."""
    document = json.loads(json.dumps(document))
    materials = document.get("materials", [])
    for material in materials:
        json_map = map_of(material) or {}
        if "baseColorTexture" in json_map:
            material.setdefault("pbrMetallicRoughness", {})["baseColorTexture"] = json_map["baseColorTexture"]
        if "normalTexture" in json_map:
            # The strength stays that of the material.
            strength = {key: value for key, value in material.get("normalTexture", {}).items() if key == "scale"}
            material["normalTexture"] = {**json_map["normalTexture"], **strength}
    moved = {}
    for primitive in (primitive for mesh in document.get("meshes", []) for primitive in mesh["primitives"]):
        attributes = primitive["attributes"]
        if OFFSET not in attributes or "material" not in primitive or not map_of(materials[primitive["material"]]):
            continue
        pair = attributes["POSITION"], attributes.pop(OFFSET)
        if pair not in moved:
            positions, offsets = (vectors_of(document, binary, index) for index in pair)
            if len(positions) != len(offsets):
                sys.exit(f"a primitive has {len(positions)} positions and {len(offsets)} of {OFFSET}")
            finite = (offset if all(map(math.isfinite, offset)) else (0, 0, 0) for offset in offsets)
            sums = [[a + b for a, b in zip(*two)] for two in zip(positions, finite)]
            data = b"".join(struct.pack("<3f", *row) for row in sums)
            stored = list(struct.iter_unpack("<3f", data))
            binary += bytes(-len(binary) % 4)
            moved[pair] = len(document["accessors"])
            document["accessors"].append({
                "bufferView": len(document["bufferViews"]), "componentType": 5126, "count": len(stored), "type": "VEC3",
                "min": [min(axis) for axis in zip(*stored)], "max": [max(axis) for axis in zip(*stored)],
            })
            view = {"buffer": 0, "byteOffset": len(binary), "byteLength": len(data), "target": 34962}
            document["bufferViews"].append(view)
            binary += data
            document["buffers"][0]["byteLength"] = len(binary)
        attributes["POSITION"] = moved[pair]
    return document, binary


def extract(path, folder):
    """Writes all files of a GLB into a folder, and says which."""
    document, binary = read_glb(path)
    folder, stem = Path(folder), Path(path).stem
    folder.mkdir(parents=True, exist_ok=True)
    found = 0
    for index, material in enumerate(document.get("materials", [])):
        json_map = map_of(material)
        if not json_map:
            continue
        found += 1
        name = f"{stem}_{index}"
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
        sys.exit(f"{path} has no material with {NAME}, version 2")
    write_glb(folder / f"{stem}_model.glb", *with_maps_vertices(document, binary))
    print(f"the model to import: {folder / stem}_model.glb")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    extract(sys.argv[1], sys.argv[2])
