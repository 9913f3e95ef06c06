"""film_tables.py SUNBEAM [--points N] [--only WORD ...] [--rows JSON]: errors and sizes of the default recipe's table
over every kind of film, into measured/performance.md.

Each table is baked and held against the exact evaluator; --only takes rows whose name holds all words. Rows that the
JSON file holds already are not measured again.
"""

import argparse
import itertools
import json
import pathlib
import re
import subprocess
import tempfile

DOCS = pathlib.Path(__file__).resolve().parent
RECIPE = DOCS.parent / "tables" / "recipes" / "sunbeam.toml"

# name: roughness, and other keys
SURFACES = {"smooth": "0", "rough 0.1": "0.1", "rough 0.3": "0.3", "rough (0.1, 0.3)": "[0.1, 0.3]"}
NUMBER = r"([-+.\de]+)"
WORST = re.compile(r"worst points:.*\n" + rf"\s+{NUMBER}" * 6)


def kinds():
    for surface, transmission, path, mode in itertools.product(SURFACES, ("straight", "refract"), ("sum", "product"),
                                                               ("rgb3", "full")):
        is_anisotropic = "(" in surface
        if not is_anisotropic or (transmission, mode) == ("refract", "full"):
            yield surface, transmission, path, mode


def overrides(surface, transmission, path, mode):
    # The bake's own check is short where the tolerance is wide; the one that counts comes after it.
    keys = {"material.roughness": SURFACES[surface], "material.transmission": transmission,
            "material.absorption_path": path, "spectrum.mode": mode, "table.encoding": "factored",
            "accuracy.tolerance_median": "1", "accuracy.tolerance_p99": "1",
            "accuracy.noise": "0.0003"}  # the default of the recipe's own tolerances
    return [word for key, value in keys.items() for word in ("--set", f"{key}={value}")]


def measure(sunbeam, kind, points, folder):
    table, report = pathlib.Path(folder) / "t.exr", pathlib.Path(folder) / "t.json"
    subprocess.run([sunbeam, "bake", RECIPE, "-o", table, *overrides(*kind)], check=True, capture_output=True)
    out = subprocess.run([sunbeam, "verify", table, "--truth", "exact", "--points", str(points), "--json", report],
                         check=True, capture_output=True, text=True).stdout
    figures = json.loads(report.read_text())
    thickness, ior, absorption, theta = (float(WORST.search(out)[k]) for k in range(1, 5))
    return {**figures, "bytes": table.stat().st_size, "film_thickness_nm": thickness, "base_ior": ior,
            "absorption_per_nm": absorption, "theta_i_deg": theta}


def row_of(name, row):
    def percent(key):
        return f"{100 * row[key]:.2g} %"

    at = (f"{row['film_thickness_nm']:.0f} nm, {row['base_ior']:.3f}, {row['absorption_per_nm']:.3f} / nm, "
          f"{row['theta_i_deg']:.0f}°")
    return (f"| {name} | {percent('error_median')} | {percent('error_p99')} | {percent('error_max')} | {at} | "
            f"{row['bytes'] / 1000:.0f} kB | {row['points']} |")


def write_docs(rows):
    head = ["| film, transmission, path, spectrum | median | p99 | max | where: film, base IOR, absorption, angle | file | points |",
            "|---|---|---|---|---|---|---|"]
    page = DOCS / "measured" / "performance.md"
    block = "\n".join(head + [row_of(name, row) for name, row in rows.items()])
    text, count = re.subn(r"(<!-- films -->\n).*?(\n<!-- end of films -->)", lambda m: m[1] + block + m[2],
                          page.read_text(), flags=re.S)
    if count != 1:
        raise SystemExit(f"{page}: found {count} places for the table of films; needs 1")
    page.write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sunbeam")
    parser.add_argument("--points", type=int, default=1000)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--rows", type=pathlib.Path, default=pathlib.Path("films.json"))
    options = parser.parse_args()
    rows = json.loads(options.rows.read_text()) if options.rows.exists() else {}
    for kind in kinds():
        name = ", ".join(kind)
        if name in rows or not all(word in name for word in options.only):
            continue
        with tempfile.TemporaryDirectory() as folder:
            rows[name] = measure(options.sunbeam, kind, options.points, folder)
        print(row_of(name, rows[name]), flush=True)
        options.rows.write_text(json.dumps(rows, indent=1))
    write_docs({", ".join(kind): rows[", ".join(kind)] for kind in kinds() if ", ".join(kind) in rows})


if __name__ == "__main__":
    main()
