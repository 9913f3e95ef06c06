"""`sunbeam bake` ended before its time, and continued: the table has the bits of a bake in one go."""

import functools
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import time
import unittest

import support

PREVIEW = ("--preview",)  # of 16 points its error, which would be most of the time
JOURNALS = {"dense": "dense.blocks", "factored": "factored.blocks", "slab": "dense.blocks"}


class RestartTest(support.CliTest):
    @classmethod
    def bake(cls, kind, name, *options, **process):
        preview = () if "--shard" in options else PREVIEW
        return support.sunbeam_in(cls.folder, "bake", "tiny.toml", *support.BAKE_JOBS[kind], "-o", name, *preview,
                                  *options, **process)

    @classmethod
    def must_bake(cls, kind, name, *options):
        result = cls.bake(kind, name, *options)
        assert result.code == 0, result
        return result

    def work(self, name):
        return self.folder / f"{name}.work"

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def check_finished(self, kind, name, *options):
        """--resume gives the table of a bake in one go and takes the work away."""
        result = self.must_bake(kind, name, "--resume", *options)
        self.assertEqual(self.bytes_of(name), self.bytes_of(f"{kind}.exr"), result)
        self.assertFalse(self.work(name).exists())
        return result


class Killed(RestartTest):
    """Ten times at random moments of its CPU time, by a signal that nothing catches."""

    KILLS = 10
    # Heavier, so that a kill does not come before the first block.
    MORE = {
        "dense": ("--set", "material.roughness=0.2", "--set", "table.angles=10",
                  "--set", "grid.base_ior={from=1.2, to=1.6, count=7}"),
        "factored": ("--set", "spectrum.mode=full", "--set", "grid.film_thickness_nm=[0, 1500]"),
        "slab": ("--set", "spectrum.mode=full", "--set", "table.angles=10", "--set", "table.azimuths=7"),
    }

    @classmethod
    def cpu_seconds(cls, run):
        def spent():
            usage = resource.getrusage(resource.RUSAGE_CHILDREN)
            return usage.ru_utime + usage.ru_stime
        before = spent()
        run()
        return spent() - before

    def test_table_is_that_of_an_uninterrupted_bake(self):
        for kind, more in self.MORE.items():
            with self.subTest(kind=kind):
                start = min(self.cpu_seconds(lambda: self.bake(kind, f"start_{k}.exr", *more, preexec_fn=support.limit_file_size(2000)))
                            for k in range(3))
                whole = self.cpu_seconds(lambda: self.must_bake(kind, f"{kind}.exr", "--threads", "1", *more)) - start
                draw, name = random.Random(kind), f"killed_{kind}.exr"
                parts = [draw.uniform(0.2, 1) for _ in range(self.KILLS)]
                for k, part in enumerate(parts):
                    moment = start + 0.4 * whole * part / sum(parts)
                    killed = self.bake(kind, name, "--resume", "--threads", 1 + k % 2, *more,
                                       preexec_fn=lambda: signal.setitimer(signal.ITIMER_PROF, moment))
                    self.assertEqual(killed.code, -signal.SIGPROF, killed)
                    self.assertFalse((self.folder / name).exists())
                result = self.check_finished(kind, name, *more)
                self.assertRegex(result.err, r"resumed with [1-9]\d* of \d+ blocks")


class Interrupted(RestartTest):
    """By Ctrl-C or a scheduler, in a bake of a few seconds."""

    BLOCKS, NOISE, JOURNAL_WITH_BLOCKS = 180, 0.0002, 20000
    BAKE = ("bake", "tiny.toml", *support.BAKE_JOBS["dense"], "--set", "table.angles=10", "--set",
            f"accuracy.noise={NOISE}", "--threads", "1", "--progress", "json")

    @classmethod
    def prepare(cls):
        cls.whole = support.succeed_in(cls.folder, *cls.BAKE, "-o", "whole.exr")

    def start(self, name):
        """Returns once there are blocks."""
        process = subprocess.Popen([support.BINARY, *self.BAKE, "-o", name], cwd=self.folder, stderr=subprocess.PIPE)
        journal = self.work(name) / "dense.blocks"
        while process.poll() is None and not (journal.exists() and journal.stat().st_size > self.JOURNAL_WITH_BLOCKS):
            time.sleep(0.001)
        return process

    def interrupt(self, stop):
        """A bake of table.exr. Returns how many blocks it says to have left."""
        self.write("table.exr", "an older table")
        process = self.start("table.exr")
        process.send_signal(stop)
        said = process.communicate(timeout=support.TIME_LIMIT_S)[1].decode()
        self.assertEqual(process.returncode, 130, said)
        last = said.splitlines()[-1]
        expected = rf"interrupted: ([1-9]\d*) of {self.BLOCKS} blocks are in table.exr.work; continue with --resume"
        self.assertRegex(last, expected)
        self.assertEqual(self.bytes_of("table.exr"), b"an older table")
        self.assertEqual(self.names(), ["table.exr", "table.exr.work", "tiny.toml", "whole.exr"])
        return int(re.match(expected, last).group(1))

    def test_control_c(self):
        blocks = self.interrupt(signal.SIGINT)
        result = self.succeed(*self.BAKE, "-o", "table.exr", "--resume")
        self.assertIn(f"resumed with {blocks} of {self.BLOCKS} blocks", result.err)
        self.assertEqual(self.bytes_of("table.exr"), self.bytes_of("whole.exr"))
        self.check_progress(result.err, resumed=blocks / self.BLOCKS)

    def test_terminated(self):
        self.interrupt(signal.SIGTERM)
        shutil.rmtree(self.work("table.exr"))

    def test_progress_as_json(self):
        self.check_progress(self.whole.err, resumed=0)

    def check_progress(self, said, resumed):
        """A line a second of each phase, and one at its end."""
        lines = [json.loads(line) for line in said.splitlines() if line.startswith("{")]
        bake = [line for line in lines if line["phase"] == "bake"]
        self.assertGreaterEqual(len(bake), 1, said)  # the last; more if it takes longer than a second
        self.assertEqual([line["phase"] for line in lines[len(bake):]], ["verify"] * (len(lines) - len(bake)))
        for phase, unit, total in ((bake, "blocks", self.BLOCKS), (lines[len(bake):], "points", 250)):
            fractions = [line["fraction"] for line in phase]
            self.assertEqual(fractions, sorted(fractions))
            self.assertEqual((fractions[-1], phase[-1]["done"], phase[-1]["seconds_left"]), (1, total, 0))
            for line in phase:
                self.assertEqual((line["unit"], line["total"]), (unit, total))
                self.assertAlmostEqual(line["fraction"], line["done"] / total, delta=1e-3)
                self.assertGreater(line["per_second"], 0)
        # Time since the start / fraction baked since then = time left / fraction left; lines come after 1 s.
        first = bake[0]
        self.assertGreaterEqual(first["seconds_left"] + 0.05, (1 - first["fraction"]) / (first["fraction"] - resumed))
        worst = [line["worst_error"] for line in bake]
        self.assertEqual(worst, sorted(worst))
        self.assertTrue(0 < worst[-1] <= self.NOISE, worst)

    def test_two_bakes_of_one_table(self):
        first = self.start("two.exr")
        try:
            first.send_signal(signal.SIGSTOP)
            for options, reason in (((), "--resume"), (("--resume",), "another bake is writing it")):
                second = self.sunbeam(*self.BAKE, "-o", "two.exr", *options)
                self.assertEqual(second.code, 2, second)
                self.assertIn(reason, second.err)
            self.assertIsNone(first.poll(), "the first bake ended too early")
        finally:
            first.kill()
            first.communicate()
        self.assertFalse((self.folder / "two.exr").exists())
        shutil.rmtree(self.work("two.exr"))


class Unfinished(RestartTest):
    """What may become of the work of a bake that was stopped."""

    @classmethod
    def prepare(cls):
        for kind in support.BAKE_JOBS:
            cls.must_bake(kind, f"{kind}.exr")
            cls.stop(kind, f"stopped_{kind}.exr")

    @classmethod
    def stop(cls, kind, name, size=9000, **options):
        result = cls.bake(kind, name, preexec_fn=support.limit_file_size(size), **options)
        assert result.code == 2 and (cls.folder / f"{name}.work").exists(), result
        return result

    def take(self, kind, name):
        """The work of a stopped bake of `name`."""
        shutil.rmtree(self.work(name), ignore_errors=True)
        shutil.copytree(self.work(f"stopped_{kind}.exr"), self.work(name))
        return self.work(name) / JOURNALS[kind]

    def refuse_work(self, kind, name, *options, naming):
        journal = self.take(kind, name)
        before = journal.read_bytes()
        result = self.bake(kind, name, *options)
        self.assertEqual((result.code, result.out), (2, ""), result)
        errors = [line for line in result.err.splitlines() if line.startswith("sunbeam: error: ")]
        self.assertEqual(len(errors), 1, result)
        for needle in naming:
            self.assertIn(needle, errors[0], result)
        self.assertEqual(journal.read_bytes(), before)
        self.assertFalse((self.folder / name).exists())

    def test_it_is_not_baked_over(self):
        self.refuse_work("dense", "a.exr", naming=["a.exr.work", "--resume", "delete"])

    def test_it_is_continued_by_the_same_bake_alone(self):
        for options, reason in (
                (("--set", "material.albedo=0.2"), "recipe"),
                (("--seed", "2"), "seed")):
            with self.subTest(options=options):
                self.refuse_work("dense", "b.exr", "--resume", *options, naming=["b.exr.work/dense.blocks", reason])

    def test_it_is_continued_as_the_same_shard_alone(self):
        result = self.bake("dense", "d.part", "--shard", "1/2", preexec_fn=support.limit_file_size(5000))
        self.assertEqual(result.code, 2, result)
        shutil.copytree(self.work("d.part"), self.work("d.exr"))
        whole = self.sunbeam("bake", "tiny.toml", *support.BAKE_JOBS["dense"], "-o", "d.exr", "--resume")
        self.assertEqual(whole.code, 2, whole)
        self.assertIn("shard 1/2; asked for 1/1", whole.err)
        for other, found in (("2/2", "1/2; asked for 2/2"), ("1/3", "1/2; asked for 1/3")):
            result = self.bake("dense", "d.part", "--resume", "--shard", other)
            self.assertEqual(result.code, 2, result)
            self.assertIn(found, result.err)
        self.must_bake("dense", "d.part", "--resume", "--shard", "1/2")

    def test_without_any_resume_starts(self):
        self.check_finished("dense", "e.exr")

    def test_a_finished_part_is_kept(self):
        self.must_bake("dense", "f.part", "--shard", "1/2")
        before = (self.folder / "f.part").stat()
        self.assertIn("is there already", self.must_bake("dense", "f.part", "--shard", "1/2", "--resume").err)
        self.assertEqual((self.folder / "f.part").stat().st_mtime_ns, before.st_mtime_ns)
        result = self.must_bake("dense", "f.part", "--shard", "1/2", "--resume", "--seed", "2")
        self.assertNotIn("is there already", result.err)
        self.assertNotEqual((self.folder / "f.part").stat().st_ino, before.st_ino)
        self.assertEqual([n for n in self.names() if n.startswith("f.")], ["f.part"])

    def test_any_threads_continue_it(self):
        for kind in support.BAKE_JOBS:
            for threads in (1, 2):
                with self.subTest(kind=kind, threads=threads):
                    self.take(kind, "g.exr")
                    result = self.check_finished(kind, "g.exr", "--threads", threads)
                    self.assertRegex(result.err, r"resumed with [1-9]\d* of \d+ blocks")

    def test_damaged_blocks_are_baked_again(self):
        draw = random.Random(1)
        for kind in support.BAKE_JOBS:
            journal = self.take(kind, "h.exr")
            whole = journal.read_bytes()
            header = support.HEADER_START + int.from_bytes(whole[8:16], "little")
            for damage in ("flip", "cut", "add"):
                with self.subTest(kind=kind, damage=damage):
                    journal = self.take(kind, "h.exr")
                    place = draw.randrange(header, len(whole))
                    flipped = whole[:place] + bytes([whole[place] ^ 0x10]) + whole[place + 1:]
                    journal.write_bytes({"flip": flipped, "cut": whole[:place], "add": whole + b"rubbish"}[damage])
                    result = self.check_finished(kind, "h.exr")
                    self.assertRegex(result.err, r"h.exr.work/\w+.blocks: its last \d+ bytes are no whole block")

    def test_a_damaged_header_is_refused(self):
        journal = self.work("stopped_dense.exr") / "dense.blocks"
        original = journal.read_bytes()
        self.addCleanup(journal.write_bytes, original)
        size = support.HEADER_START + int.from_bytes(original[8:16], "little")
        draw = random.Random(2)
        for place in [0, 8, *(draw.randrange(16, size) for _ in range(6))]:
            with self.subTest(place=place):
                journal.write_bytes(original[:place] + bytes([original[place] ^ 1]) + original[place + 1:])
                self.refuse_work("dense", "i.exr", "--resume", naming=["i.exr.work/dense.blocks"])


class FullDisk(RestartTest):
    """A limit on the size of files stands for it."""

    OLD = b"an older table"

    @classmethod
    def prepare(cls):
        for kind in support.BAKE_JOBS:
            cls.must_bake(kind, f"{kind}.exr")

    def check_full(self, name, bake, size):
        self.write(name, self.OLD)
        result = bake(name, preexec_fn=support.limit_file_size(size))
        self.assertEqual((result.code, result.out), (2, ""), result)
        errors = [line for line in result.err.splitlines() if line.startswith("sunbeam: error: ")]
        self.assertEqual(len(errors), 1, result)
        self.assertIn(name, errors[0])
        self.assertIn("File too large", errors[0])
        self.assertEqual(self.bytes_of(name), self.OLD)
        self.assertEqual([n for n in self.names() if n.startswith(name)], [name, f"{name}.work"])
        return result

    def test_blocks_are_kept_and_it_goes_on_once_there_is_room(self):
        for kind in support.BAKE_JOBS:
            for size in (100, 3000, 9000):
                with self.subTest(kind=kind, size=size):
                    self.check_full("full.exr", functools.partial(self.bake, kind), size)
                    result = self.check_finished(kind, "full.exr")
                    if size == 9000:
                        self.assertRegex(result.err, r"resumed with [1-9]\d* of \d+ blocks")

    def test_no_room_for_the_table(self):
        """All blocks are less than the table here."""
        def bake(name, *options, **process):
            return self.sunbeam("bake", "tiny.toml", "--set", "table.encoding=dense", "-o", name, *options, **process)

        self.assertEqual(bake("small.exr").code, 0)
        size = len(self.bytes_of("small.exr")) // 2
        for name in ("table.exr", "table.vdb"):
            with self.subTest(name=name):
                result = self.check_full(name, bake, size)
                self.assertIn("verify 100 %", result.err, "the bake must have got as far as writing")
                result = bake(name, "--resume")
                self.assertEqual(result.code, 0, result)
                self.assertIn("resumed with 12 of 12 blocks", result.err)
        self.assertEqual(self.bytes_of("table.exr"), self.bytes_of("small.exr"))

    def test_read_only_folder(self):
        folder = self.folder / "read_only"
        folder.mkdir()
        folder.chmod(0o555)
        self.folder.chmod(0o755)
        nobody = {"user": 65534, "group": 65534, "extra_groups": []} if os.geteuid() == 0 else {}
        for options in ((), ("--shard", "1/2")):
            result = self.bake("dense", "read_only/table.exr", *options, **nobody)
            self.check_refusal(result, "read_only/table.exr", "cannot write: Permission denied")
        self.assertEqual(list(folder.iterdir()), [])


class Preview(support.CliTest):
    def test_of_the_default_recipe(self):
        recipe = support.SOURCE_DIR / "tables/recipes/sunbeam.toml"
        self.succeed("bake", recipe, "-o", "preview.exr", "--preview")
        info = json.loads(self.succeed("info", "preview.exr", "--json").out)
        self.assertLess(info["bytes"], 200000)
        self.assertLess(float(info["error"]["error_median"]), 0.001)

    def test_states_its_error_and_succeeds_whatever_it_is(self):
        result = self.succeed("bake", "tiny.toml", "-o", "coarse.exr", "--preview", "--set", "accuracy.tolerance_median=1e-6")
        stated = float(json.loads(self.succeed("info", "coarse.exr", "--json").out)["error"]["error_median"])
        self.assertGreater(stated, 1e-6)
        self.assertIn(f"error median {stated:.3g} ", result.err)

    def test_is_of_one_machine(self):
        self.refuse("bake", "tiny.toml", "-o", "tiny.part", "--preview", "--shard", "1/2", naming=["--preview", "--shard"])


if __name__ == "__main__":
    unittest.main()
