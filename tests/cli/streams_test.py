"""Standard streams that are full, closed, or read by nobody."""

import os
import subprocess
import unittest

import support

LOST = "sunbeam: error: standard output: cannot write"

SCENE = support.SKY_SPHERE_SCENE.format(name="tiny", spp=2, max_bounces=2, tangent_rotation_deg=0)

PRINTING = {
    "help": ("--help",),
    "help of a command": ("bake", "--help"),
    "version": ("--version",),
    "info of a recipe": ("info", "tiny.toml"),
    "info of a table": ("info", "tiny.exr", "--json"),
    "eval of a recipe": ("eval", "tiny.toml", "--points", "points.csv", "--samples", "16"),
    "eval of a table": ("eval", "tiny.exr", "--points", "points.csv"),
    "verify": ("verify", "tiny.exr", "--points", "2"),
    "compare": ("compare", "a.exr", "a.exr"),
    "compare --json": ("compare", "a.exr", "a.exr", "--json"),
}
SILENT = {
    "bake": ("bake", "tiny.toml", "-o", "new.exr", "--preview"),
    "part": ("bake", "tiny.toml", "-o", "new.part", "--shard", "1/1"),
    "render": ("render", "scene.toml", "-o", "new.exr", "--material", "diffuse", "--stats", "new.json"),
    "texture": ("texture", "-o", "new.exr", "--columns", "1", "--rows", "2", "--pixels-per-scale", "4"),
}
FAILING = {
    "a bad recipe": ("bake", "tiny.toml", "-o", "new.exr", "--set", "material.albedo=2"),
    "a bad option": ("bake", "--polish"),
    "no file": ("info", "none.exr"),
}


class Streams(support.CliTest):
    @classmethod
    def prepare(cls):
        support.succeed_in(cls.folder, "bake", "tiny.toml", "-o", "tiny.exr", "--preview")
        cls.write("scene.toml", SCENE)
        support.succeed_in(cls.folder, "render", "scene.toml", "-o", "a.exr", "--material", "diffuse")
        cls.write("points.csv", "theta_i_deg,theta_o_deg,phi_deg\n10,20,30\n")

    def run_with(self, arguments, closed=(), **streams):
        """Exit code, stdout and stderr of a run. `streams` may name a file for stdout or stderr; `closed` has the numbers of
        descriptors that the program starts without."""
        opened = {name: open(path, "wb") for name, path in streams.items() if isinstance(path, str)}
        pipes = {name: subprocess.PIPE for name in ("stdout", "stderr")}
        try:
            process = subprocess.run(
                [support.BINARY, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL, timeout=support.TIME_LIMIT_S,
                preexec_fn=lambda: [os.close(descriptor) for descriptor in closed], **{**pipes, **streams, **opened})
        finally:
            for file in opened.values():
                file.close()
        return process.returncode, process.stdout or b"", (process.stderr or b"").decode()

    def run_without_reader(self, arguments, name):
        reading, writing = os.pipe()
        os.close(reading)
        try:
            return self.run_with(arguments, **{name: writing})
        finally:
            os.close(writing)

    def take_new_files(self):
        """Names and contents of what a command made."""
        made = {}
        for path in sorted(self.folder.glob("new.*")):
            made[path.name] = path.read_bytes()
            path.unlink()
        return made

    def test_what_could_not_be_printed_is_an_error(self):
        cases = [(name, "full", self.run_with(arguments, stdout="/dev/full")) for name, arguments in PRINTING.items()]
        for name in ("help", "eval of a table", "info of a recipe"):
            cases.append((name, "closed", self.run_with(PRINTING[name], closed=(1,))))
            cases.append((name, "no reader", self.run_without_reader(PRINTING[name], "stdout")))
        for name, how, (code, _, err) in cases:
            with self.subTest(command=name, how=how):
                self.assertEqual(code, 2, err)
                self.assertEqual(err.splitlines()[-1], LOST)

    def test_files_are_the_same_without_any_stream(self):
        """None is opened in the place of one. What prints nothing needs no output."""
        for name, arguments in SILENT.items():
            with self.subTest(command=name):
                code, _, err = self.run_with(arguments, stdout="/dev/full")
                self.assertEqual(code, 0, err)
                made = self.take_new_files()
                self.assertEqual(self.run_with(arguments, closed=(0, 1, 2))[0], 0)
                again = self.take_new_files()
                self.assertEqual(made.keys(), again.keys())
                if name != "render":  # it tells its time
                    self.assertEqual(made, again)

    def test_messages_that_could_not_be_printed_are_lost_and_nothing_else(self):
        for name, arguments in {
                **FAILING, "eval": PRINTING["eval of a recipe"], "compare": PRINTING["compare"], "bake": SILENT["bake"],
                "render": SILENT["render"]}.items():
            expected = self.run_with(arguments)[:2], self.take_new_files().keys()
            ways = {"closed": lambda a: self.run_with(a, closed=(2,)),
                    "no reader": lambda a: self.run_without_reader(a, "stderr")}
            if name in ("bake", "a bad recipe"):
                ways["full"] = lambda a: self.run_with(a, stderr="/dev/full")
            for how, run in ways.items():
                with self.subTest(command=name, how=how):
                    self.assertEqual((run(arguments)[:2], self.take_new_files().keys()), expected)

    def test_a_failed_check_that_cannot_be_printed_is_bad(self):
        self.succeed("render", "scene.toml", "-o", "b.exr", "--material", "diffuse", "--set", "object[0].radius=1")
        arguments = ("compare", "a.exr", "b.exr", "--max-rmse", "0")
        self.assertEqual(self.run_with(arguments)[0], 1)
        self.assertEqual(self.run_with(arguments, stdout="/dev/full")[0], 2)

    def test_eval_ends_when_nobody_reads(self):
        rows = "".join(f"{k % 89},20,30\n" for k in range(20000))
        self.write("many.csv", "theta_i_deg,theta_o_deg,phi_deg\n" + rows)
        code, _, err = self.run_without_reader(("eval", "tiny.exr", "--points", "many.csv"), "stdout")
        self.assertEqual((code, err), (2, f"{LOST}\n"))

    def test_closed_standard_input(self):
        arguments = ("eval", "tiny.exr", "--points", "-")
        code, _, err = self.run_with(arguments, closed=(0,))
        self.assertEqual((code, err), (2, "sunbeam: error: standard input: cannot read: Bad file descriptor\n"))


if __name__ == "__main__":
    unittest.main()
