"""SUNBEAM_KERNELS: what is baked and stated does not depend on the instruction set of the processor."""

import pathlib
import unittest

import support

BASELINE = {"SUNBEAM_KERNELS": "baseline"}
POINTS = "theta_i_deg,theta_o_deg,phi_deg\n" + "".join(f"{a},{a},180\n" for a in range(5, 85, 5))
ROUGH = ("--set", "table.encoding=factored", "--set", "material.roughness=0.2")


def has_several_kernels():
    cpu = pathlib.Path("/proc/cpuinfo")
    return cpu.exists() and {"avx2", "fma"} <= set(cpu.read_text().split())


class Kernels(support.CliTest):
    def bake(self, name, options, env=None):
        self.succeed("bake", "tiny.toml", "-o", name, *options, env=env)
        return (self.folder / name).read_bytes()

    def first(self, table, env=None):
        rows = support.rows_of(self.succeed("eval", table, "--points", "-", stdin=POINTS, env=env).out)
        return [float(row[f"first_{c}"]) for row in rows for c in "rgb"]

    def test_tables_and_their_errors_have_the_same_bytes(self):
        for kind, options in support.BAKE_JOBS.items():
            with self.subTest(kind=kind):
                self.assertEqual(self.bake("fastest.exr", options), self.bake("baseline.exr", options, BASELINE))

    def test_the_switch_reaches_look_ups(self):
        """Renderers may differ in the last digits; where nothing did, the test above would compare nothing."""
        self.bake("look_up.exr", ROUGH)
        fastest, baseline = self.first("look_up.exr"), self.first("look_up.exr", BASELINE)
        for a, b in zip(fastest, baseline, strict=True):
            self.assertAlmostEqual(a, b, delta=2e-6 * max(fastest))
        if has_several_kernels():
            self.assertNotEqual(fastest, baseline)

    def test_other_values_are_refused(self):
        self.refuse("bake", "tiny.toml", "-o", "none.exr", env={"SUNBEAM_KERNELS": "avx3"},
                    naming=["SUNBEAM_KERNELS", "avx3", "'fastest' and 'baseline'"])


if __name__ == "__main__":
    unittest.main()
