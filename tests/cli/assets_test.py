"""sunbeam texture and sunbeam mesh: files for other programs."""

import base64
import json
import os
import struct
import unittest
import zlib

from support import CliTest

# The square from -1 to 1 seen from above, in a picture of 4 x 4 units: what it covers has albedo 0.5.
FROM_ABOVE = """\
recipe = "tiny.toml"
[camera]
position = [0.0, 0.0, 1000.0]
look_at = [0.0, 0.0, 0.0]
up = [0.0, 1.0, 0.0]
fov_deg = 0.22918305
[render]
width = 64
height = 64
spp = 4
max_bounces = 1
[environment]
color = 1.0
[[material]]
name = "m"
type = "{material}"
{keys}
[[object]]
type = "mesh"
file = "{mesh}"
material = "m"
"""

SQUARE_OBJ = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
U_SHAPE = ("1 1 0", "1 -0.5 0", "-1 -0.5 0", "-1 1 0", "-1.5 1 0", "-1.5 -1 0", "1.5 -1 0", "1.5 1 0")


def ply(elements, *rows):
    xyz = "property float x\nproperty float y\nproperty float z\n"
    vertices, rest = elements
    return (f"ply\nformat ascii 1.0\nelement vertex {vertices}\n{xyz}{rest}end_header\n" +
            "".join(row + "\n" for row in rows))


SQUARE_ROWS = ("-1 -1 0", "1 -1 0", "1 1 0", "-1 1 0")
FACE = "element face 1\nproperty list uchar int vertex_indices\n"


def gltf(**parts):
    """The square, whose node has a skin of one joint and stands elsewhere itself."""
    data = struct.pack("<12f", -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    data += bytes(16) + struct.pack("<4f", 1, 0, 0, 0) * 4
    views = ((0, 48), (48, 12), (60, 16), (76, 64))
    accessors = ((5126, 4, "VEC3"), (5123, 6, "SCALAR"), (5121, 4, "VEC4"), (5126, 4, "VEC4"))
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "skin": 0, "translation": [9, 0, 0]}, {}], "skins": [{"joints": [1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3}, "indices": 1}]}],
        "buffers": [{"byteLength": len(data),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in views],
        "accessors": [{"bufferView": view, "componentType": component, "count": count, "type": kind}
                      for view, (component, count, kind) in enumerate(accessors)]}
    return json.dumps({**document, **parts})


def exr_attributes(content):
    """{name: bytes} of the header of an EXR, and where it ends."""
    attributes, at = {}, 8
    while content[at]:
        end = content.index(b"\0", at)
        value = content.index(b"\0", end + 1) + 5
        size, = struct.unpack("<i", content[value - 4:value])
        attributes[content[at:end].decode()] = content[value:value + size]
        at = value + size
    return attributes, at + 1


def unzipped(data, size):
    """A block of an EXR: bytes are kept as differences, every second one first (OpenEXR file layout)."""
    if len(data) == size:
        return data
    data = bytearray(zlib.decompress(data))
    for i in range(1, size):
        data[i] = (data[i - 1] + data[i] - 128) % 256
    result = bytearray(size)
    result[0::2], result[1::2] = data[:(size + 1) // 2], data[(size + 1) // 2:]
    return result


def exr_channel(content, name):
    """The values of a channel of an EXR of floats in ZIP blocks, as the renderer writes it, row by row."""
    attributes, at = exr_attributes(content)
    names = [entry.split(b"\0")[-1] for entry in attributes["channels"].split(b"\0" + struct.pack("<4i", 2, 0, 1, 1))]
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height, lines, values = x1 - x0 + 1, y1 - y0 + 1, 16, []
    place = names.index(name.encode())
    for block in range((height + lines - 1) // lines):
        offset, = struct.unpack("<Q", content[at + 8 * block:at + 8 * block + 8])
        size, = struct.unpack("<i", content[offset + 4:offset + 8])
        rows = min(lines, height - lines * block)
        data = unzipped(content[offset + 8:offset + 8 + size], 4 * width * len(names[:-1]) * rows)
        for row in range(rows):
            begin = 4 * width * (row * len(names[:-1]) + place)
            values += struct.unpack(f"<{width}f", data[begin:begin + 4 * width])
    return values


class TextureTest(CliTest):
    def test_png_has_the_size_of_the_tile(self):
        self.succeed("texture", "-o", "scales.png", "--columns", "4", "--rows", "6", "--pixels-per-scale", "16")
        header = (self.folder / "scales.png").read_bytes()[:29]
        width, height, depth, color = struct.unpack(">IIBB", header[16:26])
        self.assertEqual((width, height), (64, round(16 * 6 * 3**0.5 / 2)))
        self.assertEqual((depth, color), (16, 0))  # grey

    def test_same_seed_same_bytes(self):
        def bytes_of(seed):
            self.succeed("texture", "-o", "a.exr", "--pattern", "voronoi", "--seed", seed, "--pixels-per-scale", "8")
            return (self.folder / "a.exr").read_bytes()

        self.assertEqual(bytes_of("3"), bytes_of("3"))
        self.assertNotEqual(bytes_of("3"), bytes_of("4"))

    def test_scales_of_snakes(self):
        for pattern in "snake", "snake_head":
            self.succeed("texture", "-o", f"{pattern}.exr", "--pattern", pattern, "--columns", "12", "--rows", "14",
                         "--pixels-per-scale", "8")
        self.assertNotEqual((self.folder / "snake.exr").read_bytes(), (self.folder / "snake_head.exr").read_bytes())
        self.refuse("texture", "-o", "a.exr", "--pattern", "snake",
                    naming=("--columns: found 8; allowed for the pattern of a snake: 12 to 400",))

    def test_bad_values_are_told(self):
        self.refuse("texture", "-o", "a.exr", "--rows", "3", naming=("--rows: found 3; allowed: an even number",))
        self.refuse("texture", "-o", "a.exr", "--edge", "nan", naming=("--edge: found nan; allowed: 0.02 to 0.5",))
        self.refuse("texture", "-o", "a.exr", "--columns", "512", "--rows", "512", "--pixels-per-scale", "256",
                    naming=("--pixels-per-scale: found 256", "pixels in all"))
        self.refuse("texture", "-o", "a.jpg", naming=("allowed for heights: .exr, .png",))
        self.refuse("texture", "-o", "a.exr", "--pattern", "round", naming=("round",))


class MeshTest(CliTest):
    def test_every_shape_in_both_forms(self):
        for shape in ("snake", "torus", "sphere"):
            for name in ("a.ply", "a.obj"):
                self.succeed("mesh", shape, "-o", name, "--resolution", "16")
                self.assertGreater((self.folder / name).stat().st_size, 1000)

    def test_bad_values_are_told(self):
        self.refuse("mesh", "snake", "-o", "a.ply", "--turns", "9", naming=("--turns: found 9; allowed: 1 to 6",))
        self.refuse("mesh", "torus", "-o", "a.ply", "--minor-radius", "2", naming=("allowed: below --major-radius",))
        self.refuse("mesh", "torus", "-o", "a.stl", naming=("allowed for writing a mesh: .obj, .ply",))
        self.refuse("mesh", "cube", "-o", "a.ply", naming=("cube",))


class MeshFileTest(CliTest):
    """Files as other programs write them, rendered: the area that they cover, in a picture of 4 x 4 units."""

    def scene(self, mesh, content, material="diffuse", keys=""):
        self.write(mesh, content)
        return self.write("scene.toml", FROM_ABOVE.format(mesh=mesh, material=material, keys=keys))

    def covered_area(self, mesh, content):
        self.succeed("render", self.scene(mesh, content), "-o", "o.exr", "--material", "diffuse", "--aovs", "--threads", "1")
        return sum(exr_channel((self.folder / "o.exr").read_bytes(), "albedo.R")) / 0.5 * (4 / 64) ** 2

    def test_covered_areas(self):
        strip = "element tristrips 1\nproperty list int int vertex_indices\n"
        for mesh, content, area in (
                ("u.ply", ply((8, FACE), *U_SHAPE, "8 0 1 2 3 4 5 6 7"), 3),
                ("u.obj", "".join(f"v {row}\n" for row in U_SHAPE) + "f 1 2 3 4 5 6 7 8\n", 3),
                ("strip.ply", ply((4, strip), "-1 -1 0", "1 -1 0", "-1 1 0", "1 1 0", "4 0 1 2 3"), 4),
                ("tiny.obj", SQUARE_OBJ.replace("-1 -1 0", "-1 -1 1.07797e-046") + "f 1 2 3 4\n", 4),
                ("slashes.obj", SQUARE_OBJ + "f 1// 2// 3// 4//\n", 4),
                ("vt.obj", SQUARE_OBJ + "vt 0\nvt 1\nvt 1\nvt 0\nf 1/1 2/2 3/3 4/4\n", 4),
                ("comment.obj", SQUARE_OBJ + "f 1 2 3 4 # a comment\n", 4),
                ("skin.gltf", gltf(), 4)):
            self.assertAlmostEqual(self.covered_area(mesh, content), area, delta=0.01, msg=mesh)

    def test_refusals(self):
        for mesh, content, needles in (
                ("required.gltf", gltf(extensionsRequired=["EXT_made_up_geometry"]), ("EXT_made_up_geometry",)),
                ("cr.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n# x\rf 1 2 99999999\rf 3 7000000 1\n",
                 ("cr.obj:6: face index 99999999",)),
                ("away.gltf", gltf(buffers=[{"byteLength": 140, "uri": "../../../../../../etc/passwd"}]),
                 ("leads out of the folders",)),
                ("fifo.gltf", gltf(buffers=[{"byteLength": 140, "uri": "pipe"}]), ("no regular file",))):
            if mesh == "fifo.gltf":
                os.mkfifo(self.folder / "pipe")
            self.refuse("render", self.scene(mesh, content), "-o", "none.exr", "--material", "diffuse", naming=needles)

    def film(self, mesh, content):
        self.succeed("render", self.scene(mesh, content, "skin", "film_thickness_nm = { from = 0, to = 1000, ramp = [1, 0] }"),
                     "-o", "o.exr", "--material", "diffuse", "--aovs", "--threads", "1")
        row = exr_channel((self.folder / "o.exr").read_bytes(), "film_thickness_nm")[32 * 64:33 * 64]
        return [sum(row[x:x + 8]) / 8 for x in range(16, 48, 8)]

    def test_coordinates_at_corners_are_those_of_vertices(self):
        wedge = ply((4, FACE + "property list uchar float texcoord\n"), *SQUARE_ROWS, "4 0 1 2 3 8 0 0 1 0 1 1 0 1")
        vertex = ply((4, "property float s\nproperty float t\n" + FACE), "-1 -1 0 0 0", "1 -1 0 1 0", "1 1 0 1 1",
                     "-1 1 0 0 1", "4 0 1 2 3")
        for mesh, content in ("wedge.ply", wedge), ("vertex.ply", vertex):
            for found, expected in zip(self.film(mesh, content), (125, 375, 625, 875)):
                self.assertAlmostEqual(found, expected, delta=10, msg=mesh)

    def test_a_field_without_coordinates_warns_once(self):
        keys = ("film_thickness_nm = { from = 0, to = 1000, ramp = [1, 0] }\nbase_ior = 1.5\n"
                "scales = { around = 4 }\n")
        scene = self.scene("bare.obj", SQUARE_OBJ + "f 1 2 3 4\n", "skin", keys)
        text = (self.folder / scene).read_text()
        self.write(scene, text + text[text.index("[[object]]"):])
        result = self.succeed("render", scene, "-o", "o.exr", "--material", "diffuse")
        self.assertEqual(result.err.count("texture coordinates"), 1, result)
        self.assertIn('warning: bare.obj: the mesh has no texture coordinates, so film_thickness_nm, scales of material "m" '
                      "cannot vary over it\n", result.err)
        mapped = SQUARE_OBJ + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"
        for mesh, content, material, keys in (("mapped.obj", mapped, "skin", keys),
                                              ("plain.obj", SQUARE_OBJ + "f 1 2 3 4\n", "skin", "base_ior = 1.5")):
            result = self.succeed("render", self.scene(mesh, content, material, keys), "-o", "o.exr", "--material", "diffuse")
            self.assertNotIn("texture coordinates", result.err)


if __name__ == "__main__":
    unittest.main()
