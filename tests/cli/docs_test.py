"""The documentation: names, commands and links in it exist. For every check a planted mistake shows that it can fail."""

import unittest

import docs_checks as checks

INDEX = checks.ROOT / "docs" / "theory" / "model.md"
GLOSSARY = checks.ROOT / "docs" / "theory" / "glossary.md"


class Documentation(unittest.TestCase):
    def test_every_function_of_the_equation_index_exists(self):
        text = checks.text_of(INDEX)
        index = text[text.index("## Equation index"):]
        self.assertGreater(index.count("\n| "), 20)
        self.assertEqual(checks.rows_without_a_place(index), [])
        self.assertEqual(checks.wrong_names(index), [])

    def test_names_and_paths_of_the_code_exist(self):
        for page in checks.pages():
            with self.subTest(page=page):
                text = checks.text_of(page)
                self.assertEqual(checks.wrong_names(text) + checks.wrong_paths(text), [])

    def test_scripts_recipes_and_scenes_mention_pages_that_exist(self):
        files = checks.mentioning_files()
        self.assertGreater(len(files), 30)
        for file in files:
            with self.subTest(file=file):
                self.assertEqual(checks.wrong_mentions(checks.text_of(file)), [])

    def test_commands_parse(self):
        count = 0
        for page in checks.pages():
            with self.subTest(page=page):
                text = checks.text_of(page)
                count += len(list(checks.commands(text)))
                self.assertEqual(checks.wrong_commands(text), [])
        self.assertGreater(count, 60)

    def test_links_and_pictures_resolve(self):
        for page in checks.pages():
            with self.subTest(page=page):
                self.assertEqual(checks.wrong_links(page, checks.text_of(page)), [])

    def test_every_page_is_reached_from_the_readme(self):
        self.assertEqual(checks.unreachable({page: checks.text_of(page) for page in checks.pages()}), [])

    def test_pictures_are_shown_somewhere(self):
        shown = {(page.parent / target).resolve() for page in checks.pages() for target in checks.links(checks.text_of(page))}
        pictures = {path.resolve() for path in (checks.ROOT / "docs" / "figures").iterdir()}
        self.assertEqual(pictures - shown, set())

    def test_the_glossary_has_the_words_of_the_code(self):
        self.assertEqual(checks.missing_words(checks.text_of(GLOSSARY)), [])


class PlantedMistakes(unittest.TestCase):
    def test_names(self):
        self.assertEqual(checks.wrong_names("`runtime/include/sunbeam/bsdf.h`: `Bsdf::eval`, `EvalPdf`"), [])
        self.assertEqual(len(checks.wrong_names("`runtime/include/sunbeam/bsdf.h`: `evaluate`")), 1)
        self.assertEqual(len(checks.wrong_names("`runtime/include/sunbeam/brdf.h`: `eval`")), 1)
        self.assertEqual(checks.wrong_paths("`tests/cli/` `docs/*.md` `tests/cli/docs_test.py`"), [])
        self.assertEqual(len(checks.wrong_paths("`tests/cli/doc_test.py` `bake/*.f90`")), 2)

    def test_rows_and_mentions(self):
        row = "| Airy | R | {} | `bake/optics/fringes.cpp`: `film_fringes` |\n"
        head = "| equation | symbol | where | who else |\n"
        self.assertEqual(checks.rows_without_a_place(head + row.format("`bake/optics/thin_film.cpp`: `airy`")), [])
        self.assertEqual(len(checks.rows_without_a_place(head + row.format("in the film"))), 1)
        self.assertEqual(checks.wrong_mentions("# See docs/limits.md and docs/limit.md."), ["docs/limit.md"])

    def test_a_name_that_only_a_comment_says_does_not_count(self):
        self.assertTrue(checks.is_defined("draw", "int draw(Rng& rng);"))
        self.assertFalse(checks.is_defined("draw", "// draw(rng) is gone\nint drawn(Rng& rng);"))

    def test_commands(self):
        good = ["sunbeam eval tables/recipes/quick.toml --points -", "bash cmake/demo.sh", "sunbeam COMMAND --help",
                "build/release/bin/statistical_tests --gtest_filter='Estimators*'", "cmake --preset release -DSUNBEAM_WERROR=ON"]
        bad = ["sunbeam polish a.exr", "sunbeam bake a.toml -o b.exr --polish", "sunbeam bake a.toml --threads 1",
               "sunbeam info a.exr b.exr", "sunbeam eval a.toml --points - --quantity colour", "bash cmake/demos.sh",
               "sunbeam bake tables/recipes/none.toml -o a.exr", "build/release/bin/no_such_tests x",
               "build/release/bin/statistical_tests --gtest_filter='NoSuchSuite*'", "cmake --preset none",
               "cmake --preset release -DSUNBEAM_POLISH=ON", "echo 1 | sunbeam polish a.exr", "A=1 sunbeam polish a.exr"]
        for form in ("```\n{}\n```\n", "    {}\n", "Text `{}` and more.\n"):
            for command in good:
                with self.subTest(form=form, command=command):
                    self.assertEqual(checks.wrong_commands(form.format(command)), [])
            for command in bad:
                with self.subTest(form=form, command=command):
                    self.assertEqual(len(checks.wrong_commands(form.format(command))), 1)

    def test_links(self):
        text = "# A title\n[a](docs/limits.md) [b](#a-title) [c](https://example.org)\n"
        self.assertEqual(checks.wrong_links(checks.README, text), [])
        text = "# A title\n[a](docs/limit.md) ![b](docs/figures/none.png) [c](#a-heading)\n"
        self.assertEqual(len(checks.wrong_links(checks.README, text)), 3)

    def test_pages_without_a_way_to_them(self):
        page = checks.ROOT / "docs" / "limits.md"
        self.assertEqual(checks.unreachable({checks.README: "[a](docs/limits.md)", page: ""}), [])
        self.assertEqual(checks.unreachable({checks.README: "", page: "[a](limits.md)"}), ["docs/limits.md"])

    def test_glossary(self):
        self.assertEqual(len(checks.missing_words("| **rest** | what is left |\nThe first surface.\n")), len(checks.WORDS) - 1)


if __name__ == "__main__":
    unittest.main()
