"""cmake/test.sh: the labels that it knows, and what it refuses before it installs or builds anything."""

import os
import re
import subprocess
import unittest

import support

SCRIPT = support.SOURCE_DIR / "cmake/test.sh"


class TestScript(unittest.TestCase):
    def run_script(self, *arguments):
        return support.run_command(["bash", SCRIPT, *arguments], "/")

    def test_bad_arguments(self):
        for arguments, needle in (
                (("--fast",), "'--fast'"), (("unit",), "'unit'"), (("-D",), "'-D'"), (("",), "''"),
                (("--label",), "--label needs"), (("--label", "units"), "--label needs"),
                (("--label", "render cli"), "--label needs"), (("--label", "unit", "--all"), "alone"),
                (("--all", "--all"), "once"), (("-DA=1", "--label", "-DB=1"), "--label needs")):
            with self.subTest(arguments=arguments):
                result = self.run_script(*arguments)
                self.assertEqual((result.code, result.out), (2, ""), result)
                self.assertIn(needle, result.err.splitlines()[0], result)
                self.assertIn("\nusage: bash cmake/test.sh ", result.err, result)

    def test_help(self):
        result = self.run_script("--help")
        self.assertEqual((result.code, result.err), (0, ""), result)
        self.assertTrue(result.out.startswith("usage: bash cmake/test.sh "), result)

    def test_labels_are_those_of_ctest(self):
        """In a folder of its own: ctest would write over the log of the one that runs this."""
        folder = support.make_folder(self)
        (folder / "CTestTestfile.cmake").write_text(f'subdirs("{os.environ["SUNBEAM_BUILD_DIR"]}")\n')
        listed = subprocess.run([os.environ["CTEST_COMMAND"], "--print-labels"], cwd=folder, check=True, capture_output=True,
                                text=True, timeout=support.TIME_LIMIT_S).stdout
        labels = re.findall(r"^  (\w+)$", listed, re.MULTILINE)
        self.assertIn("unit", labels)
        known = self.run_script("--help").out.split("--label NAME  those of one label: ")[1].splitlines()[0].split()
        self.assertEqual(sorted(known), sorted(labels))


if __name__ == "__main__":
    unittest.main()
