"""Anisotropic films, scattering pigments and multiple facets through every command."""

import json
import unittest

import support

RECIPE = """\
[material]
transmission = "refract"
film_thickness_nm = 300.0
base_ior = 1.4
absorption_per_nm = 0.1
albedo = 0.5
{material}

[grid]
absorption_per_nm = [0.05, 0.1, 0.2]

[table]
encoding = "{encoding}"
angles = 4
azimuths = {azimuths}

[accuracy]
noise = 0.05
tolerance_median = 0.3
tolerance_p99 = 2.0
estimator = "{estimator}"
"""

# name: encoding, keys of the material, azimuths, estimator, nodes over phi_i and phi_o of the rest's last array
STACKS = {
    "anisotropic": ("dense", "roughness = [0.2, 0.5]", 8, "unidirectional", (3, 8)),
    "factored": ("factored", 'roughness = [0.2, 0.5]\nabsorption_path = "product"', 8, "unidirectional", (3, 3)),
    "scattering": ("auto", "roughness = 0.3\nscattering_per_nm = 0.5\nanisotropy = 0.5", 5, "bidirectional", (1, 5)),
    "multiple": ("auto", 'roughness = 0.5\nmicrofacet = "multiple"', 5, "unidirectional", (1, 5)),
}

POINTS = "theta_i_deg,phi_i_deg,theta_o_deg,phi_deg\n30,0,40,180\n30,90,40,180\n60,20,10,70\n"


class Stack(support.CliTest):
    @classmethod
    def prepare(cls):
        for name, (encoding, material, azimuths, estimator, _) in STACKS.items():
            cls.write(f"{name}.toml", RECIPE.format(encoding=encoding, material=material, azimuths=azimuths,
                                                    estimator=estimator))
            cls.write(f"{name}_scene.toml", support.SKY_SPHERE_SCENE.format(
                name=name, spp=256, max_bounces=1, tangent_rotation_deg=30.0))
            for form in ("exr", "vdb"):
                support.succeed_in(cls.folder, "bake", f"{name}.toml", "-o", f"{name}.{form}")

    def rows(self, source, points, *options):
        return support.rows_of(self.succeed("eval", source, "--points", "-", *options, stdin=points).out)

    def test_info_shows_the_azimuths(self):
        for name, (encoding, _, _, _, azimuths) in STACKS.items():
            info = json.loads(self.succeed("info", f"{name}.exr", "--json").out)
            self.assertEqual(info["encoding"], "factored" if encoding == "factored" else "dense", name)
            nodes = {axis["name"]: len(axis["nodes"]) for axis in info["arrays"][-1]["axes"]}
            self.assertEqual((nodes["phi_i"], nodes["phi_o"]), azimuths, name)
            self.assertGreater(info["error"]["error_median"], 0, name)

    def test_verify_holds_the_table_against_live_walks(self):
        for name in STACKS:
            report = self.succeed("verify", f"{name}.exr", "--points", "12")
            self.assertIn("PASS", report.out)

    def test_both_file_forms_hold_the_same(self):
        for name in STACKS:
            self.assertEqual(self.rows(f"{name}.exr", POINTS), self.rows(f"{name}.vdb", POINTS))

    def test_tables_follow_live_values(self):
        for name in STACKS:
            live = self.rows(f"{name}.toml", POINTS, "--samples", "4000")
            for a, b in zip(self.rows(f"{name}.exr", POINTS), live):
                first, rest = float(b["first_r"]), float(b["rest_r"])
                self.assertAlmostEqual(float(a["first_r"]), first, delta=0.02 * first + 1e-4, msg=name)
                self.assertAlmostEqual(float(a["rest_r"]), rest, delta=0.2 * rest, msg=name)
        for name in ("anisotropic", "factored"):
            rows = self.rows(f"{name}.exr", POINTS)
            self.assertGreater(abs(float(rows[0]["first_r"]) / float(rows[1]["first_r"]) - 1), 0.05)

    def test_what_has_no_exact_evaluator_says_so(self):
        for name, needle in {"scattering": "'scattering_per_nm'", "multiple": "'microfacet'"}.items():
            commands = [("eval", f"{name}.toml", "--points", "-", "--estimator", "exact")]
            if name != "scattering":  # solved by adding and doubling
                commands.append(("verify", f"{name}.exr", "--truth", "exact"))
            for command in commands:
                result = self.sunbeam(*command, stdin=POINTS)
                self.check_refusal(result, needle, "exact evaluator allows")
            self.assertIn(needle, self.succeed("info", f"{name}.toml").out)

    def test_anisotropic_films_have_exact_values_but_none_for_renderers(self):
        for name, needle in {"anisotropic": "'roughness'", "factored": "'absorption_path'"}.items():
            exact = self.rows(f"{name}.toml", POINTS, "--estimator", "exact")
            for a, b in zip(exact, self.rows(f"{name}.toml", POINTS, "--estimator", "pfmc", "--samples", "20000")):
                self.assertEqual(float(a["stderr_r"]), 0)
                # 2 x 3 rows at 5 standard errors: 3e-6 in all.
                self.assertAlmostEqual(float(a["rest_r"]), float(b["rest_r"]), delta=5 * float(b["stderr_r"]), msg=name)
            self.assertIn("exact-quadrature", self.succeed("verify", f"{name}.exr", "--truth", "exact", "--points", "12").out)
            self.assertIn(needle, self.succeed("info", f"{name}.toml").out)
            self.check_refusal(self.sunbeam("render", f"{name}_scene.toml", "-o", "none.exr", "--material", "live",
                                            "--estimator", "exact"), needle, "exact evaluator of a renderer allows")

    def test_table_and_live_render_the_same(self):
        """Mean of the picture inside a sphere under a constant sky."""
        for name in STACKS:
            means = []
            for material in ("table", "live"):
                stats = f"{name}_{material}.json"
                self.succeed("render", f"{name}_scene.toml", "-o", f"{name}_{material}.exr", "--material", material,
                             "--stats", stats)
                self.assertEqual(json.loads((self.folder / stats).read_text())["bad_samples"], 0)
                png = (self.folder / f"{name}_{material}.png").read_bytes()
                means.append(support.mean_linear(png))
            for a, b in zip(*means):
                self.assertAlmostEqual(a, b, delta=0.05 * b, msg=f"{name} {means}")


if __name__ == "__main__":
    unittest.main()
