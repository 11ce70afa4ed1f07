#!/usr/bin/python3
"""Makes the tables of doc/performance.md anew: what an implicit step costs, before and after, both run at the same time on one
processor. What stands below its first heading of the second order is written by hand and stays.

usage, after scripts/build and `make -C "$(scripts/build --where)" step_costs`:
    scripts/make_performance_doc.py --before DIR [--before-name NAME] [--no-counts]
  --before DIR        where the libtissue_contact_core.so to compare with lies (<build>/devel/lib of an older checkout)
  --before-name NAME  what to call it (default: its directory)
  --no-counts         without instruction counts (valgrind), which take most of the time
Needs gmsh (and valgrind). Quarter of an hour.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile

from whole_file import whole_file

PACKAGE = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
DOC = os.path.join(PACKAGE, "doc", "performance.md")
# name, mesh (cells, or h of refined_block.geo), arguments, wanted: median / p99, ms
ROWS = [
    ("uniform, 1e-2", "10,10,4", ["--tolerance", "1e-2"], ".10 / .15"),
    ("uniform, 1e-2", "20,20,6", ["--tolerance", "1e-2"], ".6 / .9"),
    ("uniform, 1e-2", "35,35,10", ["--tolerance", "1e-2", "--drag", "0.001"], "3 / 4.5"),
    ("uniform, 1e-3", "10,10,4", [], ".15 / .22"),
    ("uniform, 1e-3", "20,20,6", [], "1 / 1.5"),
    ("uniform, 1e-3", "35,35,10", ["--drag", "0.001"], "6 / 9"),
    ("refined, 1e-3", "0.0014", [], ".3 / .45"),
    ("refined, 1e-3", "0.001", [], ".5 / .75"),
    ("uniform, 1e-3, Cholesky", "10,10,4", ["--relaxation", "cholesky"], "- / no factor spike"),
]
COUNTED = [("605 uniform, 1e-3", "10,10,4"), ("refined, h 1.4 mm, 1e-3", "0.0014")]
COUNTED_DRAG = 0.0005
COUNTED_STEPS = round((0.0041 + COUNTED_DRAG) / 2e-5)
PARTS = [
    ("sweeps", r"sweepForth|sweepBack|runForth|runBack|runRelax|runCarry|GaussSeidelRelaxation::relax"),
    ("elastic forces", r"addCorotationalForces"),
    ("averaged dilatation, its forces", r"addPressureForces|MeanDilatation::addForces"),
    ("refreshing the stiffness", r"::addStiffness|addGradients|shapeGradients|refreshStiffness"),
    ("residuals", r"bodyDefect|offDiagonalProduct|computeResiduals"),
    ("surface tree, detection", r"TriangleTree|MovingSurface|detect|NarrowPhase|projectOnTriangle"),
]


def checked(command, code, output, errors):
    """The output, or the end with what the program said."""
    if code != 0:
        sys.exit("make_performance_doc.py: %s: exit code %d:\n%s" % (" ".join(command), code, errors[-2000:]))
    return output


def run(command, **more):
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, **more)
    return checked(command, result.returncode, result.stdout, result.stderr)


def environment(library):
    return dict(os.environ, LD_LIBRARY_PATH=library + ":" + os.environ.get("LD_LIBRARY_PATH", ""))


def figures(text):
    """nodes, median and p99 (ms) of a line of step_costs."""
    return int(re.search(r"nodes (\d+)", text)[1]), *(float(re.search(k + r" ([\d.]+)", text)[1])
                                                      for k in ("median_ms", "p99_ms"))


def pair(program, libraries, arguments):
    """Both at once on one processor, so that both meet the same disturbances."""
    both = [subprocess.Popen(["taskset", "-c", "0", program] + arguments, env=environment(library), stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE, universal_newlines=True) for library in libraries]
    return [figures(checked(process.args, process.returncode, *said))
            for process, said in [(process, process.communicate()) for process in both]]


def count(program, library, mesh, scratch):
    """Instructions per step: in all, and of each part."""
    out = os.path.join(scratch, "callgrind")
    run(["valgrind", "--tool=callgrind", "--callgrind-out-file=" + out,
         "--toggle-collect=tissue_contact::Simulator::advance*", program, mesh, "--drag", str(COUNTED_DRAG)],
        env=environment(library))
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
    program = os.path.join(build, "benchmark", "drivers", "step_costs")
    libraries = [options.before, os.path.join(build, "devel", "lib")]
    before = options.before_name or options.before
    commit = run(["git", "-C", PACKAGE, "rev-parse", "--short", "HEAD"]).strip()
    with open(DOC, encoding="utf-8") as old:  # what stands there by hand
        notes = re.search(r"^## .*", old.read(), re.M | re.S)[0].rstrip()
    with tempfile.TemporaryDirectory() as scratch:
        def mesh_of(mesh):
            if "," in mesh:
                return mesh
            file = os.path.join(scratch, mesh + ".msh")
            if not os.path.exists(file):
                run(["gmsh", "-3", "-format", "msh22", "-setnumber", "h", mesh,
                     os.path.join(PACKAGE, "benchmark", "drivers", "refined_block.geo"), "-o", file])
            return file
        text = ["# What a step costs", "",
                "The tables by `scripts/make_performance_doc.py`, the notes below them by hand: press and drag of `benchmark/drivers/step_costs.cpp` (5 mm ball, 4 mm deep,",
                "μ .5, E 5 kPa, ν .45, 1 ms steps), processor time of the steps in contact, both programs at once on one processor.", "",
                "%s. Before: %s; after: commit %s." % (machine(), before, commit), "",
                "| mesh, tolerance | nodes | before: median / p99, ms | after | ratio of medians | wanted |", "|---|---|---|---|---|---|"]
        for name, mesh, arguments, wanted in ROWS:
            (nodes, *old), (_, *new) = pair(program, libraries, [mesh_of(mesh)] + arguments)
            text.append("| %s | %d | %.2f / %.2f | %.2f / %.2f | %.2f | %s |"
                        % (name, nodes, *old, *new, old[0] / new[0], wanted))
        if not options.no_counts:
            text += ["", "Instructions (callgrind), millions per step, and the shares of its parts:", "",
                     "| | in all | " + " | ".join(name for name, _ in PARTS) + " | rest |", "|---" * (len(PARTS) + 3) + "|"]
            for name, mesh in COUNTED:
                for which, library in zip(("before", "after"), libraries):
                    total, parts = count(program, library, mesh_of(mesh), scratch)
                    text.append("| %s, %s | %.2f | " % (name, which, total / 1e6)
                                + " | ".join("%.0f %%" % (100 * part) for part in parts) + " |")
    text += ["", notes]
    with whole_file(DOC) as path, open(path, "w", encoding="utf-8") as out:
        out.write("\n".join(text) + "\n")


if __name__ == "__main__":
    main()
