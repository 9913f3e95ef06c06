"""plot_tables.py JSON: figures/tables.svg and the figures in measured/performance.md from what bench_tables --json wrote."""

import html
import json
import math
import pathlib
import sys

DOCS = pathlib.Path(__file__).resolve().parent

WIDTH, HEIGHT = 760, 480
LEFT, RIGHT, TOP, BOTTOM = 80, 40, 20, 60
LABEL_WIDTH, LABEL_HEIGHT = 45, 13

# family: colour, side of the marker that labels stand on
FAMILIES = {
    "sunbeam": ("#0b6e4f", "right"),
    "uniform f": ("#c1440e", "right"),
    "uniform f cos cos": ("#8a63b5", "left"),
    "MERL": ("#333333", "left"),
}


class LogAxis:
    """Decades around all values, spread over [start, end] pixels."""

    def __init__(self, values, start, end):
        self.low = math.floor(math.log10(min(values)))
        self.high = math.ceil(math.log10(max(values)))
        self.start, self.end = start, end

    def __call__(self, value):
        return self.start + (math.log10(value) - self.low) / (self.high - self.low) * (self.end - self.start)

    def decades(self):
        return [10.0 ** k for k in range(self.low, self.high + 1)]


def bytes_text(count):
    for unit in ("B", "kB", "MB", "GB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} TB"


def percent_text(share):
    return f"{100 * share:.2g} %" if share < 1 else f"{100 * share:.0f} %"


def text(x, y, content, anchor="middle", extra=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" {extra}>{html.escape(content)}</text>'


def line(x1, y1, x2, y2, stroke):
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{stroke}"/>'


def frame(x, y):
    parts = [line(x(d), y.start, x(d), y.end, "#ddd") for d in x.decades()]
    parts += [line(x.start, y(d), x.end, y(d), "#ddd") for d in y.decades()]
    parts += [text(x(d), y.start + 18, bytes_text(d)) for d in x.decades()]
    parts += [text(x.start - 8, y(d) + 4, f"{100 * d:g} %", "end") for d in y.decades()]
    middle = (y.start + y.end) / 2
    parts.append(text((x.start + x.end) / 2, HEIGHT - 14, "size of the table"))
    parts.append(text(18, middle, "error: median (marker) to p99 (line)", extra=f'transform="rotate(-90 18 {middle})"'))
    return parts


def free_height(place, taken):
    """The height of `place`, or the next further down the page that no label nearby has taken."""
    px, height = place
    for other_x, other_height in sorted(taken, key=lambda other: other[1]):
        if abs(px - other_x) < LABEL_WIDTH and abs(height - other_height) < LABEL_HEIGHT:
            height = other_height + LABEL_HEIGHT
    return height


def series(rows, colour, side, x, y):
    parts, labels = [], []
    for row in sorted(rows, key=lambda row: y(row["error_median"])):
        px, py = x(row["bytes"]), y(row["error_median"])
        labels.append((px, free_height((px, py), labels)))
        parts.append(line(px, py, px, y(row["error_p99"]), colour))
        parts.append(f'<circle cx="{px:.1f}" cy="{py:.1f}" r="4.5" fill="{colour}"/>')
        offset, anchor = (9, "start") if side == "right" else (-9, "end")
        parts.append(text(px + offset, labels[-1][1] + 4, f"{row['eval_ns']:.0f} ns", anchor, f'fill="{colour}"'))
    return parts


def legend(x, y):
    return [text(x.end - 8, y.end + 18 + 16 * k, name, "end", f'fill="{colour}" font-weight="bold"')
            for k, (name, (colour, _)) in enumerate(FAMILIES.items())]


def plot(rows):
    x = LogAxis([row["bytes"] for row in rows], LEFT, WIDTH - RIGHT)
    y = LogAxis([row[key] for row in rows for key in ("error_median", "error_p99")], HEIGHT - BOTTOM, TOP)
    parts = frame(x, y)
    for family, (colour, side) in FAMILIES.items():
        parts += series([row for row in rows if row["family"] == family], colour, side, x, y)
    head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" '
            f'height="{HEIGHT}" font-family="sans-serif" font-size="12">')
    return "\n".join([head, f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>', *parts, *legend(x, y), "</svg>\n"])


def table_of(report):
    lines = ["| table | bytes | error, median | error, p99 | eval, ns | eval / yardstick |", "|---|---|---|---|---|---|"]
    for row in report["tables"]:
        lines.append(f"| {row['name']} | {row['bytes']} | {percent_text(row['error_median'])} | "
                     f"{percent_text(row['error_p99'])} | {row['eval_ns']:.0f} | {row['eval_ratio']:.1f} |")
    return "\n".join(lines)


def sample_text(sample):
    worst = sample["worst_material"]
    return (f"Over {sample['materials']} materials, {sample['draws']} draws each at {sample['theta_o_deg']:g} degrees: mean "
            f"{sample['deviation_mean']:.3f}, worst {sample['deviation_worst']:.3f} (film {worst['film_thickness_nm']:.0f} nm, "
            f"base IOR {worst['base_ior']:.2f}, absorption {worst['absorption_per_nm']:.2f} / nm).")


def replace_between(page, name, content):
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    head, rest = page.split(begin)
    return head + begin + content + "\n" + end + rest.split(end)[1]


def main():
    report = json.loads(pathlib.Path(sys.argv[1]).read_text())
    (DOCS / "figures" / "tables.svg").write_text(plot(report["tables"]))
    page = (DOCS / "measured" / "performance.md").read_text()
    page = replace_between(page, "tables", table_of(report))
    page = replace_between(page, "yardstick",
                           f"It took {report['yardstick_ns']:.1f} ns here, conversions by {report['half_conversion']}.")
    page = replace_between(page, "sample", sample_text(report["sample"]))
    (DOCS / "measured" / "performance.md").write_text(page)


main()
