"""bench_tables runs, and its figures are where no noise could move them."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["BENCH_TABLES"]


class BenchTables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "tables.json"
            cls.out = subprocess.run([PROGRAM, "--quick", "--json", path], check=True, capture_output=True, text=True,
                                     timeout=500).stdout
            cls.report = json.loads(path.read_text())
        cls.tables = {row["name"]: row for row in cls.report["tables"]}

    def family(self, name):
        return [row for row in self.report["tables"] if row["family"] == name]

    def test_every_family_is_there_and_printed(self):
        for family in ("sunbeam", "uniform f", "uniform f cos cos", "MERL"):
            with self.subTest(family=family):
                self.assertGreater(len(self.family(family)), 0)
        for name in self.tables:
            self.assertIn(name, self.out)

    def test_figures_are_positive_and_in_order(self):
        for name, row in self.tables.items():
            with self.subTest(table=name):
                self.assertGreater(row["bytes"], 0)
                self.assertGreater(row["error_median"], 0)
                self.assertLessEqual(row["error_median"], row["error_p99"])
                self.assertGreater(row["eval_ns"], 0)
                self.assertGreater(row["eval_ratio"], 0)

    def test_bytes_of_the_plain_layouts(self):
        self.assertEqual(self.tables["uniform f 32x32x32"]["bytes"], 32 ** 3 * 3 * 2)
        self.assertEqual(self.tables["MERL 90x90x180"]["bytes"], 12 + 90 * 90 * 180 * 3 * 8)

    def test_ours_is_smaller_and_nearer_than_plain_tables(self):
        for ours in self.family("sunbeam"):
            self.assertLess(ours["error_median"], 1e-3, ours["name"])  # one node a parameter is exact in all of them
            for name in ("uniform f 32x32x32", "uniform f cos cos 32x32x32", "MERL 90x90x180"):
                with self.subTest(ours=ours["name"], table=name):
                    self.assertLess(ours["error_median"], self.tables[name]["error_median"])
                    self.assertLess(ours["bytes"], self.tables[name]["bytes"])

    def test_finer_uniform_grids_are_nearer(self):
        for family in ("uniform f", "uniform f cos cos"):
            coarse, fine = self.tables[f"{family} 16x16x16"], self.tables[f"{family} 128x128x128"]
            self.assertLess(fine["error_median"], coarse["error_median"])

    def test_throughput_varies_within_reason(self):
        sample = self.report["sample"]
        self.assertGreater(sample["deviation_mean"], 0)
        self.assertLessEqual(sample["deviation_mean"], sample["deviation_worst"])


if __name__ == "__main__":
    unittest.main()
