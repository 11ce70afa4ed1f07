#!/usr/bin/python3
"""Fit on a shallow press, foretell a deep one: a ball presses 2 mm and 3 mm deep at many points of a layered phantom whose stiffness and
layer vary from point to point. Each point's modulus and height of touch are fitted to the first press; the error of the second is of the force at 3 mm
and over the whole press. doc/calibration.md has its figures.

  benchmark/fitting/hertz.py --points 200

The truth has cells half as wide, and layers to half a millimetre where the fit knows them to one; forces have 5 % noise at 500 Hz, poses are
off by 0.1 mm (each point its own).
"""
import argparse
import csv
import os
import sys

import numpy

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import phantom_study as study  # noqa: E402 (the path comes first)
from fitting import forward, run  # noqa: E402

SCENE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "layered.yaml")
RADIUS_M, HEIGHT_M, DEEP_RATIO = 0.0035, 0.014, 3.0
SPEED_MM_PER_S = 10.0
E_KEY, DEEP_E_KEY = "tissues.phantom.material.youngs_modulus_pa", "tissues.phantom.regions.deep.material.youngs_modulus_pa"
DEEP_TOP_KEY = "tissues.phantom.regions.deep.where.0.box.max_m.2"
FINER = {"tissues.phantom.block.cells": [18, 18, 28], "tissues.phantom.block.grading.x.growth": 1.17,
         "tissues.phantom.block.grading.y.growth": 1.17, "step.max_step_s": 0.0025}


def phantom(generator):
    """Modulus (Pa) and soft layer (m) at a point: 15 % and 1 mm about 8 kPa and 5.5 mm."""
    modulus = 8000.0 * numpy.exp(0.15 * generator.standard_normal())
    return modulus, numpy.clip(5.5e-3 + 1e-3 * generator.standard_normal(), 4e-3, 7e-3)


def press(depth_mm):
    times, positions = study.press(depth_mm, SPEED_MM_PER_S, 0.1)
    positions[:, 2] += RADIUS_M - study.BALL_M
    return times, positions


def layer_keys(modulus, layer_m, to_m):
    """The layer to the next cell of the mesh."""
    layer_m = round(layer_m / to_m) * to_m
    return {E_KEY: modulus, DEEP_E_KEY: DEEP_RATIO * modulus, DEEP_TOP_KEY: HEIGHT_M - layer_m}


class PointSetup(run.Setup):
    """Both layers share the fitted modulus; the scene's layer is the point's."""
    layer_m = 0.0

    def settings(self, values):
        settings = super().settings(values)
        return dict(settings, **layer_keys(settings[E_KEY], self.layer_m, 1e-3))


def point(seed, arguments):
    """(modulus found / true, interval holds it, error at the deepest, median error over the second press)."""
    generator = numpy.random.default_rng(seed)
    modulus, layer_m = phantom(generator)
    noise = study.Noise()
    offset_m = noise.offset_m * generator.standard_normal(3)
    truth = dict(layer_keys(modulus, layer_m, 0.5e-3), **({} if arguments.same_mesh else FINER))
    shallow, deep = press(2.0), press(3.0)
    shallow_n, deep_n = study.true_forces(truth, shallow, SCENE), study.true_forces(truth, deep, SCENE)
    setup = PointSetup(**vars(study.setup(["material.youngs_modulus_pa:2e3..4e4", "offset_m:-5e-4..5e-4"], forward.Workers(1), SCENE, starts=0,
                                          seed=seed, say=lambda line: None)))
    setup.layer_m = layer_m
    seen = [study.as_fit_sees(study.record(name, motion, force, noise, offset_m, generator))
            for name, motion, force in (("shallow", shallow, shallow_n), ("deep", deep, deep_n))]
    answer, _, _, _ = run.fit(setup, seen[:1], cross_check=False)
    # The prediction is compared with the true force, whose own noise is not the model's.
    quiet = study.measured.thin(study.measured.Recording("deep", deep[0], deep_n, deep[1]), 100.0)
    stranger = run.runs_of(setup, seen[1:])[0]
    force, _ = setup.forces(answer.values, stranger)
    stranger.recording = quiet
    loud = run.foretold(stranger, force, numpy.arange(len(force)) > 0)
    deepest = numpy.abs(quiet.force_n[:, 2]).argmax()
    low, high = answer.interval(0)
    return [seed, modulus, layer_m, answer.values[0], low, high, answer.values[1], offset_m[2], quiet.force_n[deepest, 2],
            force[deepest, 2] / quiet.force_n[deepest, 2] - 1.0, loud.median]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=200, help="default: %(default)s")
    parser.add_argument("--same-mesh", action="store_true", help="the truth by the fit's own mesh")
    parser.add_argument("--csv", help="table of every point")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    rows = forward.Workers(arguments.workers).map(point, [(seed, arguments) for seed in range(1, arguments.points + 1)])
    table = numpy.array(rows)
    peak, over = numpy.abs(table[:, 9]), table[:, 10]
    print("%d points, modulus %.0f to %.0f Pa, soft layer %.1f to %.1f mm" % (
        len(table), table[:, 1].min(), table[:, 1].max(), 1e3 * table[:, 2].min(), 1e3 * table[:, 2].max()))
    print("force at 3 mm foretold: median error %.2f %%, nine of ten within %.2f %%, largest %.2f %%" % (
        tuple(100.0 * x for x in (numpy.median(peak), numpy.quantile(peak, 0.9), peak.max()))))
    print("over the press to 3 mm: median of the points' median errors %.2f %%" % (100.0 * numpy.median(over)))
    error = numpy.abs(table[:, 3] / table[:, 1] - 1.0)
    print("modulus: median error %.2f %%, inside the 95 %% interval %d of %d" % (
        100.0 * numpy.median(error), ((table[:, 4] <= table[:, 1]) & (table[:, 1] <= table[:, 5])).sum(), len(table)))
    if arguments.csv:
        with open(arguments.csv, "w", newline="", encoding="utf-8") as stream:
            csv.writer(stream).writerows([["point", "modulus_pa", "layer_m", "found_pa", "low_pa", "high_pa", "offset_found_m", "offset_m",
                                           "peak_n", "error_at_peak", "median_error"]] + rows)


if __name__ == "__main__":
    main()
