"""`sunbeam eval`: columns, digits, random streams and refusals, of recipes (live) and of tables."""

import csv
import io
import math
import subprocess
import unittest

import support

ANGLES = "theta_i_deg,theta_o_deg,phi_deg"
WALKS = ("--estimator", "pfmc", "--samples")
SAMPLES = (*WALKS, "50")
NAMED = "estimator: {}\n"

COLOURS = ("_r", "_g", "_b")


def coloured(*names):
    return [name + suffix for name in names for suffix in COLOURS]


# Quantity -> appended columns, in colour and of one wavelength.
OUTPUT_COLUMNS = {
    "brdf": (coloured("first", "rest", "stderr") + ["pdf"] + coloured("dirac"),
             ["first", "rest", "stderr", "pdf", "dirac"]),
    "albedo": (coloured("total", "stderr"), ["total", "stderr"]),
    "film": (coloured("reflectance"), ["reflectance"]),
}


class EvalTest(support.CliTest):
    def evaluate(self, source, points, *options):
        return self.succeed("eval", source, "--points", "-", *options, stdin=points)

    def rows(self, source, points, *options):
        return support.rows_of(self.evaluate(source, points, *options).out)

    def check_columns_and_digits(self, source, *options):
        points = f"note,{ANGLES}\nhello,30,40,180\n,0,89.9,0\n"
        for quantity, (colour, single) in OUTPUT_COLUMNS.items():
            for header, row, expected in (("", "", colour), ("wavelength_nm,", "510,", single)):
                with self.subTest(quantity=quantity, wavelength=bool(row)):
                    lines = points.splitlines()
                    text = "\n".join([header + lines[0], row + lines[1], row + lines[2]]) + "\n"
                    result = self.evaluate(source, text, "--quantity", quantity, *options)
                    walked = source.endswith(".toml") and quantity != "film"
                    named = NAMED.format("pfmc-unidirectional") if walked else ""
                    self.assertEqual(result.err, named + "carried through: note\n")
                    out = result.out.split("\n")
                    self.assertEqual(out[0].split(","), (header + lines[0]).split(",") + expected)
                    self.assertEqual(len(out), 4, "header, two rows, nothing after the last line end")
                    self.assertEqual(out[3], "")
                    for k in (1, 2):
                        self.assertTrue(out[k].startswith(row + lines[k] + ","), out[k])
                        numbers = out[k].split(",")[-len(expected):]
                        for number in numbers:
                            self.assertTrue(math.isfinite(float(number)), out[k])
                            self.assertEqual("%.17g" % float(number), number)


class Live(EvalTest):
    def test_columns_and_digits(self):
        self.check_columns_and_digits("tiny.toml", *SAMPLES)
        self.check_columns_and_digits("tiny.toml", *SAMPLES, "--set", "material.roughness=0.2",
                                      "--set", "material.transmission=refract")

    def test_a_row_does_not_depend_on_rows_after_it(self):
        lines = [ANGLES, "30,40,180", "10,20,0", "50,5,90", "30,40,180", "80,80,180"]
        rough = ("--set", "material.roughness=0.3", "--set", "material.transmission=refract")
        whole = self.evaluate("tiny.toml", "\n".join(lines) + "\n", *SAMPLES, *rough).out.splitlines()
        for count in range(2, len(lines)):
            part = self.evaluate("tiny.toml", "\n".join(lines[:count]) + "\n", *SAMPLES, *rough).out.splitlines()
            self.assertEqual(part, whole[:count])

    def test_a_row_does_not_depend_on_the_content_of_rows_before_it(self):
        first = self.rows("tiny.toml", f"{ANGLES}\n1,2,3\n30,40,180\n", *SAMPLES)
        second = self.rows("tiny.toml", f"{ANGLES}\n70,20,30\n30,40,180\n", *SAMPLES)
        self.assertEqual(first[1], second[1])
        self.assertNotEqual(first[0], second[0])

    def test_equal_rows_use_streams_of_their_own(self):
        for quantity, column in (("brdf", "rest_r"), ("albedo", "total_r")):
            rows = self.rows("tiny.toml", f"{ANGLES}\n30,40,180\n30,40,180\n", "--quantity", quantity, *SAMPLES)
            self.assertNotEqual(rows[0][column], rows[1][column])

    def test_seed_and_samples(self):
        points = f"{ANGLES}\n30,40,180\n"
        one = self.rows("tiny.toml", points, *SAMPLES)
        self.assertEqual(one, self.rows("tiny.toml", points, *SAMPLES, "--seed", "1"), "the default seed is 1")
        self.assertNotEqual(one[0]["rest_r"], self.rows("tiny.toml", points, *SAMPLES, "--seed", "2")[0]["rest_r"])
        many = self.rows("tiny.toml", points, *WALKS, "5000")
        self.assertLess(float(many[0]["stderr_r"]), 0.3 * float(one[0]["stderr_r"]))

    def test_from_file_and_from_standard_input(self):
        points = f"{ANGLES}\n30,40,180\n10,20,0\n"
        self.write("points.csv", points)
        from_file = self.succeed("eval", "tiny.toml", "--points", "points.csv", *SAMPLES).out
        self.assertEqual(from_file, self.evaluate("tiny.toml", points, *SAMPLES).out)

    def test_line_ends_comments_and_empty_lines(self):
        plain = self.evaluate("tiny.toml", f"{ANGLES}\n30,40,180\n10,20,0\n", *SAMPLES).out
        variants = [
            f"{ANGLES}\r\n30,40,180\r\n10,20,0\r\n",
            f"{ANGLES}\n30,40,180\n10,20,0",
            f"# made by hand\n{ANGLES}\n# one\n30,40,180\n\n#two,columns\n10,20,0\n#",
            f"#\r\n{ANGLES}\r\n\r\n30,40,180\r\n10,20,0",
        ]
        for text in variants:
            with self.subTest(text=text):
                self.assertEqual(self.evaluate("tiny.toml", text, *SAMPLES).out, plain)

    def test_header_without_rows(self):
        out = self.evaluate("tiny.toml", ANGLES + "\n").out
        self.assertEqual(out, ",".join([ANGLES, *OUTPUT_COLUMNS["brdf"][0]]) + "\n")

    def test_unknown_columns_are_carried_through(self):
        out = self.evaluate("tiny.toml", f'id,{ANGLES},remark\n7,30,40,180,"one, two"\n,30,40,180,\n', *SAMPLES).out
        lines = out.splitlines()
        self.assertTrue(lines[1].startswith('7,30,40,180,"one, two",'), out)
        self.assertTrue(lines[2].startswith(",30,40,180,,"), out)

    def test_carried_columns_are_named_once(self):
        result = self.evaluate("tiny.toml", f'"",id,{ANGLES},remark\n1,7,30,40,180,a\n2,8,30,40,180,b\n', *SAMPLES)
        self.assertEqual(result.err.splitlines()[-1], "carried through: id, remark")
        self.assertNotIn("carried", self.evaluate("tiny.toml", f"{ANGLES}\n30,40,180\n", *SAMPLES).err)

    def test_quotes_as_rfc_4180_has_them(self):
        """Python's csv module writes them, and reads what comes out."""
        remarks = ["plain", "one, two", 'five "inches"', "two\nlines", "two\r\nlines", "#hash", " blanks ", "", "ü"]
        text = io.StringIO()
        writer = csv.writer(text, quoting=csv.QUOTE_ALL)
        writer.writerow(["remark", *ANGLES.split(",")])
        writer.writerows([remark, 30, 40, 180] for remark in remarks)
        out = self.evaluate("tiny.toml", text.getvalue(), "--samples", "2").out
        rows = list(csv.reader(io.StringIO(out, newline="")))
        self.assertEqual([row[0] for row in rows], ["remark", *remarks])
        self.assertEqual([len(row) for row in rows], [len(rows[0])] * len(rows))
        plain = self.evaluate("tiny.toml", f"{ANGLES}\n" + "30,40,180\n" * len(remarks), "--samples", "2").out
        self.assertEqual([row[1:] for row in rows], list(csv.reader(io.StringIO(plain))))

    def test_a_file_of_write_csv(self):
        """R puts names into quotes; spreadsheets, blanks around them and a mark in front."""
        plain = self.rows("tiny.toml", f"{ANGLES}\n30,40,180\n", *SAMPLES)
        for text in ('"theta_i_deg","theta_o_deg","phi_deg"\n30,40,180\n', " theta_i_deg , theta_o_deg,\tphi_deg\n 30 ,\t40,180 \n",
                     '"theta_i_deg", "theta_o_deg" ,"phi_deg"\r\n"30", "40" ,"180"\r\n',
                     f"\ufeff{ANGLES}\n30,40,180\n", f"{ANGLES}\r30,40,180\r"):
            with self.subTest(text=text):
                rows = self.rows("tiny.toml", text, *SAMPLES)
                for row in rows:
                    row.update(zip(ANGLES.split(","), ("30", "40", "180")))
                self.assertEqual(rows, plain)

    def test_phi_i_counts_for_albedo(self):
        options = ("--quantity", "albedo", "--estimator", "exact", "--set", "material.roughness=[0.05, 0.4]")
        along, across = self.rows("tiny.toml", "theta_i_deg,phi_i_deg\n70,0\n70,90\n", *options)
        self.assertNotEqual(along["total_r"], across["total_r"])

    def test_columns_may_stand_in_any_order(self):
        one = self.rows("tiny.toml", f"{ANGLES}\n30,40,170\n", *SAMPLES)[0]
        other = self.rows("tiny.toml", "phi_deg,theta_o_deg,theta_i_deg\n170,40,30\n", *SAMPLES)[0]
        self.assertEqual(one, other)

    def test_every_material_key_may_be_a_column(self):
        values = {
            "transmission": ("refract", "refract"),
            "absorption_path": ("sum", "sum"),
            "film_thickness_nm": ("450", "450"),
            "exterior_ior": ("1.1", "1.1"),
            "film_ior": ("1.7", "1.7"),
            "base_ior": ("1.3", "1.3"),
            "absorption_per_nm": ("0.3", "0.3"),
            "pigment_thickness_nm": ("4", "4"),
            "albedo": ("0.2;0.4;0.6", "[0.2, 0.4, 0.6]"),
            "roughness": ("0.25;0.25", "0.25"),
        }
        base = ("--set", "material.base_ior=1.4")  # else refract and straight would agree in less
        plain = self.rows("tiny.toml", f"{ANGLES}\n30,40,180\n", *SAMPLES, *base)[0]
        outputs = OUTPUT_COLUMNS["brdf"][0]
        for key, (cell, setting) in values.items():
            with self.subTest(key=key):
                row = self.rows("tiny.toml", f"{ANGLES},{key}\n30,40,180,{cell}\n", *SAMPLES, *base)[0]
                same = self.rows("tiny.toml", f"{ANGLES}\n30,40,180\n", *SAMPLES, *base,
                                 "--set", f"material.{key}={setting}")[0]
                self.assertEqual([row[c] for c in outputs], [same[c] for c in outputs])
                self.assertNotEqual([row[c] for c in outputs], [plain[c] for c in outputs])

    def test_a_wavelength_makes_a_row_monochromatic(self):
        """The film at 650, 510 and 475 nm is the film's red, green and blue."""
        colour = self.rows("tiny.toml", "theta_i_deg\n35\n", "--quantity", "film")[0]
        single = self.rows("tiny.toml", "theta_i_deg,wavelength_nm\n35,650\n35,510\n35,475\n35,580\n",
                           "--quantity", "film")
        expected = [colour["reflectance" + suffix] for suffix in COLOURS]
        self.assertEqual([row["reflectance"] for row in single[:3]], expected)
        self.assertNotIn(single[3]["reflectance"], expected)

    def test_film_of_no_thickness_is_a_plain_interface(self):
        """Air on index 1.5: 4 % at normal incidence, and tan(56.31 deg) = 1.5 is Brewster's angle."""
        rows = self.rows("tiny.toml", "theta_i_deg\n0\n56.309932474020215\n", "--quantity", "film",
                         "--set", "material.film_thickness_nm=0")
        r_s = (math.cos(math.radians(2 * 56.309932474020215))) ** 2  # sin^2(i - t), with i + t = 90 degrees
        for suffix in COLOURS:
            self.assertAlmostEqual(float(rows[0]["reflectance" + suffix]), 0.04, places=12)
            self.assertAlmostEqual(float(rows[1]["reflectance" + suffix]), r_s / 2, places=12)

    def test_phi_is_counted_from_phi_i(self):
        """Light and viewer may be exchanged: phi_i + phi, and -phi from there."""
        self.write("grooved.toml", support.TINY_RECIPE.replace("roughness = 0.0", "roughness = [0.2, 0.4]"))
        there, back, other = self.rows(
            "grooved.toml", "theta_i_deg,phi_i_deg,theta_o_deg,phi_deg\n30,20,50,70\n50,90,30,-70\n30,60,50,70\n",
            "--estimator", "exact")
        for name in ("first_g", "rest_g"):
            self.assertAlmostEqual(float(there[name]) / float(back[name]), 1, delta=1e-6)
        self.assertGreater(abs(float(there["first_g"]) / float(other["first_g"]) - 1), 0.01)

    def test_smooth_film_is_a_dirac_and_rough_film_is_not(self):
        smooth, rough = self.rows("tiny.toml", f"{ANGLES},roughness\n30,30,180,0\n30,30,180,0.2\n", *SAMPLES)
        self.assertEqual(float(smooth["first_g"]), 0)
        self.assertGreater(float(smooth["dirac_g"]), 0.001)
        self.assertGreater(float(rough["first_g"]), 0.001)
        self.assertEqual(float(rough["dirac_g"]), 0)

    def test_the_exact_estimator_agrees_with_walks(self):
        points = "theta_i_deg,theta_o_deg,phi_deg\n20,50,70\n70,10,180\n"
        exact = self.rows("tiny.toml", points, "--estimator", "exact")
        for estimator in ("pfmc", "bidirectional"):
            walked = self.rows("tiny.toml", points, "--estimator", estimator, "--samples", "5000")
            for a, b in zip(exact, walked):
                for channel in "rgb":
                    self.assertEqual(float(a[f"stderr_{channel}"]), 0)
                    difference = abs(float(a[f"rest_{channel}"]) - float(b[f"rest_{channel}"]))
                    allowed = 5 * float(b[f"stderr_{channel}"]) + 1e-6 * float(a[f"rest_{channel}"])
                    self.assertLessEqual(difference, allowed)  # 1 false alarm in 1e5

    def test_the_bidirectional_estimator_is_named(self):
        result = self.evaluate("tiny.toml", f"{ANGLES}\n20,50,70\n", "--estimator", "bidirectional",
                               "--samples", "50")
        self.assertEqual(result.err, NAMED.format("pfmc-bidirectional"))

    def test_exact_is_the_default_and_is_named(self):
        points = f"{ANGLES}\n20,50,70\n"
        for quantity in ("brdf", "albedo"):
            default = self.evaluate("tiny.toml", points, "--quantity", quantity)
            self.assertEqual(default.err, NAMED.format("exact-quadrature"))
            for name in ("auto", "exact"):
                chosen = self.evaluate("tiny.toml", points, "--quantity", quantity, "--estimator", name)
                self.assertEqual((chosen.out, chosen.err), (default.out, default.err))
        self.assertEqual(self.evaluate("tiny.toml", "theta_i_deg\n20\n", "--quantity", "film").err, "")

    def test_albedo_needs_one_angle_and_conserves_energy(self):
        rows = self.rows("tiny.toml", "theta_i_deg,albedo\n0,1\n45,1\n85,1\n45,0\n", "--quantity", "albedo",
                         *WALKS, "500", "--set", "material.absorption_per_nm=0")
        for row in rows:
            for suffix in COLOURS:
                self.assertGreater(float(row["total" + suffix]), 0)
                self.assertLessEqual(float(row["total" + suffix]), 1 + 5 * float(row["stderr" + suffix]) + 1e-12)

    def test_full_standard_output(self):
        self.write("points.csv", f"{ANGLES}\n30,40,180\n")
        with open("/dev/full", "wb") as full:
            process = subprocess.run([support.BINARY, "eval", "tiny.toml", "--points", "points.csv", *SAMPLES],
                                     cwd=self.folder, stdout=full, stderr=subprocess.PIPE, timeout=support.TIME_LIMIT_S)
        self.assertEqual(process.returncode, 2)
        self.assertEqual(process.stderr, b"sunbeam: error: standard output: cannot write\n")


class Stacks(EvalTest):
    """--quantity film with a column `layers`."""

    def film(self, points, *options):
        return support.rows_of(self.evaluate("tiny.toml", points, "--quantity", "film", *options).out)

    def test_reference_table(self):
        path = support.SOURCE_DIR / "tests/support/reference/layered_films.csv"
        reference = support.rows_of("".join(l for l in path.read_text().splitlines(keepends=True) if l[0] != "#"))
        inputs = list(reference[0])[:6]
        points = "\n".join([",".join(inputs)] + [",".join(row[key] for key in inputs) for row in reference]) + "\n"
        rows = self.film(points)
        self.assertEqual(len(rows), len(reference))
        for row, expected in zip(rows, reference):
            self.assertEqual(list(row), list(expected))
            self.assertAlmostEqual(float(row["reflectance"]), float(expected["reflectance"]), delta=1e-9)
            self.assertAlmostEqual(float(row["transmittance"]) / float(expected["transmittance"]), 1, delta=1e-9)
            self.assertEqual(row["reflectance_below"] == "", expected["reflectance_below"] == "")
            if row["reflectance_below"]:
                self.assertAlmostEqual(float(row["reflectance_below"]), float(expected["reflectance_below"]), delta=1e-9)

    def test_one_layer_is_the_film_of_the_recipe(self):
        """The same number of another formula; what is absent is the recipe's."""
        film = self.film("film_thickness_nm,film_ior,wavelength_nm,theta_i_deg\n300,1.6,510,40\n")[0]
        for layers in ("300/1.6/0", "100/1.6/0;200/1.6/0", " 300/1.6/0"):
            stack = self.film(f"layers,wavelength_nm,theta_i_deg\n{layers},510,40\n")[0]
            self.assertAlmostEqual(float(stack["reflectance"]), float(film["reflectance"]), delta=1e-12)
            self.assertAlmostEqual(float(stack["reflectance"]) + float(stack["transmittance"]), 1, delta=1e-12)

    def test_a_bare_base(self):
        row = self.film("layers,exterior_ior,base_ior,wavelength_nm,theta_i_deg\n,1,1.5,510,0\n")[0]
        self.assertAlmostEqual(float(row["reflectance"]), 0.04, delta=1e-12)

    def test_refusals(self):
        header = "layers,base_ior,base_extinction,wavelength_nm,theta_i_deg"
        for row, needles in (("300/1.6,1.5,0,510,0", ["'layers'", "found '300/1.6'"]), ("300/1.6/0;,1.5,0,510,0", ["found ''"]),
                             ("300/1.6/nan,1.5,0,510,0", ["300/1.6/nan"]), ("-1/1.6/0,1.5,0,510,0", ["-1/1.6/0"]),
                             ("1/0.04/0,1.5,0,510,0", ["1/0.04/0"]), ("1/1.6/-1,1.5,0,510,0", ["1/1.6/-1"]),
                             ("1/1/0,0.04,0,510,0", ["'base_ior'", "0.05"]), ("1/1/0,1.5,-1,510,0", ["'base_extinction'"]),
                             ("1/1/0,1.5,0,510,90", ["'theta_i_deg'"]), ("1/1/0,1.5,0,inf,0", ["'wavelength_nm'"])):
            self.refuse("eval", "tiny.toml", "--points", "-", "--quantity", "film", stdin=f"{header}\n{row}\n",
                        naming=["standard input:2: ", "allowed", *needles])
        for columns, needles in (("layers,theta_i_deg", ["'wavelength_nm' is missing"]),
                                 ("layers,film_ior,wavelength_nm,theta_i_deg", ["'film_ior'", "beside 'layers'"]),
                                 ("layers,transmittance,wavelength_nm,theta_i_deg", ["'transmittance'", "output"])):
            self.refuse("eval", "tiny.toml", "--points", "-", "--quantity", "film", stdin=columns + "\n", naming=needles)
        self.refuse("eval", "tiny.toml", "--points", "-", stdin=f"{header},theta_o_deg,phi_deg\n",
                    naming=["'layers'", "--quantity film"])


class LiveRefusals(EvalTest):
    def refuse_points(self, text, *needles, options=()):
        self.write("points.csv", text)
        with self.subTest(text=text):
            return self.refuse("eval", "tiny.toml", "--points", "points.csv", *options,
                               naming=["points.csv", *needles])

    def test_angles(self):
        for column, name in enumerate(("theta_i_deg", "theta_o_deg", "phi_deg")):
            bad = ["nan", "inf", "-inf", "", "text", "1e999", "0x10", "1 2", "'3'"]
            if name != "phi_deg":
                bad += ["90", "90.0001", "180", "-0.001", "-30"]
            for value in bad:
                cells = ["30", "40", "180"]
                cells[column] = value
                self.refuse_points(f"{ANGLES}\n1,2,3\n{','.join(cells)}\n4,5,6\n", "points.csv:3: ", f"'{name}'",
                                   "allowed: a number")
        self.evaluate("tiny.toml", f"{ANGLES}\n89.999,89.999,-180\n0,0,720\n", *SAMPLES)

    def test_material_columns(self):
        bad = {
            "film_thickness_nm": ("-1", "nan", "inf", "100001", "thick", ""),
            "exterior_ior": ("0.99", "0", "-1", "nan", "6"),
            "film_ior": ("0.99", "0", "-1", "nan", "6"),
            "base_ior": ("0.99", "0", "-1", "nan", "6", "1;2"),
            "absorption_per_nm": ("-0.1", "nan", "1e4"),
            "pigment_thickness_nm": ("-2", "nan", "inf"),
            "albedo": ("1.01", "-0.1", "nan", "0.1;0.2", "0.1;0.2;1.3", "0.1;0.2;0.3;0.4", "red", "0.1;;0.3", ""),
            "roughness": ("1.01", "-0.1", "nan", "0;0.2", "0.1;0.1;0.1", "0.0001", "rough", ""),
            "scattering_per_nm": ("-0.1", "nan", "1e4"),
            "anisotropy": ("1", "-1", "nan"),
            "microfacet": ("both", "", "1"),
            "transmission": ("sideways", "1", "", "Refract"),
            "absorption_path": ("longest", "", "0"),
        }
        for key, values in bad.items():
            for value in values:
                self.refuse_points(f"{key},{ANGLES}\n{value},30,40,180\n", "points.csv:2: ", f"'{key}'",
                                   f"found '{value}'", "allowed")

    def test_wavelengths(self):
        for value in ("0", "-500", "nan", "inf", "", "green", "99", "1e5"):
            self.refuse_points(f"wavelength_nm,{ANGLES}\n{value},30,40,180\n", "points.csv:2: ", "'wavelength_nm'",
                               f"found '{value}'", "allowed")

    def test_a_bad_last_row_prints_nothing_at_all(self):
        good = "30,40,180\n" * 200
        self.refuse_points(f"{ANGLES}\n{good}30,400,180\n", "points.csv:202: ", "'theta_o_deg'")

    def test_line_numbers_count_comments_and_empty_lines(self):
        self.refuse_points(f"# one\n\n{ANGLES}\n# four\n30,40,180\n\n30,nan,180\n", "points.csv:7: ")

    def test_ragged_rows(self):
        for row in ("30,40", "30,40,180,1", "30", "30,40,180,", "30;40;180"):
            self.refuse_points(f"{ANGLES}\n1,2,3\n{row}\n", "points.csv:3: ", "cells", "3")

    def test_missing_header_and_columns(self):
        self.refuse_points("", "header")
        self.refuse_points("\n\n", "header")
        self.refuse_points("# only a remark\n", "header")
        self.refuse_points("30,40,180\n", "'theta_i_deg'", "missing")
        self.refuse_points("theta_i_deg,theta_o_deg\n1,2\n", "'phi_deg'", "missing")
        self.refuse_points("theta_o_deg,phi_deg\n1,2\n", "'theta_i_deg'", "missing")
        self.refuse_points("theta_o_deg\n1\n", "'theta_i_deg'", "missing", options=("--quantity", "albedo"))
        self.refuse_points("theta_o_deg\n1\n", "'theta_i_deg'", "missing", options=("--quantity", "film"))
        self.refuse_points(f"{ANGLES},phi_deg\n1,2,3,4\n", "points.csv:1: ", "twice", "phi_deg")

    def test_columns_named_like_an_output(self):
        for quantity, (colour, single) in OUTPUT_COLUMNS.items():
            for name in colour:
                self.refuse_points(f"{ANGLES},{name}\n1,2,3,4\n", f"'{name}'", "output",
                                   options=("--quantity", quantity))
            for name in single:
                self.refuse_points(f"wavelength_nm,{ANGLES},{name}\n510,1,2,3,4\n", f"'{name}'", "output",
                                   options=("--quantity", quantity))

    def test_columns_that_are_almost_a_key(self):
        for name, key in (("film_thickness", "film_thickness_nm"), ("film_thickness_um", "film_thickness_nm"),
                          ("thickness_nm", "film_thickness_nm"), ("Film thickness (nm)", "film_thickness_nm"),
                          ("filmThicknessNm", "film_thickness_nm"), ("film_thicknes_nm", "film_thickness_nm"),
                          ("Base_IOR", "base_ior"), ("base-ior", "base_ior"), ("absorption", "absorption_per_nm"),
                          ("absorption_per_um", "absorption_per_nm"), ("wavelength", "wavelength_nm"),
                          ("wavelength_um", "wavelength_nm"), ("phi_i", "phi_i_deg"), ("phi_o_deg", "phi_i_deg"),
                          ("phi_i_rad", "phi_i_deg"), ("ALBEDO", "albedo"), ("roughnes", "roughness")):
            self.refuse_points(f"{ANGLES},{name}\n30,40,180,1\n", "points.csv", f"'{name}'", f"'{key}'", "allowed")
        for name in ("Theta_I_deg", "theta_i", "theta_i_rad", "thetai_deg"):
            self.refuse_points(f"{name},theta_o_deg,phi_deg\n30,40,180\n", f"'{name}'", "'theta_i_deg'", "allowed")

    def test_quotes_that_are_not_of_rfc_4180(self):
        self.refuse_points(f'{ANGLES},remark\n30,40,180,"a\nb\n', "points.csv:2: ", "not closed")
        self.refuse_points(f'{ANGLES},remark\n30,40,180,"a\nb"\n30,40,180,a"b\n', "points.csv:4: ", "not in quotes")
        self.refuse_points(f'{ANGLES},remark\n30,40,180,"a"b\n', "points.csv:2: ", "closing quote", "allowed")

    def test_other_separators(self):
        self.refuse_points("theta_i_deg;theta_o_deg;phi_deg\n30;40;180\n", "points.csv:1: ", "';'", "allowed: ','")
        self.refuse_points("theta_i_deg\ttheta_o_deg\tphi_deg\n30\t40\t180\n", "points.csv:1: ", "tabs", "allowed: ','")

    def test_utf_16(self):
        self.refuse_points(f"{ANGLES}\n30,40,180\n".encode("utf-16"), "points.csv: ", "UTF-16", "allowed: UTF-8")

    def test_binary_files(self):
        self.refuse_points(bytes(range(1, 256)) * 20)

    def test_missing_file_and_folder(self):
        (self.folder / "folder").mkdir()
        for name, needle in (("missing.csv", "No such file"), ("folder", "folder")):
            with self.subTest(name=name):
                self.refuse("eval", "tiny.toml", "--points", name, naming=[f"{name}: cannot read", needle])

    def test_errors_in_standard_input_say_so(self):
        self.refuse("eval", "tiny.toml", "--points", "-", stdin=f"{ANGLES}\n1,2\n", naming=["standard input:2: "])

    def test_bad_overrides(self):
        self.refuse("eval", "tiny.toml", "--points", "-", "--set", "material.albedo=2",
                    stdin=f"{ANGLES}\n1,2,3\n", naming=["material.albedo", "found 2"])


class OfTable(EvalTest):
    @classmethod
    def prepare(cls):
        support.succeed_in(cls.folder, "bake", "tiny.toml", "-o", "tiny.exr")

    def test_columns_and_digits(self):
        self.check_columns_and_digits("tiny.exr")

    def test_wavelengths_select_the_channel(self):
        colour = self.rows("tiny.exr", f"{ANGLES}\n30,40,180\n")[0]
        single = self.rows("tiny.exr",
                           f"{ANGLES},wavelength_nm\n30,40,180,650\n30,40,180,510\n30,40,180,475\n")
        for row, suffix in zip(single, COLOURS, strict=True):
            for name in ("first", "rest", "stderr", "dirac"):
                self.assertEqual(row[name], colour[name + suffix])
            self.assertEqual(row["pdf"], colour["pdf"])

    def test_other_wavelengths_are_refused(self):
        for value in ("649", "580", "0"):
            with self.subTest(wavelength=value):
                self.refuse("eval", "tiny.exr", "--points", "-", stdin=f"{ANGLES},wavelength_nm\n1,2,3,{value}\n",
                            naming=["standard input:2: ", "'wavelength_nm'", value])

    def test_parameters_inside_the_grid(self):
        points = f"{ANGLES},film_thickness_nm,base_ior,absorption_per_nm\n30,30,180,200,1.5,0\n30,30,180,400,1.5,0.2\n"
        thin, thick = self.rows("tiny.exr", points)
        self.assertNotEqual(thin["dirac_r"], thick["dirac_r"])
        self.assertGreater(float(thin["rest_r"]), float(thick["rest_r"]), "absorption darkens")

    def test_without_columns_the_values_of_the_recipe_hold(self):
        plain = self.rows("tiny.exr", f"{ANGLES}\n30,40,180\n")[0]
        named = self.rows("tiny.exr",
                          f"{ANGLES},film_thickness_nm,base_ior,absorption_per_nm\n30,40,180,300,1.5,0.1\n")[0]
        for column in OUTPUT_COLUMNS["brdf"][0]:
            self.assertEqual(named[column], plain[column])

    def test_parameters_outside_the_grid_are_refused(self):
        for key, value, low, high in (("film_thickness_nm", "199.9", "200", "400"),
                                      ("film_thickness_nm", "401", "200", "400"),
                                      ("base_ior", "1.51", "1.5", "1.5"),
                                      ("absorption_per_nm", "0.21", "0", "0.2")):
            with self.subTest(key=key, value=value):
                self.refuse("eval", "tiny.exr", "--points", "-", stdin=f"{ANGLES},{key}\n1,2,3,4\n".replace("4", value),
                            naming=["standard input:2: ", f"'{key}'", value, f"{low} to {high}"])

    def test_fixed_keys_are_refused(self):
        for key, value in (("film_ior", "1.56"), ("exterior_ior", "1"), ("roughness", "0"), ("albedo", "0.1"),
                           ("transmission", "straight"), ("absorption_path", "product"),
                           ("pigment_thickness_nm", "2")):
            with self.subTest(key=key):
                self.refuse("eval", "tiny.exr", "--points", "-", stdin=f"{ANGLES},{key}\n1,2,3,{value}\n",
                            naming=[f"'{key}'", "film_thickness_nm, base_ior, absorption_per_nm"])

    def test_overrides_are_refused(self):
        self.refuse("eval", "tiny.exr", "--points", "-", "--set", "material.albedo=0.5",
                    stdin=f"{ANGLES}\n1,2,3\n", naming=["tiny.exr", "--set"])

    def test_bad_rows_are_refused(self):
        for row in ("90,0,0", "nan,0,0", "0,0", "x,0,0"):
            with self.subTest(row=row):
                self.refuse("eval", "tiny.exr", "--points", "-", stdin=f"{ANGLES}\n1,2,3\n{row}\n",
                            naming=["standard input:3: "])

    def test_agrees_with_the_live_model(self):
        """At a node of the grid: the closed forms to interpolation error, the rest to noise."""
        points = f"{ANGLES},film_thickness_nm,absorption_per_nm\n" + "".join(
            f"{i},{o},180,{d},{a}\n" for i in (0, 40) for o in (10, 60) for d in (200, 400) for a in (0, 0.2))
        table = self.rows("tiny.exr", points)
        live = self.rows("tiny.toml", points, "--samples", "2000")
        for t, l in zip(table, live, strict=True):
            for suffix in COLOURS:
                self.assertAlmostEqual(float(t["dirac" + suffix]), float(l["dirac" + suffix]), delta=1e-3)
                self.assertAlmostEqual(float(t["rest" + suffix]) / float(l["rest" + suffix]), 1, delta=0.05)
        albedo = [self.rows(source, "theta_i_deg\n40\n", "--quantity", "albedo", "--samples", "5000")[0]
                  for source in ("tiny.exr", "tiny.toml")]
        for suffix in COLOURS:
            self.assertAlmostEqual(float(albedo[0]["total" + suffix]), float(albedo[1]["total" + suffix]), delta=5e-3)
            self.assertEqual(float(albedo[0]["stderr" + suffix]), 0)


if __name__ == "__main__":
    unittest.main()
