"""Mode "full" through every command: bake, info, eval, verify and render."""

import json
import math
import unittest

import support

# Two layers of a cheap table, a coloured base, coloured pigment.
FULL_RECIPE = """\
[material]
transmission = "straight"
roughness = 0.0
albedo = [0.6, 0.3, 0.1]
absorption_spectrum = "eumelanin"
film_thickness_nm = 300.0
base_ior = 1.5
absorption_per_nm = 0.05

[grid]
absorption_per_nm = [0.0, 0.05, 0.1]

[table]
angles = 4
precision = "float"

[accuracy]
noise = 0.02
tolerance_median = 0.05
tolerance_p99 = 0.3

[spectrum]
mode = "full"
"""

SCENE = support.SKY_SPHERE_SCENE.format(name="full", spp=64, max_bounces=2, tangent_rotation_deg=0.0)

POINTS = "theta_i_deg,theta_o_deg,phi_deg\n30,40,180\n60,10,0\n"
SAMPLES = ("--samples", "2000")


def colour(row, name):
    return [float(row[f"{name}_{c}"]) for c in "rgb"]


class FullSpectrum(support.CliTest):
    @classmethod
    def prepare(cls):
        cls.write("full.toml", FULL_RECIPE)
        cls.write("scene.toml", SCENE)
        for name, options in {"full.exr": (), "full.vdb": (), "rec709.exr": ("--set", "spectrum.color_space=rec709")}.items():
            support.succeed_in(cls.folder, "bake", "full.toml", "-o", name, *options)

    def rows(self, source, points, *options):
        return support.rows_of(self.succeed("eval", source, "--points", "-", *options, stdin=points).out)

    def info(self, name):
        return json.loads(self.succeed("info", name, "--json").out)

    def assert_close(self, found, expected, relative, message=""):
        for a, b in zip(found, expected):
            self.assertAlmostEqual(a, b, delta=relative * abs(b), msg=f"{found} {expected} {message}")

    def test_info_says_what_the_colours_are(self):
        for name, space in (("full.exr", "acescg"), ("full.vdb", "acescg"), ("rec709.exr", "rec709")):
            info = self.info(name)
            self.assertEqual((info["spectrum"], info["color_space"], info["illuminant"]), ("full", space, "D65"))
            self.assertEqual(len(info["wavelengths"]), 16)
            self.assertEqual((info["wavelengths"][0], info["wavelengths"][-1]), (395, 720))
        self.assertIn("acescg", self.succeed("info", "full.exr").out)

    def test_both_file_forms_hold_the_same(self):
        self.assertEqual(self.rows("full.exr", POINTS), self.rows("full.vdb", POINTS))

    def test_verify_passes(self):
        for name in ("full.exr", "rec709.exr"):
            for truth in ("pfmc", "exact"):
                result = self.succeed("verify", name, "--points", "20", "--truth", truth)
                self.assertIn("PASS", result.out)

    def test_table_and_live_agree(self):
        for table, live, exact in zip(self.rows("full.exr", POINTS), self.rows("full.toml", POINTS, *SAMPLES),
                                      self.rows("full.toml", POINTS, "--estimator", "exact", *SAMPLES)):
            self.assert_close(colour(table, "rest"), colour(exact, "rest"), 0.05, "table")
            self.assert_close(colour(table, "dirac"), colour(live, "dirac"), 0.01, "film")
            for c in "rgb":
                difference = abs(float(live[f"rest_{c}"]) - float(exact[f"rest_{c}"]))
                self.assertLess(difference, 5 * float(live[f"stderr_{c}"]) + 1e-6 * float(exact[f"rest_{c}"]))

    def test_the_two_colour_spaces_agree(self):
        to_rec709 = [[1.705051, -0.621792, -0.083259], [-0.130256, 1.140805, -0.010548], [-0.024003, -0.128969, 1.152972]]
        acescg = self.rows("full.toml", POINTS, "--estimator", "exact", *SAMPLES)
        rec709 = self.rows("full.toml", POINTS, "--estimator", "exact", *SAMPLES, "--set", "spectrum.color_space=rec709")
        for a, b in zip(acescg, rec709):
            rest = colour(a, "rest")
            self.assert_close([sum(m * x for m, x in zip(row, rest)) for row in to_rec709], colour(b, "rest"), 0.005)

    def test_a_wavelength_makes_a_row_monochromatic(self):
        """The fold of a linear spectrum's film lies among its values."""
        lines = "wavelength_nm,theta_i_deg\n" + "".join(f"{nm},30\n" for nm in range(400, 720, 10))
        values = [float(row["reflectance"]) for row in self.rows("full.toml", lines, "--quantity", "film")]
        for c in colour(self.rows("full.toml", "theta_i_deg\n30\n", "--quantity", "film")[0], "reflectance"):
            self.assertTrue(min(values) < c < max(values))

    def test_monochromatic_rows_know_albedo_and_pigment(self):
        """Smooth, straight, without interfaces: rest is albedo / pi exp(-tau shape path) at the wavelength."""
        recipe = ("[material]\ntransmission = 'straight'\nroughness = 0.0\nfilm_thickness_nm = 0\nbase_ior = 1.0\n"
                  "film_ior = 1.0\nabsorption_per_nm = 0.1\npigment_thickness_nm = 2\n"
                  "albedo = [[400, 0.2], [700, 0.8]]\nabsorption_spectrum = [[400, 4], [600, 2]]\n[spectrum]\nmode = 'full'\n")
        self.write("bare.toml", recipe)
        rows = self.rows("bare.toml", "wavelength_nm,theta_i_deg,theta_o_deg,phi_deg\n500,0,0,0\n650,0,0,0\n", *SAMPLES)
        at_510 = 4 - 2 * 110 / 200
        for row, albedo, shape in ((rows[0], 0.4, 3 / at_510), (rows[1], 0.7, 2 / at_510)):
            self.assertAlmostEqual(float(row["rest"]), albedo / math.pi * math.exp(-0.2 * shape * 2), places=9)

    def test_albedo_columns_are_rec709_as_in_the_recipe(self):
        header, line = "albedo,theta_i_deg,theta_o_deg,phi_deg", "0.6;0.3;0.1,30,40,180"
        with_column = self.rows("full.toml", f"{header}\n{line}\n", *SAMPLES)[0]
        without = self.rows("full.toml", POINTS, *SAMPLES)[0]
        self.assert_close(colour(with_column, "rest"), colour(without, "rest"), 1e-9)

    def refuse_points(self, source, text, *needles):
        self.refuse("eval", source, "--points", "-", stdin=text, naming=needles)

    def test_refusals(self):
        self.refuse_points("full.exr", "wavelength_nm,theta_i_deg,theta_o_deg,phi_deg\n650,1,1,1\n",
                           "standard input", "'wavelength_nm'", "full", "recipe")
        self.refuse_points("full.toml", "film_thickness_nm,theta_i_deg,theta_o_deg,phi_deg\n300,1,1,1\n2000,1,1,1\n",
                           "standard input:3", "'film_thickness_nm'", "found 2000", "up to 1384")
        self.refuse("bake", "full.toml", "-o", "out.exr", "--set", "spectrum.mode=rgb3", naming=["absorption_spectrum"])

    def picture(self, name, *options):
        self.succeed("render", "scene.toml", "-o", name, *options)
        return (self.folder / name).with_suffix(".png").read_bytes()

    def test_render_shows_rec709(self):
        """A uniform sky: the mean colours of the picture by table, by live model and by a Rec.709 table agree."""
        means = {}
        for name, options in {"table.exr": (), "live.exr": ("--material", "live"), "rec.exr": ("--table", "rec709.exr")}.items():
            means[name] = support.mean_linear(self.picture(name, "--size", "16x16", *options))
        self.assert_close(means["live.exr"], means["table.exr"], 0.05)
        self.assert_close(means["rec.exr"], means["table.exr"], 0.03)
        self.assertGreater(means["table.exr"][0], means["table.exr"][2])

    def test_render_reports_what_the_png_clips(self):
        self.write("cyan.toml", FULL_RECIPE.replace("[0.6, 0.3, 0.1]", "[[480, 0], [490, 1], [510, 1], [520, 0]]"))
        self.write("cyan_scene.toml", SCENE.replace("full.toml", "cyan.toml"))
        result = self.succeed("render", "cyan_scene.toml", "-o", "cyan.exr", "--material", "live")
        self.assertIn("pixels lie outside Rec.709", result.err)
        self.assertRegex(result.err, r"added [0-9.e+]+ % of luminance")
        self.assertNotIn("outside", self.succeed("render", "scene.toml", "-o", "plain.exr").err)

    def test_live_film_too_thick_for_the_wavelengths_is_refused(self):
        self.write("thick.toml", SCENE.replace('type = "skin"', 'type = "skin"\nfilm_thickness_nm = 3000'))
        self.refuse("render", "thick.toml", "-o", "out.exr", "--material", "live",
                    naming=["thick.toml", "'skin'", "'film_thickness_nm'", "found 3000"])


if __name__ == "__main__":
    unittest.main()
