"""`sunbeam bake`: the same recipe gives the same bytes, and a table appears only when it is complete."""

import unittest

import support

# Facets make a factored table depend on walks to the last visible digit.
ENCODINGS = {
    "dense": ("--set", "table.encoding=dense"),
    "factored": ("--set", "table.encoding=factored", "--set", "material.roughness=0.2"),
}


class Reproducibility(support.CliTest):
    @classmethod
    def prepare(cls):
        bakes = {}
        for encoding, options in ENCODINGS.items():
            for form in ("exr", "vdb"):
                bakes[f"{encoding}_one.{form}"] = ("--threads", "1", *options)
                bakes[f"{encoding}_two.{form}"] = ("--threads", "2", *options)
            bakes[f"{encoding}_other.exr"] = ("--threads", "1", "--seed", "2", *options)
        cls.results = {
            name: support.succeed_in(cls.folder, "bake", "tiny.toml", "-o", name, *options)
            for name, options in bakes.items()
        }

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def test_bytes_do_not_depend_on_threads(self):
        for encoding in ENCODINGS:
            for form in ("exr", "vdb"):
                with self.subTest(encoding=encoding, form=form):
                    self.assertEqual(self.bytes_of(f"{encoding}_one.{form}"), self.bytes_of(f"{encoding}_two.{form}"))

    def test_another_seed_gives_other_values(self):
        points = "theta_i_deg,theta_o_deg,phi_deg\n30,40,180\n"
        for encoding in ENCODINGS:
            with self.subTest(encoding=encoding):
                tables = f"{encoding}_one.exr", f"{encoding}_other.exr"
                self.assertNotEqual(*(self.bytes_of(table) for table in tables))
                one, other = (self.succeed("eval", table, "--points", "-", stdin=points).out for table in tables)
                self.assertNotEqual(support.rows_of(one)[0]["rest_r"], support.rows_of(other)[0]["rest_r"])

    def test_nothing_but_the_tables_is_left(self):
        self.assertEqual(self.names(), sorted(["tiny.toml", *self.results]))

    def test_progress_and_summary_go_to_stderr(self):
        for name, result in self.results.items():
            with self.subTest(table=name):
                self.assertEqual(result.out, "")
                self.assertIn("100 %", result.err)
                encoding = name.split("_")[0]
                self.assertIn(f"{name}: {encoding}, {len(self.bytes_of(name))} bytes", result.err)


class Overrides(support.CliTest):
    """--set against the same values in a file."""

    def test_set_gives_the_table_of_an_edited_recipe(self):
        edited = support.TINY_RECIPE.replace("albedo = 0.1", "albedo = 0").replace("angles = 3", "angles = 2")
        self.write("edited.toml", edited)
        self.succeed("bake", "edited.toml", "-o", "edited.exr")
        self.succeed("bake", "tiny.toml", "-o", "set.exr", "--set", "material.albedo=0", "--set", "table.angles=2")
        self.assertEqual((self.folder / "set.exr").read_bytes(), (self.folder / "edited.exr").read_bytes())

    def test_set_can_give_lists_sections_and_words(self):
        self.succeed("bake", "tiny.toml", "-o", "rich.exr", *support.BLACK_BASE, "--set",
                     "grid.base_ior=[1.4, 1.6]", "--set", "grid.film_thickness_nm={from=100, to=300, count=3}",
                     "--set", "table.precision=float")
        text = self.succeed("info", "rich.exr").out
        self.assertRegex(text, r"axis +film_thickness_nm +3 nodes, 100 to 300 nm")
        self.assertRegex(text, r"axis +base_ior +2 nodes, 1.4 to 1.6")


class Completeness(support.CliTest):
    """An older table stays as it was, byte for byte, and no temporary file is left."""

    OLD = b"an older table"

    def setUp(self):
        self.write("old.exr", self.OLD)
        self.before = self.names()

    def check_untouched(self):
        self.assertEqual((self.folder / "old.exr").read_bytes(), self.OLD)
        self.assertEqual(self.names(), self.before)

    def test_a_bad_recipe_leaves_the_old_table(self):
        result = self.sunbeam("bake", "tiny.toml", "-o", "old.exr", "--set", "material.albedo=2")
        self.check_refusal(result, "material.albedo")
        self.check_untouched()


class UnwritableOutput(support.CliTest):
    """Refused before any work is done."""

    def test_missing_folder(self):
        self.refuse("bake", "tiny.toml", "-o", "missing/table.exr", naming=["missing/table.exr", "cannot write"])

    def test_output_is_a_folder(self):
        (self.folder / "folder.exr").mkdir(exist_ok=True)
        self.refuse("bake", "tiny.toml", "-o", "folder.exr", naming=["folder.exr", "folder"])

    def test_parent_is_a_file(self):
        self.refuse("bake", "tiny.toml", "-o", "tiny.toml/table.exr", naming=["tiny.toml/table.exr"])

    def test_extension(self):
        for name in ("table.png", "table", "table.exr.gz", "tiny.toml"):
            with self.subTest(name=name):
                self.refuse("bake", "tiny.toml", "-o", name, naming=[name, ".exr", ".vdb"])

    def test_name_too_long(self):
        self.refuse("bake", "tiny.toml", "-o", "x" * 300 + ".exr", naming=["cannot write"])


if __name__ == "__main__":
    unittest.main()
