#!/usr/bin/python3
"""Makes the tables of doc/performance.md anew: what an implicit step costs, before and after, in turn on one processor, each the
median of seven runs. They are its section "The tables"; all else on that page is written by hand and stays.

usage, after scripts/build and `make -C "$(scripts/build --where)" step_costs memory`:
    scripts/make_performance_doc.py --before DIR [--before-name NAME] [--no-counts]
  --before DIR        build directory of an older checkout. Has it no step_costs, that of the first commit with one serves (567058a: put
                      benchmark/drivers/step_costs.cpp there and make it): programs and libraries of two states do not mix
  --before-name NAME  what to call it (default: its directory)
  --no-counts         without instruction counts (valgrind), which take most of the time
Needs gmsh (and valgrind). Some minutes.
"""
import argparse
import csv
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile

from whole_file import whole_file

PACKAGE = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
DOC = os.path.join(PACKAGE, "doc", "performance.md")
# name, mesh (cells, or h of refined_block.geo), arguments, wanted: median / p99, ms, and solver error. Each tolerance is the loosest of
# 1e-1, 7e-2, 5e-2, 3e-2, 2.5e-2, 2e-2 ... with which that error is kept; caps of three to thirty iterations add little to it, and
# take the slowest steps down.
NEARLY_INCOMPRESSIBLE = ["--youngs-modulus", "20000", "--poissons-ratio", "0.49", "--drag", "0.005"]
ROWS = [
    ("uniform", "10,10,4", ["--tolerance", "3e-2"], ".10 / .15", "1 %"),
    ("uniform", "20,20,6", ["--tolerance", "5e-2", "--drag", "0.001"], ".6 / .9", "1 %"),
    ("uniform", "35,35,10", ["--tolerance", "5e-2", "--iterations", "3", "--drag", "0.001"], "3 / 4.5", "1 %"),
    ("uniform", "10,10,4", ["--tolerance", "1e-3", "--iterations", "8"], ".15 / .22", ".1 %"),
    ("uniform", "20,20,6", ["--tolerance", "2e-3", "--iterations", "8", "--drag", "0.001"], "1 / 1.5", ".1 %"),
    ("uniform", "35,35,10", ["--tolerance", "2e-3", "--iterations", "8", "--drag", "0.001"], "6 / 9", ".1 %"),
    ("refined", "0.0014", ["--tolerance", "3e-2"], ".3 / .45", ".5 %"),
    ("refined", "0.001", ["--tolerance", "2e-2"], ".5 / .75", ".5 %"),
    ("ν .49, E 20 kPa, dt 5 ms", "20,20,6", NEARLY_INCOMPRESSIBLE + ["--step", "0.005", "--tolerance", "2e-2"],
     "3 / 4.5", "1 %"),
    ("ν .49, E 20 kPa, dt 10 ms", "20,20,6", NEARLY_INCOMPRESSIBLE + ["--step", "0.01", "--tolerance", "1.5e-2"],
     "3 / 4.5", "1 %"),
    ("uniform, Cholesky", "10,10,4", ["--tolerance", "1e-3", "--relaxation", "cholesky"], "- / no factor spike", "1 %"),
]
ROUNDS = 7
CONVERGED = {"--tolerance": "1e-7", "--iterations": "300", "--relaxation": "gauss_seidel"}
GROWTH = ["10,10,4", "20,20,6", "35,35,10", "54,54,16", "69,69,20"]
GROWTH_ARGUMENTS = ["--tolerance", "3e-2", "--drag", "0.0002"]
COUNTED = [("605 uniform, 1e-3", "10,10,4"), ("refined, h 1.4 mm, 1e-3", "0.0014")]
COUNTED_DRAG = 0.0005
COUNTED_STEPS = round((0.0041 + COUNTED_DRAG) / 2e-5)
PARTS = [
    ("sweeps", r"sweepForth|sweepBack|runForth|runBack|runRelax|runCarry|runLowerProduct|BodySweep|Deflation|GaussSeidelRelaxation::relax"),
    ("elastic forces", r"addCorotationalForces"),
    ("forces of patches", r"addPatchForces"),
    ("refreshing the stiffness", r"::addStiffness|addGradients|shapeGradients|refreshStiffness"),
    ("residuals", r"bodyDefect|offDiagonalProduct|computeResiduals"),
    ("surface tree, detection", r"TriangleTree|MovingSurface|detect|NarrowPhase|projectOnTriangle"),
]


SECTION = "## The tables"


def with_tables(page, tables):
    """`page` with that section made of `tables` (lines); what stands before and behind it stays."""
    found = re.fullmatch(r"(.*^%s\n).*?(^## .*)" % SECTION, page, re.M | re.S)
    if not found:
        sys.exit("make_performance_doc.py: %s has no section \"%s\" with another behind it" % (DOC, SECTION))
    return found[1] + "\n" + "\n".join(tables) + "\n\n" + found[2]


def checked(command, code, output, errors):
    """The output, or the end with what the program said."""
    if code != 0:
        sys.exit("make_performance_doc.py: %s: exit code %d:\n%s" % (" ".join(command), code, errors[-2000:]))
    return output


def run(command, **more):
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, **more)
    return checked(command, result.returncode, result.stdout, result.stderr)


def step_costs(build):
    return os.path.join(build, "benchmark", "drivers", "step_costs")


def environment(build):
    return dict(os.environ, LD_LIBRARY_PATH=os.path.join(build, "devel", "lib") + ":" + os.environ.get("LD_LIBRARY_PATH", ""))


def figures(text):
    """nodes, median and p99 (ms) of a line of step_costs."""
    return int(re.search(r"nodes (\d+)", text)[1]), *(float(re.search(k + r" ([\d.]+)", text)[1])
                                                      for k in ("median_ms", "p99_ms"))


def forces(trace):
    """(fx, fz) of every step, and whether it is in contact."""
    with open(trace, encoding="utf-8") as file:
        return [(float(row["fx"]), float(row["fz"]), int(row["static"]) + int(row["kinetic"]) > 0) for row in csv.DictReader(file)]


def solver_error(trace, converged):
    """RMS of the difference over the RMS of the force, of the steps in contact."""
    steps = [(a, b) for a, b in zip(forces(trace), forces(converged)) if b[2]]
    off = sum((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 for a, b in steps)
    return math.sqrt(off / sum(b[0] ** 2 + b[1] ** 2 for _, b in steps))


def converged_trace(build, mesh, arguments, scratch):
    """Of the same motion with every step solved to the end."""
    values = dict(zip(arguments[::2], arguments[1::2]), **CONVERGED)
    trace = os.path.join(scratch, "converged.csv")
    run([step_costs(build), mesh, "--trace", trace] + [word for pair in values.items() for word in pair], env=environment(build))
    return trace


def pair(builds, arguments, traces):
    """In turn on one processor: at once, either would find its data gone from the caches."""
    rounds = [[figures(run(["taskset", "-c", "0", step_costs(build)] + arguments + ["--trace", trace], env=environment(build)))
               for build, trace in zip(builds, traces)] for _ in range(ROUNDS)]
    return [[statistics.median(figure) for figure in zip(*of_build)] for of_build in zip(*rounds)]


def growth_table(build):
    """Median step over nodes, and the exponent of a power law through all of them."""
    rows = [figures(run([step_costs(build), mesh] + GROWTH_ARGUMENTS, env=environment(build))) for mesh in GROWTH]
    logs = [(math.log(nodes), math.log(median)) for nodes, median, _ in rows]
    mean = [sum(column) / len(logs) for column in zip(*logs)]
    exponent = sum((x - mean[0]) * (y - mean[1]) for x, y in logs) / sum((x - mean[0]) ** 2 for x, _ in logs)
    head = ["", "### Growth with the number of nodes", "", "Uniform, tolerance 3e-2: exponent %.2f (1.1 wanted)." % exponent, ""]
    return head + ["| nodes | median, ms | µs per node |", "|---|---|---|"] + [
        "| %d | %.2f | %.2f |" % (nodes, median, 1e3 * median / nodes) for nodes, median, _ in rows]


def count(build, mesh, scratch):
    """Instructions per step: in all, and of each part."""
    out = os.path.join(scratch, "callgrind")
    run(["valgrind", "--tool=callgrind", "--callgrind-out-file=" + out,
         "--toggle-collect=tissue_contact::Simulator::advance*", step_costs(build), mesh, "--drag", str(COUNTED_DRAG)],
        env=environment(build))
    lines = re.findall(r"^ *([\d,]+) \([ \d.]+%\) +(.*)$", run(["callgrind_annotate", "--threshold=100", out]), re.M)
    numbers = [(int(number.replace(",", "")), what) for number, what in lines]
    total = numbers[0][0]
    parts = [sum(number for number, what in numbers[1:] if re.search(pattern, what)) for _, pattern in PARTS]
    return total / COUNTED_STEPS, [part / total for part in parts] + [1.0 - sum(parts) / total]


def machine():
    name = re.search(r"model name\s*: (.*)", open("/proc/cpuinfo").read())[1]
    return "%s, %d processors, load %.1f while it ran" % (name, os.cpu_count(), os.getloadavg()[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", required=True)
    parser.add_argument("--before-name")
    parser.add_argument("--no-counts", action="store_true")
    options = parser.parse_args()
    build = run([os.path.join(PACKAGE, "scripts", "build"), "--where"]).strip()
    builds = [options.before, build]
    for needed in builds:
        if not os.access(step_costs(needed), os.X_OK):
            sys.exit("make_performance_doc.py: %s is not built" % step_costs(needed))
    before = options.before_name or options.before
    commit = run(["git", "-C", PACKAGE, "rev-parse", "--short", "HEAD"]).strip()
    with open(DOC, encoding="utf-8") as old:
        page = old.read()
    with_tables(page, [])  # refused now, not after all of it
    with tempfile.TemporaryDirectory() as scratch:
        def mesh_of(mesh):
            if "," in mesh:
                return mesh
            file = os.path.join(scratch, mesh + ".msh")
            if not os.path.exists(file):
                run(["gmsh", "-3", "-format", "msh22", "-setnumber", "h", mesh,
                     os.path.join(PACKAGE, "benchmark", "drivers", "refined_block.geo"), "-o", file])
            return file
        text = ["Made by `scripts/make_performance_doc.py`: press and drag of `benchmark/drivers/step_costs.cpp` (ball of 5 mm, 4 mm deep, μ 0.5;",
                "E 5 kPa, ν 0.45, steps of 1 ms where nothing else is said), processor time of the steps in contact; both programs in turn on one",
                "processor, medians of %d runs. Solver error: RMS of the force's difference from that of steps solved to the end, over the" % ROUNDS,
                "force's RMS. Wanted: what was aimed for. A ratio above 1 means faster than before.", "", "### Time of a step", "",
                "%s. Before: %s; after: commit %s." % (machine(), before, commit), "",
                "| mesh | tolerance (iterations at most) | nodes | before: median / p99, ms | after | ratio of medians | wanted | solver error | wanted |",
                "|---|---|---|---|---|---|---|---|---|"]
        for name, mesh, arguments, wanted, wanted_error in ROWS:
            traces = [os.path.join(scratch, which + ".csv") for which in ("before", "after")]
            (nodes, *old), (_, *new) = pair(builds, [mesh_of(mesh)] + arguments, traces)
            error = solver_error(traces[1], converged_trace(build, mesh_of(mesh), arguments, scratch))
            settings = dict(zip(arguments[::2], arguments[1::2]))
            text.append("| %s | %s (%s) | %d | %.2f / %.2f | %.2f / %.2f | %.2f | %s | %.2f %% | %s |"
                        % (name, settings["--tolerance"], settings.get("--iterations", "30"), nodes, *old, *new, old[0] / new[0], wanted, 100 * error,
                           wanted_error))
            print(text[-1], flush=True)
        text += growth_table(build)
        text += ["", "### Memory", "", "`benchmark/drivers/memory.cpp`; 1.5 kB per node wanted with Gauss–Seidel:", ""]
        text += ["    " + line for line in run([os.path.join(os.path.dirname(step_costs(build)), "memory")], env=environment(build)).splitlines()]
        if not options.no_counts:
            text += ["", "### Profile: shares of the instructions", "",
                     "Instructions (callgrind), millions per step, and the shares of its parts:", "",
                     "| | in all | " + " | ".join(name for name, _ in PARTS) + " | rest |", "|---" * (len(PARTS) + 3) + "|"]
            for name, mesh in COUNTED:
                for which, counted in zip(("before", "after"), builds):
                    total, parts = count(counted, mesh_of(mesh), scratch)
                    text.append("| %s, %s | %.2f | " % (name, which, total / 1e6)
                                + " | ".join("%.0f %%" % (100 * part) for part in parts) + " |")
    with whole_file(DOC) as path, open(path, "w", encoding="utf-8") as out:
        out.write(with_tables(page, text))


if __name__ == "__main__":
    main()
