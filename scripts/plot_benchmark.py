#!/usr/bin/python3
"""Pictures of a speed-against-error run: reads the CSV files that tissue_contact_benchmark wrote into a folder.

usage: plot_benchmark.py FOLDER
Per scene <scene>.png: time per step against solver error (left) and against total error (right). Colour: solver and
relaxation; marker: mesh and step; the line joins the Pareto front; ring: the shipped settings; star: a peer.
growth.png: time and error of the shipped solver over the nodes of press and drag.
"""
import csv
import math
import os
import sys

if sys.argv[1:2] in (["--help"], ["-h"]):
    print(__doc__)
    sys.exit(0)
try:
    import matplotlib
except ImportError:
    sys.exit("plot_benchmark.py: matplotlib is missing; on Debian: apt-get install python3-matplotlib")
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from whole_file import whole_file  # noqa: E402

SCENES = ["press-drag", "grasp", "partial-slip", "robot", "robot-sweep"]
TITLES = {
    "press-drag": "Press and drag",
    "grasp": "Grasp with PSM jaws",
    "partial-slip": "Partial slip under a sphere",
    "robot": "Recorded dVRK PSM touches a pad",
    "robot-sweep": "Recorded dVRK PSM sweeps through a slab",
}
# Colour-blind safe (Okabe and Ito), ours in the strong ones.
COLOURS = {
    "predictor_corrector gauss_seidel": "#0072B2",
    "predictor_corrector cholesky": "#D55E00",
    "reference": "#000000",
    "cone4": "#56B4E9",
    "polyhedral": "#009E73",
    "impulse": "#CC79A7",
    "condensed_lcp": "#999999",
    "bullet": "#E69F00",
    "bullet_undamped": "#F0E442",
}
NAMES = {
    "predictor_corrector gauss_seidel": "predictor\u2013corrector, Gauss\u2013Seidel",
    "predictor_corrector cholesky": "predictor\u2013corrector, Cholesky",
    "reference": "reference (Newton)",
    "cone4": "4-sided cone",
    "polyhedral": "polyhedral cone",
    "impulse": "friction impulses",
    "condensed_lcp": "condensed LCP",
    "bullet": "Bullet (deformable)",
    "bullet_undamped": "Bullet, tissue undamped",
}
PEERS = ("bullet", "bullet_undamped")
MARKERS = ["s", "^", "D", "v", "P", "X", "<", ">"]
SMALLEST = 1e-6  # solver errors below are drawn here: the reference against itself


def number(text):
    return float(text) if text else math.nan


def read(file):
    rows = []
    with open(file, newline="", encoding="utf-8") as stream:
        for line in csv.DictReader(stream):
            row = dict(line)
            for key in line:
                if key not in ("scene", "method", "relaxation", "error_of"):
                    row[key] = number(line[key])
            kind = row["method"]
            if kind == "predictor_corrector":
                kind += " " + row["relaxation"]
            row["kind"] = kind
            rows.append(row)
    return rows


def size_name(row):
    if row["refined_cell_m"] > 0:  # its nodes are as many as it needs, and other ones in each run
        return "cells of %.2g mm follow, %g ms" % (1e3 * row["refined_cell_m"], 1e3 * row["dt_s"])
    return "%d nodes, %g ms" % (row["nodes"], 1e3 * row["dt_s"])


def pareto(rows, error):
    front = []
    for row in sorted((r for r in rows if not math.isnan(r[error])), key=lambda r: (r["median_ms"], r[error])):
        if not front or row[error] < front[-1][error]:
            front.append(row)
    return front


def draw(axes, rows, error, markers):
    """Points with a faint line up to p99; the Pareto front of those at the shipped mesh and step, or of all."""
    for row in rows:
        value = max(row[error], SMALLEST)
        if math.isnan(row[error]):
            continue
        colour = COLOURS[row["kind"]]
        is_peer = row["kind"] in PEERS
        marker = "*" if is_peer else markers[size_name(row)]
        axes.plot([100 * value] * 2, [row["median_ms"], row["p99_ms"]], color=colour, alpha=0.18, linewidth=1, zorder=1)
        axes.plot(100 * value, row["median_ms"], marker=marker, color=colour, markersize=14 if is_peer else 6,
                  markeredgecolor="black" if is_peer else "white", markeredgewidth=0.6, linestyle="none", zorder=3)
    candidates = [r for r in rows if r["kind"] not in PEERS and (error != "solver_error" or r["at_shipped_size"])]
    front = pareto(candidates, error)
    axes.plot([100 * max(r[error], SMALLEST) for r in front], [r["median_ms"] for r in front], color="black",
              linewidth=1.2, alpha=0.7, zorder=2)
    for row in rows:
        if row["shipped"] and not math.isnan(row[error]):
            axes.plot(100 * max(row[error], SMALLEST), row["median_ms"], marker="o", markersize=15, color="none",
                      markeredgecolor="#CC0000", markeredgewidth=2, zorder=4)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.grid(True, which="major", alpha=0.3)
    axes.grid(True, which="minor", alpha=0.08)


def plain(axis):
    """Numbers without powers; over less than a decade and a half also between the powers of ten."""
    low, high = axis.get_view_interval()
    name = matplotlib.ticker.FuncFormatter(lambda v, _: "%g" % v)
    axis.set_major_formatter(name)
    axis.set_minor_formatter(name if high < 30 * low else matplotlib.ticker.NullFormatter())
    if high < 30 * low:
        axis.set_minor_locator(matplotlib.ticker.LogLocator(subs=(2, 3, 5)))


def legend(figure, rows, markers):
    handles = []
    for kind in COLOURS:
        if any(r["kind"] == kind for r in rows):
            marker = "*" if kind in PEERS else "o"
            handles.append(plt.Line2D([], [], color=COLOURS[kind], marker=marker, linestyle="none", markersize=9,
                                      label=NAMES[kind]))
    for size, marker in markers.items():
        handles.append(plt.Line2D([], [], color="#555555", marker=marker, linestyle="none", markersize=7, label=size))
    handles.append(plt.Line2D([], [], marker="o", markersize=12, color="none", markeredgecolor="#CC0000",
                              markeredgewidth=2, label="shipped settings"))
    handles.append(plt.Line2D([], [], color="black", linewidth=1.2, label="Pareto front"))
    handles.append(plt.Line2D([], [], color="#555555", alpha=0.4, linewidth=1, label="median to p99"))
    figure.legend(handles=handles, loc="lower center", ncol=4, fontsize=9, frameon=False)
    return math.ceil(len(handles) / 4)


def plot_scene(rows, folder, scene):
    shipped_first = sorted({size_name(r): (not r["at_shipped_size"], r["nodes"], r["dt_s"])
                            for r in rows if r["kind"] not in PEERS}.items(), key=lambda item: item[1])
    markers = {}
    for k, (name, _) in enumerate(shipped_first):
        markers[name] = "o" if k == 0 else MARKERS[(k - 1) % len(MARKERS)]
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 6.4), sharey=True)
    draw(left, rows, "solver_error", markers)
    draw(right, rows, "total_error", markers)
    truth_error = rows[0]["truth_error"]
    if truth_error > 0:
        low = right.get_xlim()[0]
        if 100 * truth_error > low:
            right.axvspan(low, 100 * truth_error, color="#888888", alpha=0.12, linewidth=0)
            right.text(100 * truth_error, right.get_ylim()[1], "the truth's own error ", rotation=90, fontsize=8,
                       va="top", ha="right", color="#555555")
            right.set_xlim(left=low)
    left.set_ylabel("wall time per step, ms")
    of = rows[0]["error_of"]
    left.set_xlabel("solver error of the %s, %% RMS\n(same mesh and step, solved to convergence)" % of)
    right.set_xlabel("total error of the %s, %% RMS\n(stored truth, or finer mesh)" % of)
    for axis in (left.xaxis, right.xaxis, left.yaxis):
        plain(axis)
    figure.suptitle("%s: %g nodes, %g ms steps as shipped; one core" % (
        TITLES.get(scene, scene), next(r["nodes"] for r in rows if r["shipped"]),
        1e3 * next(r["dt_s"] for r in rows if r["shipped"])), fontsize=12)
    lines = legend(figure, rows, markers)
    figure.tight_layout(rect=(0, 0.035 * lines + 0.02, 1, 1))
    save(figure, os.path.join(folder, scene + ".png"))


def save(figure, file):
    try:
        with whole_file(file) as part:
            figure.savefig(part, dpi=100)
    except OSError as error:
        sys.exit("plot_benchmark.py: cannot write %s: %s" % (file, error.strerror))
    plt.close(figure)


def plot_growth(rows, folder):
    shipped = next(r for r in rows if r["shipped"])
    grown = sorted((r for r in rows if r["shipped_solver"] and r["dt_s"] == shipped["dt_s"] and not r["refined_cell_m"] > 0), key=lambda r: r["nodes"])
    if len(grown) < 2:
        return False
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6))
    nodes = [r["nodes"] for r in grown]
    left.plot(nodes, [r["median_ms"] for r in grown], "o-", color="#0072B2", label="median")
    left.plot(nodes, [r["p99_ms"] for r in grown], "o:", color="#0072B2", alpha=0.5, label="p99")
    first = grown[0]
    left.plot(nodes, [first["median_ms"] * n / first["nodes"] for n in nodes], color="#888888", linewidth=1,
              label="proportional to nodes")
    right.plot(nodes, [100 * r["total_error"] for r in grown], "s-", color="#D55E00", label="total error")
    right.plot(nodes, [100 * r["solver_error"] for r in grown], "o-", color="#0072B2", label="solver error")
    for kind in PEERS:
        peers = sorted((r for r in rows if r["kind"] == kind and r["dt_s"] == shipped["dt_s"]), key=lambda r: r["nodes"])
        if peers:
            style = {"color": COLOURS[kind], "markersize": 13, "markeredgecolor": "black", "markeredgewidth": 0.6}
            left.plot([r["nodes"] for r in peers], [r["median_ms"] for r in peers], "*--", label=NAMES[kind], **style)
            right.plot([r["nodes"] for r in peers], [100 * r["total_error"] for r in peers], "*--",
                       label=NAMES[kind] + ", total error", **style)
    for axes, what in ((left, "wall time per step, ms"), (right, "error of the %s, %% RMS" % shipped["error_of"])):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel("nodes")
        axes.set_ylabel(what)
        axes.set_xticks(nodes)
        axes.set_xticklabels(["%d" % n for n in nodes])
        axes.xaxis.set_minor_locator(matplotlib.ticker.NullLocator())
        axes.grid(True, alpha=0.3)
        axes.legend(fontsize=9)
        plain(axes.yaxis)
    figure.suptitle("Press and drag, shipped solver, %g ms steps, one core" % (1e3 * shipped["dt_s"]), fontsize=12)
    figure.tight_layout()
    save(figure, os.path.join(folder, "growth.png"))
    return True


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = sys.argv[1]
    made = []
    for scene in SCENES:
        file = os.path.join(folder, scene + ".csv")
        if not os.path.exists(file):
            continue
        rows = read(file)
        plot_scene(rows, folder, scene)
        made.append(scene + ".png")
        if scene == "press-drag" and plot_growth(rows, folder):
            made.append("growth.png")
    if not made:
        sys.exit("plot_benchmark.py: no table of tissue_contact_benchmark in '%s'" % folder)
    print("pictures: " + ", ".join(os.path.join(folder, name) for name in made))


if __name__ == "__main__":
    main()
