"""Where outputs go: devices, FIFOs, links, files that are inputs too; and what is left after a kill.

Devices are reached by links in the folder of the test, so that a program that replaces them harms no other.
"""

import ctypes
import os
import shutil
import signal
import stat
import subprocess
import threading
import time
import unittest

import support

SCENE = support.SKY_SPHERE_SCENE.format(name="tiny", spp=2, max_bounces=2, tangent_rotation_deg=0)
MESH_SCENE = SCENE.split("[[object]]")[0] + '[[object]]\ntype = "mesh"\nfile = "ball.ply"\nmaterial = "skin"\n'
TEMPORARY = ".sunbeam-tmp"


def without_override():
    """For a process to call before it starts: root, too, may then only do what the modes of files allow."""
    if os.geteuid() == 0:
        PR_CAPBSET_DROP, CAP_DAC_OVERRIDE = 24, 1
        if ctypes.CDLL(None, use_errno=True).prctl(PR_CAPBSET_DROP, CAP_DAC_OVERRIDE, 0, 0, 0) != 0:
            raise OSError(ctypes.get_errno(), "prctl")


class OutputsTest(support.CliTest):
    @classmethod
    def prepare(cls):
        support.succeed_in(cls.folder, "bake", "tiny.toml", "-o", "tiny.exr", "--preview")
        cls.write("scene.toml", SCENE)

    def read(self, name):
        return (self.folder / name).read_bytes()

    def link(self, name, target):
        (self.folder / name).unlink(missing_ok=True)
        (self.folder / name).symlink_to(target)
        return name

    def no_leftovers(self):
        self.assertEqual([n for n in self.names() if n.endswith((TEMPORARY, ".work")) or ".tmp" in n], [])


# What writes FILE, by its ending.
WRITERS = {
    ".exr": ("bake", "tiny.toml", "--preview", "-o"),
    ".part": ("bake", "tiny.toml", "--shard", "1/1", "-o"),
    ".vdb": ("bake", "tiny.toml", "--preview", "-o"),
    ".svg": ("plot", "tiny.exr", "--what", "reflectance", "-o"),
    ".png": ("texture", "--columns", "1", "--rows", "2", "--pixels-per-scale", "4", "-o"),
    ".ply": ("mesh", "sphere", "--resolution", "16", "-o"),
    ".json": ("verify", "tiny.exr", "--points", "2", "--json"),
}


class Devices(OutputsTest):
    def test_every_kind_of_output(self):
        """A device and a FIFO are written to and stay; so does a link. A file that is replaced keeps its mode."""
        for number, (ending, command) in enumerate(WRITERS.items()):
            with self.subTest(ending=ending):
                self.link(f"null{ending}", "/dev/null")
                if ending in (".exr", ".part", ".png"):
                    self.succeed(*command, f"null{ending}")
                self.link(f"full{ending}", "/dev/full")
                result = self.sunbeam(*command, f"full{ending}")
                self.assertEqual(result.code, 2, result)
                self.assertEqual(result.err.splitlines()[-1],
                                 f"sunbeam: error: full{ending}: cannot write: No space left on device")
                shutil.rmtree(self.folder / f"full{ending}.work", ignore_errors=True)  # which --resume would go on from
                self.assertEqual([os.readlink(self.folder / f"{n}{ending}") for n in ("null", "full")],
                                 ["/dev/null", "/dev/full"])
                written = self.replaced_behind_a_link(ending, command, (0o600, 0o640, 0o755)[number % 3])
                received = self.sent_to_a_fifo(ending, command)
                if ending == ".vdb":  # which has a new UUID each time
                    self.assertEqual(len(received), len(written))
                else:
                    self.assertEqual(received, written)
        for device in ("/dev/null", "/dev/full"):
            self.assertTrue(stat.S_ISCHR(os.stat(device).st_mode), device)
        self.no_leftovers()

    def replaced_behind_a_link(self, ending, command, mode):
        end = self.folder / f"end{ending}"
        end.write_bytes(b"old")
        end.chmod(mode)
        self.link(f"link{ending}", end.name)
        self.succeed(*command, f"link{ending}")
        self.assertTrue((self.folder / f"link{ending}").is_symlink())
        self.assertEqual(stat.S_IMODE(end.stat().st_mode), mode)
        return end.read_bytes()

    def sent_to_a_fifo(self, ending, command):
        received = []
        fifo = self.folder / f"fifo{ending}"
        os.mkfifo(fifo)
        reader = threading.Thread(target=lambda: received.append(fifo.read_bytes()), daemon=True)
        reader.start()
        self.succeed(*command, fifo.name)
        reader.join(timeout=support.TIME_LIMIT_S)
        self.assertTrue(stat.S_ISFIFO(fifo.lstat().st_mode))
        return received[0]

    def test_figures_on_standard_output(self):
        self.link("out.json", "/dev/stdout")
        command = ("verify", "tiny.exr", "--points", "2", "--json", "out.json")
        out = self.succeed(*command).out
        self.assertIn('"error_median"', out)
        self.assertIn("PASS", out)
        with open(self.folder / "log", "wb") as log:  # a file behind it is not replaced either
            log.write(b"before\n")
            log.flush()
            subprocess.run([support.BINARY, *command], cwd=self.folder, stdout=log, stderr=subprocess.DEVNULL, check=True)
        text = self.read("log").decode()
        self.assertTrue(text.startswith("before\n"))
        self.assertIn('"error_median"', text)
        self.assertIn("PASS", text)

    def test_fifos_as_inputs(self):
        for name, content, command in (
                ("r.toml", self.read("tiny.toml"), ("info", "r.toml")),
                ("t.exr", self.read("tiny.exr"), ("info", "t.exr")),
                ("s.toml", SCENE.encode(), ("render", "s.toml", "-o", "s.exr", "--material", "diffuse")),
                ("p.csv", b"theta_i_deg,theta_o_deg,phi_deg\n1,2,3\n", ("eval", "tiny.exr", "--points", "p.csv"))):
            with self.subTest(name=name):
                os.mkfifo(self.folder / name)
                writer = threading.Thread(target=(self.folder / name).write_bytes, args=(content,), daemon=True)
                writer.start()
                self.succeed(*command)
                writer.join(timeout=support.TIME_LIMIT_S)

    def test_endless_and_missing_inputs(self):
        self.link("zero.exr", "/dev/zero")
        self.link("nowhere.exr", "nothing")
        (self.folder / "folder.exr").mkdir()
        for name, reason in (("zero.exr", "cannot read: no end after 1100 MB"),
                             ("nowhere.exr", "cannot read: No such file"),
                             ("folder.exr", "cannot read: it is a folder"), ("", "found ''; allowed: a path")):
            with self.subTest(name=name):
                self.check_refusal(self.sunbeam("info", name, "--max-memory", "1.1"), f"{name}: {reason}")


class Links(OutputsTest):
    @classmethod
    def prepare(cls):
        super().prepare()
        for name in ("disk", "disk/deep"):
            (cls.folder / name).mkdir()

    def test_a_link_that_leads_nowhere_yet_makes_the_file(self):
        for ending in (".exr", ".part", ".png"):
            with self.subTest(ending=ending):
                self.link(f"link{ending}", f"disk/deep/../real{ending}")
                self.succeed(*WRITERS[ending], f"link{ending}")
                self.assertTrue((self.folder / f"link{ending}").is_symlink())
                self.assertGreater((self.folder / f"disk/real{ending}").stat().st_size, 100)
        self.no_leftovers()
        self.assertEqual(sorted(os.listdir(self.folder / "disk")), ["deep", "real.exr", "real.part", "real.png"])

    def test_work_is_beside_the_end_of_a_link(self):
        """A bake that was stopped under one name goes on under the other."""
        self.link("link.exr", "disk/work.exr")
        options = ("bake", "tiny.toml", "--preview", *support.BAKE_JOBS["dense"])
        stopped = self.sunbeam(*options, "-o", "link.exr", preexec_fn=support.limit_file_size(4000))
        self.assertEqual(stopped.code, 2, stopped)
        self.assertTrue((self.folder / "disk/work.exr.work").is_dir(), stopped)
        result = self.succeed(*options, "-o", "disk/work.exr", "--resume")
        self.assertIn("resumed with", result.err)
        self.assertFalse((self.folder / "disk/work.exr.work").exists())

    def test_two_dots_behind_a_link_lead_above_its_end(self):
        """As the system reads it, and not as text."""
        self.succeed("mesh", "sphere", "-o", "disk/ball.ply", "--resolution", "16")
        self.link("short", "disk/deep")
        self.write("dots.toml", MESH_SCENE.replace("ball.ply", "short/../ball.ply"))
        self.succeed("render", "dots.toml", "-o", "dots.exr", "--material", "diffuse")
        self.write("disk/table.toml", SCENE.replace("tiny.exr", "../short/../../tiny.exr"))
        self.succeed("render", "disk/table.toml", "-o", "dots.exr")
        self.succeed("texture", "-o", "short/../map.png", "--columns", "1", "--rows", "2", "--pixels-per-scale", "4")
        self.assertTrue((self.folder / "disk/map.png").is_file())


class Names(OutputsTest):
    def test_what_may_not_be_written_is_not_replaced(self):
        folder = self.folder / "closed"
        folder.mkdir()
        (folder / "old.png").write_bytes(b"old")
        folder.chmod(0o555)
        self.addCleanup(folder.chmod, 0o755)
        self.write("fixed.png", "old")
        (self.folder / "fixed.png").chmod(0o444)
        for name in ("fixed.png", "closed/old.png", "closed/new.png"):
            with self.subTest(name=name):
                self.refuse(*WRITERS[".png"], name, naming=[f"{name}: cannot write: Permission denied"],
                            preexec_fn=without_override)
        self.assertEqual((self.read("fixed.png"), self.read("closed/old.png")), (b"old", b"old"))

    def test_names_of_255_bytes(self):
        for ending in (".exr", ".part", ".png"):
            with self.subTest(ending=ending):
                name = "x" * (255 - len(ending)) + ending
                self.succeed(*WRITERS[ending], name)
                self.assertGreater((self.folder / name).stat().st_size, 100)
        self.no_leftovers()


class SameFile(OutputsTest):
    """An output that is an input too, or another output, is refused before any work and stays as it was."""

    @classmethod
    def prepare(cls):
        super().prepare()
        (cls.folder / "sub").mkdir()
        cls.write("points.csv", "theta_i_deg,theta_o_deg,phi_deg\n1,2,3\n")
        cls.write("mesh.toml", MESH_SCENE)
        cls.write("relief.toml", SCENE.replace(
            'type = "skin"\n', 'type = "skin"\nbump = {file = "heights.exr", tiles = [4, 4], height = 0.1}\n'))
        support.succeed_in(cls.folder, "mesh", "sphere", "-o", "ball.ply", "--resolution", "16")
        support.succeed_in(cls.folder, *WRITERS[".png"], "heights.exr")
        support.succeed_in(cls.folder, *WRITERS[".part"], "part.exr")
        support.succeed_in(cls.folder, "render", "scene.toml", "-o", "a.exr", "--material", "diffuse")
        for name, target in (("link.json", "tiny.exr"), ("p.svg", "sub/../tiny.exr"), ("a_link.png", "a.exr"),
                             ("table.exr", "tiny.exr"), ("scene.png", "scene.toml")):
            (cls.folder / name).symlink_to(target)
        os.link(cls.folder / "tiny.exr", cls.folder / "hard.json")

    def test_every_command(self):
        render = ("render", "scene.toml", "--material", "diffuse", "-o")
        verify = ("verify", "tiny.exr", "--points", "2")
        cases = [
            (("bake", "tiny.toml", "--shard", "1/2", "-o", "tiny.toml"), "tiny.toml", "tiny.toml"),
            (("bake", "tiny.toml", "--shard", "1/2", "-o", "sub/../tiny.toml"), "sub/../tiny.toml", "tiny.toml"),
            (("merge", "part.exr", "-o", "part.exr"), "part.exr", "part.exr"),
            (("plot", "tiny.exr", "--what", "polar", "-o", "p.svg"), "p.svg", "tiny.exr"),
            ((*verify, "--json", "tiny.exr"), "tiny.exr", "tiny.exr"),
            ((*verify, "--json", "./tiny.exr"), "./tiny.exr", "tiny.exr"),
            ((*verify, "--json", "link.json"), "link.json", "tiny.exr"),
            ((*verify, "--json", "hard.json"), "hard.json", "tiny.exr"),
            ((*verify, "--json", "new.html", "--html", "sub/../new.html"), "sub/../new.html", "new.html"),
            (("compare", "a.exr", "a.exr", "--png", "a_link.png"), "a_link.png", "a.exr"),
            ((*render, "table.exr"), "table.exr", "tiny.exr"),
            ((*render, "scene.exr"), "scene.png", "scene.toml"),
            ((*render, "new.exr", "--stats", "scene.toml"), "scene.toml", "scene.toml"),
            ((*render, "new.exr", "--stats", "tiny.toml"), "tiny.toml", "tiny.toml"),
            ((*render, "new.exr", "--stats", "new.exr"), "new.exr", "new.exr"),
            ((*render, "new.exr", "--stats", "new.png"), "new.png", "new.png"),
            ((*render, "new.exr", "--table", "part.exr", "--stats", "part.exr"), "part.exr", "part.exr"),
            ((*render, "new.exr", "--resume", "a.exr", "--stats", "a.exr"), "a.exr", "a.exr"),
            (("render", "mesh.toml", "--material", "diffuse", "-o", "new.exr", "--stats", "ball.ply"), "ball.ply", "ball.ply"),
            (("render", "relief.toml", "--material", "diffuse", "-o", "heights.exr"), "heights.exr", "heights.exr"),
        ]
        inputs = ("tiny.toml", "tiny.exr", "scene.toml", "a.exr", "part.exr", "ball.ply", "heights.exr")
        before = [self.read(name) for name in inputs]
        for arguments, output, other in cases:
            with self.subTest(arguments=arguments):
                result = self.refuse(*arguments, naming=[f"error: {output}: ", other])
                self.assertRegex(result.err, "is an input of this command|is the same file as another output")
        self.assertEqual([self.read(name) for name in inputs], before)

    def test_standard_output_behind_an_input(self):
        for arguments, name in ((("eval", "tiny.exr", "--points", "points.csv"), "points.csv"),
                                (("info", "tiny.toml"), "tiny.toml")):
            with self.subTest(name=name), open(self.folder / name, "ab") as file:
                before = self.read(name)
                process = subprocess.run([support.BINARY, *arguments], cwd=self.folder, stdout=file, stderr=subprocess.PIPE,
                                         timeout=support.TIME_LIMIT_S)
                self.assertEqual((process.returncode, process.stderr.decode()), (
                    2, f"sunbeam: error: standard output: cannot write: it is an input of this command, {name}\n"))
                self.assertEqual(self.read(name), before)

    def test_a_picture_goes_on_in_its_place(self):
        self.succeed("render", "scene.toml", "-o", "b.exr", "--material", "diffuse")
        self.succeed("render", "scene.toml", "-o", "b.exr", "--material", "diffuse", "--resume", "b.exr", "--spp", "4")

    def test_one_device_for_everything(self):
        for name in ("null.exr", "null.png", "null.json"):
            self.link(name, "/dev/null")
        self.succeed("render", "scene.toml", "-o", "null.exr", "--material", "diffuse", "--stats", "null.json")


class Killed(OutputsTest):
    """In the middle of a mesh of 30 MB."""

    COMMAND = ("mesh", "sphere", "-o", "big.ply", "--resolution", "1024")

    def temporaries(self):
        return [n for n in self.names() if n.startswith(".big.ply.") and n.endswith(TEMPORARY)]

    def size_of(self, name):
        """0 if it went in the meantime, as the probe before the work does."""
        try:
            return (self.folder / name).stat().st_size
        except FileNotFoundError:
            return 0

    def end_while_writing(self, number):
        process = subprocess.Popen([support.BINARY, *self.COMMAND], cwd=self.folder, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + support.TIME_LIMIT_S
        while not any(self.size_of(name) > 0 for name in self.temporaries()):
            self.assertTrue(process.poll() is None and time.monotonic() < deadline, "no temporary was seen")
        process.send_signal(number)
        self.assertEqual(process.wait(timeout=support.TIME_LIMIT_S), -number)

    def test_the_next_run_clears_up(self):
        self.write("big.ply", "old")
        self.end_while_writing(signal.SIGKILL)
        self.assertEqual(len(self.temporaries()), 1)
        self.assertEqual(self.read("big.ply"), b"old")
        self.succeed(*WRITERS[".png"], "other.png")
        self.assertEqual(len(self.temporaries()), 1)
        self.succeed(*WRITERS[".ply"], "big.ply")
        self.no_leftovers()

    def test_signals_that_end_it_leave_nothing(self):
        self.write("big.ply", "old")
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            with self.subTest(signal=number):
                self.end_while_writing(number)
                self.no_leftovers()
                self.assertEqual(self.read("big.ply"), b"old")


if __name__ == "__main__":
    unittest.main()
