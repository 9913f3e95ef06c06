"""The installed package, used by a program that has nothing but it, OpenEXR and Imath."""

import csv
import io
import math
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

BINARY = os.environ["SUNBEAM_BINARY"]
BUILD_DIR = pathlib.Path(os.environ["SUNBEAM_BUILD_DIR"])
HAS_VDB = os.environ["SUNBEAM_BUILD_VDB"] == "1"
CMAKE = os.environ["CMAKE_COMMAND"]
NM = os.environ["CMAKE_NM"]
EXAMPLE = pathlib.Path(__file__).resolve().parent / "example"

# Packages that an embedder of plain tables may lack.
NOT_NEEDED = ("OpenVDB", "embree", "TBB", "fmt", "tomlplusplus", "CLI11", "nlohmann_json", "PNG",
              "GTest", "benchmark")

RECIPE = """\
[material]
transmission = "straight"
roughness = 0.0
albedo = 0.02
film_thickness_nm = 300.0
base_ior = 1.5
absorption_per_nm = 0.1
[grid]
film_thickness_nm = [200.0, 400.0]
[table]
angles = 3
[accuracy]
noise = 0.05
tolerance_median = 0.3
tolerance_p99 = 1.0
"""

VDB_PROJECT = """\
cmake_minimum_required(VERSION 3.25)
project(vdb_user LANGUAGES CXX)
find_package(sunbeam REQUIRED COMPONENTS vdb)
add_executable(example main.cpp)
target_link_libraries(example PRIVATE sunbeam::table_vdb)
"""


def run(*command, check=True, cwd=None):
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=500, cwd=cwd)
    if check and result.returncode != 0:
        raise AssertionError(f"$ {' '.join(map(str, command))}\n{result.stdout}\n{result.stderr}")
    return result


class Embedding(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="sunbeam-embed-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.prefix = cls.folder / "prefix"
        run(CMAKE, "--install", BUILD_DIR, "--prefix", cls.prefix)
        (cls.folder / "recipe.toml").write_text(RECIPE)
        for name in ("table.exr", "table.vdb"):
            run(BINARY, "bake", "recipe.toml", "-o", name, cwd=cls.folder)

    def configure(self, source, build, *options, check=True):
        return run(CMAKE, "-G", "Ninja", "-S", source, "-B", self.folder / build, f"-DCMAKE_PREFIX_PATH={self.prefix}",
                   "-DCMAKE_BUILD_TYPE=Release", *options, check=check)

    def build(self, source, build, *options):
        self.configure(source, build, *options)
        run(CMAKE, "--build", self.folder / build)
        return self.folder / build / "example"

    def expected_eval(self, table):
        points = f"theta_i_deg,theta_o_deg,phi_deg\n{math.degrees(math.acos(0.6))!r},{math.degrees(math.acos(0.8))!r},180\n"
        (self.folder / "points.csv").write_text(points)
        text = run(BINARY, "eval", table, "--points", "points.csv", cwd=self.folder).stdout
        row = next(csv.DictReader(io.StringIO(text)))
        return [float(row[f"first_{c}"]) + float(row[f"rest_{c}"]) for c in "rgb"], float(row["pdf"])

    def check_output(self, text, table):
        """The program's numbers against those of the command."""
        lines = {line.split()[0]: [float(x) for x in line.split()[1:]] for line in text.splitlines()}
        values, pdf = self.expected_eval(table)
        for got, expected in zip(lines["eval"], values, strict=True):
            self.assertGreater(expected, 0)
            self.assertAlmostEqual(got / expected, 1, delta=1e-9)
        self.assertAlmostEqual(lines["pdf"][0] / pdf, 1, delta=1e-9)
        self.assertAlmostEqual(math.hypot(*lines["sample"]), 1, delta=1e-9)
        self.assertGreater(lines["sample"][2], 0)

    def test_example(self):
        example = self.build(EXAMPLE, "build-example", *(f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in NOT_NEEDED))
        self.check_output(run(example, self.folder / "table.exr").stdout, "table.exr")
        libraries = run("ldd", example).stdout
        self.assertRegex(libraries, r"libOpenEXR")
        for name in ("openvdb", "embree", "tbb", "fmt", "tomlplusplus", "png"):
            self.assertNotRegex(libraries.lower(), rf"lib{name}")
        for bad in ("missing.exr", "recipe.toml"):
            result = run(example, self.folder / bad, check=False)
            self.assertEqual(result.returncode, 1)
            self.assertIn(bad, result.stderr)

    def test_component_vdb(self):
        project = self.folder / "vdb-project"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(VDB_PROJECT)
        source = (EXAMPLE / "main.cpp").read_text()
        changed = source.replace("table_io.h", "table_vdb.h").replace("load_table_exr", "load_table_vdb")
        self.assertEqual(changed.count("vdb"), 2)
        (project / "main.cpp").write_text(changed)
        if HAS_VDB:
            example = self.build(project, "build-vdb")
            self.check_output(run(example, self.folder / "table.vdb").stdout, "table.vdb")
        else:
            result = self.configure(project, "build-vdb", check=False)
            self.assertNotEqual(result.returncode, 0)
            self.assertIn("SUNBEAM_BUILD_VDB", result.stderr)

    def test_an_unknown_component_is_refused(self):
        project = self.folder / "unknown-project"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(VDB_PROJECT.replace("COMPONENTS vdb", "COMPONENTS tracer"))
        (project / "main.cpp").write_text("int main() {}\n")
        result = self.configure(project, "build-unknown", check=False)
        self.assertNotEqual(result.returncode, 0)
        self.assertRegex(result.stderr, r"no\s+component\s+'tracer'")

    def test_installed_files(self):
        names = {path.relative_to(self.prefix).as_posix() for path in self.prefix.rglob("*") if path.is_file()}
        for needed in ("bin/sunbeam", "include/sunbeam/table_bsdf.h", "include/sunbeam/core/vec.h"):
            self.assertIn(needed, names)
        self.assertEqual("include/sunbeam/table_vdb.h" in names, HAS_VDB)
        headers = [name for name in names if name.startswith("include/")]
        self.assertGreater(len(headers), 15)
        for header in headers:
            text = (self.prefix / header).read_text()
            for include in re.findall(r'#\s*include\s*[<"]([^>"]+)[>"]', text):
                with self.subTest(header=header, include=include):
                    self.assertTrue(re.fullmatch(r"[a-z_0-9]+", include) or f"include/{include}" in names)
        for path in self.prefix.rglob("*.cmake"):
            self.assertNotIn(str(BUILD_DIR), path.read_text(), f"{path.name} points into the build folder")

    def test_everything_bears_the_abi_version(self):
        """Two versions of the library may meet in one program, so no name of theirs is the same."""
        headers = [path.read_text() for path in (self.prefix / "include").rglob("*.h")]
        spaces = [re.findall(r"^inline namespace (v[0-9]+) \{", text, re.MULTILINE) for text in headers]
        self.assertTrue(all(len(names) == 1 for names in spaces), "each header opens it once")
        version = {names[0] for names in spaces}
        self.assertEqual(len(version), 1, version)
        version = version.pop()
        mangled = f"7sunbeam{len(version)}{version}"
        archives = sorted(self.prefix.rglob("libsunbeam_*.a"))
        self.assertGreaterEqual(len(archives), 2)
        for archive in archives:
            names = [line.split()[-1] for line in run(NM, "--defined-only", archive).stdout.splitlines() if "7sunbeam" in line]
            self.assertGreater(len(names), 10)
            others = [name for name in names if "7sunbeam" in name.replace(mangled, "")]
            self.assertEqual(others, [], archive.name)


if __name__ == "__main__":
    unittest.main()
