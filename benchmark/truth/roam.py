#!/usr/bin/python3
"""Prints how far forces on a ball that wanders over a block are off, on meshes that follow it and on even ones, against Gmsh meshes refined
along all of its way (doc/notes/accuracy.md).

usage, after scripts/build and `make -C "$(scripts/build --where)" moving_mesh`:
  roam.py SCENE --runs DIR        (Debian: gmsh, python3-numpy)
  SCENE       ball: of 5 mm, 200 mm at 100 mm/s on 100 x 100 x 40 mm; small-tool: of 1 mm, 60 mm at 20 mm/s on 200 x 200 x 50 mm
  --runs DIR  meshes and runs; what is there is not made again. All of it: half an hour of one processor

The three meshes are of one family, with edges s h within `reach` of the way and s (h + g d) at the distance d beyond it, at most s c, so that forces are
off by s^2 times something: F = F(s) - a s^2 through the two finer ones, which makes of what a mesh is off by chance 2.3 times as much; what the third is off
from that line tells how well the truth is known. Runs are not made again when the program changes: give another folder.
Steps are the same everywhere (1 ms), so their error is not in it.
"""
import argparse
import csv
import math
import os
import re
import subprocess
import sys

import numpy as np

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
SCALES = (2.0, 1.4, 1.0)
LANDED = 210  # steps: after them the ball slides
RADIUS_CELLS = 0.14  # edges under the ball over its radius on the finest mesh


class Scene:
    def __init__(self, radius_m, size_m, cells, speed_m_per_s, length_m, settings):
        self.radius_m, self.size_m, self.cells, self.speed_m_per_s, self.length_m, self.settings = (
            radius_m, size_m, cells, speed_m_per_s, length_m, settings)

    def arguments(self):
        return ["--radius", "%g" % self.radius_m, "--speed", "%g" % self.speed_m_per_s, "--length", "%g" % self.length_m,
                "--block", ",".join("%g" % value for value in self.size_m + self.cells)]


# settings: (refinement, tolerance)
SCENES = {
    "ball": Scene(0.005, (0.1, 0.1, 0.04), (10, 10, 4), 0.1, 0.2,
                  [("never", "1e-2"), ("auto", "3e-2"), ("auto", "1e-2"), ("auto", "1e-3"), ("fine", "1e-2"), ("fine", "1e-3")]),
    "small-tool": Scene(0.001, (0.2, 0.2, 0.05), (20, 20, 5), 0.02, 0.06,
                        [("never", "1e-2"), ("auto", "3e-2"), ("auto", "1e-2"), ("auto", "1e-3"), ("fine", "1e-2"), ("fine", "1e-3")]),
}


def way(length_m):
    """Points of moving_mesh's figure of eight, up to that length."""
    def eight(angle):
        return np.array([0.033 * math.sin(angle), 0.033 * math.sin(2 * angle)])

    points, passed, angle = [eight(0.0)], 0.0, 0.0
    while passed < length_m:
        passed += np.linalg.norm(eight(angle + 1e-4) - eight(angle))
        angle += 1e-4
        points.append(eight(angle))
    return points


def geometry(scene, scale):
    x, y, z = scene.size_m
    h = RADIUS_CELLS * scale * scene.radius_m
    points = [way(scene.length_m)[0]]
    for point in way(scene.length_m):
        if np.linalg.norm(point - points[-1]) > 0.2 * scene.radius_m:
            points.append(point)
    text = ['SetFactory("OpenCASCADE");', "Box(1) = {%g, %g, 0, %g, %g, %g};" % (-x / 2, -y / 2, x, y, z), "Physical Volume(1) = {1};"]
    text += ["Point(%d) = {%.9g, %.9g, %g};" % (1000 + k, point[0], point[1], z) for k, point in enumerate(points)]
    text.append("Field[1] = Distance; Field[1].PointsList = {1000:%d};" % (999 + len(points)))
    text.append('Field[2] = MathEval; Field[2].F = "Min(%g,%g+%g*Max(0,F1-%g))";' % (
        0.005 * scale * max(scene.size_m) / 0.1, h, 0.175 * scale, 0.8 * scene.radius_m))
    text.append("Background Field = 2; Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;")
    text.append("Mesh.MeshSizeFromCurvature = 0; Mesh.Algorithm = 6; Mesh.Algorithm3D = 1; Mesh.RandomSeed = 1;")
    return "\n".join(text) + "\n"


def run(program, name, arguments, folder):
    """(forces of the steps in which the ball slides, what the program printed)"""
    trace = os.path.join(folder, name + ".csv")
    if not os.path.exists(trace):
        done = subprocess.run([program, "--trace", trace + ".part"] + arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode != 0:
            sys.exit("roam.py: %s: %s" % (" ".join(done.args), done.stderr))
        with open(os.path.join(folder, name + ".txt"), "w", encoding="utf-8") as said:
            said.write(done.stdout)
        os.rename(trace + ".part", trace)
    with open(trace, newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))[LANDED:]
    with open(os.path.join(folder, name + ".txt"), encoding="utf-8") as said:
        return np.array([[float(row[axis]) for axis in ("fx", "fy", "fz")] for row in rows]), [int(row["nodes"]) for row in rows], said.read()


def rms(values):
    return math.sqrt((values**2).sum() / len(values))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", choices=sorted(SCENES))
    parser.add_argument("--runs", required=True)
    options = parser.parse_args()
    scene = SCENES[options.scene]
    os.makedirs(options.runs, exist_ok=True)
    build = subprocess.run([os.path.join(PACKAGE, "scripts", "build"), "--where"], stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
    program = os.path.join(build, "benchmark", "drivers", "moving_mesh")
    found = []
    for scale in SCALES:
        name = os.path.join(options.runs, "%s_%g" % (options.scene, scale))
        if not os.path.exists(name + ".msh"):
            with open(name + ".geo", "w", encoding="utf-8") as stream:
                stream.write(geometry(scene, scale))
            subprocess.run(["gmsh", "-3", "-format", "msh22", "-nopopup", name + ".geo", "-o", name + ".part.msh"], stdout=subprocess.DEVNULL, check=True)
            os.rename(name + ".part.msh", name + ".msh")
        forces, nodes, _ = run(program, os.path.basename(name), scene.arguments() + ["--mesh", name + ".msh", "--refinement", "never", "--tolerance", "1e-4"],
                               options.runs)
        print("Gmsh, edges of %.2g mm under the ball: %d nodes" % (1e3 * RADIUS_CELLS * scale * scene.radius_m, nodes[0]), flush=True)
        found.append(forces)
    coarse, middle, fine = found
    slope = (middle - fine) / (SCALES[1]**2 - SCALES[2]**2)
    truth = fine - slope * SCALES[2]**2
    size = rms(truth)
    print("force %.4g N; the finest mesh is %.2g %% off, the coarsest %.2g %%, of which the line leaves %.2g %%" % (
        size, 100 * rms(fine - truth) / size, 100 * rms(coarse - truth) / size, 100 * rms(coarse - truth - slope * SCALES[0]**2) / size))
    print("| refinement | tolerance | nodes | error | of a mean over 20 ms | a step, median / p99, ms | moves of the mesh |\n|---|---|---|---|---|---|---|")
    for refinement, tolerance in scene.settings:
        name = "%s_%s_%s" % (options.scene, re.sub(r"[^\w.]+", "_", refinement), tolerance)
        forces, nodes, said = run(program, name, scene.arguments() + ["--refinement", refinement, "--tolerance", tolerance], options.runs)
        off = forces - truth
        smooth = np.stack([np.convolve(off[:, axis], np.ones(20) / 20, "valid") for axis in range(3)], axis=1)
        took = re.search(r"^all: .*?median_ms ([\d.]+) p99_ms ([\d.]+)", said)
        moves = re.search(r"^mesh moves: (\d+)", said, re.M)
        print("| `%s` | %s | %.0f | %.2g %% | %.2g %% | %s / %s | %s |" % (
            refinement, tolerance, np.mean(nodes), 100 * rms(off) / size, 100 * rms(smooth) / size, took[1], took[2], moves[1]), flush=True)


if __name__ == "__main__":
    main()
