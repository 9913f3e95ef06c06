"""`sunbeam verify`: the report, and an exit code that follows the recipe's tolerances."""

import json
import re
import unittest

import support

REQUIRED_KEYS = {"error_median", "error_p95", "error_p99", "error_max", "error_textured_median", "error_textured_p95",
                 "error_textured_p99", "error_textured_max", "noise_floor", "dirac_error_p99", "energy_max",
                 "reciprocity_max", "points"}
POINTS = ("--points", "100")
DENSE = ("--set", "table.encoding=dense")
# Two nodes over everything: a median error of about 0.7 %, 8 % at the 99th percentile.
COARSE = (*DENSE, "--set", "grid.film_thickness_nm=[0, 1000]", "--set", "grid.base_ior=[1, 2]")


class Verify(support.CliTest):
    @classmethod
    def prepare(cls):
        bakes = {
            "good.exr": DENSE,
            "good.vdb": DENSE,
            "factored.exr": ("--set", "table.encoding=factored"),
        }
        for name, options in bakes.items():
            support.succeed_in(cls.folder, "bake", "tiny.toml", "-o", name, *options)

    def bake_coarse(self, figure, tolerance):
        name = f"coarse_{figure}.exr"
        self.miss("bake", "tiny.toml", "-o", name, *COARSE, "--set", f"accuracy.tolerance_{figure}={tolerance}",
                  figure=f"error_{figure}")
        return name

    def report(self, *arguments, code=0):
        result = self.sunbeam("verify", *arguments, "--json", "report.json")
        self.assertEqual(result.code, code, result)
        return json.loads((self.folder / "report.json").read_text()), result

    def test_a_good_table_passes(self):
        report, result = self.report("good.exr", *POINTS)
        self.assertLessEqual(REQUIRED_KEYS, set(report))
        self.assertEqual(report["points"], 100)
        self.assertIn("PASS", result.out)
        self.assertLessEqual(report["error_median"], 0.3)
        self.assertLessEqual(report["error_p99"], 1.0)

    def test_the_figures_are_in_order_and_physical(self):
        for table in ("good.exr", "factored.exr"):
            with self.subTest(table=table):
                report, _ = self.report(table, *POINTS)
                self.assertGreater(report["error_median"], 0)
                self.assertLessEqual(report["error_median"], report["error_p95"])
                self.assertLessEqual(report["error_p95"], report["error_p99"])
                self.assertLessEqual(report["error_p99"], report["error_max"])
                self.assertGreater(report["noise_floor"], 0)
                self.assertLessEqual(report["noise_floor"], 0.1, "a third of the median tolerance")
                self.assertGreater(report["energy_max"], 0.01)
                self.assertLessEqual(report["energy_max"], 1)
                self.assertLess(report["reciprocity_max"], 1e-6, "products of floats")
                self.assertLess(report["dirac_error_p99"], 0.01)

    def test_the_exact_evaluator_as_truth(self):
        by_walks, _ = self.report("good.exr", *POINTS)
        exact, result = self.report("good.exr", *POINTS, "--truth", "exact")
        self.assertEqual((by_walks["truth"], exact["truth"]), ("pfmc-unidirectional", "exact-quadrature"))
        self.assertIn("exact-quadrature", result.out)
        self.assertEqual(exact["noise_floor"], 0)
        self.assertGreater(exact["error_median"], 0)
        # The same points and directions: the two differ by the noise of the walks alone.
        self.assertLessEqual(abs(exact["error_median"] - by_walks["error_median"]), by_walks["noise_floor_p99"])

    def test_no_exact_truth_for_a_material_that_is_not_plain(self):
        self.succeed("bake", "tiny.toml", "-o", "many_facets.exr", "--set", "material.roughness=0.3",
                     "--set", 'material.microfacet="multiple"', "--set", "table.azimuths=3",
                     "--set", "accuracy.tolerance_median=1")
        self.refuse("verify", "many_facets.exr", "--truth", "exact",
                    naming=["many_facets.exr: ", "'microfacet'", "found multiple", "single"])

    def test_stdout_holds_the_same_figures(self):
        report, result = self.report("good.exr", *POINTS)
        for key in REQUIRED_KEYS:
            self.assertRegex(result.out, rf"(?m)^{key} +{re.escape(f'{report[key]:.6g}')}$")

    def test_a_coarse_table_fails_by_its_p99(self):
        report, result = self.report(self.bake_coarse("p99", 0.03), *POINTS, code=1)
        self.assertIn("FAIL", result.out)
        self.assertNotIn("sunbeam: error", result.err)
        self.assertGreater(report["error_p99"], 0.03)
        self.assertLess(report["error_median"], 0.3)

    def test_a_coarse_table_fails_by_its_median(self):
        report, result = self.report(self.bake_coarse("median", 0.003), *POINTS, code=1)
        self.assertIn("FAIL", result.out)
        self.assertGreater(report["error_median"], 0.003)
        self.assertLess(report["error_p99"], 1.0)

    def test_a_table_that_returns_more_than_arrives_fails(self):
        """A white base under a pigment that sends light straight back: eight cosines widen the lobe."""
        self.miss("bake", "tiny.toml", "-o", "bright.exr", "--set", "material.absorption_path=sum", "--set", "material.albedo=1",
                  "--set", "grid.absorption_per_nm=[0]", "--set", "grid.film_thickness_nm=[300]", "--set",
                  "material.scattering_per_nm=1", "--set", "material.anisotropy=-0.75", "--set", "table.angles=8", "--set",
                  "table.azimuths=3", "--set", "accuracy.tolerance_median=1", "--set", "accuracy.tolerance_p99=0.03",
                  figure="energy")
        report, result = self.report("bright.exr", "--points", "250", code=1)
        self.assertGreater(report["energy_max"], 1.1)
        self.assertRegex(result.out, r"(?m)^FAIL: .*, energy 1\.\d+ \(allowed 1\.03\)$")

    def test_threads_form_and_repetition_do_not_matter(self):
        reports = [self.report(*arguments, *POINTS)[0] for arguments in (
            ("good.exr", "--threads", "1"), ("good.exr", "--threads", "2"), ("good.vdb",))]
        self.assertEqual(reports[0], reports[1])
        self.assertEqual(reports[0], reports[2])

    def test_points_and_seed_choose_the_points(self):
        ten, _ = self.report("good.exr", "--points", "10")
        self.assertEqual(ten["points"], 10)
        other, _ = self.report("good.exr", "--points", "10", "--seed", "5")
        self.assertNotEqual(ten["error_median"], other["error_median"])
        one, _ = self.report("good.exr", "--points", "1")
        self.assertEqual(one["error_median"], one["error_max"])

    def test_unwritable_report(self):
        (self.folder / "folder").mkdir()
        for path, needle in (("missing/report.json", "cannot write"), ("folder", "folder")):
            with self.subTest(path=path):
                self.refuse("verify", "good.exr", "--points", "1", "--json", path, naming=[path, needle])


if __name__ == "__main__":
    unittest.main()
