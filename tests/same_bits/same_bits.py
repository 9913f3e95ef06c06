"""Do two sunbeam programs make the same bits? See cmake/same_bits.sh.

Both bake the same tables: of every kind, whole, merged and resumed, as .exr and .vdb. The whole ones are evaluated, and so are
their recipes by every estimator. An outcome is {name: value}: attributes and arrays of a table, columns of `eval`.
"""

import argparse
import concurrent.futures
import csv
import functools
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile

from table_parts import parts_of

HERE = pathlib.Path(__file__).resolve().parent
REFERENCE = HERE.parent / "support/reference"
ROUGHNESSES = "material.roughness=[0.2, 0.5]"
SLAB = ("table.encoding=dense", "table.azimuths=2", "material.scattering_per_nm=0.5", "material.anisotropy=0.5")

# Settings on top of base.toml: a film that refracts, of roughness 0.2, path sum, spectrum rgb3.
RECIPES = {
    "factored smooth": ("table.encoding=factored", "material.roughness=0"),
    "factored smooth product": ("table.encoding=factored", "material.roughness=0", "material.absorption_path=product",
                                "material.transmission=straight", "spectrum.mode=full"),
    "factored rough": ("table.encoding=factored", "spectrum.mode=full", "material.absorption_spectrum=eumelanin"),
    "factored rough product": ("table.encoding=factored", "material.absorption_path=product"),
    "factored anisotropic": ("table.encoding=factored", "table.azimuths=4", ROUGHNESSES, "table.precision=float"),
    "dense walked": ("table.encoding=dense",),
    "dense anisotropic": ("table.encoding=dense", "table.azimuths=4", ROUGHNESSES, "material.absorption_path=product"),
    "dense walked slab": (*SLAB, "table.values=walks", "accuracy.estimator=bidirectional"),
    "dense solved slab": (*SLAB, "spectrum.mode=full"),
    "multiple facets": ("table.encoding=dense", "table.azimuths=4", "material.microfacet=multiple"),
}

# What is baked of each, in this order. Measuring its error is most of the time of each.
TABLES = (("whole", ".exr"), ("whole", ".vdb"), ("merged", ".vdb"), ("resumed", ".exr"))

# Columns of the reference files that hold what `eval` appends.
RESULTS = {"first", "rest", "stderr", "total", "specular", "reflectance", "mean"}


# What differs where two files hold the same attributes and arrays, but not the same bytes.
LAYOUT = "layout of the file"


class Failure(Exception):
    pass


def command_of(binary, *arguments):
    return [str(part) for part in (binary, *arguments)]


def run(command, folder, stdin=""):
    process = subprocess.run(command, cwd=folder, input=stdin, capture_output=True, text=True)
    if process.returncode != 0:
        raise Failure(f"`{' '.join(command)}` exits with {process.returncode}: {process.stderr.strip()[-300:]}")
    return process


class Recipe:
    """One recipe with one of the programs, in a folder of its own."""

    def __init__(self, binary, name, folder):
        self.binary, self.folder = binary, folder
        self.settings = [part for setting in RECIPES.get(name, ()) for part in ("--set", setting)]
        self.source = (HERE / "base.toml", *self.settings)

    def sunbeam(self, *arguments, stdin=""):
        return run(command_of(self.binary, *arguments), self.folder, stdin)

    def bake(self, name, *options):
        return self.sunbeam("bake", *self.source, "-o", name, "--threads", "1", *options)

    # Tables

    def whole(self, form):
        self.bake(f"whole{form}")

    def merged(self, form):
        for k in (1, 2):
            self.bake(f"{k}.part", "--shard", f"{k}/2")
        self.sunbeam("merge", "1.part", "2.part", "-o", f"merged{form}", "--threads", "1")

    def resumed(self, form):
        """The disk is full when half of the blocks are done: a part, one of two, is about as large."""
        name, size = f"resumed{form}", (self.folder / "1.part").stat().st_size
        bake = command_of(self.binary, "bake", *self.source, "-o", name, "--threads", "1")
        limited = ["bash", "-c", f"trap '' XFSZ; exec prlimit --fsize={size} \"$@\"", "bash", *bake]
        stopped = subprocess.run(limited, cwd=self.folder, capture_output=True, text=True)
        if stopped.returncode == 0:
            raise Failure(f"{name} was not stopped by a limit of {size} bytes")
        said = self.bake(name, "--resume").stderr
        done = re.search(r"resumed with ([1-9]\d*) of (\d+) blocks", said)
        if not done or done[1] == done[2]:
            raise Failure(f"{name} was not resumed half way: {done and done[0]}")

    def table(self, how, form):
        getattr(self, how)(form)
        path = self.folder / f"{how}{form}"
        return parts_of(path) | {LAYOUT: bytes_of(path)}

    # Values

    def eval(self, points, quantity, source, *options):
        said = self.sunbeam("eval", *source, "--points", "-", "--quantity", quantity, *options, stdin=points).stdout
        rows = list(csv.DictReader(io.StringIO(said)))
        return {column: [row[column] for row in rows] for column in rows[0]}


def bytes_of(path):
    """Of OpenVDB without the UUID, which may be random."""
    content = path.read_bytes()
    return content[:21] + content[57:] if path.suffix == ".vdb" else content


def points_of(path):
    """The rows of a CSV file without the columns of results."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    columns = [name for name in rows[0] if name not in RESULTS]
    return "\n".join([",".join(columns), *(",".join(row[name] for name in columns) for row in rows)]) + "\n"


def estimators_of(name):
    """Those that `eval` allows for a recipe."""
    exact = not any(word in name for word in ("slab", "facets"))
    return ("auto", "pfmc", "bidirectional", *(["exact"] if exact else []))


def comparisons_of(recipe, name):
    """[(what is compared, a function that makes it)], in the order in which they must be made."""
    found, points = [], points_of(HERE / "points.csv")
    found += [(f"{how} {form}", functools.partial(recipe.table, how, form)) for how, form in TABLES]
    for form in (".exr", ".vdb"):
        found += [(f"eval {quantity} of {form}", functools.partial(recipe.eval, points, quantity, [f"whole{form}"]))
                  for quantity in ("brdf", "albedo", "film")]
    for estimator in estimators_of(name):
        options = ("--estimator", estimator, "--samples", "20", "--seed", "3")
        found += [(f"eval {quantity} by {estimator}",
                   functools.partial(recipe.eval, points, quantity, recipe.source, *options))
                  for quantity in ("brdf", "albedo")]
    return found + [("eval film", functools.partial(recipe.eval, points, "film", recipe.source))]


def reference_comparisons(recipe):
    """The points of the reference files: every key of a plain material varies."""
    found = []
    for file, quantity in (("eval", "brdf"), ("rough_refract", "brdf"), ("albedo", "albedo")):
        points = points_of(REFERENCE / f"{file}.csv")
        for estimator in ("pfmc", "bidirectional", "exact"):
            options = ("--estimator", estimator, "--samples", "20", "--seed", "5")
            found.append((f"eval {file}.csv by {estimator}",
                          functools.partial(recipe.eval, points, quantity, recipe.source, *options)))
    points = points_of(REFERENCE / "film.csv")
    return found + [("eval film.csv", functools.partial(recipe.eval, points, "film", recipe.source))]


def outcomes(binary, name, folder):
    """{what is compared: its outcome, or a Failure} of one program."""
    folder.mkdir(parents=True)
    recipe = Recipe(binary, name, folder)
    comparisons = comparisons_of(recipe, name) if name in RECIPES else reference_comparisons(recipe)
    made = {}
    for what, make in comparisons:
        try:
            made[what] = make()
        except Exception as failure:  # a broken table may break its reader in any way
            made[what] = failure
    return made


def relative_difference(old, new):
    """The largest of two columns, or None where a cell is no number."""
    try:
        pairs = [(float(a), float(b)) for a, b in zip(old, new, strict=True)]
    except ValueError:
        return None
    return max((abs(a - b) / max(abs(a), abs(b)) for a, b in pairs if a != b), default=0.0)


def describe(name, old, new):
    if not (isinstance(old, list) and isinstance(new, list)):
        return name
    difference = relative_difference(old, new)
    return name if difference is None else f"{name} (by {difference:.1e})"


def differences(old, new, excused):
    """(what differs, what differs and is excused) of two outcomes."""
    if isinstance(new, Exception):
        return [f"the new program fails: {new}"], []
    names = [name for name in {**old, **new} if old.get(name) != new.get(name)]
    if len(names) > 1:
        names = [name for name in names if name != LAYOUT]
    allowed = [name for name in names if not name.startswith("array ") and name.startswith(excused)]
    return [describe(name, old.get(name), new.get(name)) for name in names if name not in allowed], allowed


def report(name, what, differing, allowed):
    verdict = "differs: " + ", ".join(differing) if differing else "same"
    if allowed:
        verdict += f" (excused: {', '.join(allowed)})"
    print(f"{name:24} {what:38} {verdict}", flush=True)


def compare(name, old, new, excused):
    """Prints every comparison of one recipe. Returns how many there are and how many differ."""
    differ = 0
    for what, value in old.items():
        if isinstance(value, Exception):
            raise Failure(f"{name}, {what}: the old program fails: {value}")
        differing, allowed = differences(value, new[what], excused)
        report(name, what, differing, allowed)
        differ += bool(differing)
    return len(old), differ


def compare_all(programs, excused):
    names = [*reversed(RECIPES), "reference points"]  # the slow ones first
    with tempfile.TemporaryDirectory(prefix="same-bits-") as folder, \
            concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        jobs = [[pool.submit(outcomes, program, name, pathlib.Path(folder) / side / name.replace(" ", "_"))
                 for side, program in zip(("old", "new"), programs)] for name in names]
        try:
            counts = [compare(name, old.result(), new.result(), excused) for name, (old, new) in zip(names, jobs)]
        finally:
            pool.shutdown(cancel_futures=True)
    return [sum(column) for column in zip(*counts)]


def program(path):
    found = pathlib.Path(path).resolve()
    if not (found.is_file() and os.access(found, os.X_OK)):
        raise argparse.ArgumentTypeError(f"{path} is no program")
    return found


def main():
    parser = argparse.ArgumentParser(prog="same_bits.sh", description="Checks that two sunbeam programs make the same bits.")
    parser.add_argument("old", type=program)
    parser.add_argument("new", type=program)
    parser.add_argument("--except", dest="excused", action="append", default=[], metavar="NAME",
                        help="attributes of tables whose name begins so may differ, and content_hash with them: error, tool_version")
    options = parser.parse_args()
    excused = (*options.excused, "content_hash") if options.excused else ()
    try:
        count, differ = compare_all((options.old, options.new), excused)
    except Failure as failure:
        print(f"same_bits.sh: error: {failure}", file=sys.stderr)
        return 2
    print(f"{count} comparisons, {differ} differ")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
