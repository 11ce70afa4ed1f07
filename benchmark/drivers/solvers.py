#!/usr/bin/python3
"""Builds and runs random_problems, writes its table into doc/solvers.md and its picture to doc/cone4_error.png.

usage: benchmark/drivers/solvers.py [--most N]    N: problems of each size (default 1000: about half an hour on one core)
Needs python3-matplotlib.
"""
import csv
import io
import pathlib
import re
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CURVES = {
    "fixed4": ("4 sides, fixed axes", "tab:red", "-"),
    "fixed8": ("8 sides, fixed axes", "tab:orange", "-"),
    "compacted4": ("4 sides compacted along the last sliding, turning 5° per step", "tab:blue", "--"),
    "predictor_corrector": ("predictor–corrector", "black", "-"),
}
PANELS = [
    ("direction_error_deg", "sliding: direction error of friction, °", "angle of sliding from $t_1$, °"),
    ("drag_error_percent", "sliding: error of drag, %", "angle of sliding from $t_1$, °"),
    ("held_error_percent", "at rest: error of the largest load held, %", "angle of the load from $t_1$, °"),
]


def program():
    build = subprocess.run([ROOT / "scripts/build", "--where"], check=True, capture_output=True, text=True).stdout.strip()
    subprocess.run([ROOT / "scripts/build"], check=True, stdout=sys.stderr)
    target = "random_problems"
    subprocess.run(["cmake", "--build", build, "--target", target], check=True, stdout=sys.stderr)
    return pathlib.Path(build) / "benchmark" / "drivers" / "random_problems"


def plot(rows):
    figure, axes = plt.subplots(1, 3, figsize=(13, 4.6))
    for axis, (column, title, label) in zip(axes, PANELS):
        for name, (text, color, style) in CURVES.items():
            points = [(float(row["angle_deg"]), float(row[column])) for row in rows if row["cone"] == name]
            axis.plot(*zip(*points), style, color=color, label=text)
        axis.set(title=title, xlabel=label, xlim=(0, 90), xticks=range(0, 91, 15))
        axis.grid(alpha=0.3)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="lower center", ncol=2, frameon=False)
    figure.tight_layout(rect=(0, 0.12, 1, 1))
    figure.savefig(ROOT / "doc/cone4_error.png", dpi=110)


def main():
    executable = program()
    cones = subprocess.run([executable, "cone"], check=True, capture_output=True, text=True).stdout
    plot(list(csv.DictReader(io.StringIO(cones))))
    table = subprocess.run([executable, "table", *sys.argv[1:]], check=True, stdout=subprocess.PIPE, text=True).stdout
    page = ROOT / "doc/solvers.md"
    text = page.read_text(encoding="utf-8")
    begin, end = "<!-- table: benchmark/drivers/solvers.py -->\n", "<!-- end of table -->"
    changed = re.sub(re.escape(begin) + ".*?" + re.escape(end), lambda _: begin + table + end, text, flags=re.DOTALL)
    page.write_text(changed, encoding="utf-8")


if __name__ == "__main__":
    main()
