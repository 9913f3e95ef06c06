"""Help, version and mistakes on the command line itself."""

import os
import pathlib
import re
import unittest

import support

COMMANDS = ("bake", "merge", "info", "eval", "verify", "plot", "render", "compare")


class Help(support.CliTest):
    def test_top_level_help_lists_every_command_and_shows_an_example(self):
        result = self.succeed("--help")
        self.assertEqual(result.err, "")
        for command in COMMANDS:
            self.assertRegex(result.out, rf"(?m)^  {command}\b")
        self.assertRegex(result.out, r"(?s)Example:\n.*sunbeam bake ")

    def test_help_of_every_command_shows_an_example_of_that_command(self):
        for command in COMMANDS:
            with self.subTest(command=command):
                result = self.succeed(command, "--help")
                self.assertEqual(result.err, "")
                self.assertRegex(result.out, rf"(?s)Example:\n.*sunbeam {command} ")

    def test_help_names_every_option(self):
        options = {
            "bake": ("--output", "--set", "--threads", "--seed", "--resume", "--preview", "--shard", "--progress"),
            "merge": ("--output", "--threads", "--progress"),
            "info": ("--json",),
            "eval": ("--points", "--quantity", "--estimator", "--set", "--samples", "--seed"),
            "verify": ("--points", "--json", "--html", "--threads", "--seed"),
            "plot": ("--output", "--what", "--film-thickness-nm", "--base-ior", "--absorption-per-nm", "--theta-i"),
            "compare": ("--png", "--json", "--pixels-per-degree", "--max-rmse", "--max-relmse", "--max-flip", "--max-bias",
                        "--max-bias-z"),
            "render": ("--output", "--material", "--estimator", "--size", "--spp", "--threads", "--seed", "--stats"),
        }
        for command, names in options.items():
            text = self.succeed(command, "--help").out
            for name in names:
                with self.subTest(command=command, option=name):
                    self.assertIn(name, text)

    def test_the_example_of_eval_works_as_printed(self):
        text = self.succeed("eval", "--help").out
        example = text.split("Example:\n", 1)[1]
        path = f"{pathlib.Path(support.BINARY).parent}{os.pathsep}{os.environ['PATH']}"
        result = support.run_command(["/bin/bash", "-c", example], support.SOURCE_DIR, env={"PATH": path})
        self.assertEqual(result.code, 0, result)
        self.assertEqual(len(support.rows_of(result.out)), 1, result)


class Version(support.CliTest):
    def test_version_is_the_one_of_the_project(self):
        cmake = (support.SOURCE_DIR / "CMakeLists.txt").read_text()
        version = re.search(r"project\(sunbeam VERSION ([\d.]+)", cmake).group(1)
        result = self.succeed("--version")
        self.assertEqual((result.out, result.err), (f"sunbeam {version}\n", ""))


class Mistakes(support.CliTest):
    def test_no_arguments_shows_how_to_go_on(self):
        result = self.sunbeam()
        self.assertEqual(result.code, 2, result)
        self.assertEqual(result.out, "", result)
        self.assertRegex(result.err, "subcommand|Usage")
        self.assertIn("--help", result.err)

    def test_mistakes_are_named(self):
        bake = ("bake", "tiny.toml", "-o", "out.exr")
        points = self.write("points.csv", "theta_i_deg,theta_o_deg,phi_deg\n1,2,3\n")
        evaluate = ("eval", "tiny.toml", "--points", points)
        cases = [
            (("polish",), ["polish"]),
            (("--polish",), ["--polish"]),
            (("bake", "--polish"), ["--polish"]),
            ((*bake, "--polish"), ["--polish"]),
            ((*bake, "extra.toml"), ["extra.toml"]),
            (("bake", "tiny.toml"), ["--output"]),
            (("bake",), ["recipe"]),
            (("info",), ["source"]),
            (("eval", "tiny.toml"), ["--points"]),
            (("verify",), ["table"]),
            (("render", "scene.toml"), ["--output"]),
            ((*bake, "--threads", "-1"), ["--threads", "-1"]),
            ((*bake, "--threads", "two"), ["--threads", "two"]),
            ((*bake, "--seed", "one"), ["--seed", "one"]),
            ((*bake, "--seed", "-1"), ["--seed", "-1"]),
            ((*bake, "--seed"), ["--seed"]),
            ((*evaluate, "--quantity", "colour"), ["--quantity", "colour", "brdf", "albedo", "film"]),
            ((*evaluate, "--estimator", "guess"), ["--estimator", "guess", "auto", "pfmc", "exact"]),
            (("render", "scene.toml", "-o", "i.exr", "--estimator", "guess"), ["guess", "auto", "pfmc", "exact"]),
            ((*evaluate, "--samples", "1"), ["--samples", "1", "2"]),
            ((*evaluate, "--samples", "many"), ["--samples", "many"]),
            (("verify", "table.exr", "--points", "0"), ["--points", "0", "1"]),
            (("render", "scene.toml", "-o", "i.exr", "--material", "wood"), ["wood", "table", "live", "diffuse"]),
            (("render", "scene.toml", "-o", "i.exr", "--spp", "0"), ["--spp", "0", "1"]),
            (("render", "scene.toml", "-o", "i.exr", "--noise", "nan"), ["--noise", "nan"]),
            (("render", "scene.toml", "-o", "i.exr", "--watch=-1"), ["--watch", "-1"]),
            (("info", "tiny.toml", "--max-memory", "0.5"), ["--max-memory", "0.5", "1 to 1e+06"]),
        ]
        for arguments, needles in cases:
            with self.subTest(arguments=arguments):
                self.refuse(*arguments, naming=needles)


class Words(support.CliTest):
    def test_a_file_whose_name_looks_like_an_option(self):
        for name in ("-t.toml", "--json"):
            self.write(name, support.TINY_RECIPE)
        self.succeed("info", "--", "-t.toml")
        self.assertIn('"recipe_hash"', self.succeed("info", "--json", "--", "-t.toml").out)
        self.succeed("bake", "--output=-t.exr", "--preview", "--", "-t.toml")
        self.assertTrue((self.folder / "-t.exr").is_file())

    def test_options_without_a_value_and_twice(self):
        for arguments, needles in (
                (("info", "tiny.toml", "--json="), ["--json", "found ''"]),
                (("render", "tiny.toml", "-o", "a.exr", "--watch="), ["--watch", "found ''"]),
                (("mesh", "sphere", "-o", "a.ply", "-o", "b.ply"), ["--output", "received 2"]),
                (("mesh", "sphere", "-o", ""), ["--output", "found ''; allowed: a path"])):
            with self.subTest(arguments=arguments):
                self.refuse(*arguments, naming=needles)

    def test_control_characters_are_escaped(self):
        for arguments in (("info", "a\x1b[31m\n.exr"), ("bake", "--\x1b[31m\n"), ("\x1b[31m\n",)):
            with self.subTest(arguments=arguments):
                self.refuse(*arguments, naming=["\\x1b[31m\\n"])


class Numbers(support.CliTest):
    """Every option of every command that takes a number, as --help lists them, refuses what is none."""

    COMMANDS = {
        "bake": ("tiny.toml", "-o", "new.exr", "--preview"),
        "merge": ("tiny.part", "-o", "new.exr"),
        "info": ("tiny.exr",),
        "eval": ("tiny.exr", "--points", "points.csv"),
        "verify": ("tiny.exr", "--points", "1"),
        "plot": ("tiny.exr", "--what", "polar", "-o", "new.svg"),
        "render": ("scene.toml", "-o", "new.exr", "--material", "diffuse"),
        "compare": ("a.exr", "a.exr"),
        "texture": ("-o", "new.png", "--columns", "1", "--rows", "2", "--pixels-per-scale", "4"),
        "mesh": ("sphere", "-o", "new.ply", "--resolution", "16"),
    }
    # Options that help shows as text, and how the text holds the number.
    IN_TEXT = {"--shard": "{}/2", "--size": "{}x8", "--crop": "0,0,{},8", "--time": "{}s", "--set": "material.albedo={}"}
    NO_NUMBER = {"--output", "--set", "--progress", "--points", "--quantity", "--estimator", "--truth", "--json", "--html",
                 "--what", "--material", "--table", "--resume", "--stats", "--png", "--pattern", "--help"}
    BAD = ("nan", "inf", "-inf", "1e999", "", "0x1p3", "-1e400")  # in turns: a run takes a twentieth of a second

    @classmethod
    def prepare(cls):
        cls.write("scene.toml", support.SKY_SPHERE_SCENE.format(name="tiny", spp=1, max_bounces=2, tangent_rotation_deg=0))
        cls.write("points.csv", "theta_i_deg,theta_o_deg,phi_deg\n1,2,3\n")
        support.succeed_in(cls.folder, "bake", "tiny.toml", "-o", "tiny.exr", "--preview")
        support.succeed_in(cls.folder, "bake", "tiny.toml", "-o", "tiny.part", "--shard", "1/1")
        support.succeed_in(cls.folder, "render", "scene.toml", "-o", "a.exr", "--material", "diffuse")

    def arguments_of(self, command, option, value):
        """The command with this option, in place of one that is there."""
        arguments = list(self.COMMANDS[command])
        if command == "mesh" and option in ("--body-radius", "--turns", "--major-radius", "--minor-radius"):
            arguments[0] = "torus" if option.endswith("or-radius") else "snake"
        if command == "eval" and option == "--set":
            arguments[0] = "tiny.toml"
        if command == "bake" and option == "--shard":
            arguments.remove("--preview")
        if option in arguments:
            at = arguments.index(option)
            del arguments[at:at + 2]
        if option == "--set":
            value = value.replace("material.albedo", "object[0].radius" if command == "render" else "material.albedo")
        return (command, *arguments, f"{option}={value}")

    def test_every_numeric_option(self):
        listed = re.findall(r"(?m)^  (\w+) ", self.succeed("--help").out.split("Subcommands:\n", 1)[1].split("Example:")[0])
        self.assertEqual(sorted(listed), sorted(self.COMMANDS))
        seen = []
        for command in self.COMMANDS:
            for option, kind in re.findall(r"(?m)^  (?:-\w,)?(--[\w-]+)(?:\{\w+\})? *(INT|UINT|FLOAT|TEXT)?", self.succeed(command, "--help").out):
                is_number = kind in ("INT", "UINT", "FLOAT") or option == "--watch" or (command, option) == ("verify", "--points")
                form = "{}" if is_number else self.IN_TEXT.get(option)
                if form is None:
                    self.assertTrue(option in self.NO_NUMBER or not kind, (command, option))
                    continue
                in_turn = self.BAD[len(seen) % len(self.BAD)]
                is_new_float = option not in seen and kind not in ("INT", "UINT")
                seen.append(option)
                for value in {in_turn, "nan"} if is_new_float else {in_turn}:
                    with self.subTest(command=command, option=option, value=value):
                        result = self.sunbeam(*self.arguments_of(command, option, form.format(value)))
                        self.check_refusal(result, {"--set": "radius" if command == "render" else "albedo"}.get(
                            option, option.strip("-").split("-")[0]))
        self.assertGreaterEqual(set(seen), {
            "--threads", "--seed", "--samples", "--points", "--film-thickness-nm", "--base-ior", "--absorption-per-nm",
            "--theta-i", "--spp", "--noise", "--watch", "--pixels-per-degree", "--max-rmse", "--max-relmse", "--max-flip",
            "--max-bias", "--max-bias-z", "--columns", "--rows", "--edge", "--jitter", "--pixels-per-scale", "--resolution",
            "--body-radius", "--turns", "--major-radius", "--minor-radius", "--radius", "--max-memory", *self.IN_TEXT})
        self.assertEqual([n for n in self.names() if n.startswith("new")], [])


if __name__ == "__main__":
    unittest.main()
