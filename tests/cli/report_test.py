"""`sunbeam verify --html` and `sunbeam plot`: a page that stands alone and agrees with --json, pictures, refusals."""

import base64
import cmath
import html.parser
import json
import math
import re
import struct
import unittest
import xml.etree.ElementTree

import support

VOID = {"meta", "img", "link", "br", "hr", "input"}
SECTIONS = ("summary", "spheres", "error", "worst", "slices", "energy", "provenance")
FIGURES = ("error_median", "error_p95", "error_p99", "error_max", "error_textured_median", "error_textured_p99",
           "noise_floor", "energy_max", "reciprocity_max", "dirac_error_p99", "rest_error_median", "points")
PNG = b"\x89PNG\r\n\x1a\n"


class Page(html.parser.HTMLParser):
    """Tags in balance, ids, figures, references and text by id."""

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.figures, self.references, self.text, self.tags = [], [], {}, [], {}, []
        self.feed(text)
        self.close()

    def handle_startendtag(self, tag, attributes):
        self.note(tag, dict(attributes))

    def handle_starttag(self, tag, attributes):
        self.note(tag, dict(attributes))
        if tag not in VOID:
            self.open.append((tag, dict(attributes).get("id")))

    def handle_endtag(self, tag):
        if not self.open or self.open[-1][0] != tag:
            raise AssertionError(f"</{tag}> at {self.getpos()} closes {self.open[-3:]}")
        self.open.pop()

    def handle_data(self, data):
        if self.open and self.open[-1][1]:
            name = self.open[-1][1]
            self.text[name] = self.text.get(name, "") + data

    def note(self, tag, attributes):
        self.tags.append(tag)
        if "id" in attributes:
            self.ids.append(attributes["id"])
        if tag == "data":
            self.figures[attributes["id"]] = float(attributes["value"])
        self.references += [attributes[key] for key in ("src", "href", "xlink:href") if key in attributes]


def size_of_png(content):
    assert content.startswith(PNG)
    return struct.unpack(">II", content[16:24])


def airy(thickness_nm, degrees):
    """Reflectance at 650, 510 and 475 nm of tiny.toml's film of 1.56 between 1 and 1.5 (docs/theory/model.md)."""
    indices = (1, 1.56, 1.5)
    cosines = [cmath.sqrt(1 - (math.sin(math.radians(degrees)) / n) ** 2) for n in indices]
    result = []
    for nm in (650, 510, 475):
        phase = cmath.exp(4j * math.pi / nm * indices[1] * thickness_nm * cosines[1])
        total = 0
        for admittances in ([n * c for n, c in zip(indices, cosines)], [n / max(abs(c), 1e-12) for n, c in zip(indices, cosines)]):
            upper, lower = ((admittances[k] - admittances[k + 1]) / (admittances[k] + admittances[k + 1]) for k in (0, 1))
            total += abs((upper + lower * phase) / (1 + upper * lower * phase)) ** 2 / 2
        result.append(total)
    return result


def srgb_byte(linear):
    return 255 * (12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055)


class Report(support.CliTest):
    @classmethod
    def prepare(cls):
        support.succeed_in(cls.folder, "bake", support.SOURCE_DIR / "tables/recipes/quick.toml", "-o", "quick.exr")
        support.succeed_in(cls.folder, "bake", "tiny.toml", "-o", "tiny.exr")
        support.succeed_in(cls.folder, "verify", "quick.exr", "--points", "60", "--json", "quick.json", "--html", "quick.html")
        cls.source = (cls.folder / "quick.html").read_text()
        cls.page = Page(cls.source)

    def test_tags_are_balanced_and_ids_unique(self):
        self.assertEqual(self.page.open, [])
        self.assertEqual(len(self.page.ids), len(set(self.page.ids)))

    def test_every_section_is_there(self):
        self.assertLessEqual(set(SECTIONS), set(self.page.ids))
        self.assertGreaterEqual(self.page.tags.count("svg"), 4 + 6 + 1)

    def test_the_page_needs_no_other_file(self):
        self.assertNotRegex(self.source, r"https?://|@import|url\(|<script|<link")
        self.assertGreaterEqual(len(self.page.references), 6 * 4)
        for reference in self.page.references:
            kind, content = reference.split(",", 1)
            self.assertEqual(kind, "data:image/png;base64")
            self.assertGreater(min(size_of_png(base64.b64decode(content, validate=True))), 50)
        self.assertLess(len(self.source), 2_000_000)

    def test_light_and_dark(self):
        self.assertIn("prefers-color-scheme: dark", self.source)

    def test_figures_are_those_of_the_json_report(self):
        report = json.loads((self.folder / "quick.json").read_text())
        for name in FIGURES:
            self.assertEqual(self.page.figures[name], report[name], name)
        self.assertEqual(self.page.text["truth"], report["truth"])
        self.assertIn(">PASS<", self.source)

    def test_the_recipe_is_that_of_the_table(self):
        info = json.loads(self.succeed("info", "quick.exr", "--json").out)
        self.assertEqual(self.page.text["recipe"].strip(), info["recipe"].strip())
        self.assertIn(f"{info['bytes']} bytes", self.source)

    def test_the_command_makes_the_same_page(self):
        command = self.page.text["command"].split()
        self.assertEqual(command[0], "sunbeam")
        self.succeed(*command[1:], "--threads", "1")
        self.assertEqual((self.folder / "quick.html").read_text(), self.source)

    def test_a_failing_table_still_has_its_report(self):
        self.miss("bake", "tiny.toml", "-o", "strict.exr", "--set", "accuracy.tolerance_median=1e-6", figure="error_median")
        result = self.sunbeam("verify", "strict.exr", "--points", "20", "--truth", "exact", "--html", "strict.html")
        self.assertEqual(result.code, 1, result)
        source = (self.folder / "strict.html").read_text()
        self.assertEqual(Page(source).open, [])
        self.assertIn(">FAIL<", source)
        self.assertIn("--truth exact", source)

    def test_a_name_with_markup_is_text(self):
        (self.folder / "a<b>&.exr").write_bytes((self.folder / "tiny.exr").read_bytes())
        self.sunbeam("verify", "a<b>&.exr", "--points", "5", "--html", "odd name.html")
        page = Page((self.folder / "odd name.html").read_text())
        self.assertEqual(page.open, [])
        self.assertIn("'a<b>&.exr'", page.text["command"])
        self.assertIn("'odd name.html'", page.text["command"])

    def test_refusals(self):
        (self.folder / "folder.html").mkdir()
        for path, needle in (("missing/report.html", "cannot write"), ("folder.html", "folder"),
                             ("report.pdf", ".html"), ("quick.exr", ".html")):
            with self.subTest(path=path):
                self.refuse("verify", "quick.exr", "--points", "1", "--html", path, naming=[path, needle])


class Plot(support.CliTest):
    @classmethod
    def prepare(cls):
        support.succeed_in(cls.folder, "bake", "tiny.toml", "-o", "tiny.exr")

    def test_pictures(self):
        for what, size in (("sphere", (512, 512)), ("slice", (512, 256))):
            with self.subTest(what=what):
                self.succeed("plot", "tiny.exr", "--what", what, "-o", f"{what}.png")
                content = (self.folder / f"{what}.png").read_bytes()
                self.assertEqual(size_of_png(content), size)
                self.assertGreater(max(support.mean_linear(content)), 0.005)

    def test_charts(self):
        for what in ("polar", "reflectance"):
            with self.subTest(what=what):
                self.succeed("plot", "tiny.exr", "--what", what, "-o", f"{what}.svg")
                root = xml.etree.ElementTree.parse(self.folder / f"{what}.svg").getroot()
                self.assertEqual(root.tag, "{http://www.w3.org/2000/svg}svg")
                self.assertGreater(len(root.findall(".//{http://www.w3.org/2000/svg}path")), 6)

    def test_values_of_the_reflectance_chart(self):
        """The map holds the film's reflectance, thickness to the right and angle upwards, and so do the curves."""
        self.succeed("plot", "tiny.exr", "--what", "reflectance", "-o", "values.svg", "--film-thickness-nm", "250")
        svg = (self.folder / "values.svg").read_text()
        rows = support.png_rows(base64.b64decode(re.search(r'href="data:image/png;base64,([^"]+)"', svg)[1]))
        self.assertEqual((len(rows), len(rows[0])), (120, 3 * 240))
        compared = 0
        for y in range(5, 120, 10):
            for x in range(5, 240, 10):
                expected = airy(200 + (x + 0.5) / 240 * 200, 90 * (1 - (y + 0.5) / 120))
                if max(expected) > 0.5:
                    continue  # the tone curve begins
                compared += 1
                for channel in range(3):
                    self.assertAlmostEqual(rows[y][3 * x + channel], srgb_byte(expected[channel]), delta=1.5)
        self.assertGreater(compared, 150)
        for channel, color in enumerate(("#e5484d", "#30a46c", "#3e82f7")):
            data = re.search(rf'd="M([^"]+)" fill="none" stroke="{color}" stroke-width="2"', svg)[1]
            points = [tuple(map(float, point.split())) for point in data.split("L")]
            self.assertEqual(len(points), 181)
            for k, (x, y) in enumerate(points):
                self.assertAlmostEqual(x, 60 + 480 * k / 180, delta=0.06)
                self.assertAlmostEqual(y, 276 + 190 * (1 - airy(250, k / 2)[channel]), delta=0.1)

    def test_parameters_change_the_picture(self):
        pictures = set()
        for options in ((), ("--film-thickness-nm", "250"), ("--absorption-per-nm", "0.2"), ("--theta-i", "60")):
            self.succeed("plot", "tiny.exr", "--what", "polar", "-o", "p.svg", *options)
            pictures.add(re.sub("<title>.*</title>", "", (self.folder / "p.svg").read_text()))
        self.assertEqual(len(pictures), 4)

    def test_refusals(self):
        sphere = ("plot", "tiny.exr", "--what", "sphere", "-o", "s.png")
        polar = ("plot", "tiny.exr", "--what", "polar", "-o", "p.svg")
        self.write("s.png", "an older picture")
        self.write("p.svg", "an older picture")
        cases = [
            (("plot", "tiny.exr", "-o", "s.png"), ["--what"]),
            (("plot", "tiny.exr", "--what", "cube", "-o", "s.png"), ["--what", "cube", "polar", "reflectance"]),
            (("plot", "tiny.exr", "--what", "sphere", "-o", "s.svg"), ["s.svg", "sphere", ".png"]),
            (("plot", "tiny.exr", "--what", "polar", "-o", "s.png"), ["s.png", "polar", ".svg"]),
            (("plot", "tiny.exr", "--what", "slice", "-o", "tiny.exr"), ["tiny.exr", ".png"]),
            (("plot", "none.exr", "--what", "slice", "-o", "s.png"), ["none.exr"]),
            (("plot", "tiny.exr", "--what", "slice", "-o", "missing/s.png"), ["missing/s.png", "cannot write"]),
            ((*sphere, "--film-thickness-nm", "9000"), ["tiny.exr", "film_thickness_nm", "9000", "200", "400"]),
            ((*sphere, "--base-ior", "1.7"), ["tiny.exr", "base_ior", "1.7", "1.5"]),
            ((*sphere, "--absorption-per-nm", "-1"), ["tiny.exr", "absorption_per_nm", "-1", "0.2"]),
            ((*sphere, "--absorption-per-nm", "nan"), ["absorption_per_nm", "nan"]),
            ((*sphere, "--theta-i", "30"), ["--theta-i", "sphere", "polar"]),
            ((*polar, "--theta-i", "90"), ["--theta-i", "90", "0 to 89"]),
        ]
        for arguments, needles in cases:
            with self.subTest(arguments=arguments):
                self.refuse(*arguments, naming=needles)


if __name__ == "__main__":
    unittest.main()
