"""`sunbeam bake --shard` and `sunbeam merge`: parts, joined in any order, are the table of one machine."""

import functools
import random
import unittest

import support

SHARDS = 16


class PartsTest(support.CliTest):
    @classmethod
    def part(cls, kind, shard, shards, name, *options):
        return support.succeed_in(cls.folder, "bake", "tiny.toml", *support.BAKE_JOBS[kind], "--shard",
                                  f"{shard}/{shards}", "-o", name, *options)

    @classmethod
    def parts(cls, kind, shards, *options):
        names = [f"{kind}_{k}_of_{shards}{''.join(options)}.part" for k in range(1, shards + 1)]
        for k, name in enumerate(names):
            cls.part(kind, k + 1, shards, name, *options)
        return names


class Merge(PartsTest):
    def test_table_is_that_of_one_machine(self):
        for kind, options in support.BAKE_JOBS.items():
            with self.subTest(kind=kind):
                names = self.parts(kind, SHARDS)
                random.Random(kind).shuffle(names)
                merged = self.succeed("merge", *names, "-o", "merged.exr")
                one = self.succeed("bake", "tiny.toml", *options, "-o", "one.exr")
                self.assertEqual((self.folder / "merged.exr").read_bytes(), (self.folder / "one.exr").read_bytes())
                self.assertEqual(merged.err.splitlines()[-1].replace("merged", "one"), one.err.splitlines()[-1])

    def test_as_vdb(self):
        """Tables are written without the random identifier that OpenVDB gives its files."""
        names = self.parts("dense", 3)
        self.succeed("merge", *names, "-o", "merged.vdb")
        self.succeed("bake", "tiny.toml", *support.BAKE_JOBS["dense"], "-o", "one.vdb")
        self.assertEqual((self.folder / "merged.vdb").read_bytes(), (self.folder / "one.vdb").read_bytes())

    def check_merge(self, name, shards, *options):
        names = [f"{name}_{k}.part" for k in range(1, shards + 1)]
        for k, part in enumerate(names):
            self.succeed("bake", "tiny.toml", *options, "--shard", f"{k + 1}/{shards}", "-o", part)
        self.succeed("merge", *names, "-o", f"{name}.exr")
        one = self.succeed("bake", "tiny.toml", *options, "-o", f"{name}_one.exr")
        self.assertEqual((self.folder / f"{name}.exr").read_bytes(), (self.folder / f"{name}_one.exr").read_bytes())
        return one

    def test_more_shards_than_blocks(self):
        self.check_merge("few", 20, "--set", "table.encoding=dense")

    def test_a_table_beyond_its_tolerances_says_what_to_do(self):
        """One machine would go on to the other encoding."""
        auto = ("--set", "table.encoding=auto", "--set", "accuracy.tolerance_median=0.005", "--set",
                "accuracy.tolerance_p99=0.006", "--set", "material.roughness=0.2")
        for k in (1, 2):
            self.succeed("bake", "tiny.toml", *auto, "--shard", f"{k}/2", "-o", f"auto_{k}.part")
        result = self.miss("merge", "auto_1.part", "auto_2.part", "-o", "auto.exr", figure="error_median")
        self.assertRegex(result.err.splitlines()[-1], r"auto.exr: misses the recipe's tolerances.*--set table.encoding=\w+$")
        self.succeed("info", "auto.exr")

    def test_a_table_beyond_its_tolerances_without_another_encoding(self):
        strict = ("--set", "table.encoding=dense", "--set", "accuracy.tolerance_median=1e-6")
        self.succeed("bake", "tiny.toml", *strict, "--shard", "1/1", "-o", "strict.part")
        merged = self.miss("merge", "strict.part", "-o", "strict.exr", figure="error_median")
        self.assertNotIn("table.encoding", merged.err)
        baked = self.miss("bake", "tiny.toml", *strict, "-o", "strict_one.exr", figure="error_median")
        self.assertEqual((self.folder / "strict.exr").read_bytes(), (self.folder / "strict_one.exr").read_bytes())
        self.assertEqual(merged.err.splitlines()[-1].replace("strict", "strict_one"), baked.err.splitlines()[-1])


class Refused(PartsTest):
    """What cannot be merged is named; nothing is written, and an older table stays."""

    @classmethod
    def prepare(cls):
        cls.names = cls.parts("dense", 3)
        cls.write("table.exr", "an older table")

    def refuse_parts(self, parts, *naming):
        for output in ("table.exr", "new.exr"):
            self.refuse("merge", *parts, "-o", output, naming=naming)

    def damaged(self, change):
        part = (self.folder / self.names[1]).read_bytes()
        self.write("damaged.part", change(part))
        return [self.names[0], "damaged.part", self.names[2]]

    def test_missing(self):
        self.refuse_parts(self.names[:1], "of 3 parts these are missing: 2, 3")

    def test_twice(self):
        self.refuse_parts([*self.names, self.names[1]], f"{self.names[1]}: is part 2 of 3, and so is")
        self.write("copy.part", (self.folder / self.names[0]).read_bytes())
        self.refuse_parts([*self.names, "copy.part"], f"copy.part: is part 1 of 3, and so is {self.names[0]}")

    def test_of_another_bake(self):
        for options, reason in ((("--set", "material.albedo=0.2"), "recipe"), (("--seed", "2"), "seed 2 against 1")):
            self.part("dense", 2, 3, "other.part", *options)
            self.refuse_parts([self.names[0], "other.part", self.names[2]], "other.part", self.names[0], reason)

    def test_of_another_count(self):
        self.part("dense", 2, 4, "of_four.part")
        self.refuse_parts([self.names[0], "of_four.part", self.names[2]], "of_four.part: is one of 4 parts",
                          f"{self.names[0]} is one of 3")

    def test_flipped_bits(self):
        size = (self.folder / self.names[1]).stat().st_size
        draw = random.Random(1)

        def flip(place, part):
            return part[:place] + bytes([part[place] ^ 1 << draw.randrange(8)]) + part[place + 1:]

        for place in (0, 8, 20, support.HEADER_START + 3, support.HEADER_START + 130, *(draw.randrange(size) for _ in range(12)), size - 1):
            with self.subTest(place=place):
                self.refuse_parts(self.damaged(functools.partial(flip, place)), "damaged.part: ")

    def test_cut_short_or_longer(self):
        size = (self.folder / self.names[1]).stat().st_size
        for end in (0, 5, 30, 100, size // 2, size - 1):
            with self.subTest(end=end):
                self.refuse_parts(self.damaged(lambda part: part[:end]), "damaged.part: ")
        self.refuse_parts(self.damaged(lambda part: part + b"more"), "damaged.part: ")

    def test_no_part(self):
        self.write("random.part", random.Random(2).randbytes(5000))
        for name in ("tiny.toml", "table.exr", "random.part", "absent.part", "."):
            with self.subTest(name=name):
                self.refuse_parts([self.names[0], name, self.names[2]], f"{name}: ")

    def test_output_that_cannot_be_written(self):
        self.refuse("merge", *self.names, "-o", "table.png", naming=["table.png", ".exr", ".vdb"])
        self.refuse("merge", *self.names, "-o", "missing/table.exr", naming=["missing/table.exr", "cannot write"])

    def test_shard(self):
        for text in ("0/2", "3/2", "1", "1/0", "a/b", "1/2/3", "-1/2", "1.5/2", "1/99999999", ""):
            with self.subTest(shard=text):
                self.refuse("bake", "tiny.toml", "-o", "x.part", f"--shard={text}", naming=["--shard"])


if __name__ == "__main__":
    unittest.main()
