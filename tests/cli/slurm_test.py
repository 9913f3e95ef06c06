"""cmake/slurm/bake.sh on a real Slurm cluster of one node. Skipped, with the reason, where none can be started;
SUNBEAM_NEEDS_SLURM makes that a failure."""

import os
import subprocess
import time
import unittest

import slurm_cluster
import support

# Its blocks take seconds, and their error is soon measured.
RECIPE = ("tiny.toml", *support.BAKE_JOBS["dense"], "--set", "table.angles=10", "--set", "accuracy.noise=0.0002")
PARTS = 4
TIME_LIMIT_S = 500

# Stands for sunbeam: kills the first run of part 3 once it has some blocks.
FAILS_ONCE = """\
#!/bin/sh
if [ "$1 ${SLURM_ARRAY_TASK_ID:-}" != "bake 3" ] || [ "${SLURM_RESTART_COUNT:-0}" != 0 ]; then
  exec "$REAL_SUNBEAM" "$@"
fi
"$REAL_SUNBEAM" "$@" &
until [ "$(stat -c %s "$JOURNAL" 2>/dev/null || echo 0)" -gt 6000 ]; do :; done
kill -KILL $!
wait $!
"""

FAILS_ALWAYS = """\
#!/bin/sh
[ "$1 ${SLURM_ARRAY_TASK_ID:-}" != "bake 2" ] || exit 9
exec "$REAL_SUNBEAM" "$@"
"""


class SlurmArray(support.CliTest):
    @classmethod
    def prepare(cls):
        # Short paths: that of a socket is limited.
        cls.cluster = slurm_cluster.Cluster(support.make_folder(cls))
        try:
            cls.enterClassContext(cls.cluster)
        except slurm_cluster.Unavailable as reason:
            if "SUNBEAM_NEEDS_SLURM" in os.environ:
                raise
            raise unittest.SkipTest(f"Slurm: {reason}") from None
        cls.environment = dict(cls.cluster.variables, REAL_SUNBEAM=support.BINARY, SUNBEAM=support.BINARY)

    def submit(self, output, *options, **environment):
        """Returns once all jobs have ended."""
        script = support.SOURCE_DIR / "cmake/slurm/bake.sh"
        result = support.run_command(["sh", script, *options[:1], PARTS, output, *options[1:]], self.folder,
                                     env=dict(self.environment, **environment))
        self.assertEqual(result.code, 0, result)
        end = time.monotonic() + TIME_LIMIT_S
        while self.cluster.command("squeue", "--noheader") and time.monotonic() < end:
            time.sleep(0.2)
        self.assertEqual(self.cluster.command("squeue", "--noheader"), "", self.logs(output))

    def logs(self, output):
        return "".join(f"\n== {path.name}\n{path.read_text()}"
                       for path in sorted((self.folder / f"{output}.parts").glob("*.log")))

    def script(self, name, text):
        path = self.folder / name
        path.write_text(text)
        path.chmod(0o755)
        return str(path)

    def check_table(self, name, *recipe):
        """It is that of one machine, and of the parts only the logs are left."""
        self.succeed("bake", f"./{recipe[0]}", *recipe[1:], "-o", "one.exr")
        self.assertTrue((self.folder / name).exists(), self.logs(name))
        self.assertEqual((self.folder / name).read_bytes(), (self.folder / "one.exr").read_bytes())
        self.assertEqual(sorted(p.name for p in (self.folder / f"{name}.parts").iterdir()),
                         ["1.log", "2.log", "3.log", "4.log", "merge.log"])

    def test_a_killed_part_goes_on_and_the_table_is_that_of_one_machine(self):
        self.submit("farm.exr", *RECIPE, SUNBEAM=self.script("fails_once.sh", FAILS_ONCE),
                    JOURNAL=str(self.folder / "farm.exr.parts/3.part.work/dense.blocks"))
        logs = self.logs("farm.exr")
        self.assertIn("exit code 137: queued again", logs)
        self.assertRegex(logs, r"resumed with [1-9]\d* of 45 blocks")
        self.check_table("farm.exr", *RECIPE)

    def test_a_part_that_always_fails_is_given_up_and_the_same_command_does_the_rest(self):
        recipe = RECIPE[:-2]
        self.submit("later.exr", *recipe, SUNBEAM=self.script("fails.sh", FAILS_ALWAYS), RESTARTS="1")
        logs = self.logs("later.exr")
        self.assertEqual(logs.count("exit code 9: queued again"), 1, logs)
        self.assertFalse((self.folder / "later.exr").exists())
        self.assertNotIn("merge.log", logs)
        self.submit("later.exr", *recipe)
        logs = self.logs("later.exr")
        self.assertEqual(logs.count("is there already"), PARTS - 1, logs)
        self.assertEqual(logs.count(": part 2 of 4, "), 1, logs)
        self.check_table("later.exr", *recipe)

    def test_names_that_look_like_options_or_patterns(self):
        recipe, name = "-50%a \\%j.toml", "--help %a%%j 100%.exr"
        (self.folder / recipe).write_bytes((self.folder / RECIPE[0]).read_bytes())
        self.submit(name, recipe, *RECIPE[1:-2])
        self.check_table(name, recipe, *RECIPE[1:-2])

    def test_a_backslash_is_refused_by_name(self):
        script = support.SOURCE_DIR / "cmake/slurm/bake.sh"
        result = support.run_command(["sh", script, RECIPE[0], PARTS, "back\\slash.exr"], self.folder, env=self.environment)
        self.assertEqual((result.code, result.out), (2, ""), result)
        self.assertIn("back\\slash.exr: a name with a backslash", result.err)
        self.assertEqual(list(self.folder.glob("*.parts")), [])


if __name__ == "__main__":
    unittest.main()
