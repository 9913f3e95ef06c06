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
SOURCE = pathlib.Path(os.environ["SUNBEAM_SOURCE_DIR"])
CXX = os.environ["CXX"]
CC = os.environ.get("CC", "cc")
CXXFLAGS = os.environ.get("CXXFLAGS", "")
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


# A plane under one lamp, seen from so far that all pixels see one pair of directions.
PLANE = """\
table = "skin.exr"
[camera]
position = [0.0, 60.0, 80.0]
look_at = [0.0, 0.0, 0.0]
up = [0.0, 1.0, 0.0]
fov_deg = 0.1
[render]
width = 8
height = 8
spp = 4
max_bounces = 1
[[light]]
type = "directional"
towards = [0.0, 0.8, -0.6]
irradiance = 1.0
[[material]]
name = "skin"
type = "skin"
film_thickness_nm = 350.0
base_ior = 1.0
absorption_per_nm = 0.7
[[object]]
type = "plane"
normal = [0.0, 1.0, 0.0]
half_size = 10.0
material = "skin"
"""

SNIPPET = """\
#include <ImfArray.h>
#include <ImfRgbaFile.h>

#include <cstdio>

%s
int main() {
  const sunbeam::Vec3 wo = {0.8, 0, 0.6}, wi = {-0.6, 0, 0.8};
  const double u0 = 0.3, u1 = 0.6, u2 = 0.1;
  sunbeam::Rgb throughput(1);
%s
  std::printf("%%.9g %%.9g %%.9g\\n", f.r * wi.z, f.g * wi.z, f.b * wi.z);
  Imf::RgbaInputFile file("plane.exr");
  Imf::Array2D<Imf::Rgba> pixels(8, 8);
  file.setFrameBuffer(&pixels[0][0], 1, 8);
  file.readPixels(0, 7);
  std::printf("%%.9g %%.9g %%.9g\\n", double(pixels[4][4].r), double(pixels[4][4].g), double(pixels[4][4].b));
}
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
        # As after the README's line, where find_package() looks beside the command too.
        os.environ["PATH"] = f"{BUILD_DIR / 'bin'}{os.pathsep}{os.environ['PATH']}"
        (cls.folder / "recipe.toml").write_text(RECIPE)
        for name in ("table.exr", "table.vdb"):
            run(BINARY, "bake", "recipe.toml", "-o", name, cwd=cls.folder)

    def configure(self, source, build, *options, check=True, prefix=None):
        return run(CMAKE, "-G", "Ninja", "-S", source, "-B", self.folder / build,
                   f"-DCMAKE_PREFIX_PATH={prefix or self.prefix}", "-DCMAKE_BUILD_TYPE=Release", *options, check=check)

    def build(self, source, build, *options, prefix=None):
        self.configure(source, build, *options, prefix=prefix)
        run(CMAKE, "--build", self.folder / build)
        return self.folder / build / "example"

    @classmethod
    def shared_prefix(cls):
        """The runtime as a shared library, without OpenVDB, in a prefix of its own."""
        prefix, build = cls.folder / "shared", cls.folder / "build-shared"
        if not prefix.exists():
            run(CMAKE, "-G", "Ninja", "-S", SOURCE, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_SHARED_LIBS=ON",
                *(f"-DSUNBEAM_BUILD_{part}=OFF" for part in ("BAKE", "TRACER", "VDB", "TESTS")))
            run(CMAKE, "--build", build)
            run(CMAKE, "--install", build, "--prefix", prefix)
        return prefix

    def expected_eval(self, table):
        points = f"theta_i_deg,theta_o_deg,phi_deg\n{math.degrees(math.acos(0.6))!r},{math.degrees(math.acos(0.8))!r},180\n"
        (self.folder / "points.csv").write_text(points)
        text = run(BINARY, "eval", table, "--points", "points.csv", cwd=self.folder).stdout
        row = next(csv.DictReader(io.StringIO(text)))
        return [float(row[f"first_{c}"]) + float(row[f"rest_{c}"]) for c in "rgb"], float(row["pdf"])

    def check_example(self, example, table="table.exr"):
        self.check_output(run(example, self.folder / table).stdout, table)
        for bad in ("missing.exr", "recipe.toml"):
            result = run(example, self.folder / bad, check=False)
            self.assertEqual(result.returncode, 1)
            self.assertIn(bad, result.stderr)

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
        self.check_example(example)
        libraries = run("ldd", example).stdout
        self.assertRegex(libraries, r"libOpenEXR")
        for name in ("openvdb", "embree", "tbb", "fmt", "tomlplusplus", "png"):
            self.assertNotRegex(libraries.lower(), rf"lib{name}")

    def test_the_readme_has_the_colours_of_a_picture(self):
        """The snippet in Rec.709 against what `sunbeam render` makes of the same table; pixels are halves here."""
        shutil.copy(SOURCE / "tables" / "golden" / "preview.exr", self.folder / "skin.exr")
        (self.folder / "plane.toml").write_text(PLANE)
        run(BINARY, "render", "plane.toml", "-o", "plane.exr", cwd=self.folder)
        block = re.search(r"```cpp\n(.*?)```", (SOURCE / "README.md").read_text(), re.DOTALL).group(1)
        includes, body = block.split("\n\n", 1)
        project = self.folder / "readme"
        project.mkdir()
        (project / "main.cpp").write_text(SNIPPET % (includes, body))
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(readme LANGUAGES CXX)\nfind_package(sunbeam REQUIRED)\n"
            "add_executable(example main.cpp)\ntarget_link_libraries(example PRIVATE sunbeam::table OpenEXR::OpenEXR)\n")
        text = run(self.build(project, "build-readme"), cwd=self.folder).stdout
        snippet, picture = ([float(x) for x in line.split()] for line in text.splitlines())
        self.assertGreater(max(snippet), 2 * min(snippet), "a colour")
        for got, seen in zip(snippet, picture, strict=True):
            self.assertAlmostEqual(got, seen, delta=2e-3 * max(snippet))

    def test_hosts_without_exceptions(self):
        for header in ("table_bsdf.h", "table_io.h", "textured_table.h", "spectral_bsdf.h"):
            source = self.folder / "no_exceptions.cpp"
            source.write_text(f"#include <sunbeam/{header}>\n")
            run(CXX, "-std=c++20", "-fno-exceptions", "-fsyntax-only", "-I", self.prefix / "include", source)

    def test_c_example(self):
        self.check_example(self.build(EXAMPLE / "c", "build-c"))

    def test_the_c_snippet_compiles(self):
        page = (SOURCE / "docs" / "guide" / "embed.md").read_text()
        snippet = re.search(r"```c\n(.*?)```", page, re.DOTALL).group(1)
        source = self.folder / "snippet.c"
        source.write_text("#include <stdio.h>\n#include <sunbeam/sunbeam.h>\n"
                          "int look(size_t count, const double* wo, const double* wi, double* f, double* pdf) {\n"
                          f"{snippet}return 0;\n}}\n")
        run(CC, "-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I",
            self.prefix / "include", source)

    def test_shared_library(self):
        prefix = self.shared_prefix()
        for source, build in ((EXAMPLE, "build-shared-cpp"), (EXAMPLE / "c", "build-shared-c")):
            example = self.build(source, build, prefix=prefix)
            self.check_example(example)
            self.assertRegex(run("ldd", example).stdout, r"libsunbeam\.so")
        self.assertEqual(list(prefix.rglob("*.a")), [])

    def test_a_shared_library_shows_the_interface_alone(self):
        library = next(self.shared_prefix().rglob("libsunbeam.so"))
        names = [line.split()[-1] for line in run(NM, "-DC", "--defined-only", library).stdout.splitlines()]
        ours = [line for line in run(NM, "-DC", "--defined-only", library).stdout.splitlines() if "sunbeam" in line]
        self.assertGreater(len(ours), 40)
        self.assertLess(len(ours), 250)
        for inner in ("BoundTable", "FilmCurves", "TexturedData", "fit_isotropic"):
            self.assertFalse([line for line in ours if f"v1::{inner}::" in line or f"v1::{inner}(" in line], inner)
        self.assertIn("sunbeam_eval", names)

    def test_a_plug_in_hides_the_archives(self):
        source = self.folder / "plug_in.cpp"
        source.write_text("#include <sunbeam/table_bsdf.h>\n#include <sunbeam/table_io.h>\n"
                          "extern \"C\" __attribute__((visibility(\"default\"))) double use(const char* path) {\n"
                          "  const auto t = sunbeam::load_table_exr(path);\n"
                          "  return t.bind(sunbeam::Parameters::of(t.material)).pdf({0, 0, 1}, {0, 0, 1});\n}\n")
        project = self.folder / "plug-in"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(plug_in LANGUAGES CXX)\nfind_package(sunbeam REQUIRED)\n"
            "add_library(plug_in SHARED ../plug_in.cpp)\ntarget_link_libraries(plug_in PRIVATE sunbeam::table)\n"
            "set_target_properties(plug_in PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)\n")
        self.build(project, "build-plug-in")
        symbols = run(NM, "-D", "--defined-only", self.folder / "build-plug-in" / "libplug_in.so").stdout
        self.assertIn(" use", symbols)
        self.assertEqual([line for line in symbols.splitlines() if "7sunbeam" in line or "sunbeam_" in line], [])

    def test_fetch_content(self):
        example = self.build(EXAMPLE / "fetch_content", "build-fetched", f"-DSUNBEAM_SOURCE_DIR={SOURCE}")
        self.check_example(example)
        self.assertFalse((self.folder / "build-fetched" / "bin" / "sunbeam").exists())

    def test_fetch_content_of_a_shared_library(self):
        """The objects are those of shared_prefix(), so that this configures alone and asks what would be linked."""
        project = self.folder / "fetched-shared"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(fetched LANGUAGES CXX)\ninclude(FetchContent)\n"
            f"FetchContent_Declare(sunbeam SOURCE_DIR {SOURCE})\nFetchContent_MakeAvailable(sunbeam)\n"
            "get_target_property(type sunbeam::table TYPE)\nmessage(STATUS \"sunbeam::table is ${type}\")\n")
        for shared, kind in (("ON", "SHARED_LIBRARY"), ("OFF", "STATIC_LIBRARY")):
            text = self.configure(project, f"build-fetched-{shared}", f"-DBUILD_SHARED_LIBS={shared}").stdout
            self.assertIn(f"sunbeam::table is {kind}", text)

    def test_pkg_config(self):
        for prefix, name in ((self.prefix, "static"), (self.shared_prefix(), "shared")):
            folder = next(prefix.rglob("sunbeam.pc")).parent
            # Who links the shared library may lack the packages that it is made of.
            only = "PKG_CONFIG_LIBDIR" if name == "shared" else "PKG_CONFIG_PATH"
            environment = {**os.environ, only: str(folder)}
            flags = subprocess.run(["pkg-config", "--cflags", "--libs", "sunbeam"], capture_output=True, text=True,
                                   check=True, env=environment).stdout.split()
            example = self.folder / f"example-{name}"
            run(CXX, "-std=c++20", *CXXFLAGS.split(), EXAMPLE / "main.cpp", "-o", example, *flags,
                f"-Wl,-rpath,{folder.parent}")
            self.check_example(example)

    def test_the_build_tree_is_no_package(self):
        project = self.folder / "no-prefix"
        project.mkdir()
        (project / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(none LANGUAGES CXX)\n"
                                                "find_package(sunbeam REQUIRED)\n")
        result = run(CMAKE, "-G", "Ninja", "-S", project, "-B", self.folder / "build-none", check=False)
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("could not be found", " ".join(result.stderr.split()).replace("not find a package", "could not be found"))

    def test_component_vdb(self):
        project = self.folder / "vdb-project"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(VDB_PROJECT)
        source = (EXAMPLE / "main.cpp").read_text()
        changed = source.replace("table_io.h", "table_vdb.h").replace("try_load_table_exr", "try_load_table")
        self.assertEqual(changed.count("vdb"), 1)
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
                    self.assertTrue(re.fullmatch(r"[a-z_0-9]+|stddef\.h", include) or f"include/{include}" in names)
        for path in self.prefix.rglob("*.cmake"):
            self.assertNotIn(str(BUILD_DIR), path.read_text(), f"{path.name} points into the build folder")

    @staticmethod
    def global_symbols(library):
        """The mangled names that the linker sees of `library`."""
        lines = run(NM, "-g", "--defined-only", library).stdout.splitlines()
        return [line.split()[2] for line in lines if len(line.split()) == 3]

    def test_everything_bears_the_abi_version(self):
        """Two versions of the library may meet in one program, so no name of theirs is the same."""
        # Two headers are C or macros, without a namespace.
        headers = [path.read_text() for path in (self.prefix / "include").rglob("*.h")
                   if path.name not in ("sunbeam.h", "export.h")]
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
            # C names bear none. Those with an underscore in front are C++, or the compiler's as DW.ref are.
            plain = [name for name in self.global_symbols(archive) if not name.startswith(("_", "DW.ref."))]
            self.assertEqual([name for name in plain if not name.startswith("sunbeam_")], [], archive.name)


if __name__ == "__main__":
    unittest.main()
