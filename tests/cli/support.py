"""What the command-line tests share: running `sunbeam`, a recipe that bakes in about a second, and checks of
the contract for bad input.

The environment names the program (SUNBEAM_BINARY) and the sources (SUNBEAM_SOURCE_DIR).
"""

import csv
import io
import os
import pathlib
import resource
import shutil
import signal
import struct
import subprocess
import tempfile
import unittest
import zlib

BINARY = os.environ["SUNBEAM_BINARY"]
SOURCE_DIR = pathlib.Path(os.environ["SUNBEAM_SOURCE_DIR"])
TIME_LIMIT_S = 500  # of a command, for machines that are busy; none takes a tenth of it on an idle core

# A film that light passes straight and a dark base: the cheapest table with two swept parameters.
TINY_RECIPE = """\
[material]
transmission = "straight"
absorption_path = "product"
roughness = 0.0
albedo = 0.1
film_thickness_nm = 300.0
base_ior = 1.5
absorption_per_nm = 0.1

[grid]
film_thickness_nm = [200.0, 400.0]
absorption_per_nm = [0.0, 0.2]

[table]
angles = 3

[accuracy]
noise = 0.05
tolerance_median = 0.3
tolerance_p99 = 1.0
"""

# A sphere of skin under a constant sky, a few pixels: {name}.toml and its table {name}.exr.
SKY_SPHERE_SCENE = """\
recipe = "{name}.toml"
table = "{name}.exr"

[camera]
position = [0.0, -4.0, 0.0]
look_at = [0.0, 0.0, 0.0]

[render]
width = 8
height = 8
spp = {spp}
max_bounces = {max_bounces}

[environment]
color = 1.0

[[material]]
name = "skin"
type = "skin"
tangent_rotation_deg = {tangent_rotation_deg}

[[object]]
type = "sphere"
center = [0.0, 0.0, 0.0]
radius = 3.0
material = "skin"
"""

# Overrides of tiny.toml for every kind of bake job, with blocks by the dozen.
BAKE_JOBS = {
    "dense": ("--set", "table.encoding=dense", "--set", "table.angles=6",
              "--set", "grid.film_thickness_nm={from=200, to=400, count=9}"),
    "factored": ("--set", "table.encoding=factored", "--set", "material.roughness=0.2", "--set", "table.angles=10",
                 "--set", "grid.base_ior={from=1.2, to=1.6, count=8}"),
    "slab": ("--set", "material.scattering_per_nm=0.1", "--set", "material.absorption_path=sum", "--set",
             "material.transmission=refract", "--set", "grid.base_ior={from=1.2, to=1.6, count=4}", "--set",
             "grid.film_thickness_nm={from=200, to=400, count=9}", "--set", "table.azimuths=3"),
}

# Work and parts begin with their kind, and size and hash of the text that says what is baked.
HEADER_START = 8 + 8 + 32

# With a black base nothing but the film remains: no walks to speak of.
BLACK_BASE = ("--set", "material.albedo=0")


class Result:
    def __init__(self, command, process):
        self.command = " ".join(str(part) for part in command)
        self.code = process.returncode
        self.out = process.stdout.decode("utf-8", "replace")
        self.err = process.stderr.decode("utf-8", "replace")

    def __str__(self):
        return f"\n$ {self.command}\nexit code {self.code}\nstdout: {self.out[-2000:]}\nstderr: {self.err[-2000:]}"


def run_command(command, cwd, stdin="", env=None, timeout=TIME_LIMIT_S, **options):
    process = subprocess.run(
        [str(part) for part in command], cwd=cwd, input=stdin.encode(), capture_output=True,
        timeout=timeout, env=dict(os.environ, LC_ALL="C", **(env or {})), **options)
    return Result(command, process)


def limit_file_size(size):
    """A function for a process to call before it starts: files end at `size` bytes, as if the disk were full."""
    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    return limit


def limit_cpu_seconds(seconds):
    """The same for the CPU time that it may spend, which other processes do not lengthen."""
    return lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))


def make_folder(owner):
    """A temporary folder that goes when the test case or class `owner` is done."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="sunbeam-test-"))
    clean_up = owner.addClassCleanup if isinstance(owner, type) else owner.addCleanup
    clean_up(shutil.rmtree, folder)
    return folder


def sunbeam_in(folder, *arguments, **options):
    return run_command([BINARY, *arguments], folder, **options)


def succeed_in(folder, *arguments, **options):
    """Runs and expects exit code 0; for set-up code outside a test case."""
    result = sunbeam_in(folder, *arguments, **options)
    if result.code != 0:
        raise AssertionError(f"expected success: {result}")
    return result


def rows_of(text):
    return list(csv.DictReader(io.StringIO(text)))


def png_rows(content):
    """Bytes of the rows of an 8-bit RGB PNG without interlacing (PNG specification, section 9)."""
    width, height = struct.unpack(">II", content[16:24])
    data, at = b"", 8
    while at < len(content):
        size, kind = struct.unpack(">I4s", content[at:at + 8])
        data += content[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        at += 12 + size
    data = zlib.decompress(data)
    stride, above, rows = 3 * width, bytearray(3 * width), []
    for y in range(height):
        kind, line = data[y * (stride + 1)], bytearray(data[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left, up, corner = (line[x - 3], above[x], above[x - 3]) if x >= 3 else (0, above[x], 0)
            paeth = min((left, up, corner), key=lambda v: abs(left + up - corner - v))
            line[x] = (line[x] + (0, left, up, (left + up) // 2, paeth)[kind]) % 256
        rows.append(line)
        above = line
    return rows


def mean_linear(content):
    """Mean linear colour of an sRGB picture."""
    def linear(byte):
        s = byte / 255
        return s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4
    values = [[linear(byte) for row in png_rows(content) for byte in row[c::3]] for c in range(3)]
    return [sum(v) / len(v) for v in values]


class CliTest(unittest.TestCase):
    """One folder per class, `self.folder`, in which the program runs. `prepare` fills it once."""

    longMessage = True

    @classmethod
    def setUpClass(cls):
        cls.folder = make_folder(cls)
        (cls.folder / "tiny.toml").write_text(TINY_RECIPE)
        cls.prepare()

    @classmethod
    def prepare(cls):
        pass

    @classmethod
    def write(cls, name, text):
        path = cls.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return name

    def sunbeam(self, *arguments, **options):
        return sunbeam_in(self.folder, *arguments, **options)

    def succeed(self, *arguments, **options):
        result = self.sunbeam(*arguments, **options)
        self.assertEqual(result.code, 0, result)
        return result

    def miss(self, *arguments, figure, **options):
        """Runs a bake or merge and expects a table that misses the tolerances of its recipe by this figure: exit code 1, and the
        last line says so."""
        result = self.sunbeam(*arguments, **options)
        self.assertEqual(result.code, 1, result)
        self.assertRegex(result.err.splitlines()[-1],
                         rf"^\S+: misses the recipe's tolerances: .*\b{figure} \S+ \(allowed \S+\)", result)
        return result

    def names(self):
        return sorted(entry.name for entry in self.folder.iterdir())

    def check_refusal(self, result, *needles):
        """Exit code 2, nothing on stdout, one line of error that holds every needle."""
        self.assertEqual(result.code, 2, result)
        self.assertEqual(result.out, "", result)
        self.assertEqual(result.err.count("\n"), 1, f"stderr is not one line: {result}")
        self.assertTrue(result.err.startswith("sunbeam: error: "), result)
        self.assertTrue(result.err.endswith("\n"), result)
        for needle in needles:
            self.assertIn(needle, result.err, result)

    def refuse(self, *arguments, naming=(), **options):
        """Runs, expects a refusal that names `naming`, and that no file came, went or changed."""
        before = {entry.name: entry.stat().st_mtime_ns for entry in self.folder.iterdir()}
        result = self.sunbeam(*arguments, **options)
        self.check_refusal(result, *naming)
        after = {entry.name: entry.stat().st_mtime_ns for entry in self.folder.iterdir()}
        self.assertEqual(after, before, f"the refused command changed the folder: {result}")
        return result
