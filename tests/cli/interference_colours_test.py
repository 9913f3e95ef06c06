"""Oxides on metals go through their known colours, in the known order, as they grow thicker."""

import math
import unittest

import support

# Intervals of CIELAB under D65 for each colour of a series: hue in degrees, chroma, lightness.
ANODISED_TITANIUM = {
    "gold": ((75, 95), (20, 50), (50, 72)),
    "purple": ((290, 350), (20, 60), (20, 45)),
    "blue": ((260, 290), (30, 60), (30, 50)),
    "light blue": ((235, 260), (15, 35), (55, 80)),
    "yellow": ((90, 110), (30, 75), (75, 90)),
    "pink": ((325, 380), (30, 75), (50, 75)),
    "green": ((140, 190), (20, 60), (50, 90)),
}
TEMPERED_STEEL = {
    "straw": ((80, 95), (10, 32), (52, 70)),
    "brown": ((50, 85), (25, 60), (20, 45)),
    "purple": ((300, 345), (25, 90), (5, 25)),
    "blue": ((270, 300), (30, 90), (18, 45)),
    "grey blue": ((235, 262), (10, 28), (58, 75)),
}

# Rec.709 to CIE XYZ, by rows; a row's sum is that component of D65 (ITU-R BT.709).
REC709_TO_XYZ = ((0.4124564, 0.3575761, 0.1804375), (0.2126729, 0.7151522, 0.0721750),
                 (0.0193339, 0.1191920, 0.9503041))


def lightness_chroma_hue(rgb):
    """CIELAB with the white (1, 1, 1), hue in degrees."""
    def f(row):
        t = sum(a * b for a, b in zip(row, rgb)) / sum(row)
        return t ** (1 / 3) if t > (6 / 29) ** 3 else t / (3 * (6 / 29) ** 2) + 4 / 29
    x, y, z = map(f, REC709_TO_XYZ)
    a, b = 500 * (x - y), 200 * (y - z)
    return 116 * y - 16, math.hypot(a, b), math.degrees(math.atan2(b, a)) % 360


def matches(colour, intervals):
    (lightness, chroma, hue), ((low, high), chromas, lightnesses) = colour, intervals
    return (low <= hue <= high or low <= hue + 360 <= high) and \
        chromas[0] <= chroma <= chromas[1] and lightnesses[0] <= lightness <= lightnesses[1]


class InterferenceColours(support.CliTest):
    def colours(self, recipe, thicknesses):
        """Of light reflected by the smooth film at normal incidence."""
        rows = "".join(f"{nm},0\n" for nm in thicknesses)
        result = self.succeed("eval", support.SOURCE_DIR / "tables/recipes" / recipe, "--quantity", "film",
                              "--set", "spectrum.color_space=rec709", "--points", "-",
                              stdin="film_thickness_nm,theta_i_deg\n" + rows)
        return [lightness_chroma_hue([float(row[f"reflectance_{c}"]) for c in "rgb"])
                for row in support.rows_of(result.out)]

    def check_series(self, recipe, series, thickest_nm):
        """Each colour appears at least 5 nm long, and is over before the next one begins."""
        thicknesses = range(thickest_nm + 1)
        colours = self.colours(recipe, thicknesses)
        end, last = -1, "bare metal"
        for name, intervals in series.items():
            found = [nm for nm, colour in zip(thicknesses, colours) if matches(colour, intervals)]
            self.assertGreaterEqual(len(found), 5, f"{recipe}: {name} at {found} nm")
            self.assertGreater(found[0], end, f"{recipe}: {name} begins before {last} ends")
            end, last = found[-1], name

    def test_anodised_titanium_from_gold_to_green(self):
        self.check_series("titanium.toml", ANODISED_TITANIUM, 200)

    def test_tempered_steel_from_straw_to_grey_blue(self):
        self.check_series("steel.toml", TEMPERED_STEEL, 100)

    def test_bare_metals_have_next_to_no_colour(self):
        for recipe in ("titanium.toml", "steel.toml"):
            (_, chroma, _), = self.colours(recipe, [0])
            self.assertLess(chroma, 5, recipe)


if __name__ == "__main__":
    unittest.main()
