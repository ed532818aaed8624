#!/usr/bin/env python3
"""Tests of extract.py: `python3 test_extract.py`. Tests of integrations/check run them, too."""
import contextlib
import io
import struct
import tempfile
import unittest
from pathlib import Path

import extract

IMAGES = [b"plain color", b"plain normals", b"shift", b"cutout", b"own color!", b"own normals"]
POSITIONS = [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]
OFFSETS = [0.1, -0.5, 0.25, float("nan"), 1.0, 1.0]


def made():
    """A file with three primitives: one with offsets, one of a plain material that shares its positions, and one whose
    positions are quantised."""
    floats = struct.Struct("<6f").pack
    # Each position has two bytes of padding behind it.
    parts = [floats(*POSITIONS), floats(*OFFSETS), struct.pack("<3hxx3hxx", -32768, 0, 32767, 32767, 0, 0), *IMAGES]
    views, binary = [], b""
    for part in parts:
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(part)})
        binary += part + bytes(-len(part) % 4)
    views[2]["byteStride"] = 8
    vectors = {"count": 2, "type": "VEC3", "componentType": 5126}
    json_map = {
        "version": 2, "texture": {"index": 2}, "scale": [1] * 8, "offset": [0.5] * 8,
        "cutout": {"texture": {"index": 3}, "scale": [1] * 12, "offset": [0] * 12},
        "baseColorTexture": {"index": 4}, "normalTexture": {"index": 5, "texCoord": 1},
    }
    deep = {
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0},
        "normalTexture": {"index": 1, "scale": 0.5},
    }
    document = {
        "asset": {"version": "2.0", "copyright": "ü"},
        "buffers": [{"byteLength": len(binary)}],
        "bufferViews": views,
        "accessors": [
            {"bufferView": 0, "min": [0, 0, 0], "max": [1, 2, 3], **vectors},
            {"bufferView": 1, **vectors},
            {"bufferView": 2, "normalized": True, **vectors, "componentType": 5122},
        ],
        "images": [{"bufferView": 3 + i, "mimeType": "image/png"} for i in range(len(IMAGES))],
        "textures": [{"source": i} for i in range(len(IMAGES))],
        "materials": [{**deep, "extensions": {extract.NAME: json_map}}, deep],
        "meshes": [{"primitives": [
            {"attributes": {"POSITION": 0, extract.OFFSET: 1}, "material": 0},
            {"attributes": {"POSITION": 0, extract.OFFSET: 1}, "material": 1},
            {"attributes": {"POSITION": 2, extract.OFFSET: 1}, "material": 0},
            {"attributes": {"POSITION": 0, extract.OFFSET: 1}, "material": 0},
        ]}],
    }
    return document, binary


class Extract(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.before, self.bytes_before = made()
        extract.write_glb(self.folder / "deep.glb", self.before, self.bytes_before)
        with contextlib.redirect_stdout(io.StringIO()):
            extract.extract(self.folder / "deep.glb", self.folder / "out")
        self.after, self.bytes_after = extract.read_glb(self.folder / "out/deep_model.glb")
        self.primitives = self.after["meshes"][0]["primitives"]

    def test_a_file_is_written_as_it_was_read(self):
        self.assertEqual(extract.read_glb(self.folder / "deep.glb"), (self.before, self.bytes_before))

    def test_positions_are_where_the_maps_have_them(self):
        moved, plain, quantised, same = (primitive["attributes"] for primitive in self.primitives)
        self.assertEqual(plain, {"POSITION": 0, extract.OFFSET: 1}, "its material has no map")
        self.assertEqual(list(moved), ["POSITION"], "who knows the extension must not add the offsets again")
        self.assertEqual(moved, same, "what is shared stays shared")
        # An offset that is not finite counts as 0.
        cases = [(moved, [[0.1, -0.5, 0.25], [1, 2, 3]]), (quantised, [[-0.9, -0.5, 1.25], [1, 0, 0]])]
        for attributes, expected in cases:
            rows = extract.vectors_of(self.after, self.bytes_after, attributes["POSITION"])
            self.assertEqual(len(rows), len(expected))
            for row, wanted in zip(rows, expected):
                for number, right in zip(row, wanted):
                    self.assertAlmostEqual(number, right, places=6)
            accessor = self.after["accessors"][attributes["POSITION"]]
            self.assertEqual(accessor["min"], [min(axis) for axis in zip(*rows)])
            self.assertEqual(accessor["max"], [max(axis) for axis in zip(*rows)])

    def test_textures_are_those_that_the_maps_shift(self):
        deep, plain = self.after["materials"]
        self.assertEqual(deep["pbrMetallicRoughness"], {"baseColorTexture": {"index": 4}, "metallicFactor": 0})
        self.assertEqual(deep["normalTexture"], {"index": 5, "texCoord": 1, "scale": 0.5})
        self.assertEqual(deep["extensions"], self.before["materials"][0]["extensions"])
        self.assertEqual(plain, self.before["materials"][1])
        kinds = ["shift", "cutout", "color", "normal"]
        written = [(self.folder / f"out/deep_0_{kind}.png").read_bytes() for kind in kinds]
        self.assertEqual(written, IMAGES[2:])
        self.assertIn("ShiftOffset1 = 0.5, 0.5, 0.5, 0.5", (self.folder / "out/deep_0.txt").read_text())

    def test_all_else_stays(self):
        self.assertTrue(self.bytes_after.startswith(self.bytes_before))
        self.assertEqual(self.after["buffers"], [{"byteLength": len(self.bytes_after)}])
        for key in ["asset", "images", "textures"]:
            self.assertEqual(self.after[key], self.before[key])
        for key in ["accessors", "bufferViews"]:
            self.assertEqual(self.after[key][: len(self.before[key])], self.before[key])

    def test_a_file_without_maps_is_refused(self):
        del self.before["materials"][0]["extensions"]
        extract.write_glb(self.folder / "plain.glb", self.before, self.bytes_before)
        with self.assertRaises(SystemExit):
            extract.extract(self.folder / "plain.glb", self.folder / "out")


if __name__ == "__main__":
    unittest.main()
