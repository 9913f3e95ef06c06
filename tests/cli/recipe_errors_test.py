"""Bad recipes: each gives one line that names file, line, key, what was found and what is allowed."""

import unittest

import support

# Sections of a sound recipe; a case replaces one of them.
SOUND = {
    "material": 'roughness = 0.2\nalbedo = 0.3\nbase_ior = 1.5',
    "grid": "film_thickness_nm = [200.0, 400.0]",
    "table": "angles = 4",
    "accuracy": "noise = 0.05",
    "spectrum": 'mode = "rgb3"',
}


def recipe_with(section, body):
    sections = dict(SOUND, **{section: body})
    return "".join(f"[{name}]\n{text}\n\n" for name, text in sections.items())


class RecipeErrors(support.CliTest):
    def test_the_sound_recipe_is_sound(self):
        """Else every case below would fail for the wrong reason."""
        self.write("sound.toml", recipe_with("spectrum", SOUND["spectrum"]))
        points = "theta_i_deg,theta_o_deg,phi_deg\n30,40,180\n"
        self.succeed("eval", "sound.toml", "--points", "-", "--samples", "10", stdin=points)

    def check(self, section, key, value, *needles, where=None):
        """`key = value` in `section` is refused with its line (that of the key) and all needles."""
        text = recipe_with(section, f"{key} = {value}")
        line = text[:text.index(f"[{section}]")].count("\n") + 2
        name = self.write("bad.toml", text)
        with self.subTest(f"{section}.{key} = {value}"):
            self.refuse("bake", name, "-o", "out.exr",
                        naming=[f"bad.toml:{line}: ", f"'{where or f'{section}.{key}'}'", *needles])

    def test_numbers_out_of_range(self):
        limits = {
            "film_thickness_nm": ("0", "100000", ("-1", "-0.001", "100001")),
            "exterior_ior": ("1", "5", ("0.99", "0", "-1.5", "5.1")),
            "film_ior": ("1", "5", ("0.99", "0", "-1.5", "5.1")),
            "base_ior": ("1", "5", ("0.99", "0", "-1.5", "5.1")),
            "absorption_per_nm": ("0", "1000", ("-0.1", "1001")),
            "pigment_thickness_nm": ("0", "1000000", ("-2", "1000001")),
            "roughness": ("0", "1", ("-0.1", "1.01")),
            "albedo": ("0", "1", ("-0.1", "1.01")),
        }
        for key, (low, high, values) in limits.items():
            for value in (*values, "nan", "inf", "-inf"):
                self.check("material", key, value, f"found {value}", f"allowed: {low} to {high}")

    def test_other_sections_out_of_range(self):
        self.check("table", "angles", "1", "found 1;", "2 to 512")
        self.check("table", "angles", "513", "found 513", "2 to 512")
        self.check("table", "angles", "4.5", "found 4.5", "whole number")
        self.check("table", "azimuths", "0", "found 0;", "1 to 512")
        self.check("table", "precision", '"double"', 'found "double"', '"half", "float"')
        self.check("table", "encoding", '"sparse"', 'found "sparse"', '"dense"')
        self.check("accuracy", "noise", "0", "found 0;", "1e-06 to 1")
        self.check("accuracy", "noise", "nan", "found nan")
        self.check("accuracy", "tolerance_median", "0.0", "found 0;")
        self.check("accuracy", "tolerance_p99", "-0.1", "found -0.1")
        self.check("spectrum", "mode", '"hero"', 'found "hero"', '"rgb3"')

    def test_removed_keys(self):
        """What a recipe could once say is refused with what to do instead."""
        self.check("table", "frame", '"none"', "removed in 0.2.0", "closed form", "leave the key out")
        self.check("table", "frame", '"closed"', "removed in 0.2.0")
        self.check("accuracy", "interpolation", "0.01", "removed in 0.2.0", "[grid]", "sunbeam verify")
        name = self.write("limits.toml", recipe_with("limits", "megabytes = 1"))
        self.refuse("bake", name, "-o", "out.exr", naming=["key 'limits': removed in 0.2.0", "leave the section out"])

    def test_wrong_types(self):
        self.check("material", "exterior_ior", '"1.5"', "found a string", "number")
        self.check("material", "exterior_ior", "[1.5]", "found a", "number")
        for key in ("base_ior", "film_ior"):
            self.check("material", key, '"1.5"', 'found "1.5"', "a table of optical constants", "one of Ag, Al")
            self.check("material", key, "true", "found a boolean", "a number", "[nm, n]")
            self.check("material", key, "[1.5]", "element 1 is 1.5", "lists of 2 to 3 numbers")
        self.check("material", "base_ior", "2020-01-01", "found a date", "number")
        self.check("material", "transmission", "1", "found 1", "string")
        self.check("material", "transmission", '"sideways"', 'found "sideways"', '"straight", "refract"')
        self.check("material", "absorption_path", '"longest"', 'found "longest"', '"product", "sum"')
        self.check("material", "albedo", "[0.1, 0.2]", "found 2 numbers", "list of 3")
        self.check("material", "albedo", "[0.1, 0.2, 1.3]", "element 3 is 1.3", "0 to 1")
        self.check("material", "roughness", "[0, 0.2]", "found 0, 0.2", "two such values")
        self.check("material", "roughness", "[0.1, 0.2, 0.3]", "found 3 numbers", "a list of 2")
        self.check("material", "microfacet", '"double"', 'found "double"', '"single", "multiple"')
        self.check("material", "anisotropy", "1", "found 1", "-0.99 to 0.99")
        self.check("material", "roughness", "[]", "found 0 numbers")
        self.check("material", "roughness", "0.0001", "found 0.0001", "0.001 to 1")

    def test_scattering_needs_the_path_sum(self):
        self.check("material", "absorption_path", '"product"\nscattering_per_nm = 0.5', "found product",
                   "allowed: sum")
        self.check("material", "scattering_per_nm", "900", "optical thickness", "up to 100")

    def test_azimuths_that_the_material_does_not_allow(self):
        for material, value, needle in (
            ("roughness = [0.1, 0.3]", 6, "a multiple of 4 up to 512"),
            ("roughness = [0.1, 0.3]", 1, "a multiple of 4 up to 512"),
            ("scattering_per_nm = 0.5", 1, "scattering_per_nm > 0 has azimuth; allowed: 2 to 512"),
            ('microfacet = "multiple"', 1, 'microfacet "multiple" has azimuth; allowed: 2 to 512'),
        ):
            name = self.write("bad.toml", f"[material]\n{material}\n[table]\nazimuths = {value}\n")
            with self.subTest(f"{material}, {value}"):
                self.refuse("bake", name, "-o", "out.exr",
                            naming=["bad.toml:4: ", "'table.azimuths'", f"found {value}", needle])

    def test_lobes_that_no_table_of_these_nodes_holds(self):
        facets = ("--set", "material.roughness=0.001", "--set", 'material.microfacet="multiple"')
        back = ("--set", "material.absorption_path=sum", "--set", "material.scattering_per_nm=0.5", "--set",
                "material.anisotropy=-0.99", "--set", "table.azimuths=9")
        for options, needles in (
            (facets, ("'table.azimuths'", "found 9", 'microfacet "multiple"', "allowed with roughness 0.001: 12 to 512")),
            (back, ("'material.anisotropy'", "found -0.99", "3 cosines", "to 0.99", "table.angles")),
        ):
            for more in ((), ("--preview",), ("--shard", "1/2")):
                with self.subTest(options=options, more=more):
                    self.refuse("bake", "tiny.toml", "-o", "out.exr", *options, *more, naming=["tiny.toml: key ", *needles])

    def test_full_spectrum_keys_need_mode_full(self):
        for key, value in (("illuminant", '"D65"'), ("color_space", '"acescg"')):
            self.check("spectrum", key, value, "rgb3", 'allowed with "full" only')
        self.check("material", "absorption_spectrum", '"flat"', "rgb3", 'allowed with "full" only')
        self.check("material", "albedo", "[[400, 0.1], [700, 0.5]]", "rgb3", 'allowed with "full" only')

    def check_full(self, section, key, value, *needles):
        """As check(), in mode full."""
        sections = {name: "" for name in SOUND}
        sections["spectrum"] = 'mode = "full"\n'
        sections[section] += f"{key} = {value}\n"
        text = "".join(f"[{name}]\n{body}" for name, body in sections.items())
        line = text[:text.index(f"{key} = {value}")].count("\n") + 1
        name = self.write("bad.toml", text)
        with self.subTest(f"{section}.{key} = {value}"):
            self.refuse("bake", name, "-o", "out.exr", naming=[f"bad.toml:{line}: ", f"'{section}.{key}'", *needles])

    def test_full_spectrum(self):
        self.check_full("spectrum", "illuminant", '"A"', 'found "A"', '"D65", "E"')
        self.check_full("spectrum", "color_space", '"srgb"', 'found "srgb"', '"acescg", "rec709"')
        self.check_full("spectrum", "color_spce", '"rec709"', "not known", "'color_space'")
        self.check_full("material", "absorption_spectrum", '"melanin"', 'found "melanin"', '"eumelanin", "pheomelanin"')
        self.check_full("material", "absorption_spectrum", "3", "found 3", "string")
        for key in ("albedo", "absorption_spectrum"):
            self.check_full("material", key, "[[400, 0.5]]", "found 1 pairs", "at least two pairs")
            self.check_full("material", key, "[[400, 0.5], [400, 0.6]]", "element 2 is [400, 0.6]", "ascending")
            self.check_full("material", key, "[[400, 0.5], [500]]", "element 2 is a list of 1", "pairs")
            self.check_full("material", key, '[[400, 0.5], [500, "dark"]]', "element 2 is [500, a string]", "pairs")
            self.check_full("material", key, "[[400, 0.5], [500, nan]]", "element 2", "pairs")
            self.check_full("material", key, "[[400, 0.5], 0.3]", "element 2 is 0.3", "pairs")
            self.check_full("material", key, "[[400, 0.5], [500, -0.1]]", "element 2 is [500, -0.1]", "pairs")
            self.check_full("material", key, "[[0, 0.5], [500, 0.1]]", "element 1 is [0, 0.5]", "1 to 1000000")
        self.check_full("material", "albedo", "[[400, 0.5], [500, 1.1]]", "element 2 is [500, 1.1]", "0 to 1")
        self.check_full("material", "albedo", "[0.5, 1.1, 0]", "element 2 is 1.1", "0 to 1")
        self.check_full("material", "absorption_spectrum", "[[400, 1], [500, 0], [600, 0]]", "510 nm is 0", "positive")
        self.check_full("material", "film_thickness_nm", "5600", "found 5600", "film_ior 1.56", "up to 5538")
        self.check_full("grid", "film_thickness_nm", "[100, 5600]", "found 5600", "film_ior 1.56", "up to 5538")

    def test_grids(self):
        self.check("grid", "base_ior", "[]", "empty", "allowed")
        self.check("grid", "base_ior", "[1.6, 1.4]", "increase", "1.6", "1.4")
        self.check("grid", "base_ior", "[1.4, 1.4]", "increase", "1.4")
        self.check("grid", "base_ior", "[1.4, 0.5]", "element 2 is 0.5", "1 to 5")
        self.check("grid", "base_ior", "[1.4, nan]", "element 2 is nan")
        self.check("grid", "base_ior", "[1.4, inf]", "element 2 is inf")
        self.check("grid", "base_ior", '[1.4, "thick"]', "element 2 is a string", "number")
        self.check("grid", "base_ior", "1.5", "found", "1.5", "list of numbers")
        self.check("grid", "film_thickness_nm", "[-5.0, 5.0]", "element 1 is -5", "0 to 100000")
        ranged = [
            ("{from = 1.4, to = 1.6, count = 0}", "count", "found 0;"),
            ("{from = 1.4, to = 1.6, count = -3}", "count", "found -3;"),
            ("{from = 1.4, to = 1.6, count = 2.5}", "count", "found 2.5;"),
            ("{from = 1.4, to = 1.6, count = 1}", "count", "from < to"),
            ("{from = 1.5, to = 1.5, count = 2}", "count", "from < to"),
            ("{from = 1.4, to = 1.6, count = 5000}", "count", "found 5000;"),
            ("{from = 1.6, to = 1.4, count = 3}", "to", "found 1.4; allowed: 1.6 to 5"),
            ("{from = 0.9, to = 1.4, count = 3}", "from", "found 0.9; allowed: 1 to 5"),
            ("{from = nan, to = 1.4, count = 3}", "from", "found nan"),
        ]
        for value, key, needle in ranged:
            self.check("grid", "base_ior", value, needle, where=f"grid.base_ior.{key}")
        for key in ("from", "to", "count"):
            value = "{" + ", ".join(f"{k} = 2" for k in ("from", "to", "count") if k != key) + "}"
            self.check("grid", "base_ior", value, "missing", where=f"grid.base_ior.{key}")

    def test_a_table_too_large_to_hold_is_refused_at_once(self):
        huge = "\n".join(f"{key} = {{from = 1.0, to = 5.0, count = 4096}}"
                         for key in ("film_thickness_nm", "base_ior", "absorption_per_nm"))
        name = self.write("bad.toml", recipe_with("grid", huge))
        self.refuse("bake", name, "-o", "out.exr", "--set", "table.angles=512", "--set", "table.azimuths=512",
                    naming=["bad.toml"], preexec_fn=support.limit_cpu_seconds(20))

    def test_unknown_keys_name_the_nearest(self):
        self.check("material", "film_thicknes_nm", "300.0", "not known", "'film_thickness_nm'")
        self.check("material", "rougness", "0.1", "not known", "'roughness'")
        self.check("grid", "base_iorr", "[1.5]", "not known", "'base_ior'")
        self.check("table", "angle", "4", "not known", "'angles'")
        self.check("accuracy", "tolerance_p90", "0.1", "not known", "'tolerance_p99'")
        self.check("spectrum", "mod", '"rgb3"', "not known", "'mode'")

    def test_unknown_sections_name_the_nearest(self):
        text = recipe_with("spectrum", SOUND["spectrum"]) + "[acuracy]\nnoise = 0.1\n"
        line = text[:text.index("[acuracy]")].count("\n") + 1
        name = self.write("bad.toml", text)
        self.refuse("bake", name, "-o", "out.exr", naming=[f"bad.toml:{line}: ", "'acuracy'", "'accuracy'"])

    def test_a_key_outside_any_section(self):
        name = self.write("bad.toml", "roughness = 0.2\n")
        self.refuse("bake", name, "-o", "out.exr", naming=["bad.toml:1: ", "'roughness'"])

    def test_a_section_that_is_no_section(self):
        for text in ("material = 1.5\n", "[[material]]\nroughness = 0.2\n", 'material = "skin"\n'):
            with self.subTest(text=text):
                name = self.write("bad.toml", text)
                self.refuse("bake", name, "-o", "out.exr", naming=["bad.toml:1: ", "'material'", "section"])

    def test_broken_toml_names_the_line(self):
        broken = [
            ("[material]\nroughness = 0.2\n\nbase_ior = = 3\n", 4),
            ("[material]\nbase_ior = 1.5\nbase_ior = 1.6\n", 3),
            ("[material\nbase_ior = 1.5\n", 1),
            ("[material]\nbase_ior 1.5\n", 2),
            ('[material]\n\ntransmission = "refract\n', 3),
            ("[material]\nbase_ior = 1,5\n", 2),
        ]
        for text, line in broken:
            with self.subTest(text=text):
                name = self.write("bad.toml", text)
                self.refuse("bake", name, "-o", "out.exr", naming=[f"bad.toml:{line}: "])

    def test_files_that_are_no_text(self):
        for content in (bytes(range(256)), b"\x00" * 64, b"a = " + b"[" * 4000):
            with self.subTest(content=content[:8]):
                name = self.write("bad.toml", content)
                self.refuse("bake", name, "-o", "out.exr", naming=["bad.toml"])

    def test_bad_overrides_are_quoted(self):
        overrides = [
            ("material", ["'material'", "section.key=value"]),
            ("material.albedo", ["'material.albedo'", "section.key=value"]),
            ("albedo=0.5", ["'albedo=0.5'", "section.key=value"]),
            ("=1", ["'=1'", "section.key=value"]),
            (".albedo=1", ["'.albedo=1'", "section.key=value"]),
            ("material.albedo=", ["material.albedo", "allowed"]),
            ("material.albedo=1.5", ["material.albedo", "found 1.5", "0 to 1"]),
            ("material.albdo=0.5", ["material.albdo", "'albedo'"]),
            ("materials.albedo=0.5", ["'materials'", "'material'"]),
            ("material.albedo.red=0.5", ["material.albedo", "section"]),
            ("material.base_ior=nan", ["material.base_ior", "found nan"]),
            ("grid.base_ior=[]", ["grid.base_ior", "empty"]),
        ]
        for override, needles in overrides:
            with self.subTest(override=override):
                self.refuse("bake", "tiny.toml", "-o", "out.exr", "--set", override, naming=["tiny.toml", *needles])

    def test_missing_file_and_folder(self):
        (self.folder / "folder.toml").mkdir()
        for name, needle in (("missing.toml", "No such file"), ("folder.toml", "folder")):
            with self.subTest(name=name):
                self.refuse("bake", name, "-o", "out.exr", naming=[name, needle])
                self.refuse("eval", name, "--points", "-", stdin="theta_i_deg\n1\n", naming=[name, needle])


if __name__ == "__main__":
    unittest.main()
