"""`sunbeam render`: pictures, statistics and refusals, with a scene and a table of a few pixels and nodes."""

import json
import shlex
import signal
import struct
import subprocess
import time
import unittest

import support

SCENE = """\
recipe = "../tiny.toml"
table = "../tables/tiny.exr"
diffuse_albedo = 0.5

[camera]
position = [0.0, -4.0, 1.0]
look_at = [0.0, 0.0, 0.0]
fov_deg = 40.0

[render]
width = 24
height = 16
spp = 4
max_bounces = 4

[environment]
color = [0.5, 0.6, 0.7]

[[light]]
type = "quad"
center = [0.0, -2.0, 3.0]
edge_u = [0.0, 1.0, 0.0]
edge_v = [1.0, 0.0, 0.0]
radiance = 6.0

[[material]]
name = "skin"
type = "skin"
film_thickness_nm = 350

[[material]]
name = "floor"
type = "diffuse"
albedo = 0.2

[[object]]
type = "sphere"
center = [0.0, 0.0, 0.0]
radius = 1.0
material = "skin"

[[object]]
type = "plane"
center = [0.0, 0.0, -1.0]
material = "floor"
"""

STATS = {"seconds", "cpu_seconds", "build_cpu_seconds", "samples", "rays", "vertices", "samples_per_second",
         "peak_rss_mb"}


def png_size(content):
    """Width and height from the header of a PNG."""
    if content[:8] != b"\x89PNG\r\n\x1a\n" or content[12:16] != b"IHDR":
        raise AssertionError("not a PNG file")
    return struct.unpack(">II", content[16:24])


def exr_size(content):
    """Width and height from the data window of a single-part EXR."""
    if content[:4] != b"\x76\x2f\x31\x01":
        raise AssertionError("not an EXR file")
    marker = b"dataWindow\0box2i\0" + struct.pack("<I", 16)
    start = content.index(marker) + len(marker)
    x0, y0, x1, y1 = struct.unpack("<4i", content[start:start + 16])
    return (x1 - x0 + 1, y1 - y0 + 1)


def without_time(content):
    """An EXR whose header does not tell how long it took."""
    marker = b"sunbeam.seconds\0string\0" + struct.pack("<I", 12)
    start = content.index(marker) + len(marker)
    return content[:start] + b" " * 12 + content[start + 12:]


def channels(content):
    """Names of the channels of a single-part EXR."""
    marker = b"channels\0chlist\0"
    at = content.index(marker) + len(marker)
    size, = struct.unpack("<I", content[at:at + 4])
    names, at, end = [], at + 4, at + 4 + size
    while content[at] != 0:
        stop = content.index(b"\0", at)
        names.append(content[at:stop].decode())
        at = stop + 1 + 16
    return names


class RenderTest(support.CliTest):
    @classmethod
    def prepare(cls):
        for name in ("scenes", "tables"):
            (cls.folder / name).mkdir()
        cls.write("scenes/scene.toml", SCENE)

    def read(self, name):
        return (self.folder / name).read_bytes()

    def render(self, output, *options, scene="scenes/scene.toml"):
        return self.succeed("render", scene, "-o", output, *options)


class Pictures(RenderTest):
    @classmethod
    def prepare(cls):
        super().prepare()
        support.succeed_in(cls.folder, "bake", "tiny.toml", "-o", "tables/tiny.exr")

    def test_exr_and_png_have_the_size_of_the_scene(self):
        result = self.render("scene.exr")
        self.assertEqual(result.out, "")
        self.assertEqual(exr_size(self.read("scene.exr")), (24, 16))
        self.assertEqual(png_size(self.read("scene.png")), (24, 16))

    def test_size_and_spp_replace_those_of_the_scene(self):
        self.render("sized.exr", "--size", "10x30", "--spp", "3", "--stats", "sized.json")
        self.assertEqual(exr_size(self.read("sized.exr")), (10, 30))
        self.assertEqual(png_size(self.read("sized.png")), (10, 30))
        self.assertEqual(json.loads(self.read("sized.json"))["samples"], 10 * 30 * 3)

    def test_statistics(self):
        self.render("stats.exr", "--stats", "stats.json")
        stats = json.loads(self.read("stats.json"))
        self.assertLessEqual(STATS, set(stats))
        for key in STATS:
            self.assertGreater(stats[key], 0, key)
        self.assertEqual(stats["samples"], 24 * 16 * 4)
        self.assertGreaterEqual(stats["rays"], stats["samples"])
        self.assertAlmostEqual(stats["samples_per_second"] * stats["seconds"] / stats["samples"], 1, delta=1e-6)
        self.assertLess(stats["peak_rss_mb"], 4096)
        self.assertEqual(stats.get("bad_samples", 0), 0)

    def test_pixels_do_not_depend_on_threads(self):
        for material in ("table", "live", "diffuse"):
            with self.subTest(material=material):
                for threads in ("1", "2"):
                    self.render(f"threads{threads}.exr", "--material", material, "--size", "70x50", "--threads", threads)
                self.assertEqual(without_time(self.read("threads1.exr")), without_time(self.read("threads2.exr")))
                self.assertEqual(self.read("threads1.png"), self.read("threads2.png"))

    def test_seed_and_material_change_the_picture(self):
        variants = {
            "table": (), "again": (), "seed": ("--seed", "2"),
            "live": ("--material", "live"), "diffuse": ("--material", "diffuse"),
        }
        for name, options in variants.items():
            self.render(f"{name}.exr", *options)
        self.assertEqual(without_time(self.read("table.exr")), without_time(self.read("again.exr")))
        pictures = [self.read(f"{name}.png") for name in ("table", "seed", "live", "diffuse")]
        self.assertEqual(len(set(pictures)), len(pictures), "two variants gave the same picture")

    def test_layers_and_metadata(self):
        self.render("plain.exr")
        self.assertEqual(set(channels(self.read("plain.exr"))),
                         {"R", "G", "B", "variance.R", "variance.G", "variance.B", "sample_count"})
        self.render("layers.exr", "--aovs", "--seed", "7")
        content = self.read("layers.exr")
        self.assertLess({"albedo.R", "normal.X", "geometric_normal.Z", "Z", "film_thickness_nm"},
                        set(channels(content)))
        for name in ("scene", "scene_hash", "recipe_hash", "seed", "spp", "seconds", "tool_version", "material"):
            self.assertIn(f"sunbeam.{name}\0string".encode(), content)

    def test_crop_keeps_its_place(self):
        self.render("crop.exr", "--crop", "5,3,21,10")
        content = self.read("crop.exr")
        self.assertEqual(exr_size(content), (16, 7))
        self.assertIn(b"displayWindow\0box2i\0" + struct.pack("<I4i", 16, 0, 0, 23, 15), content)
        self.assertIn(b"dataWindow\0box2i\0" + struct.pack("<I4i", 16, 5, 3, 20, 9), content)

    def test_a_limit_of_time(self):
        result = self.render("time.exr", "--time", "1.5s", "--material", "diffuse", "--stats", "time.json")
        self.assertIn("100 %", result.err)
        stats = json.loads(self.read("time.json"))
        self.assertGreater(stats["samples"], 24 * 16 * 100)
        self.assertLess(stats["cpu_seconds"], 10)  # whatever else runs

    def test_a_limit_of_noise(self):
        for noise in ("0.1", "0.02"):
            self.render("noise.exr", "--noise", noise, "--stats", f"noise{noise}.json")
        coarse, fine = (json.loads(self.read(f"noise{noise}.json"))["samples"] for noise in ("0.1", "0.02"))
        self.assertGreater(fine, 4 * coarse)
        self.assertLess(fine, 24 * 16 * 65536)

    def test_resume_goes_on_with_the_samples_that_are_missing(self):
        self.render("part.exr", "--aovs", "--spp", "3")
        self.render("resumed.exr", "--aovs", "--spp", "9", "--resume", "part.exr", "--stats", "resumed.json")
        self.render("whole.exr", "--aovs", "--spp", "9")
        self.assertEqual(json.loads(self.read("resumed.json"))["samples"], 24 * 16 * 6)
        self.succeed("compare", "resumed.exr", "whole.exr", "--max-rmse", "1e-6")

    def test_resume_refuses_what_is_not_the_same(self):
        self.render("seed1.exr")
        self.write("scenes/changed.toml", SCENE.replace("radius = 1.0", "radius = 0.9"))
        cases = [
            (("scenes/scene.toml", "--seed", "2"), ("seed1.exr", "sunbeam.seed", "'1'", "'2'")),
            (("scenes/scene.toml", "--material", "diffuse"), ("seed1.exr", "sunbeam.material")),
            (("scenes/changed.toml",), ("seed1.exr", "sunbeam.scene_hash")),
            (("scenes/scene.toml", "--size", "20x20"), ("same window",)),
        ]
        for options, naming in cases:
            with self.subTest(options=options):
                self.refuse("render", *options, "-o", "i.exr", "--resume", "seed1.exr", naming=naming)

    def test_ctrl_c_writes_what_there_is(self):
        process = subprocess.Popen(
            [support.BINARY, "render", "scenes/scene.toml", "-o", "stopped.exr", "--spp", "16777216", "--watch"],
            cwd=self.folder, stderr=subprocess.PIPE)
        while process.poll() is None and not (self.folder / "stopped.png").exists():  # of --watch
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=support.TIME_LIMIT_S)
        self.assertEqual(process.returncode, 130, err)
        self.assertIn(b"--resume stopped.exr", err)
        self.assertEqual(exr_size(self.read("stopped.exr")), (24, 16))

    def test_paths_are_relative_to_the_scene(self):
        result = support.run_command([support.BINARY, "render", "scene.toml", "-o", "../from_inside.exr"],
                                     self.folder / "scenes")
        self.assertEqual(result.code, 0, result)
        self.render("from_outside.exr")
        self.assertEqual(self.read("from_inside.png"), self.read("from_outside.png"))

    def test_parameters_outside_the_table_are_refused(self):
        for key, value in (("film_thickness_nm", "450"), ("base_ior", "1.7"), ("absorption_per_nm", "0.3")):
            with self.subTest(key=key):
                self.write("scenes/outside.toml", SCENE.replace("film_thickness_nm = 350", f"{key} = {value}"))
                self.refuse("render", "scenes/outside.toml", "-o", "i.exr",
                            naming=["scenes/outside.toml", "'skin'", key, value])


class MissingTable(RenderTest):
    def test_the_printed_command_bakes_it(self):
        result = self.refuse("render", "scenes/scene.toml", "-o", "i.exr",
                             naming=["scenes/scene.toml", "tables/tiny.exr", "does not exist", "sunbeam bake "])
        command = shlex.split(result.err[result.err.index("sunbeam bake "):])
        self.assertEqual(command, ["sunbeam", "bake", "tiny.toml", "-o", "tables/tiny.exr"])
        self.succeed(*command[1:])
        self.render("i.exr")

    def test_live_and_diffuse_need_no_table(self):
        self.write("scenes/other.toml", SCENE.replace("tables/tiny.exr", "tables/missing.exr"))
        for material in ("live", "diffuse"):
            with self.subTest(material=material):
                self.render(f"{material}.exr", "--material", material, "--spp", "1", scene="scenes/other.toml")

    def test_the_estimator_of_live_skins(self):
        """tiny.toml has the product path, which no fast exact evaluator covers."""
        self.write("sum.toml", support.TINY_RECIPE.replace('"product"', '"sum"'))
        self.write("scenes/sum.toml", SCENE.replace("../tiny.toml", "../sum.toml"))
        live = ("--material", "live", "--spp", "1", "--stats", "s.json")
        cases = [("scene", "auto", "pfmc-unidirectional"), ("scene", "pfmc", "pfmc-unidirectional"),
                 ("sum", "auto", "exact-quadrature"), ("sum", "exact", "exact-quadrature"),
                 ("sum", "pfmc", "pfmc-unidirectional")]
        for scene, option, name in cases:
            with self.subTest(scene=scene, option=option):
                result = self.render("i.exr", *live, "--estimator", option, scene=f"scenes/{scene}.toml")
                self.assertIn(f"estimator: {name}\n", result.err)
                self.assertEqual(json.loads(self.read("s.json"))["estimator"], name)
                self.assertIn(name.encode(), self.read("i.exr"))
        self.assertIn("estimator: exact-quadrature\n", self.render("i.exr", *live, scene="scenes/sum.toml").err)

    def test_an_estimator_that_cannot_be_used(self):
        self.refuse("render", "scenes/scene.toml", "-o", "i.exr", "--material", "live", "--estimator", "exact",
                    naming=["scenes/scene.toml", "'skin'", "'absorption_path'", "product", "sum"])
        for material in ("table", "diffuse"):
            self.refuse("render", "scenes/scene.toml", "-o", "i.exr", "--material", material, "--estimator", "exact",
                        naming=["--estimator", "exact", "--material live"])

    def test_a_film_that_grows_too_thick_for_the_estimator(self):
        """The whole range counts, before anything is rendered: a rough film has a limit."""
        self.write("rough.toml", support.TINY_RECIPE.replace('"product"', '"sum"').replace("roughness = 0.0", "roughness = 0.2"))
        scene = SCENE.replace("../tiny.toml", "../rough.toml").replace(
            "film_thickness_nm = 350", "film_thickness_nm = {from = 300, to = 90000, ramp = [1, 0]}")
        self.write("scenes/thick.toml", scene)
        self.refuse("render", "scenes/thick.toml", "-o", "i.exr", "--material", "live", "--estimator", "exact",
                    naming=["scenes/thick.toml", "material 'skin'", "'film_thickness_nm'", "90000"])

    def test_a_scene_that_names_no_table_or_recipe(self):
        self.write("scenes/none.toml", "\n".join(SCENE.splitlines()[2:]) + "\n")
        self.refuse("render", "scenes/none.toml", "-o", "i.exr", naming=["scenes/none.toml", "'table'"])
        self.refuse("render", "scenes/none.toml", "-o", "i.exr", "--material", "live",
                    naming=["scenes/none.toml", "'recipe'"])
        self.render("diffuse.exr", "--material", "diffuse", "--spp", "1", scene="scenes/none.toml")


class Refusals(RenderTest):
    """All with --material diffuse, so that no table is needed."""

    def refuse_scene(self, old, new, *needles, scene=SCENE):
        self.assertIn(old, scene)
        self.write("scenes/bad.toml", scene.replace(old, new, 1))
        line = scene[:scene.index(old)].count("\n") + 1
        with self.subTest(old=old, new=new):
            self.refuse("render", "scenes/bad.toml", "-o", "i.exr", "--material", "diffuse",
                        naming=[f"scenes/bad.toml:{line}: ", *needles])

    def test_bad_values(self):
        self.refuse_scene("radius = 1.0", "radius = -1.0", "radius", "found -1", "allowed")
        self.refuse_scene("radius = 1.0", "radius = nan", "radius", "found nan", "allowed")
        self.refuse_scene("radius = 1.0", "radius = inf", "radius", "found inf", "allowed")
        self.refuse_scene("radius = 1.0", 'radius = "big"', "radius", "found a string", "number")
        self.refuse_scene("fov_deg = 40.0", "fov_deg = 180.0", "camera.fov_deg", "found 180", "allowed")
        self.refuse_scene("spp = 4", "spp = 0", "render.spp", "found 0", "allowed")
        self.refuse_scene("width = 24", "width = 24.5", "render.width", "found 24.5", "whole number")
        self.refuse_scene("albedo = 0.2", "albedo = 1.2", "albedo", "found 1.2", "0 to 1")
        self.refuse_scene("film_thickness_nm = 350", "film_thickness_nm = -1", "film_thickness_nm", "found -1")
        self.refuse_scene("film_thickness_nm = 350", "base_ior = 0.9", "base_ior", "found 0.9")
        self.refuse_scene("color = [0.5, 0.6, 0.7]", "color = [0.5, 0.6]", "environment.color", "2 numbers")
        self.refuse_scene("color = [0.5, 0.6, 0.7]", "color = [0.5, -1, 0.7]", "environment.color", "element 2 is -1")
        self.refuse_scene("look_at = [0.0, 0.0, 0.0]", "look_at = [0.0, -4.0, 1.0]", "camera.look_at", "position")
        self.refuse_scene("radiance = 6.0", "radiance = -6.0", "radiance", "found -6")
        self.refuse_scene('type = "sphere"', 'type = "cube"', "type", 'found "cube"', '"sphere"')
        self.refuse_scene('type = "skin"', 'type = "skim"', "type", 'found "skim"', '"skin"')
        self.refuse_scene('material = "skin"', 'material = "skim"', "material", 'found "skim"', '"skin"')
        self.refuse_scene('name = "floor"', 'name = "skin"', "name", '"skin"', "second time")

    def test_unknown_keys_and_sections(self):
        self.refuse_scene("fov_deg", "fov_degrees", "camera.fov_degrees", "'fov_deg'")
        self.refuse_scene("max_bounces", "max_bounce", "render.max_bounce", "'max_bounces'")
        self.refuse_scene("[environment]", "[enviroment]", "enviroment", "'environment'")
        self.refuse_scene("[[light]]", "[[ligth]]", "ligth", "'light'")

    def test_broken_toml(self):
        self.refuse_scene("fov_deg = 40.0", "fov_deg = = 40.0")
        self.refuse_scene("[camera]", "[camera")

    def test_missing_things(self):
        self.write("scenes/empty.toml", SCENE[:SCENE.index("[[object]]")])
        self.refuse("render", "scenes/empty.toml", "-o", "i.exr", "--material", "diffuse",
                    naming=["scenes/empty.toml", "object"])
        for name in ("missing.toml", "scenes"):
            with self.subTest(scene=name):
                self.refuse("render", name, "-o", "i.exr", naming=[name, "cannot read"])

    def test_missing_files_of_a_scene(self):
        self.refuse_scene("color = [0.5, 0.6, 0.7]", 'file = "sky.exr"', "environment.file", "scenes/sky.exr")
        self.refuse_scene('center = [0.0, 0.0, -1.0]\n', 'file = "snake.obj"\n', "object[1].file", "scenes/snake.obj",
                          scene=SCENE.replace('type = "plane"', 'type = "mesh"'))

    def test_missing_recipe(self):
        self.write("scenes/bad.toml", SCENE.replace("../tiny.toml", "../missing.toml"))
        self.refuse("render", "scenes/bad.toml", "-o", "i.exr", "--material", "live", naming=["missing.toml"])

    def test_bad_sizes(self):
        for size in ("0x10", "10x0", "10", "x", "10x", "x10", "10x10x", "10*10", "-1x10", "1.5x2", "99999x1", " 8x8", ""):
            with self.subTest(size=size):
                self.refuse("render", "scenes/scene.toml", "-o", "i.exr", "--material", "diffuse", "--size", size,
                            naming=["--size", f"'{size}'", "WIDTHxHEIGHT"])

    def test_bad_crops_times_and_limits(self):
        cases = [("--crop", "1,2,3"), ("--crop", "1,2,3,4,5"), ("--crop", "a,0,1,1"), ("--crop", "0,0,25,16"),
                 ("--crop", "5,5,5,9"), ("--time", "0s"), ("--time", "10x"), ("--time", "-1s"), ("--time", "nan"),
                 ("--noise", "0"), ("--noise", "2"), ("--resume", "missing.exr")]
        for option, value in cases:
            with self.subTest(option=option, value=value):
                self.refuse("render", "scenes/scene.toml", "-o", "i.exr", "--material", "diffuse", f"{option}={value}",
                            naming=[option.strip("-") if option == "--crop" else value])

    def test_a_camera_inside_an_object(self):
        self.write("scenes/inside.toml", SCENE.replace("position = [0.0, -4.0, 1.0]", "position = [0.0, -0.5, 0.1]"))
        self.refuse("render", "scenes/inside.toml", "-o", "i.exr", "--material", "diffuse",
                    naming=["scenes/inside.toml", "camera", "inside object 1"])

    def test_unwritable_outputs(self):
        for name in ("folder.exr", "folder.json", "blocked.png"):
            (self.folder / name).mkdir()
        cases = [
            (("-o", "missing/i.exr"), "missing/i.exr"),
            (("-o", "folder.exr"), "folder.exr"),
            (("-o", "blocked.exr"), "blocked.png"),
            (("-o", "i.png"), "i.png"),
            (("-o", "i"), ".exr"),
            (("-o", "i.exr", "--stats", "missing/s.json"), "missing/s.json"),
            (("-o", "i.exr", "--stats", "folder.json"), "folder.json"),
        ]
        for options, needle in cases:
            with self.subTest(options=options):
                self.refuse("render", "scenes/scene.toml", "--material", "diffuse", *options, naming=[needle])


if __name__ == "__main__":
    unittest.main()
