"""Which part may include which, and what must not be mentioned. Reads sources only.

Every #include is resolved to a path within the sources if there is such a file; else it keeps its text.
"""

import fnmatch
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

SOURCE_DIR = pathlib.Path(os.environ["SUNBEAM_SOURCE_DIR"])
SUFFIXES = {".h", ".hpp", ".cpp", ".cc"}
PRODUCT = ("runtime/*", "bake/*")

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"\n]+)[>"]', re.MULTILINE)
EMBREE_CALL = re.compile(r"\brtc[A-Z]\w*")
STANDARD_HEADER = r"(?:[a-z_0-9]+|stddef\.h)"


class Rule:
    """Files that match one of `files` (and none of `but`) include nothing that fully matches `forbidden`."""

    def __init__(self, name, files, forbidden, but=()):
        self.name = name
        self.files = files
        self.forbidden = re.compile(forbidden)
        self.but = but

    def covers(self, path):
        return any(fnmatch.fnmatch(path, p) for p in self.files) and not any(fnmatch.fnmatch(path, p) for p in self.but)


CORE = "runtime/include/sunbeam/core/"
TABLE_HEADER = r"runtime/include/sunbeam/table.*|runtime/src/(?:table|fit|lookup)/.*"

# Rooms (folders with sources) from the ground up. A file includes its own room and those on lower floors; rooms on one
# floor know nothing of one another.
FLOORS = {
    "bake": (
        ("bake/base",), ("bake/optics/dispersion",), ("bake/optics",), ("bake/optics/layered",),
        ("bake/live/film",), ("bake/live/walks", "bake/live/exact"), ("bake/live/general",), ("bake/live/adding_doubling",),
        ("bake/live",),
        ("bake/recipe",), ("bake/blocks",), ("bake/factored/facets", "bake/factored/orders"), ("bake/factored", "bake/dense"), ("bake/check",), ("bake/jobs",),
        ("bake/scene", "bake/compare", "bake/report"), ("bake/cli",)),
    "runtime/src": (
        ("runtime/src/base",), ("runtime/src/files",), ("runtime/src/exr", "runtime/src/film", "runtime/src/vdb"),
        ("runtime/src/table",), ("runtime/src/sampling",), ("runtime/src/rest",), ("runtime/src/layers",), ("runtime/src/fit",), ("runtime/src/textured",), ("runtime/src/lookup",), ("runtime/src/c",)),
}
LARGEST_ROOM = 16  # files
MAY_BE_LARGER = {"bake/cli", "bake/report"}  # a file a subcommand, a file a chart


def room_of(path):
    return pathlib.PurePosixPath(path).parent.as_posix()


def floors_of_rooms(floors):
    return {room: level for level, rooms in enumerate(floors) for room in rooms}


def steps_up(root, paths):
    """[(file, include)] where a file includes a room that is not below its own."""
    found = []
    for floors in map(floors_of_rooms, FLOORS.values()):
        for path in paths:
            here = room_of(path)
            if here not in floors:
                continue
            for include in includes_of(root, path):
                there = room_of(include)
                if there in floors and there != here and floors[there] >= floors[here]:
                    found.append((path, include))
    return found


def rooms_with_sources(paths):
    """{room: number of files} of the trees whose rooms have floors."""
    rooms = {}
    for path in paths:
        if any(path.startswith(tree + "/") for tree in FLOORS):
            rooms[room_of(path)] = rooms.get(room_of(path), 0) + 1
    return rooms


def too_large(rooms):
    return sorted(room for room, files in rooms.items() if files > LARGEST_ROOM and room not in MAY_BE_LARGER)

RULES = [
    Rule("runtime knows nothing of bake", ["runtime/*"], r"bake/.*"),
    Rule("core headers include core and the standard library only", [CORE + "*"],
         rf"(?!{CORE}[^/]+$)(?!{STANDARD_HEADER}$).*"),
    Rule("public headers include public headers and the standard library only", ["runtime/include/*"],
         rf"(?!runtime/include/sunbeam/)(?!{STANDARD_HEADER}$).*"),
    Rule("tables know nothing of the tracer", ["runtime/include/*", "runtime/src/*"], r"runtime/tracer/.*"),
    Rule("tables know nothing of configuration files", ["runtime/include/*", "runtime/src/*"], r"runtime/config/.*|toml.*"),
    Rule("the tracer knows nothing of tables", ["runtime/tracer/*"], TABLE_HEADER),
    Rule("only embree_* includes Embree", PRODUCT, r"embree.*", but=["runtime/tracer/embree_*"]),
    Rule("only *_vdb.cpp includes OpenVDB", PRODUCT, r"openvdb.*", but=["*_vdb.cpp"]),
    Rule("optics stand alone in bake", ["bake/optics/*"], r"bake/(?!optics/).*"),
    Rule("the live model stands on optics only", ["bake/live/*"], r"bake/(?!live/|optics/).*"),
    Rule("the live model knows nothing of tables", ["bake/live/*", "bake/optics/*"], TABLE_HEADER + "|runtime/tracer/.*"),
    Rule("comparing pictures needs pictures only", ["bake/compare/*"], r"bake/(?!compare/).*|" + TABLE_HEADER),
    Rule("the library bake knows nothing of the command line", ["bake/*"], r"CLI/.*", but=["bake/cli/*"]),
]


def strip_comments(text):
    return re.sub(r'//[^\n]*|/\*.*?\*/|("(?:[^"\\\n]|\\.)*")', lambda m: m.group(1) or " ", text, flags=re.DOTALL)


def resolve(root, path, include):
    folders = [root / pathlib.Path(path).parent, root, root / "runtime/include"]
    for folder in folders:
        found = (folder / include).resolve()
        if found.is_file() and root.resolve() in found.parents:
            return found.relative_to(root.resolve()).as_posix()
    return include


def includes_of(root, path):
    text = (root / path).read_text(encoding="utf-8")
    return [resolve(root, path, include) for include in INCLUDE.findall(text)]


def violations(root, paths):
    """[(rule name, file, include)] and the number of includes each rule looked at."""
    found, looked = [], {rule.name: 0 for rule in RULES}
    for path in paths:
        includes = includes_of(root, path)
        for rule in RULES:
            if not rule.covers(path):
                continue
            looked[rule.name] += len(includes)
            found += [(rule.name, path, include) for include in includes if rule.forbidden.fullmatch(include)]
    return found, looked


def embree_calls(root, paths):
    return [(path, call) for path in paths if not fnmatch.fnmatch(path, "runtime/tracer/embree_*")
            for call in EMBREE_CALL.findall(strip_comments((root / path).read_text(encoding="utf-8")))]


def repository_files():
    """Every file that git tracks or would track."""
    listing = subprocess.run(
        ["git", "-c", "safe.directory=*", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=SOURCE_DIR, capture_output=True, check=True).stdout.decode()
    return sorted(name for name in set(listing.split("\0")) if name and (SOURCE_DIR / name).is_file())


def product_sources():
    return sorted(path.relative_to(SOURCE_DIR).as_posix() for top in ("runtime", "bake")
                  for path in (SOURCE_DIR / top).rglob("*") if path.suffix in SUFFIXES)


class Layering(unittest.TestCase):
    def test_something_was_scanned(self):
        sources = product_sources()
        self.assertGreater(len(sources), 40)
        _, looked = violations(SOURCE_DIR, sources)
        for rule, count in looked.items():
            with self.subTest(rule=rule):
                self.assertGreater(count, 0, "the rule covers no #include at all")

    def test_the_exceptions_are_used(self):
        """Embree and OpenVDB are included where they are allowed, so the search finds them."""
        includes = {path: includes_of(SOURCE_DIR, path) for path in product_sources()}
        for file, library in (("runtime/tracer/embree_api.h", "embree"), ("runtime/src/table/table_vdb.cpp", "openvdb")):
            self.assertTrue(any(include.startswith(library) for include in includes[file]), (file, library))
        calls = EMBREE_CALL.findall((SOURCE_DIR / "runtime/tracer/embree_scene.cpp").read_text())
        self.assertGreater(len(calls), 5)

    def test_includes(self):
        found, _ = violations(SOURCE_DIR, product_sources())
        self.assertEqual(found, [])

    def test_rooms(self):
        self.assertEqual(steps_up(SOURCE_DIR, product_sources()), [])

    def test_every_room_has_a_floor(self):
        known = {room for floors in FLOORS.values() for rooms in floors for room in rooms}
        self.assertEqual(set(rooms_with_sources(product_sources())) - known, set())

    def test_no_room_is_crowded(self):
        self.assertEqual(too_large(rooms_with_sources(product_sources())), [])

    def test_embree_calls(self):
        self.assertEqual(embree_calls(SOURCE_DIR, product_sources()), [])


class Mentions(unittest.TestCase):
    # Put together here so that this file does not mention it either.
    FORBIDDEN = ("../" + "shared").encode()

    def test_nothing_outside_the_repository_is_mentioned(self):
        files = repository_files()
        self.assertGreater(len(files), 50)
        self.assertIn("CMakeLists.txt", files)
        found = [name for name in files if self.FORBIDDEN in (SOURCE_DIR / name).read_bytes()]
        self.assertEqual(found, [])


class RulesCanFail(unittest.TestCase):
    """Each rule finds a violation that is planted in a small tree."""

    PLANTED = {
        "runtime knows nothing of bake": ("runtime/src/a.cpp", '#include "bake/recipe/recipe.h"'),
        "core headers include core and the standard library only":
            ("runtime/include/sunbeam/core/a.h", '#include "sunbeam/bsdf.h"'),
        "public headers include public headers and the standard library only":
            ("runtime/include/sunbeam/a.h", "#include <ImfHeader.h>"),
        "tables know nothing of the tracer": ("runtime/src/table/table.cpp", '#  include "../tracer/scene.h"'),
        "tables know nothing of configuration files": ("runtime/src/table/table.cpp", "#include <toml++/toml.h>"),
        "the tracer knows nothing of tables": ("runtime/tracer/a.cpp", '#include "sunbeam/table_bsdf.h"'),
        "only embree_* includes Embree": ("runtime/tracer/render.cpp", "#include <embree3/rtcore.h>"),
        "only *_vdb.cpp includes OpenVDB": ("runtime/src/table/table.cpp", "#include <openvdb/openvdb.h>"),
        "optics stand alone in bake": ("bake/optics/a.cpp", '#include "../base/running_mean.h"'),
        "the live model stands on optics only": ("bake/live/a.cpp", '#include "bake/jobs/bake.h"'),
        "the live model knows nothing of tables": ("bake/live/a.cpp", '#include "sunbeam/table.h"'),
        "comparing pictures needs pictures only": ("bake/compare/a.cpp", '#include "bake/recipe/recipe.h"'),
        "the library bake knows nothing of the command line": ("bake/jobs/a.cpp", "#include <CLI/CLI.hpp>"),
    }

    def test_every_rule(self):
        self.assertEqual(set(self.PLANTED), {rule.name for rule in RULES})
        for name, (path, line) in self.PLANTED.items():
            with self.subTest(rule=name), tempfile.TemporaryDirectory() as folder:
                root = pathlib.Path(folder)
                existing = ("bake/recipe/recipe.h", "bake/jobs/bake.h", "bake/base/running_mean.h",
                            "runtime/tracer/scene.h", "runtime/include/sunbeam/bsdf.h",
                            "runtime/include/sunbeam/table.h", "runtime/include/sunbeam/table_bsdf.h")
                for file in (*existing, path):
                    (root / file).parent.mkdir(parents=True, exist_ok=True)
                    (root / file).write_text("#pragma once\n#include <vector>\n")
                (root / path).write_text(f"#include <vector>\n{line}\n")
                found, _ = violations(root, [*existing, path])
                self.assertIn((name, path), [(rule, file) for rule, file, _ in found])

    def test_every_step_up(self):
        """Each pair of rooms, one way or both."""
        for floors in map(floors_of_rooms, FLOORS.values()):
            with tempfile.TemporaryDirectory() as folder:
                root = pathlib.Path(folder)
                for room in floors:
                    (root / room).mkdir(parents=True, exist_ok=True)
                    (root / room / "a.h").write_text("#pragma once\n#include <vector>\n")
                    (root / room / "b.cpp").write_text("".join(f'#include "{other}/a.h"\n' for other in floors))
                paths = [f"{room}/b.cpp" for room in floors]
                expected = {(f"{here}/b.cpp", f"{there}/a.h") for here in floors for there in floors
                            if there != here and floors[there] >= floors[here]}
                self.assertGreater(len(expected), 0)
                self.assertEqual(set(steps_up(root, paths)), expected)

    def test_a_crowded_room(self):
        rooms = rooms_with_sources([f"bake/dense/{k}.h" for k in range(17)] + [f"bake/cli/{k}.h" for k in range(17)] +
                                   [f"bake/base/{k}.h" for k in range(16)] + [f"runtime/tracer/{k}.h" for k in range(17)])
        self.assertEqual(too_large(rooms), ["bake/dense"])

    def test_embree_calls(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            (root / "path.cpp").write_text("// rtcComment\nvoid f() { rtcIntersect1(); }\n")
            self.assertEqual(embree_calls(root, ["path.cpp"]), [("path.cpp", "rtcIntersect1")])


if __name__ == "__main__":
    unittest.main()
