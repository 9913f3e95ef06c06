"""The shipped films of layers: their tables show what the live model shows, but for noise.

Each look is a ball, rendered once by its table and twice live. The difference of table and live must be that of two
live pictures: in FLIP, and in the mean of each channel, where noise alone is beyond 4.5 standard errors once in
8000 runs of all looks. Random numbers are those of a seed, so that a run repeats."""

import json
import re
import unittest

import support

# With such a tolerance bakes check their tables by walks, which take less time.
BY_WALKS = ("--set", "accuracy.tolerance_median=0.01")
SIZE = ("--size", "48x48", "--spp", "64")

# Exact evaluation of uneven platelets takes long: nacre has two of its twelve, Morpho one thickness of its grid.
LOOKS = {"chrysochroa": (), "morpho": (r"\[1500.0, 2000.0\]", "[1755.0]"), "nacre": ("film_periods = 12", "film_periods = 2"),
         "titanium": (), "steel": (), "oil": ()}


class FilmLooks(support.CliTest):
    def render(self, name, *options):
        self.succeed("render", "scene.toml", "-o", name, *SIZE, *options)

    def compare(self, a, b):
        return json.loads(self.succeed("compare", a, b, "--json").out)

    def test_tables_look_like_live(self):
        scene = (support.SOURCE_DIR / "tables/scenes/look.toml").read_text()
        for look, change in LOOKS.items():
            with self.subTest(look=look):
                recipe = (support.SOURCE_DIR / f"tables/recipes/{look}.toml").read_text()
                if change:
                    recipe, changes = re.subn(*change, recipe)
                    self.assertEqual(changes, 1)
                self.write("look.toml", recipe)
                self.succeed("bake", "look.toml", "-o", "look.exr", "--preview", *BY_WALKS)
                self.write("scene.toml", scene.replace("../recipes/titanium.toml", "look.toml"))
                self.render("table.exr", "--table", "look.exr")
                for seed in (2, 3):
                    self.render(f"live_{seed}.exr", "--material", "live", "--seed", seed)
                found, noise = self.compare("table.exr", "live_2.exr"), self.compare("live_3.exr", "live_2.exr")
                self.assertLess(found["flip"], 1.1 * noise["flip"])
                self.assertLess(max(map(abs, found["bias_z"])), 4.5)


if __name__ == "__main__":
    unittest.main()
