"""Recipes of layered films: what [[material.film]] means, what is refused, and that they bake to small tables."""

import json
import unittest

import support

LAYERS = """\
[material]
{material}
[[material.film]]
thickness_nm = {d1}
ior = {n1}
[[material.film]]
thickness_nm = {d2}
ior = {n2}
[spectrum]
mode = "{mode}"
"""


def layered(material="", d1=100, n1=1.5, d2=50, n2="2.1\nextinction = 0.05", mode="rgb3"):
    return LAYERS.format(material=material, d1=d1, n1=n1, d2=d2, n2=n2, mode=mode)


def single(material, mode="rgb3"):
    return f'[material]\n{material}\n[spectrum]\nmode = "{mode}"\n'


# One for each key that alone makes a film layered.
LAYERED = {
    "film": layered(),
    "film_ior": single('film_ior = "chitin"'),
    "film_extinction": single("film_extinction = 0.1"),
    "base_ior": single('base_ior = "silica"'),
    "base_extinction": single("base_ior = 2.0\nbase_extinction = 3.0"),
    "thickness_spread": single("thickness_spread = 0.1"),
}


class FilmRecipe(support.CliTest):
    @classmethod
    def prepare(cls):
        cls.write("layered.toml", layered())
        cls.write("plain.toml", single("albedo = 0\nabsorption_per_nm = 0"))
        for key, text in LAYERED.items():
            cls.write(f"{key}.toml", text)

    def rows(self, text, points, *options, quantity="film"):
        self.write("r.toml", text)
        return support.rows_of(self.succeed("eval", "r.toml", "--quantity", quantity, "--points", "-", *options,
                                            stdin=points).out)

    def reflectances(self, text, nm=(410, 550, 690), degrees=(0, 35, 75), **columns):
        """Of the recipe's own film."""
        points = ",".join(["wavelength_nm", "theta_i_deg", *columns]) + "\n"
        points += "".join(",".join([str(a), str(b), *map(str, columns.values())]) + "\n" for a in nm for b in degrees)
        return [float(row["reflectance"]) for row in self.rows(text, points)]

    def stack(self, layers, base="1.5,0", nm=(410, 550, 690), degrees=(0, 35, 75)):
        """Of a stack in a CSV."""
        points = "layers,base_ior,base_extinction,wavelength_nm,theta_i_deg\n"
        points += "".join(f"{layers},{base},{a},{b}\n" for a in nm for b in degrees)
        return [float(row["reflectance"]) for row in self.rows(single(""), points)]

    def check_equal(self, found, expected, delta=1e-12):
        self.assertEqual(len(found), len(expected))
        for a, b in zip(found, expected):
            self.assertAlmostEqual(a, b, delta=delta)

    def check_refused(self, text, *needles, command=("eval", "r.toml", "--points", "-", "--quantity", "film")):
        self.write("r.toml", text)
        with self.subTest(text=text):
            self.refuse(*command, naming=["r.toml", *needles], stdin="theta_i_deg\n30\n")

    def test_layers_lie_from_top_to_bottom(self):
        expected = self.stack("100/1.5/0;50/2.1/0.05")
        self.check_equal(self.reflectances(layered()), expected)
        self.assertGreater(abs(expected[1] - self.stack("50/2.1/0.05;100/1.5/0")[1]), 1e-3)

    def test_the_slider_scales_all_layers(self):
        expected = self.stack("200/1.5/0;100/2.1/0.05")
        self.check_equal(self.reflectances(layered("film_thickness_nm = 300")), expected)
        self.check_equal(self.reflectances(layered(), film_thickness_nm=300), expected)
        self.check_equal(self.reflectances(layered("film_thickness_nm = 0")), self.stack(""))

    def test_periods_are_the_list_written_out(self):
        expected = self.stack(";".join(["100/1.5/0;50/2.1/0.05"] * 3))
        self.check_equal(self.reflectances(layered("film_periods = 3")), expected)
        self.check_equal(self.reflectances(layered("film_periods = 3\nfilm_thickness_nm = 450")), expected)

    def test_a_name_is_the_list_of_its_file(self):
        lines = (support.SOURCE_DIR / "tables/optics/chitin.csv").read_text().splitlines()
        numbers = [line for line in lines if line[:1].isdigit()]
        self.assertGreater(len(numbers), 10)
        listed = "[" + ", ".join(f"[{line}]" for line in numbers) + "]"
        self.assertEqual(self.reflectances(layered(n1='"chitin"')), self.reflectances(layered(n1=listed)))
        for form in ("{ cauchy = [1.5, 0] }", "[[400, 1.5], [700, 1.5, 0]]"):
            self.check_equal(self.reflectances(layered(n1=form)), self.reflectances(layered()))

    def test_a_layer_of_no_thickness_is_none(self):
        self.check_equal(self.reflectances(layered(d1=0)), self.stack("50/2.1/0.05"))
        self.check_equal(self.reflectances(layered(d1=0, d2=0)), self.stack(""))

    def test_one_layer_is_the_film_of_the_old_keys(self):
        old = single("film_ior = 1.6\nfilm_thickness_nm = 250")
        for text in (single("[[material.film]]\nthickness_nm = 250\nior = 1.6"),
                     layered(d1=100, n1=1.6, d2=150, n2=1.6),
                     single("film_ior = { cauchy = [1.6, 0] }\nfilm_thickness_nm = 250")):
            self.check_equal(self.reflectances(text), self.reflectances(old), 1e-9)
            points = "theta_i_deg\n0\n50\n80\n"
            for a, b in zip(self.rows(text, points, quantity="albedo"), self.rows(old, points, quantity="albedo")):
                for key in ("total_r", "total_g", "total_b"):
                    self.assertAlmostEqual(float(a[key]), float(b[key]), delta=1e-5)

    def test_three_wavelengths_take_the_indices_there(self):
        text = layered(n1='"melanin"')
        row = self.rows(text, "theta_i_deg\n40\n")[0]
        single_rows = self.reflectances(text, nm=(650, 510, 475), degrees=(40,))
        self.check_equal([float(row[f"reflectance_{c}"]) for c in "rgb"], single_rows)

    def test_bases(self):
        metal = single("film_thickness_nm = 60\nfilm_ior = 2.4\nbase_ior = 0.05\nbase_extinction = 3.2")
        self.check_equal(self.reflectances(metal), self.stack("60/2.4/0", "0.05,3.2"))
        listed = single("film_thickness_nm = 60\nfilm_ior = 2.4\nbase_ior = [[400, 0.05, 3.2], [700, 0.05, 3.2]]")
        self.check_equal(self.reflectances(listed), self.stack("60/2.4/0", "0.05,3.2"))
        points = "theta_i_deg,theta_o_deg,phi_deg\n30,40,120\n"
        for estimator in ("pfmc", "bidirectional", "exact"):
            row = self.rows(metal, points, "--estimator", estimator, "--samples", "100", quantity="brdf")[0]
            self.assertEqual([float(row[f"rest_{c}"]) for c in "rgb"], [0, 0, 0])
            self.assertGreater(float(row["first_g"]), 0)

    def test_stacks_of_a_csv_stand_on_the_base_of_the_recipe(self):
        points = "layers,wavelength_nm,theta_i_deg\n60/2.4/0,550,30\n"
        metal = self.rows(single("base_ior = 2.7\nbase_extinction = 3.2"), points)[0]
        self.check_equal([float(metal["reflectance"])], self.stack("60/2.4/0", "2.7,3.2", (550,), (30,)))
        self.assertEqual(metal["reflectance_below"], "")
        named = self.rows(single('base_ior = "Ti"'), points)[0]
        self.assertGreater(abs(float(named["reflectance"]) - float(metal["reflectance"])), 1e-3)
        alone = "layers,wavelength_nm,theta_i_deg,base_ior\n60/2.4/0,550,30,1.5\n"
        self.write("r.toml", single('base_ior = "Ti"'))
        self.refuse("eval", "r.toml", "--quantity", "film", "--points", "-", stdin=alone,
                    naming=["column 'base_ior' stands alone", "base_extinction together"])

    def test_columns_of_metal_and_spread_work_on_old_recipes(self):
        points = "base_ior,base_extinction,thickness_spread,theta_i_deg\n{},{},{},30\n"
        for base, k, spread in ((0.2, 3, 0), (1.5, 0, 0.1), (2, 1, 0.3)):
            row = self.rows((self.folder / "plain.toml").read_text(), points.format(base, k, spread))[0]
            recipe = single(f"base_ior = {base}\nbase_extinction = {k}\nthickness_spread = {spread}")
            own = self.rows(recipe, "theta_i_deg\n30\n")[0]
            self.assertEqual([row[f"reflectance_{c}"] for c in "rgb"], [own[f"reflectance_{c}"] for c in "rgb"])
        self.refuse("eval", "tiny.toml", "--quantity", "film", "--points", "-",
                    stdin="base_extinction,theta_i_deg\n1,30\n", naming=["key 'albedo': found 0.1", "base_extinction > 0"])

    def test_columns_of_recipe_keys_are_refused(self):
        self.write("r.toml", layered())
        for column, needle in (("film_periods", "recipes alone"), ("film_extinction", "recipes alone"),
                               ("film_period", "almost 'film_periods'")):
            self.refuse("eval", "r.toml", "--quantity", "film", "--points", "-", stdin=f"{column},theta_i_deg\n2,30\n",
                        naming=[f"column '{column}'", needle])

    def test_columns_that_contradict_the_design_are_refused(self):
        for text, column, needle in ((layered(), "film_ior", "layers"), (single('base_ior = "silica"'), "base_ior", "wavelength"),
                                     (single('base_ior = "Ti"'), "base_extinction", "wavelength")):
            self.write("r.toml", text)
            self.refuse("eval", "r.toml", "--quantity", "film", "--points", "-", stdin=f"{column},theta_i_deg\n1.5,30\n",
                        naming=[f"column '{column}'", needle])
        self.write("r.toml", layered(d1=0, d2=0))
        self.refuse("eval", "r.toml", "--quantity", "film", "--points", "-", stdin="film_thickness_nm,theta_i_deg\n5,30\n",
                    naming=["standard input:2: ", "'film_thickness_nm': found 5", "0 nm thick", "allowed: 0"])
        for nm, needle in ((3000, "layer 1 of the film"), (340, "350 to 1000 nm")):
            self.write("r.toml", layered(n1='"chitin"'))
            self.refuse("eval", "r.toml", "--quantity", "film", "--points", "-",
                        stdin=f"wavelength_nm,theta_i_deg\n{nm},30\n", naming=["standard input:2: ", needle])

    def test_film_keys_are_refused(self):
        for text, needles in (
            (layered("film_ior = 1.5"), ["r.toml:2: ", "'material.film_ior'", "[[material.film]]"]),
            (layered("film_extinction = 0.1"), ["'material.film_extinction'", "[[material.film]]"]),
            (single("film_periods = 2"), ["'material.film_periods'", "without [[material.film]]"]),
            (layered("film_periods = 0"), ["'material.film_periods'", "found 0", "1 to 1000"]),
            (layered("film_periods = 501"), ["'material.film'", "found 1002 layers in 501 periods", "1 to 1000"]),
            (single("film = []"), ["'material.film'", "found 0 layers"]),
            (single("film = 3"), ["'material.film'", "entries"]),
            (layered(d1=-1), ["'material.film[0].thickness_nm'", "found -1", "0 to 100000"]),
            (layered(d1=60000, d2=60000), ["'material.film'", "found 120000 nm", "up to 100000"]),
            (layered(n1=0.01), ["'material.film[0].ior'", "found 0.01", "0.05 to 10"]),
            (layered(n1='"chitine"'), ["'material.film[0].ior'", 'chitin, guanine']),
            (layered(n1='"chitin"\nextinction = 0.1'), ["'material.film[0].extinction'", "beside a name"]),
            (layered(n1="1.5\nextincton = 0.1"), ["extincton", "'extinction'"]),
            (layered("film_thickness_nm = 300", d1=0, d2=0), ["'material.film_thickness_nm'", "found 300", "allowed: 0"]),
            (layered("[grid]\nfilm_thickness_nm = [0.0, 300.0]\n[material]", d1=0, d2=0), []),
            (single("film_ior = 0.9"), ["'material.film_ior'", "found 0.9", "1 to 5"]),
            (single('film_ior = "chitin"\nfilm_extinction = 0.1'), ["'material.film_extinction'", "beside a name"]),
            (single("thickness_spread = 0.31"), ["'material.thickness_spread'", "found 0.31", "0 to 0.3"]),
        ):
            self.check_refused(text, *needles)

    def test_bases_are_refused(self):
        below = {"albedo": "0.1", "absorption_per_nm": "0.1", "pigment_thickness_nm": "2", "scattering_per_nm": "0.1",
                 "anisotropy": "0.1", "absorption_path": '"sum"', "absorption_spectrum": '"flat"'}
        for key, value in below.items():
            for base in ('base_ior = "Au"', "base_extinction = 0.5"):
                self.check_refused(single(f"{base}\n{key} = {value}", "full"), f"'material.{key}'", "r.toml:3: ",
                                   "the base absorbs", "nothing is seen below")
        for text, needles in (
            (single("base_ior = 0.5"), ["'material.base_ior'", "found 0.5", "1 to 5"]),
            (single("base_ior = [[400, 0.9], [700, 1.5]]"), ["'material.base_ior'", "found n = 0.9", "does not absorb", "1 to 5"]),
            (single("base_ior = 0.01\nbase_extinction = 2"), ["'material.base_ior'", "0.05 to 10"]),
            (single("base_extinction = -1"), ["'material.base_extinction'", "found -1", "0 to 100"]),
            (single('base_ior = "Au"\nbase_extinction = 2'), ["'material.base_extinction'", "beside a name"]),
            (single('base_ior = "Au"\n[grid]\nbase_ior = [1.4, 1.5]'), ["'grid.base_ior'", "the base absorbs"]),
            (single('base_ior = "silica"\n[grid]\nbase_ior = [1.4, 1.5]'), ["'grid.base_ior'", "index of its own"]),
            (single("base_extinction = 1\n[grid]\nbase_ior = [1.4, 1.5]"), ["'grid.base_ior'", "the base absorbs"]),
            (single("base_extinction = 1\n[grid]\nabsorption_per_nm = [0.0, 0.1]"), ["'grid.absorption_per_nm'", "the base absorbs"]),
        ):
            self.check_refused(text, *needles)

    def test_colours_that_no_number_of_wavelengths_folds(self):
        self.check_refused(layered(d1=4000, d2=4000, mode="full"), "'material.film'", "found 8000", "up to 48")
        self.check_refused(layered("film_thickness_nm = 9000", mode="full"), "r.toml:2: ", "'material.film_thickness_nm'")
        mirror = layered("film_periods = 8", d1=100, n1=2.4, d2=150, n2=1.38, mode="full")
        self.check_refused(mirror, "'material.film'", "found a film of 2000 nm", "at 64 wavelengths", "allowed: up to 0.3 %")
        self.rows(mirror.replace("full", "rgb3"), "theta_i_deg\n30\n")
        too_thick = "film_thickness_nm,theta_i_deg\n5000,30\n"
        self.write("r.toml", layered(mode="full"))
        self.refuse("eval", "r.toml", "--quantity", "film", "--points", "-", stdin=too_thick,
                    naming=["standard input:2: ", "'film_thickness_nm'", "resolve films up to"])

    def totals(self, source, *options):
        rows = support.rows_of(self.succeed("eval", source, "--quantity", "albedo", "--points", "-", *options,
                                            stdin="theta_i_deg\n0\n35\n75\n").out)
        return [float(row[f"total_{c}"]) for row in rows for c in "rgb"]

    def test_they_bake_to_small_tables(self):
        """Tables know the recipe's film and base, and reflect what the exact evaluator says."""
        for key in LAYERED:
            with self.subTest(key=key):
                self.succeed("bake", f"{key}.toml", "-o", f"{key}.exr", "--preview")
                info = json.loads(self.succeed("info", f"{key}.exr", "--json").out)
                self.assertEqual((info["schema_version"], info["encoding"]), (4, "factored"))
                self.assertLess(info["bytes"], 30000)
                recipe = json.loads(self.succeed("info", f"{key}.toml", "--json").out)
                self.assertEqual(info["base"], recipe["base"])
                self.assertEqual(len(info["film"]["layers"]), 2 if key == "film" else 1)
                for a, b in zip(self.totals(f"{key}.exr"), self.totals(f"{key}.toml", "--estimator", "exact")):
                    self.assertAlmostEqual(a / b, 1, delta=1e-3)

    def test_parts_make_the_same_table(self):
        self.succeed("bake", "film.toml", "-o", "whole.exr")
        for part in (1, 2):
            self.succeed("bake", "film.toml", "-o", f"{part}.part", "--shard", f"{part}/2")
        self.succeed("merge", "1.part", "2.part", "-o", "merged.exr")
        self.assertEqual((self.folder / "merged.exr").read_bytes(), (self.folder / "whole.exr").read_bytes())

    def test_info_shows_the_film(self):
        self.write("r.toml", layered("film_periods = 2\nthickness_spread = 0.1\nfilm_thickness_nm = 600", n1='"chitin"'))
        text = self.succeed("info", "r.toml").out
        self.assertIn("600 nm, thickness_spread 0.1, periods 2 of 2 layers", text)
        self.assertIn("200 nm, n 1.55083, k 0 at 510 nm", text)
        self.assertIn("n 1.5, k 0 at 510 nm, clear", text)
        info = json.loads(self.succeed("info", "r.toml", "--json").out)
        self.assertEqual([info["film"][key] for key in ("thickness_nm", "thickness_spread", "periods")], [600, 0.1, 2])
        self.assertEqual([layer["extinction"] for layer in info["film"]["layers"]], [0, 0.05])
        self.assertEqual(info["base"], {"ior": 1.5, "extinction": 0, "opaque": False})
        self.assertTrue(json.loads(self.succeed("info", "base_extinction.toml", "--json").out)["base"]["opaque"])
        self.assertNotIn("film", json.loads(self.succeed("info", "tiny.toml", "--json").out))

    def test_scenes_keep_the_base_of_the_recipe(self):
        scene = support.SKY_SPHERE_SCENE.format(name="base_ior", spp=4, max_bounces=1, tangent_rotation_deg=0.0)
        for key, name, needle in (("base_ior = 1.4", "base_ior", "'base_ior'"),
                                  ("absorption_per_nm = 0.1", "base_extinction", "'absorption_per_nm'")):
            text = scene.replace("base_ior", name).replace('type = "skin"', f'type = "skin"\n{key}')
            self.write("scene.toml", text)
            self.refuse("render", "scene.toml", "-o", "out.exr", "--material", "live", naming=["scene.toml", needle])
        self.write("scene.toml", scene)
        self.succeed("render", "scene.toml", "-o", "picture.exr", "--material", "live")


if __name__ == "__main__":
    unittest.main()
