"""bench_render runs, and its figures are where no noise could move them."""

import json
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["BENCH_RENDER"]
MEAN = {"bench_sphere": 0.3883, "bench_torus": 0.3871}  # of albedo 0.5


class BenchRender(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "render.json"
            cls.out = subprocess.run([PROGRAM, "--quick", "--json", path], check=True, capture_output=True, text=True,
                                     timeout=500).stdout
            cls.report = json.loads(path.read_text())

    def rows(self):
        return [row for part in self.report.values() if isinstance(part, list) for row in part]

    def test_every_part_is_there_and_printed(self):
        for part in ("ceiling", "table", "start", "looks", "estimators", "aovs"):
            with self.subTest(part=part):
                self.assertGreater(len(self.report[part]), 0)
                for key in self.report[part][0]:
                    self.assertIn(key, self.out)

    def test_figures_are_positive(self):
        for row in self.rows():
            for key, value in row.items():
                if not isinstance(value, str):
                    with self.subTest(row=row, key=key):
                        self.assertTrue(math.isfinite(value) and value > 0)

    def test_the_bare_loop_traces_the_same_rays_to_the_same_picture(self):
        for row in self.report["ceiling"]:
            with self.subTest(scene=row["scene"]):
                self.assertAlmostEqual(row["bare_rays_per_path"] / row["rays_per_path"], 1, delta=0.03)
                for key in ("mean", "bare_mean"):
                    self.assertAlmostEqual(row[key] / MEAN[row["scene"]], 1, delta=0.03)

    def test_looks_begin_with_their_reference(self):
        for row in self.report["looks"]:
            if row["material"] == "diffuse":
                self.assertEqual(row["time_ratio"], 1)
                self.assertEqual(row["equal_noise_ratio"], 1)


if __name__ == "__main__":
    unittest.main()
