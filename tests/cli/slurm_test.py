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
TIME_LIMIT_S = 150

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

    def test_a_killed_part_goes_on_and_the_table_is_that_of_one_machine(self):
        wrapper = self.folder / "fails_once.sh"
        wrapper.write_text(FAILS_ONCE)
        wrapper.chmod(0o755)
        self.submit("farm.exr", *RECIPE, SUNBEAM=str(wrapper),
                    JOURNAL=str(self.folder / "farm.exr.parts/3.part.work/dense.blocks"))
        logs = self.logs("farm.exr")
        self.assertIn("exit code 137: queued again", logs)
        self.assertRegex(logs, r"resumed with [1-9]\d* of 45 blocks")
        self.succeed("bake", *RECIPE, "-o", "one.exr")
        self.assertTrue((self.folder / "farm.exr").exists(), logs)
        self.assertEqual((self.folder / "farm.exr").read_bytes(), (self.folder / "one.exr").read_bytes())
        self.assertEqual(sorted(p.name for p in (self.folder / "farm.exr.parts").iterdir()),
                         ["1.log", "2.log", "3.log", "4.log", "merge.log"])

    def test_a_part_that_always_fails_is_given_up_and_nothing_is_merged(self):
        self.submit("never.exr", *RECIPE, "--set", "material.albedo=2", RESTARTS="1")
        logs = self.logs("never.exr")
        self.assertEqual(logs.count("exit code 2: queued again"), PARTS, logs)
        self.assertEqual(logs.count("material.albedo"), 2 * PARTS, logs)
        self.assertFalse((self.folder / "never.exr").exists())
        self.assertNotIn("merge.log", logs)


if __name__ == "__main__":
    unittest.main()
