"""sunbeam texture and sunbeam mesh: files for other programs."""

import struct
import unittest

from support import CliTest


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


if __name__ == "__main__":
    unittest.main()
