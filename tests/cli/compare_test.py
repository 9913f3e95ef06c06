"""`sunbeam compare`: figures by hand, limits, pictures and refusals, on EXR files written here byte by byte."""

import json
import math
import resource
import struct
import unittest
import zlib

import support

MEAN = ("B", "G", "R")
VARIANCE = ("variance.B", "variance.G", "variance.R")


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value


def exr_bytes(width, height, channels, more=b""):
    """An uncompressed EXR of 32-bit floats; channels: {name: one value a pixel or one for all}; more attributes."""
    names = sorted(channels)
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    listed = b"".join(n.encode() + b"\0" + struct.pack("<iI2i", 2, 0, 1, 1) for n in names) + b"\0"
    header = struct.pack("<II", 20000630, 2)
    header += attribute("channels", "chlist", listed) + attribute("compression", "compression", b"\0")
    header += attribute("dataWindow", "box2i", box) + attribute("displayWindow", "box2i", box)
    header += attribute("lineOrder", "lineOrder", b"\0") + attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + more + b"\0"
    size = 4 * width * len(names)
    first = len(header) + 8 * height
    offsets = b"".join(struct.pack("<Q", first + y * (8 + size)) for y in range(height))
    lines = b""
    for y in range(height):
        lines += struct.pack("<iI", y, size)
        for name in names:
            value = channels[name]
            row = value[y * width:(y + 1) * width] if isinstance(value, list) else [value] * width
            lines += struct.pack(f"<{width}f", *row)
    return header + offsets + lines


def png_bytes(width, height, color_type, bits, rows, *chunks):
    """A PNG of these rows, which are bytes; chunks (kind, content) come before them."""
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", width, height, bits, color_type, 0, 0, 0)
    data = zlib.compress(b"".join(b"\0" + row for row in rows))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + b"".join(chunk(*c) for c in chunks) + chunk(b"IDAT", data)
            + chunk(b"IEND", b""))


AP1 = struct.pack("<8f", 0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
GREY, RGB = 0, 2  # colour types of PNG


class CompareTest(support.CliTest):
    @classmethod
    def exr(cls, name, mean, variance=None, width=12, height=10, **channels):
        """`mean` and `variance`: of all three channels; `channels`: what replaces or adds to them."""
        layers = dict.fromkeys(MEAN, mean)
        if variance is not None:
            layers.update(dict.fromkeys(VARIANCE, variance))
        layers.update({name.replace("_", "."): value for name, value in channels.items()})
        return cls.write(name, exr_bytes(width, height, {k: v for k, v in layers.items() if v is not None}))

    def figures(self, *arguments):
        return json.loads(self.succeed("compare", *arguments, "--json").out)


class Figures(CompareTest):
    @classmethod
    def prepare(cls):
        cls.exr("one.exr", 1.0, 0.5)
        cls.exr("more.exr", 1.25, 0.5)
        cls.exr("plain.exr", 1.25)

    def test_a_picture_against_itself(self):
        figures = self.figures("one.exr", "one.exr")
        for key in ("rmse", "relmse", "flip"):
            self.assertEqual(figures[key], 0, key)
        self.assertEqual(figures["bias"], [0, 0, 0])
        self.assertEqual(figures["beyond_3_sigma"]["pixels"], {"tested": 360, "beyond": 0, "share": 0})
        self.assertEqual(figures["exceeded"], [])

    def test_figures_by_hand(self):
        """A quarter off at variance 0.5 + 0.5: 120 pixels, blocks of 100 and of 20."""
        figures = self.figures("more.exr", "one.exr")
        self.assertAlmostEqual(figures["rmse"], 0.25)
        self.assertAlmostEqual(figures["relmse"], 0.0625 / 1.01)
        self.assertEqual(figures["relmse_epsilon"], 0.01)
        self.assertEqual(figures["bias"], [0.25] * 3)
        self.assertEqual(figures["reference_mean"], [1] * 3)
        for ci, z in zip(figures["bias_ci95"], figures["bias_z"]):
            self.assertAlmostEqual(ci, 1.959964 / math.sqrt(120), places=6)
            self.assertAlmostEqual(z, 0.25 * math.sqrt(120), places=6)
        self.assertEqual(figures["beyond_3_sigma"]["blocks"], {"tested": 6, "beyond": 0, "share": 0})
        self.assertAlmostEqual(figures["beyond_3_sigma"]["expected_share"], 0.0027, places=5)
        self.assertEqual(figures["pixels_per_degree"], 67)
        self.assertGreater(figures["flip"], 0)

    def test_text_holds_the_same_figures(self):
        text = self.succeed("compare", "more.exr", "one.exr").out
        self.assertRegex(text, r"(?m)^rmse +0\.25$")
        self.assertIn("(A - B)^2 / (B^2 + 0.01)", text)
        self.assertRegex(text, r"(?m)^bias R +0\.25 \+- 0\.179 \(95 %\), 2\.74 sigma")
        self.assertRegex(text, r"(?m)^pixels +0 % of 360 values beyond 3 sigma; noise alone: 0\.27 %$")

    def test_without_variance_there_is_no_test_against_noise(self):
        result = self.succeed("compare", "plain.exr", "one.exr", "--json")
        self.assertNotIn("bias_z", json.loads(result.out))
        self.assertRegex(result.err, r"^note: plain\.exr: no channels variance\.R")
        self.refuse("compare", "one.exr", "plain.exr", "--max-bias-z", "3", naming=["plain.exr", "variance", "--max-bias-z"])

    def test_the_observer_comes_nearer(self):
        checks = [0.4 + 0.2 * ((x + y) % 2) for y in range(10) for x in range(12)]
        self.exr("checks.exr", checks)
        self.exr("grey.exr", 0.5)
        near, far = (self.figures("checks.exr", "grey.exr", "--pixels-per-degree", p)["flip"] for p in ("5", "100"))
        self.assertLess(far, near)

    def test_picture_of_flip(self):
        """Palette PNG of the size of the images; where nothing differs its index is 0."""
        result = self.succeed("compare", "more.exr", "one.exr", "--png", "flip.png")
        content = (self.folder / "flip.png").read_bytes()
        self.assertEqual(struct.unpack(">IIBB", content[16:26]), (12, 10, 8, 3))
        self.assertIn("black 0, pale yellow 1", result.err)
        self.succeed("compare", "one.exr", "one.exr", "--png", "flip.png")
        self.assertNotEqual(content, (self.folder / "flip.png").read_bytes())


class Colours(CompareTest):
    @classmethod
    def prepare(cls):
        cls.exr("half.exr", 0.5, width=3, height=2)

    def png(self, name, value, *chunks, color_type=GREY, bits=8):
        row = (bytes([value]) if bits == 8 else struct.pack(">H", value)) * (3 if color_type == GREY else 9)
        return self.write(name, png_bytes(3, 2, color_type, bits, [row] * 2, *chunks))

    def test_srgb_of_png_is_decoded_to_linear_light(self):
        for bits, value in ((8, 188), (16, 188 * 257)):
            for color_type in (GREY, RGB):
                self.png("a.png", value, color_type=color_type, bits=bits)
                result = self.succeed("compare", "a.png", "half.exr", "--json")
                linear = ((188 / 255 + 0.055) / 1.055) ** 2.4
                for bias in json.loads(result.out)["bias"]:
                    self.assertAlmostEqual(bias, linear - 0.5, places=6)
                self.assertIn("note: a.png: sRGB is decoded to linear light\n", result.err)

    def test_flip_takes_a_png_as_what_is_displayed(self):
        """The tone curve shows a rendered 1 as a light grey, and leaves a PNG alone."""
        self.png("white.png", 255)
        self.png("black.png", 0)
        self.exr("white.exr", 1.0, width=3, height=2)
        figures = self.figures("white.png", "white.exr")
        self.assertEqual(figures["rmse"], 0)
        self.assertGreater(figures["flip"], 0.05)
        self.assertEqual(self.figures("white.png", "black.png")["bias"], [1] * 3)

    def test_png_of_other_colours(self):
        self.png("linear.png", 9, (b"gAMA", struct.pack(">I", 100000)))
        self.refuse("compare", "linear.png", "half.exr", naming=["linear.png", "gAMA is 1; allowed: 0.45455"])
        wide = [0.3127, 0.329, 0.708, 0.292, 0.17, 0.797, 0.131, 0.046]
        self.png("wide.png", 9, (b"cHRM", struct.pack(">8I", *(round(1e5 * c) for c in wide))))
        self.refuse("compare", "half.exr", "wide.png", naming=["wide.png", "cHRM"])
        self.png("usual.png", 9, (b"gAMA", struct.pack(">I", 45455)))
        self.succeed("compare", "half.exr", "usual.png")

    def test_chromaticities_are_converted(self):
        channels = {"R": 0.25, "G": 0.1, "B": 0.025, **dict.fromkeys(VARIANCE, 1.0)}
        self.write("ap1.exr", exr_bytes(3, 2, channels, attribute("chromaticities", "chromaticities", AP1)))
        self.exr("rec709.exr", 0, 1.0, width=3, height=2, R=0.362, G=0.08126, B=0.00993)
        result = self.succeed("compare", "ap1.exr", "rec709.exr", "--json", "--max-rmse", "2e-5")
        self.assertIn("note: ap1.exr: the chromaticities of its header are converted to Rec.709, but no variance\n", result.err)
        self.assertNotIn("bias_z", json.loads(result.out))


class Limits(CompareTest):
    @classmethod
    def prepare(cls):
        cls.exr("one.exr", 1.0, 0.5)
        cls.exr("more.exr", 0.75, 0.5)

    def test_exit_code_says_what_is_exceeded(self):
        for option, value in (("rmse", 0.25), ("relmse", 0.0625 / 1.01), ("bias", 0.25), ("bias-z", 2.7386)):
            with self.subTest(option=option):
                self.succeed("compare", "more.exr", "one.exr", f"--max-{option}", f"{value * 1.001:.8f}")
                result = self.sunbeam("compare", "more.exr", "one.exr", f"--max-{option}", f"{value * 0.999:.8f}", "--json")
                self.assertEqual(result.code, 1, result)
                self.assertEqual(json.loads(result.out)["exceeded"], [f"--max-{option}"])
                self.assertRegex(result.err, rf"^FAIL: \S+ is above --max-{option} ")

    def test_limit_of_flip(self):
        value = self.figures("more.exr", "one.exr")["flip"]
        self.succeed("compare", "more.exr", "one.exr", "--max-flip", repr(value * 1.01))
        self.assertEqual(self.sunbeam("compare", "more.exr", "one.exr", "--max-flip", repr(value * 0.99)).code, 1)

    def test_several_limits(self):
        result = self.sunbeam("compare", "more.exr", "one.exr", "--max-rmse", "0", "--max-flip", "0", "--max-bias", "1")
        self.assertEqual(result.code, 1, result)
        self.assertEqual(result.err.count("FAIL: "), 2)

    def test_equal_pictures_pass_limits_of_zero(self):
        self.succeed("compare", "one.exr", "one.exr", "--max-rmse", "0", "--max-relmse", "0", "--max-flip", "0",
                     "--max-bias", "0", "--max-bias-z", "0")


SCENE = """\
diffuse_albedo = {albedo}

[camera]
position = [0.0, -4.0, 1.0]
look_at = [0.0, 0.0, 0.0]

[render]
width = 32
height = 24
spp = 64

[environment]
color = 0.2

[[light]]
type = "quad"
center = [0.0, -2.0, 3.0]
edge_u = [0.0, 1.0, 0.0]
edge_v = [1.0, 0.0, 0.0]
radiance = 6.0

[[material]]
name = "skin"
type = "skin"

[[object]]
type = "sphere"
center = [0.0, 0.0, 0.0]
radius = 1.0
material = "skin"
"""


class Renderings(CompareTest):
    """Seeds are fixed: nothing here can fail by chance."""

    @classmethod
    def prepare(cls):
        for name, albedo, seed in (("a", 0.5, "1"), ("b", 0.5, "2"), ("darker", 0.48, "3")):
            cls.write(f"{name}.toml", SCENE.format(albedo=albedo))
            support.succeed_in(cls.folder, "render", f"{name}.toml", "-o", f"{name}.exr", "--material", "diffuse", "--seed", seed)

    def test_other_windows_are_refused(self):
        for name, window in (("left", "0,0,16,24"), ("right", "16,0,32,24"), ("low", "0,1,16,24")):
            self.succeed("render", "a.toml", "-o", f"{name}.exr", "--material", "diffuse", "--spp", "1", "--crop", window)
        self.refuse("compare", "left.exr", "right.exr", naming=["left.exr and right.exr", "(0, 0) to (16, 24) of 32 x 24", "(16, 0)"])
        self.refuse("compare", "left.exr", "low.exr", naming=["16 x 24", "16 x 23"])
        self.succeed("compare", "left.exr", "left.exr", "--max-rmse", "0")

    def test_other_seeds_differ_by_noise(self):
        figures = self.figures("a.exr", "b.exr", "--max-bias-z", "4")
        self.assertGreater(figures["rmse"], 0)
        counts = figures["beyond_3_sigma"]
        self.assertLess(counts["pixels"]["tested"], 32 * 24 * 3)  # the sky is the same everywhere
        self.assertLess(counts["pixels"]["share"], 0.03)
        self.assertLess(counts["blocks"]["share"], 0.1)

    def test_another_albedo_is_more_than_noise(self):
        result = self.sunbeam("compare", "darker.exr", "a.exr", "--max-bias-z", "4", "--json")
        self.assertEqual(result.code, 1, result)
        self.assertLess(max(json.loads(result.out)["bias"]), 0)


class Refusals(CompareTest):
    @classmethod
    def prepare(cls):
        cls.exr("one.exr", 1.0, 0.5)

    def test_files(self):
        self.exr("wide.exr", 1.0, width=13)
        self.exr("no_blue.exr", 1.0, B=None)
        self.write("garbage.exr", "not an EXR file")
        content = (self.folder / "one.exr").read_bytes()
        self.write("cut.exr", content[:len(content) // 2])
        cases = [("wide.exr", ["wide.exr", "13 x 10", "12 x 10"]), ("no_blue.exr", ["no_blue.exr", "G, R", "R, G and B"]),
                 ("garbage.exr", ["garbage.exr"]), ("cut.exr", ["cut.exr"]), ("missing.exr", ["missing.exr"])]
        for name, needles in cases:
            for arguments in ((name, "one.exr"), ("one.exr", name)):
                with self.subTest(arguments=arguments):
                    self.refuse("compare", *arguments, naming=needles)

    def test_a_header_that_claims_too_many_rows(self):
        """2147483644 rows in a file of a few kB, refused within a gigabyte and 20 s."""
        box = struct.pack("<4i", 0, 0, 11, 9)
        content = (self.folder / "one.exr").read_bytes()
        self.write("rows.exr", content.replace(box, struct.pack("<4i", 0, -1073741822, 11, 1073741821), 1))
        self.write("rows.toml", SCENE.format(albedo=0.5).replace("color = 0.2", 'file = "rows.exr"'))
        self.write("bump.toml", SCENE.format(albedo=0.5).replace(
            'type = "skin"', 'type = "skin"\nbump = { file = "rows.exr", height = 0.1 }'))
        for arguments in (("compare", "rows.exr", "one.exr"), ("render", "rows.toml", "-o", "o.exr", "--material", "diffuse"),
                          ("render", "bump.toml", "-o", "o.exr", "--material", "diffuse")):
            with self.subTest(arguments=arguments):
                self.refuse(*arguments, naming=["rows.exr", "data windows ask for"], preexec_fn=support.limit_cpu_seconds(20))
        self.assertLess(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, 1000000)  # kB, of the largest child

    def test_values(self):
        values = [1.0] * 120
        for bad in (math.nan, math.inf, -math.inf):
            values[27] = bad
            self.exr("bad.exr", 1.0, G=values)
            with self.subTest(bad=bad):
                self.refuse("compare", "bad.exr", "one.exr", naming=["bad.exr", "channel G of pixel (3, 2)", str(bad), "finite"])
                self.refuse("compare", "one.exr", "bad.exr", naming=["bad.exr", "channel G"])
        for bad in (math.nan, -1.0):
            values[27] = bad
            self.exr("bad.exr", 1.0, 0.5, variance_R=values)
            with self.subTest(variance=bad):
                self.refuse("compare", "bad.exr", "one.exr", naming=["bad.exr", "channel variance.R of pixel (3, 2)"])

    def test_options(self):
        for option in ("--max-rmse", "--max-relmse", "--max-flip", "--max-bias", "--max-bias-z"):
            for value in ("-1", "nan", "inf", "small"):
                with self.subTest(option=option, value=value):
                    self.refuse("compare", "one.exr", "one.exr", option, value, naming=[option, f"'{value}'"])
        for value in ("0", "nan", "1e9"):
            self.refuse("compare", "one.exr", "one.exr", "--pixels-per-degree", value, naming=["--pixels-per-degree", f"'{value}'"])
        self.refuse("compare", "one.exr", naming=["reference"])
        self.refuse("compare", "one.exr", "one.exr", "--max-rsme", "1", naming=["--max-rsme", "--max-rmse"])
        self.refuse("compare", "one.exr", "one.exr", "--png", "flip.jpg", naming=["flip.jpg", ".png"])
        self.refuse("compare", "one.exr", "one.exr", "--png", "missing/flip.png", naming=["missing/flip.png"])


if __name__ == "__main__":
    unittest.main()
