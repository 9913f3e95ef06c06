"""`[table] encoding`: auto takes the smallest table that meets the tolerances and says so."""

import json
import re
import unittest

import support

SCATTERING = ("--set", "material.absorption_path=sum", "--set", "material.scattering_per_nm=0.2",
              "--set", "table.azimuths=3")
# Three cosines are too few for the legs of a rough film.
FACETS = ("--set", "material.roughness=0.2")
MULTIPLE = ("--set", "material.roughness=0.3", "--set", 'material.microfacet="multiple"', "--set", "table.azimuths=3")


class Encoding(support.CliTest):
    def encoding(self):
        return json.loads(self.succeed("info", "table.exr", "--json").out)["encoding"]

    def bake(self, *options):
        """The result of a bake, and the encoding inside the table."""
        return self.succeed("bake", "tiny.toml", "-o", "table.exr", *options), self.encoding()

    def bake_and_miss(self, *options):
        """The same with a tolerance that no table meets."""
        result = self.miss("bake", "tiny.toml", "-o", "table.exr", "--set", "accuracy.tolerance_median=1e-6", *options,
                           figure="error_median")
        return result, self.encoding()

    def test_auto_takes_factored_within_the_tolerances(self):
        result, encoding = self.bake()
        self.assertEqual(encoding, "factored")
        self.assertIn("tiny.toml: factored, ", result.err)
        self.assertIn("encoding auto: factored is the smallest that meets the tolerances (median 0.3, p99 1)", result.err)
        self.assertNotIn("tiny.toml: dense, ", result.err)

    def test_auto_falls_back_to_dense(self):
        result, encoding = self.bake(*FACETS, "--set", "accuracy.tolerance_median=0.005")
        self.assertEqual(encoding, "dense")
        first = result.err.index("encoding auto: factored misses the tolerances (median 0.005, p99 1)")
        self.assertLess(result.err.index("tiny.toml: factored, "), first)
        self.assertGreater(result.err.index("tiny.toml: dense, "), first)
        self.assertIn("encoding auto: dense is the smallest that meets the tolerances", result.err)

    def test_auto_keeps_the_better_of_two_that_miss(self):
        """Factored is tried first."""
        for options, better in (((), 0), (FACETS, 1)):
            with self.subTest(options=options):
                result, encoding = self.bake_and_miss(*options)
                tried = re.findall(r"^encoding auto: (\w+) misses the tolerances \(median 1e-06, p99 1\)$", result.err, re.M)
                self.assertEqual(tried, ["factored", "dense"])
                self.assertEqual(encoding, tried[better])
                errors = re.findall(r"^error median (\S+) p99", result.err, re.M)
                self.assertLess(float(errors[better]), float(errors[1 - better]))
                stated = json.loads(self.succeed("info", "table.exr", "--json").out)["error"]["error_median"]
                self.assertEqual(f"{float(stated):.3g}", errors[better])

    def test_depths_that_factors_cannot_hold(self):
        """One visit multiplies by up to the exponential of a depth of path product."""
        deep = ("--set", "material.absorption_path=product", "--set", "grid.absorption_per_nm=[0, 25]",
                "--set", "material.absorption_per_nm=1", "--set", "accuracy.tolerance_median=10", "--set", "accuracy.tolerance_p99=10")
        self.refuse("bake", "tiny.toml", "-o", "deep.exr", *deep, "--set", "table.encoding=factored",
                    naming=["tiny.toml: key 'grid.absorption_per_nm': found an optical depth of 50", "allowed", "40"])
        self.assertFalse((self.folder / "deep.exr.work").exists())
        result, encoding = self.bake(*deep)
        self.assertEqual(encoding, "dense")
        self.assertNotIn("factored", result.err)

    def test_what_is_asked_for_is_taken_without_a_word(self):
        for encoding in ("dense", "factored"):
            result, found = self.bake_and_miss("--set", f"table.encoding={encoding}")
            self.assertEqual(found, encoding)
            self.assertNotIn("encoding auto", result.err)

    def test_auto_of_what_has_no_factors_is_dense(self):
        for options in (SCATTERING, MULTIPLE):
            result, encoding = self.bake(*options, "--set", "accuracy.tolerance_median=1")  # 3 azimuths are few
            self.assertEqual(encoding, "dense")
            self.assertNotIn("encoding auto", result.err)

    def test_factored_is_refused_where_there_are_no_factors(self):
        for options, cause in ((SCATTERING, "scattering_per_nm"), (MULTIPLE, "microfacet")):
            self.refuse("bake", "tiny.toml", "-o", "none.exr", "--set", "table.encoding=factored", *options,
                        naming=["table.encoding", "factored", cause, '"auto", "dense"'])

    def test_unknown_encoding(self):
        self.refuse("bake", "tiny.toml", "-o", "none.exr", "--set", "table.encoding=sparse",
                    naming=["table.encoding", "sparse", "auto", "dense", "factored"])


if __name__ == "__main__":
    unittest.main()
