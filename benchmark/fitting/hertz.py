#!/usr/bin/python3
"""Fit on a shallow press, predict a deep one: a ball of 3.5 mm presses 2 mm and 3 mm deep at many points of a layered phantom whose stiffness and
soft layer vary from point to point. Each point's modulus and height of touch are fitted to the first press; the second is predicted.
doc/calibration.md has its figures.

  benchmark/fitting/hertz.py --points 300

The truth has a finer mesh than the fit, and layers to half a millimetre where the fit knows them to one. Forces have 5 % noise at 500 Hz, poses 0.1 mm,
and each point's height of touch is off by 0.1 mm (standard deviations). A slow press without friction is proportional to the modulus, so that points with the same
layer share a simulated curve of force over depth; --check simulates one point with another modulus and says how far it is off that.
"""
import argparse
import csv
import os
import sys

import numpy
from scipy.interpolate import PchipInterpolator

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import phantom_study as study  # noqa: E402 (the path comes first)
from fitting import forward, parameters, run, solve, uncertainty  # noqa: E402

SCENE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "layered.yaml")
RADIUS_M, HEIGHT_M, DEEP_RATIO = 0.0035, 0.014, 3.0
SPEED_MM_PER_S, STEP_S, DEEPEST_M = 5.0, 0.01, 3.5e-3
MODULUS_PA = 8000.0  # of the curves
E_KEY, DEEP_E_KEY = "tissues.phantom.material.youngs_modulus_pa", "tissues.phantom.regions.deep.material.youngs_modulus_pa"
DEEP_TOP_KEY = "tissues.phantom.regions.deep.where.0.box.max_m.2"
TRUTH = {"tissues.phantom.block.cells": [18, 18, 28], "tissues.phantom.block.grading.x.growth": 1.17,
         "tissues.phantom.block.grading.y.growth": 1.17}
FIT_TO_M, TRUE_TO_M = 1e-3, 0.5e-3  # layers end where cells do


class Curve:
    """Force over depth of one layer, per Pa of its modulus."""

    def __init__(self, layer_m, mesh, modulus=MODULUS_PA):
        times = numpy.arange(int((DEEPEST_M + 2e-4) / (1e-3 * SPEED_MM_PER_S * STEP_S))) * STEP_S
        depth = -2e-4 + 1e-3 * SPEED_MM_PER_S * times
        motion = numpy.zeros((len(times), 6))
        motion[:, 2] = RADIUS_M - depth
        settings = {E_KEY: modulus, DEEP_E_KEY: DEEP_RATIO * modulus, DEEP_TOP_KEY: HEIGHT_M - layer_m}
        done = forward.forces(SCENE, dict(settings, **mesh), study.TOOL, times, motion)
        if done.doubts:
            sys.exit("the curves are in doubt: %s" % dict(done.doubts))
        self.force, self.error = (PchipInterpolator(depth, values / modulus) for values in (done.force_n[:, 2], done.error_n))

    def at(self, modulus, depth_m):
        """As a run of the scene gives it."""
        depth_m = numpy.clip(depth_m, -2e-4, DEEPEST_M - 1e-4)
        force = numpy.zeros((len(depth_m), 3))
        force[:, 2] = modulus * self.force(depth_m)
        return forward.Simulated(force, modulus * self.error(depth_m))


def depth_of(positions):
    return RADIUS_M - positions[:, 2]


def press(depth_mm):
    times, positions = study.press(depth_mm, SPEED_MM_PER_S)
    return times, positions + [0.0, 0.0, RADIUS_M - study.BALL_M]


def layers(grid_m):
    return [i * grid_m for i in range(int(round(4e-3 / grid_m)), int(round(7e-3 / grid_m)) + 1)]


def nearest(curves, layer_m):
    return curves[min(curves, key=lambda known: abs(known - layer_m))]


def point(seed, true_curves, fit_curves, fitted):
    """A row of the table."""
    generator = numpy.random.default_rng(seed)
    modulus = MODULUS_PA * numpy.exp(0.15 * generator.standard_normal())
    layer_m = float(numpy.clip(5.5e-3 + 1e-3 * generator.standard_normal(), 4e-3, 7e-3))
    noise = study.Noise()
    offset_m = noise.offset_m * generator.standard_normal(3)
    curve, truth = nearest(fit_curves, layer_m), nearest(true_curves, layer_m)
    seen, true_n = [], []
    for name, motion in (("shallow", press(2.0)), ("deep", press(3.0))):
        true_n.append(truth.at(modulus, depth_of(motion[1])).force_n)
        recording = study.record(name, motion, true_n[-1], noise, offset_m, generator)
        recording.force_n[:, :2] = numpy.nan  # a sensor of one axis
        seen.append(study.as_fit_sees(recording))
    runs = [solve.Run(recording, depth_of(recording.positions_m), numpy.ones(len(recording.times_s), bool)) for recording in seen]
    problem = solve.Problem(runs[:1], fitted, lambda values, one: curve.at(values[0], one.motion + values[1]), forward.Workers(1), lambda line: None)
    answer = uncertainty.assess(problem, solve.refine(problem, solve.search(problem, 4, seed)[0]))
    # The prediction is compared with the true force, whose own noise is not the model's.
    deep, predicted = runs[1], curve.at(answer.values[0], runs[1].motion + answer.values[1]).force_n
    quiet = numpy.stack([study.measured.thin(study.measured.Recording("", press(3.0)[0], true_n[1], press(3.0)[1]), 100.0).force_n[:, 2]] * 3, axis=1)
    deep.recording.force_n[:, 2] = quiet[:, 2]
    over = run.prediction_error(deep, predicted, numpy.arange(len(predicted)) > 0)
    pressed = quiet[:, 2] >= 0.98 * quiet[:, 2].max()
    return [seed, modulus, layer_m, answer.values[0], *answer.interval(0), answer.values[1], offset_m[2], quiet[:, 2].max(),
            float(numpy.median(predicted[pressed, 2] / quiet[pressed, 2]) - 1.0), over.median]


def tell(table):
    deepest, over, error = numpy.abs(table[:, 9]), table[:, 10], numpy.abs(table[:, 3] / table[:, 1] - 1.0)
    print("%d points, modulus %.0f to %.0f Pa, soft layer %.1f to %.1f mm, %.2f to %.2f N at 3 mm" % (
        len(table), table[:, 1].min(), table[:, 1].max(), 1e3 * table[:, 2].min(), 1e3 * table[:, 2].max(), table[:, 8].min(), table[:, 8].max()))
    print("force at 3 mm predicted: median error %.2f %%, nine of ten within %.2f %%, largest %.2f %%" % (
        tuple(100.0 * x for x in (numpy.median(deepest), numpy.quantile(deepest, 0.9), deepest.max()))))
    print("over the press to 3 mm: median of the points' median errors %.2f %%" % (100.0 * numpy.median(over)))
    print("modulus: median error %.2f %%, inside the 95 %% interval %d of %d" % (
        100.0 * numpy.median(error), ((table[:, 4] <= table[:, 1]) & (table[:, 1] <= table[:, 5])).sum(), len(table)))


def check(curve):
    other = Curve(5e-3, {}, 2.0 * MODULUS_PA)
    depth = numpy.linspace(5e-4, 3e-3, 20)
    print("forces proportional to the modulus within %.2f %%" % (100.0 * numpy.abs(other.force(depth) / curve.force(depth) - 1.0).max()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=300, help="default: %(default)s")
    parser.add_argument("--same-mesh", action="store_true", help="the truth by the fit's own mesh")
    parser.add_argument("--check", action="store_true", help="is the force proportional to the modulus?")
    parser.add_argument("--csv", help="table of every point")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    workers = forward.Workers(arguments.workers)
    true_to_m, mesh = (FIT_TO_M, {}) if arguments.same_mesh else (TRUE_TO_M, TRUTH)
    wanted = [(layer, {}) for layer in layers(FIT_TO_M)] + [(layer, mesh) for layer in layers(true_to_m)]
    curves = workers.map(Curve, wanted)
    fit_curves = {layer: curve for (layer, _), curve in zip(wanted[:4], curves)}
    true_curves = {layer: curve for (layer, _), curve in zip(wanted[4:], curves[4:])}
    if arguments.check:
        check(fit_curves[layers(FIT_TO_M)[1]])
    fitted = parameters.parse_fits([E_KEY + ":2e3..4e4", "offset_m:-5e-4..5e-4"], parameters.SceneKeys(SCENE))
    rows = [point(seed, true_curves, fit_curves, fitted) for seed in range(1, arguments.points + 1)]
    tell(numpy.array(rows))
    if arguments.csv:
        with open(arguments.csv, "w", newline="", encoding="utf-8") as stream:
            csv.writer(stream).writerows([["point", "modulus_pa", "layer_m", "found_pa", "low_pa", "high_pa", "offset_found_m", "offset_m",
                                           "peak_n", "error_at_3_mm", "median_error"]] + rows)


if __name__ == "__main__":
    main()
