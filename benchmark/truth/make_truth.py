#!/usr/bin/python3
"""Makes the truths that tissue_contact_benchmark measures total errors against: the same scenes on many meshes refined around the
contact, extrapolated to no mesh size, no growth of the cells away from the contact and no step.

usage, after scripts/build and `make -C "$(scripts/build --where)" truth_run`:
  make_truth.py SCENE --runs DIR [--bag FILE] [--out FILE]      (Debian: gmsh, python3-numpy)
  SCENE       press-drag, partial-slip, grasp or robot
  --runs DIR  meshes and runs; what is there is not run again, unless geometry, motion, tolerance or program are others. All of
              press-drag takes a quarter of an hour of one processor
  --bag FILE  of robot: its recording (default: dvrk/psm2_classic_motion.bag of the folder TISSUE_CONTACT_SHARED_DATA)
  --out FILE  the table (default: beside this script)

A tetrahedron of edge s misses forces by s^2 times something that depends on the place alone. Edges here are h within `reach` of the
path of the contact and h + g (d - reach) at the distance d beyond it, at most c; so with the step dt

    F(h, g, dt) = F + a h^2 + b h g + c g^2 + t dt

in every sample and component, by least squares over the runs: g at a given h is the far field's share, h the near field's.
Runs weigh 1 / h^2, as what is left of nodes that come into contact one by one does. t comes from runs on one mesh.
"""
import argparse
import csv
import hashlib
import os
import re
import subprocess
import sys

import numpy as np

HERE = os.path.dirname(os.path.realpath(__file__))
PACKAGE = os.path.dirname(os.path.dirname(HERE))


class Run:
    """Edge lengths in mm: h within `reach` of the path, g more per mm beyond, at most c."""

    def __init__(self, h, g, c, step_s):
        self.h, self.g, self.c, self.step_s = h, g, c, step_s


class Plan:
    """`runs` for mesh and far field, all of one step; `steps` for dF/d(step), `bends` to see that it is straight; `none`: the
    components of the force that are 0 by symmetry; `files` of the package that hold the scene, where the program does not; `bag`:
    its motion is recorded."""

    def __init__(self, table, size_m, path_m, reach_mm, tolerance, runs, steps, bends, none=(1,), files=(), bag=False):
        self.table, self.size_m, self.path_m, self.reach_mm, self.tolerance = table, size_m, path_m, reach_mm, tolerance
        self.runs, self.steps, self.bends, self.none, self.files, self.bag = runs, steps, bends, none, files, bag


def program(*command, output=None):
    with open(output + ".part", "w", encoding="utf-8") if output else open(os.devnull, "w", encoding="utf-8") as stream:
        done = subprocess.run(command, stdout=stream, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit("make_truth.py: %s failed: %s" % (" ".join(command), done.stderr[-1000:]))
    if output:
        os.rename(output + ".part", output)
    return done.stderr


def key(*parts):
    """A part of a name for what these texts and files make."""
    return hashlib.sha256(b"\0".join(part.encode() for part in parts)).hexdigest()[:12]


def content(file):
    with open(file, "rb") as stream:
        return hashlib.sha256(stream.read()).hexdigest()


def box_geometry(size_m, path, run, reach_m):
    """Gmsh text of a box on z = 0, finest around the segment `path` (x from, x to) in the middle of its upper face."""
    x, y, z = size_m[0] / 2, size_m[1] / 2, size_m[2]
    corners = [(sx * x, sy * y, height) for height in (0.0, z) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    lines = [(1, 2), (2, 3), (3, 4), (4, 1), (5, 6), (6, 7), (7, 8), (8, 5), (1, 5), (2, 6), (3, 7), (4, 8)]
    loops = [(-4, -3, -2, -1), (5, 6, 7, 8), (1, 10, -5, -9), (2, 11, -6, -10), (3, 12, -7, -11), (4, 9, -8, -12)]
    text = ["Point(%d) = {%.17g, %.17g, %.17g};" % ((i,) + p) for i, p in enumerate(corners, 1)]
    text += ["Line(%d) = {%d, %d};" % ((i,) + p) for i, p in enumerate(lines, 1)]
    for i, loop in enumerate(loops, 1):
        text.append("Curve Loop(%d) = {%s}; Plane Surface(%d) = {%d};" % (i, ", ".join(map(str, loop)), i, i))
    text.append("Surface Loop(1) = {1:6}; Volume(1) = {1}; Physical Volume(1) = {1};")
    distance = "Sqrt((x-Max(%g,Min(%g,x)))^2+y^2+(z-%g)^2)" % (path[0], path[1], z)
    text.append('Field[1] = MathEval; Field[1].F = "Min(%g,%g+%g*Max(0,%s-%g))";' % (
        1e-3 * run.c, 1e-3 * run.h, run.g, distance, reach_m))
    text.append("Background Field = 1; Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;")
    text.append("Mesh.MeshSizeFromCurvature = 0; Mesh.Algorithm = 6; Mesh.Algorithm3D = 1; Mesh.RandomSeed = 1;")
    return "\n".join(text) + "\n"


def forces(scene, plan, run, folder, truth_run, version, bag):
    """Times and forces (samples x 3) of a run. version: of the programs and files that make it; bag: [] or its recording."""
    geometry = box_geometry(plan.size_m, plan.path_m, run, 1e-3 * plan.reach_mm)
    mesh = os.path.join(folder, "h%g_g%g_%s" % (run.h, run.g, key(geometry, version)))
    if not os.path.exists(mesh + ".msh"):
        with open(mesh + ".geo", "w", encoding="utf-8") as stream:
            stream.write(geometry)
        program("gmsh", "-3", "-format", "msh22", "-nopopup", mesh + ".geo", "-o", mesh + ".part.msh")
        os.rename(mesh + ".part.msh", mesh + ".msh")
    arguments = ["%g" % run.step_s, "%g" % plan.tolerance, "0"]  # all of the motion
    result = "%s_%s.csv" % (mesh, "_".join(arguments))
    if not os.path.exists(result):
        print(os.path.basename(result), program(truth_run, scene, mesh + ".msh", *arguments, *bag, output=result).strip(), flush=True)
    with open(result, newline="", encoding="utf-8") as stream:
        rows = np.array([[float(v) for v in row] for row in list(csv.reader(stream))[1:]])
    return rows[:, 0], rows[:, 1:]


def fit(runs, values):
    """F at h = g = 0 per sample and component; runs: (h, g), values: runs x samples x 3."""
    terms = [[1.0, h * h, h * g, g * g] for h, g in runs]
    if len({g for _, g in runs}) == 1:
        sys.exit("make_truth.py: runs with different growths are needed")
    weights = np.array([1.0 / (h * h) for h, _ in runs])
    matrix = np.array(terms) * weights[:, None]
    flat = values.reshape(len(runs), -1) * weights[:, None]
    return np.linalg.lstsq(matrix, flat, rcond=None)[0].reshape((4,) + values.shape[1:])


def rms(values, over):
    return float(np.sqrt((values**2).sum() / (over**2).sum()))


def extrapolate(data):
    """The truth over the time that all runs have; what the near field and the far field of the finest run add to it, and how
    much leaving out any one run changes it, as shares of the force. data: (run, times, forces), all of one step."""
    samples = min(len(times) for _, times, _ in data)
    keys = [(run.h, run.g) for run, _, _ in data]
    values = np.array([force[:samples] for _, _, force in data])
    parts = fit(keys, values)
    scatter = max(rms(fit(keys[:k] + keys[k + 1:], np.delete(values, k, 0))[0] - parts[0], parts[0])
                  for k in range(len(keys)))
    near = [rms(parts[1] * h * h, parts[0]) for h, _ in keys]
    far = [rms(parts[2] * h * g + parts[3] * g * g, parts[0]) for h, g in keys]
    best = min(range(len(keys)), key=lambda k: near[k] + far[k])
    return parts[0], {"near field of the run at h %g mm, g %g" % keys[best]: near[best], "its far field": far[best],
                      "change by leaving out a run, at most": scatter}


def step_slope(data):
    """dF/d(step) per sample over the time that all runs have, and what a straight line leaves, as a share of the force.
    data: (run, times, forces) of one mesh."""
    samples = min(len(times) for _, times, _ in data)
    steps = np.array([run.step_s for run, _, _ in data])
    values = np.array([force[:samples] for _, _, force in data])
    matrix = np.stack([np.ones_like(steps), steps], axis=1)
    solution = np.linalg.lstsq(matrix, values.reshape(len(data), -1), rcond=None)[0]
    left = (matrix @ solution).reshape(values.shape) - values
    return solution[1].reshape(values.shape[1:]), max(rms(one, values[0]) for one in left)


PLANS = {
    "press-drag": Plan(
        "press_drag", (0.1, 0.1, 0.04), (-0.01, 0.01), 6.0, 1e-5,
        [Run(1.4, 0.3, 10, 0.002), Run(1.4, 0.15, 8, 0.002), Run(1.0, 0.3, 10, 0.002), Run(1.0, 0.15, 8, 0.002),
         Run(0.7, 0.3, 10, 0.002), Run(0.7, 0.15, 8, 0.002), Run(0.5, 0.3, 10, 0.002), Run(0.5, 0.15, 8, 0.002),
         Run(0.35, 0.3, 10, 0.002)],
        [Run(0.7, 0.3, 10, 0.002), Run(0.7, 0.3, 10, 0.001)],
        [Run(2.0, 0.3, 10, step) for step in (0.002, 0.001, 0.0005, 0.00025)]),
    "partial-slip": Plan(
        "partial_slip", (0.06, 0.06, 0.03), (0.0, 0.0), 7.0, 1e-6,
        [Run(1.4, 0.3, 6, 0.02), Run(1.4, 0.15, 5, 0.02), Run(1.0, 0.3, 6, 0.02), Run(1.0, 0.15, 5, 0.02),
         Run(0.7, 0.3, 6, 0.02), Run(0.7, 0.15, 5, 0.02)],
        [Run(1.0, 0.3, 6, step) for step in (0.02, 0.01)], [Run(2.0, 0.3, 6, step) for step in (0.02, 0.01, 0.005)]),
    "grasp": Plan(
        "grasp", (0.004, 0.01, 0.03), (-0.002, 0.002), 5.0, 1e-5,
        [Run(0.7, 0.3, 4, 0.002), Run(0.7, 0.15, 2, 0.002), Run(0.5, 0.3, 4, 0.002), Run(0.5, 0.15, 2, 0.002),
         Run(0.5, 0.075, 1, 0.002), Run(0.35, 0.3, 4, 0.002), Run(0.35, 0.15, 2, 0.002), Run(0.35, 0.075, 1, 0.002),
         Run(0.25, 0.3, 4, 0.002), Run(0.25, 0.15, 2, 0.002), Run(0.18, 0.3, 4, 0.002), Run(0.18, 0.15, 2, 0.002)],
        [Run(0.5, 0.3, 4, step) for step in (0.002, 0.001)], [Run(0.7, 0.3, 4, step) for step in (0.002, 0.001, 0.0005)], (0, 1),
        ("config/grasp.yaml", "config/grasp_path.csv", "urdf/psm_classic.urdf")),
    # Joint states come every 10 ms, 10.3 at most: 2.1 ms is five steps each, 1.05 and 0.525 ms are ten and twenty.
    "robot": Plan(
        "robot", (0.03, 0.026, 0.012), (-0.0015, 0.0016), 2.5, 1e-5,
        [Run(0.7, 0.3, 3, 0.0021), Run(0.7, 0.15, 2, 0.0021), Run(0.5, 0.3, 3, 0.0021), Run(0.5, 0.15, 2, 0.0021),
         Run(0.35, 0.3, 3, 0.0021), Run(0.35, 0.15, 2, 0.0021), Run(0.35, 0.1, 1.5, 0.0021), Run(0.25, 0.3, 3, 0.0021),
         Run(0.25, 0.15, 2, 0.0021), Run(0.25, 0.1, 1.5, 0.0021), Run(0.18, 0.3, 3, 0.0021), Run(0.18, 0.15, 2, 0.0021)],
        [Run(0.35, 0.3, 3, step) for step in (0.0021, 0.00105)],
        [Run(0.5, 0.3, 3, step) for step in (0.0021, 0.00105, 0.000525)], (),
        ("config/psm_palpation.yaml", "urdf/psm_classic.urdf"), True),
}


def commit():
    def git(*words):
        return subprocess.run(["git", "-C", PACKAGE] + list(words), stdout=subprocess.PIPE, text=True, check=False).stdout.strip()

    return git("log", "-1", "--format=%h of %cs") + (", changed" if git("status", "--porcelain", "--untracked-files=no") else "")


def write_table(file, scene, plan, times, truth, uncertainty, facts):
    how = "%s.csv: meshes refined around the contact to %g mm, extrapolated in mesh and step" % (
        plan.table, min(run.h for run in plan.runs))
    with open(file + ".part", "w", encoding="utf-8") as stream:
        stream.write("# how: %s\n# uncertainty: %.4f\n" % (how, uncertainty))
        stream.write("# made by: benchmark/truth/make_truth.py %s\n# commit: %s\n" % (scene, commit()))
        for name, share in facts.items():
            stream.write("# %s, share of the force: %.4f\n" % (name, share))
        stream.write("time_s,force_x_n,force_y_n,force_z_n\n")
        for time, force in zip(times, truth):
            stream.write("%.6g,%.6f,%.6f,%.6f\n" % ((time,) + tuple(force + 0.0)))
    os.rename(file + ".part", file)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("scene", choices=sorted(PLANS))
    parser.add_argument("--runs", required=True)
    data = os.environ.get("TISSUE_CONTACT_SHARED_DATA") or os.path.join(PACKAGE, "..", "shared", "data")
    parser.add_argument("--bag", default=os.path.join(data, "dvrk", "psm2_classic_motion.bag"))
    parser.add_argument("--out")
    arguments = parser.parse_args()
    plan = PLANS[arguments.scene]
    bag = [arguments.bag] if plan.bag else []
    if bag and not os.path.isfile(arguments.bag):
        sys.exit("make_truth.py: no recording '%s'; give the dVRK PSM's with --bag FILE" % arguments.bag)
    folder = os.path.join(arguments.runs, arguments.scene)
    os.makedirs(folder, exist_ok=True)
    build = subprocess.run([os.path.join(PACKAGE, "scripts", "build"), "--where"], stdout=subprocess.PIPE, text=True,
                           check=True).stdout.strip()
    truth_run = os.path.join(build, "benchmark", "drivers", "truth_run")
    libraries = re.findall(re.escape(build) + r"\S+", subprocess.run(["ldd", truth_run], stdout=subprocess.PIPE, text=True,
                                                                     check=True).stdout)
    version = key(program("gmsh", "--version"), *map(content, [truth_run] + libraries + bag + [os.path.join(PACKAGE, file) for file in plan.files]))

    def of(runs):
        return [(run,) + forces(arguments.scene, plan, run, folder, truth_run, version, bag) for run in runs]

    bent = step_slope(of(plan.bends))[1]
    slope = step_slope(of(plan.steps))[0]
    data = of(plan.runs)
    truth, facts = extrapolate(data)
    samples = min(len(truth), len(slope))
    moved = -slope[:samples] * plan.runs[0].step_s
    facts["the step of %g ms" % (1e3 * plan.runs[0].step_s)] = rms(moved, truth[:samples])
    facts["what is not linear in the step"] = bent
    truth = truth[:samples] + moved
    truth[:, list(plan.none)] = 0.0
    uncertainty = facts["change by leaving out a run, at most"] + bent
    write_table(arguments.out or os.path.join(HERE, plan.table + ".csv"), arguments.scene, plan, data[0][1], truth, uncertainty,
                facts)
    for name, share in facts.items():
        print("%s: %.2f %%" % (name, 100 * share))


if __name__ == "__main__":
    main()
