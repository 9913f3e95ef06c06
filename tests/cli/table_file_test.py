"""`sunbeam info`, other programs that read the files, and damaged files. One bake of each encoding serves all."""

import json
import pathlib
import random
import re
import shutil
import tempfile
import unittest

import support

COMMON = ("--seed", "7", "--set", "grid.base_ior=[1.4, 1.6]", "--set", "material.albedo=0.02")
OPTIONS = {
    "table": (*COMMON, "--set", "table.encoding=dense"),
    "factored": (*COMMON, "--set", "table.encoding=factored", "--set", "material.roughness=0.2"),
}
FORMS = ("exr", "vdb")
NAMES = [f"{table}.{form}" for table in OPTIONS for form in FORMS]
# A smooth film has no film_transmittance.
ARRAYS = {"table": ["film_reflectance", "remainder", "rest_stderr"], "factored": ["arrival", "exchange"]}
KEYS = ["schema_version", "encoding", "bytes", "axes", "arrays", "recipe", "recipe_hash", "seed", "samples",
        "estimator", "spectrum", "color_space", "tool_version", "error"]


def setUpModule():
    global FOLDER
    FOLDER = pathlib.Path(tempfile.mkdtemp(prefix="sunbeam-test-"))
    unittest.addModuleCleanup(shutil.rmtree, FOLDER)
    (FOLDER / "tiny.toml").write_text(support.TINY_RECIPE)
    for name in NAMES:
        support.succeed_in(FOLDER, "bake", "tiny.toml", "-o", name, *OPTIONS[name[:-4]])


class TableFileTest(support.CliTest):
    @classmethod
    def prepare(cls):
        for name in NAMES:
            shutil.copy(FOLDER / name, cls.folder / name)

    def info(self, name):
        return json.loads(self.succeed("info", name, "--json").out)


class Info(TableFileTest):
    def test_json_keys(self):
        for name in NAMES:
            with self.subTest(table=name):
                self.assertEqual(list(self.info(name)), KEYS)

    def test_values(self):
        for name in NAMES:
            with self.subTest(table=name):
                info = self.info(name)
                self.assertEqual(info["schema_version"], 3)
                self.assertEqual(info["encoding"], "dense" if name.startswith("table") else "factored")
                self.assertEqual(info["bytes"], (self.folder / name).stat().st_size)
                self.assertEqual(info["seed"], 7)
                self.assertGreater(info["samples"], 0)
                self.assertEqual((info["spectrum"], info["color_space"]), ("rgb3", "rec709"))
                self.assertRegex(info["estimator"], r"^pfmc-[\w-]+$")
                self.assertRegex(info["recipe_hash"], r"^[0-9a-f]{32}$")
                self.assertEqual(f"sunbeam {info['tool_version']}\n", self.succeed("--version").out)

    def test_the_recipe_chooses_the_estimator(self):
        baked = self.succeed("bake", "tiny.toml", "-o", "bidirectional.exr", "--set", "table.encoding=dense",
                             "--set", "accuracy.estimator=bidirectional")
        self.assertEqual(baked.err.count("pfmc-bidirectional"), 2)
        self.assertIn("points by pfmc-unidirectional", baked.err)  # enough of a truth where nothing scatters
        info = json.loads(self.succeed("info", "bidirectional.exr", "--json").out)
        self.assertEqual(info["estimator"], "pfmc-bidirectional")
        self.succeed("verify", "bidirectional.exr", "--points", "10", "--truth", "bidirectional")

    PARAMETERS = {
        "film_thickness_nm": ("nm", [200, 400]),
        "base_ior": ("1", [1.4, 1.6]),
        "absorption_per_nm": ("1/nm", [0, 0.2]),
    }
    DIRECTIONS = {"cos_theta_i": ("1", 3), "phi_i": ("rad", 1), "cos_theta_o": ("1", 3), "phi_o": ("rad", 1)}
    # Of the grid: the depth is absorption times 2 nm, and the albedo the one of the base.
    LEADING = {"base_ior": ("1", [1.4, 1.6]), "optical_depth": ("1", [0, 0.4]), "albedo": ("1", [0.02])}

    def check_axes(self, axes, expected):
        self.assertEqual([axis["name"] for axis in axes], list(expected))
        for axis in axes:
            self.assertEqual(list(axis), ["name", "unit", "nodes"])
            unit, nodes = expected[axis["name"]]
            self.assertEqual(axis["unit"], unit)
            if isinstance(nodes, list):
                self.assertEqual(axis["nodes"], nodes)
            else:
                self.assertEqual(len(axis["nodes"]), nodes)
                self.assertEqual(axis["nodes"], sorted(axis["nodes"]))

    def test_axes(self):
        self.check_axes(self.info("table.exr")["axes"], {**self.PARAMETERS, **self.DIRECTIONS})
        self.check_axes(self.info("factored.exr")["axes"], self.PARAMETERS)

    def test_arrays(self):
        for table, names in ARRAYS.items():
            arrays = self.info(f"{table}.exr")["arrays"]
            self.assertEqual([array["name"] for array in arrays], names)
            precisions = {"float", "half"} if table == "table" else {"half"}
            self.assertEqual({array["precision"] for array in arrays}, precisions)
        self.assertEqual(self.info("table.exr")["arrays"][1]["axes"], self.info("table.exr")["axes"])
        # 2 n1 d / lambda of 400 nm at 475 nm and 200 nm at 650 nm, with one node beyond.
        orders = self.info("factored.exr")["arrays"][1]["axes"][3]["nodes"]
        self.assertAlmostEqual(orders[-2], 2 * 1.56 * 400 / 475, places=9)
        self.assertAlmostEqual(orders[0], 2 * 1.56 * 200 / 650, places=9)
        self.check_axes(self.info("factored.exr")["arrays"][1]["axes"],
                        {**self.LEADING, "fringe_order": ("1", len(orders)), **self.DIRECTIONS})

    def test_both_forms_agree_in_all_but_bytes(self):
        for table in OPTIONS:
            exr, vdb = (self.info(f"{table}.{form}") for form in FORMS)
            self.assertNotEqual(exr.pop("bytes"), vdb.pop("bytes"))
            self.assertEqual(exr, vdb)

    def test_both_forms_evaluate_to_the_same_digits(self):
        points = "theta_i_deg,theta_o_deg,phi_deg,film_thickness_nm\n0,0,0,200\n30,40,180,311\n85,89,20,400\n"
        for quantity in ("brdf", "albedo", "film"):
            for table in OPTIONS:
                exr, vdb = (self.succeed("eval", f"{table}.{form}", "--points", "-", "--quantity", quantity,
                                         stdin=points).out for form in FORMS)
                self.assertEqual(exr, vdb)

    def test_the_recipe_inside_gives_the_table_again(self):
        for table in OPTIONS:
            info = self.info(f"{table}.exr")
            self.write("inside.toml", info["recipe"])
            self.succeed("bake", "inside.toml", "-o", "again.exr", "--seed", str(info["seed"]))
            self.assertEqual((self.folder / "again.exr").read_bytes(), (self.folder / f"{table}.exr").read_bytes())

    def test_the_error_inside_is_that_of_verify(self):
        for table in OPTIONS:
            self.succeed("verify", f"{table}.exr", "--points", "250", "--json", "report.json")
            report = json.loads((self.folder / "report.json").read_text())
            self.assertEqual(self.info(f"{table}.exr")["error"], report)

    def test_text_shows_the_same_facts(self):
        for name in NAMES:
            text = self.succeed("info", name).out
            info = self.info(name)
            for fact in (info["recipe_hash"], info["estimator"], info["recipe"], str(info["bytes"])):
                self.assertIn(fact, text)
            for axis in info["axes"]:
                self.assertRegex(text, rf"(?m)^axis +{axis['name']} +{len(axis['nodes'])} nodes")
            for array in info["arrays"]:
                axes = " ".join(f"{axis['name']} {len(axis['nodes'])}" for axis in array["axes"])
                self.assertRegex(text, rf"(?m)^array +{array['name']} +{array['precision']}: {axes}$")

    def test_an_extension_in_capitals_is_the_same_form(self):
        shutil.copy(self.folder / "table.exr", self.folder / "CAPITAL.EXR")
        self.assertEqual(self.info("CAPITAL.EXR"), self.info("table.exr"))


class InfoOfRecipe(support.CliTest):
    def test_it_names_what_auto_takes_and_why(self):
        text = self.succeed("info", "tiny.toml").out
        self.assertRegex(text, r"(?m)^eval +exact-quadrature: \w")
        self.assertRegex(text, r"(?m)^render +pfmc-unidirectional: .*absorption_path.*product.*sum")
        info = json.loads(self.succeed("info", "tiny.toml", "--json").out)
        self.assertEqual(list(info), ["recipe_hash", "spectrum", "eval", "render"])
        self.assertEqual(info["eval"]["estimator"], "exact-quadrature")
        self.assertEqual(info["render"]["estimator"], "pfmc-unidirectional")
        for use in ("eval", "render"):
            self.assertIn(info[use]["reason"], text)

    def test_the_sum_path_is_exact_in_a_renderer_unless_a_rough_film_is_thick(self):
        recipe = support.TINY_RECIPE.replace('"product"', '"sum"').replace("roughness = 0.0", "roughness = 0.2")
        for thickness, name in (("300.0", "exact-quadrature"), ("6000.0", "pfmc-unidirectional")):
            grid_free = recipe.replace("film_thickness_nm = [200.0, 400.0]\n", "")
            self.write("sum.toml", grid_free.replace("film_thickness_nm = 300.0", f"film_thickness_nm = {thickness}"))
            self.assertEqual(json.loads(self.succeed("info", "sum.toml", "--json").out)["render"]["estimator"], name)


class OtherPrograms(TableFileTest):
    """What other programs see of the files. A missing program fails the test."""

    def run_tool(self, package, *command):
        if shutil.which(command[0]) is None:
            self.fail(f"{command[0]} is not installed: apt install {package}")
        result = support.run_command(command, self.folder)
        self.assertEqual(result.code, 0, result)
        return result.out

    def test_exrheader(self):
        for table, first_axis in (("table", "film_thickness_nm"), ("factored", "base_ior")):
            text = self.run_tool("openexr", "exrheader", f"{table}.exr")
            self.assertEqual(re.findall(r'(?m)^name \(type string\): "(\w+)"', text), ARRAYS[table])
            info = self.info(f"{table}.exr")
            self.assertIn(f'sunbeam.recipe_hash (type string): "{info["recipe_hash"]}"', text)
            self.assertIn('sunbeam.schema_version (type string): "3"', text)
            self.assertIn(f'sunbeam.axis.0.name (type string): "{first_axis}"', text)

    def test_exrinfo(self):
        for table, channels in (("table", ("'G': half", "'G': float")), ("factored", ("'Y': half",))):
            text = self.run_tool("openexr", "exrinfo", "-v", f"{table}.exr")
            for name in ARRAYS[table]:
                self.assertRegex(text, rf"part \d+: {name}\b")
            for channel in channels:
                self.assertIn(channel, text)

    def test_exrmultipart_splits_the_file(self):
        """Reads every pixel and writes it anew."""
        for table, arrays in ARRAYS.items():
            self.run_tool("openexr", "exrmultipart", "-separate", "-i", f"{table}.exr", "-o", f"part_{table}")
            parts = sorted(self.folder.glob(f"part_{table}*.exr"))
            self.assertEqual(len(parts), len(arrays))
            for part in parts:
                self.run_tool("openexr", "exrheader", part.name)

    def test_vdb_print(self):
        for table, kind in (("table", "vec3s"), ("factored", "float")):
            text = self.run_tool("libopenvdb-tools", "vdb_print", "-l", f"{table}.vdb")
            for name in ARRAYS[table]:
                self.assertRegex(text, rf"(?m)^\W*Name: {name}$")
            info = self.info(f"{table}.vdb")
            self.assertIn(f'sunbeam.recipe_hash: {info["recipe_hash"]}', text)
            self.assertIn(kind, self.run_tool("libopenvdb-tools", "vdb_print", f"{table}.vdb"))


class Damage(TableFileTest):
    """Cut, flipped and foreign files: refused, never read as something else, never a crash."""

    POSITIONS = 40

    def refuse_file(self, name):
        self.check_refusal(self.sunbeam("info", name, "--json"), name)

    def test_cut_files(self):
        for name in NAMES:
            content = (self.folder / name).read_bytes()
            # Every scale of length, and the last bytes of all.
            lengths = {0, 1, 4, 7, 8, 20, 57, 64, len(content) - 1, len(content) - 9}
            lengths |= {len(content) * k // (self.POSITIONS - len(lengths)) for k in range(self.POSITIONS - len(lengths))}
            self.assertGreaterEqual(len(lengths), self.POSITIONS - 2)
            for length in sorted(lengths):
                with self.subTest(table=name, length=length):
                    self.refuse_file(self.write(f"cut.{name[-3:]}", content[:length]))

    def test_flipped_bits(self):
        """A flip that changes nothing of the table, such as a display hint, may pass."""
        chance = random.Random(20240501)
        for name in NAMES:
            content = (self.folder / name).read_bytes()
            original = self.succeed("info", name, "--json").out
            # Half of them in the first 2000 bytes, where the headers are.
            positions = [chance.randrange(2000) for _ in range(self.POSITIONS // 2)]
            positions += [chance.randrange(len(content)) for _ in range(self.POSITIONS // 2)]
            refused = 0
            for position in positions:
                flipped = bytearray(content)
                flipped[position] ^= 1 << chance.randrange(8)
                damaged = self.write(f"flipped.{name[-3:]}", bytes(flipped))
                with self.subTest(table=name, position=position):
                    result = self.sunbeam("info", damaged, "--json")
                    if result.code == 0:
                        self.assertEqual(result.out, original)
                    else:
                        self.check_refusal(result, damaged)
                        refused += 1
            self.assertGreater(refused, self.POSITIONS * 3 // 4)

    def test_appended_zeros_and_overwritten_stretches(self):
        for name in NAMES:
            content = (self.folder / name).read_bytes()
            original = self.succeed("info", name, "--json").out
            for start in range(0, len(content), max(1, len(content) // 10)):
                for fill in (b"\x00", b"\xff"):
                    damaged = content[:start] + fill * 512 + content[start + 512:]
                    with self.subTest(table=name, start=start, fill=fill):
                        result = self.sunbeam("info", self.write(f"filled.{name[-3:]}", damaged[:len(content)]), "--json")
                        if result.code == 0:
                            self.assertEqual(result.out, original)
                        else:
                            self.check_refusal(result, "filled")

    def test_foreign_files(self):
        self.write("text.exr", support.TINY_RECIPE)
        self.write("text.vdb", support.TINY_RECIPE)
        self.write("empty.exr", "")
        self.write("empty.vdb", "")
        shutil.copy(self.folder / "table.exr", self.folder / "exr.vdb")
        shutil.copy(self.folder / "table.vdb", self.folder / "vdb.exr")
        for name in ("text.exr", "text.vdb", "empty.exr", "empty.vdb", "exr.vdb", "vdb.exr"):
            with self.subTest(name=name):
                self.refuse_file(name)

    def test_a_picture_is_not_a_table(self):
        self.write("scene.toml", 'diffuse_albedo = 0.5\n[camera]\nposition = [0, -4, 1]\nlook_at = [0, 0, 0]\n'
                   '[environment]\ncolor = 0.5\n[[material]]\nname = "grey"\ntype = "diffuse"\n'
                   '[[object]]\ntype = "sphere"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = "grey"\n')
        self.succeed("render", "scene.toml", "-o", "picture.exr", "--size", "8x8", "--spp", "1")
        for arguments in (("info",), ("verify",), ("eval", "--points", "-")):
            with self.subTest(command=arguments[0]):
                self.refuse(*arguments, "picture.exr", stdin="theta_i_deg,theta_o_deg,phi_deg\n1,2,3\n",
                            naming=["picture.exr", "not a Sunbeam table"])

    def test_every_command_refuses_a_damaged_table(self):
        content = bytearray((self.folder / "table.exr").read_bytes())
        content[len(content) // 2] ^= 0x10
        self.write("damaged.exr", bytes(content))
        self.write("scene.toml", 'table = "damaged.exr"\n[camera]\nposition = [0, -4, 1]\nlook_at = [0, 0, 0]\n'
                   '[[material]]\nname = "skin"\ntype = "skin"\n'
                   '[[object]]\ntype = "sphere"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = "skin"\n')
        for arguments in (("info", "damaged.exr"), ("verify", "damaged.exr"),
                          ("eval", "damaged.exr", "--points", "-"), ("render", "scene.toml", "-o", "i.exr")):
            with self.subTest(command=arguments[0]):
                self.refuse(*arguments, stdin="theta_i_deg,theta_o_deg,phi_deg\n1,2,3\n", naming=["damaged.exr"])

    def test_missing_file_folder_and_extension(self):
        for suffix in ("exr", "vdb"):
            (self.folder / f"folder.{suffix}").mkdir()
            for name, needle in ((f"missing.{suffix}", "No such file"), (f"folder.{suffix}", "folder")):
                for command in ("info", "verify"):
                    with self.subTest(name=name, command=command):
                        self.refuse(command, name, naming=[name, needle])
        self.write("tiny.txt", support.TINY_RECIPE)
        for command, name in (("info", "tiny.txt"), ("verify", "tiny.txt"), ("verify", "tiny.toml")):
            with self.subTest(command=command):
                self.refuse(command, name, naming=[name, ".exr", ".vdb"])


if __name__ == "__main__":
    unittest.main()
