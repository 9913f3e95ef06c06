"""The look-ups of builds of the runtime, line by line. Python's standard library only.

As a program it compares what two builds wrote into files: lookups_test.py compare A B
"""

import os
import pathlib
import subprocess
import sys
import unittest

TOLERANCE = 1e-6
LEAST = 1e-9  # what is less is compared as if it were this
# Kernels of the film for other instruction sets differ by 5e-7 of the light that meets it, and what is looked
# up may have little of it left, or be a reflectance over a chance.
LEAST_OF_OTHER_KERNELS = 4
# Visible normals are drawn by shares of 16 bits, which such a difference may round the other way.
DENSITIES = (" pdf", " mis_pdf", " throughput", " wi")
TOLERANCE_OF_SHARES = 1e-3


def split(line):
    """("table and what", [numbers])"""
    name, _, numbers = line.partition(": ")
    return name, [float(number) for number in numbers.split()]


def differences(a, b, least=LEAST):
    """Lines of a that b does not repeat to within TOLERANCE of the greatest number in them."""
    a, b = a.splitlines(), b.splitlines()
    if len(a) != len(b):
        return [f"{len(a)} lines against {len(b)}"]
    found = []
    for number, lines in enumerate(zip(a, b), 1):
        (name, x), (name_b, y) = map(split, lines)
        scale = max(least, *map(abs, x))
        # Written so that what is not a number differs.
        is_density = least == LEAST_OF_OTHER_KERNELS and name.endswith(DENSITIES)
        allowed = (TOLERANCE_OF_SHARES if is_density else TOLERANCE) * scale
        same = name == name_b and len(x) == len(y) and all(abs(p - q) <= allowed for p, q in zip(x, y))
        if not same:
            found.append(f"{number}: {lines[0]} against {lines[1]}")
    return found


def look_ups(build, kernels="fastest"):
    program = pathlib.Path(os.environ["LOOKUPS"]) / f"lookups_{build}"
    environment = dict(os.environ, SUNBEAM_KERNELS=kernels)
    return subprocess.run([program], env=environment, capture_output=True, check=True, text=True).stdout


class LookUps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.fast, cls.portable = look_ups("fast"), look_ups("portable")
        cls.vectors = look_ups("fast", "baseline")

    def test_vectors_and_plain_numbers(self):
        self.assertEqual(differences(self.vectors, self.portable), [])

    def test_fast_and_portable(self):
        self.assertEqual(differences(self.fast, self.portable, LEAST_OF_OTHER_KERNELS), [])

    def test_something_was_looked_up(self):
        names = {split(line)[0] for line in self.fast.splitlines()}
        self.assertGreater(len(names), 80)
        for what in ("f", "f of many", "pdf", "wi", "throughput", "mis_pdf"):
            self.assertGreater(max(max(split(line)[1]) for line in self.fast.splitlines()
                                   if split(line)[0] == f"anisotropic bound {what}"), 0, what)


class TheComparison(unittest.TestCase):
    TEXT = "a f: 0.5 0.25 1e-3\na pdf: 0.125\n"

    def test_sees_an_error_of_1e_5(self):
        self.assertEqual(differences(self.TEXT, self.TEXT), [])
        for wrong in ("0.500005", "nan"):
            self.assertEqual(len(differences(self.TEXT, self.TEXT.replace("0.5", wrong))), 1)
            self.assertEqual(len(differences(self.TEXT.replace("0.5", wrong), self.TEXT)), 1)
        self.assertEqual(len(differences(self.TEXT, self.TEXT.replace("0.125", "0.12500125"))), 1)
        self.assertEqual(len(differences(self.TEXT, self.TEXT.splitlines()[0])), 1)


if __name__ == "__main__":
    if sys.argv[1:2] == ["compare"]:
        texts = [pathlib.Path(path).read_text(encoding="utf-8") for path in sys.argv[2:4]]
        found = differences(*texts)
        equal = sum(a == b for a, b in zip(*map(str.splitlines, texts)))
        print(f"{equal} of {len(texts[0].splitlines())} lines are equal; {len(found)} differ by more than {TOLERANCE}")
        sys.exit("\n".join(found[:10]) if found else 0)
    unittest.main()
