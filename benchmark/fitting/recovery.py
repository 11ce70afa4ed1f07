#!/usr/bin/python3
"""Does fit.py find what is there? Seeded trials: a phantom of random stiffness, damping and friction is pressed, swung upon and dragged over in
a finer simulation, recorded with noise, and fitted. Prints errors and how often the stated intervals hold the truth; exit code 1 if an error is above 3 %
(E), 15 % (damping) or .02 (friction), or fewer than nine of ten intervals hold it. doc/calibration.md has its
figures.

  benchmark/fitting/recovery.py --trials 10             some 100 s each on two cores
  benchmark/fitting/recovery.py --static                instead, static friction by static_friction.py: a plate turns on a ring of that phantom
  benchmark/fitting/recovery.py --same-mesh             data of the very model that fits them: what noise alone does
  benchmark/fitting/recovery.py --write-example FOLDER  press.csv, swing.csv, drag.csv, deeper.csv, twist.csv of config/calibration
"""
import argparse
import csv
import os
import sys

import numpy

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))
import phantom_study as study  # noqa: E402 (the path comes first)
from fitting import breakaway, forward, run  # noqa: E402

# The ball's fit has the scene's static friction, the truth another: what a drag does not tell.
FITS = {"E": "youngs_modulus_pa:1e3..1e5", "damping": "stiffness_s:1e-3..1e-1", "kinetic": "kinetic:0.05..1.2", "offset": "offset_m:-5e-4..5e-4"}
NAMES = ["E", "damping", "kinetic", "offset"]
WANTED = {"E": 0.03, "damping": 0.15, "kinetic": 0.02, "static": 0.02}  # largest errors that are allowed; and nine of ten truths inside
EXAMPLE = {"youngs_modulus_pa": 7000.0, "stiffness_s": 0.014, "static": 0.45, "kinetic": 0.3}


def random_truth(generator):
    kinetic = generator.uniform(0.2, 0.5)
    return {"youngs_modulus_pa": 4e3 * 5.0 ** generator.uniform(), "stiffness_s": 5e-3 * 4.0 ** generator.uniform(),
            "static": kinetic + generator.uniform(0.05, 0.2), "kinetic": kinetic}


def recordings(truth, noise, generator, names, workers, settings):
    motions = {name: study.MOTIONS[name]() for name in names}
    keys = dict(study.truth_keys(**truth), **settings)
    forces = workers.map(study.true_forces, [(keys, motion) for motion in motions.values()])
    offset_m = noise.offset_m * generator.standard_normal(3)
    return [study.record(name, motion, force, noise, offset_m, generator)
            for (name, motion), force in zip(motions.items(), forces)], offset_m


def trial(seed, noise, arguments, workers):
    """Rows: trial, parameter, truth, estimate, interval, and its halves by noise and by model."""
    generator = numpy.random.default_rng(seed)
    truth = random_truth(generator)
    settings = {} if arguments.same_mesh else study.TRUTH
    raw, offset_m = recordings(truth, noise, generator, [*study.PROTOCOL], workers, settings)
    setup = study.setup([FITS[name] for name in NAMES], workers, starts=0, seed=seed, say=print if arguments.verbose else lambda line: None)
    finer = {} if arguments.same_mesh else study.FINER
    answer, _, problem, _ = run.fit(setup, [study.as_fit_sees(one) for one in raw], cross_check=False, finer=finer)
    for sentence in answer.unidentified:
        print("trial %d: %s" % (seed, sentence))
    true_values = {"E": truth["youngs_modulus_pa"], "damping": truth["stiffness_s"], "kinetic": truth["kinetic"], "offset": offset_m[2]}
    for i, name in enumerate(NAMES):
        true = true_values[name]
        slope = answer.parameters[i].slope(answer.point[i])
        yield [seed, name, true, answer.values[i], *answer.interval(i), slope * answer.noise_half[i], slope * answer.model_half[i],
               problem.evaluations]


def static_trial(seed, noise, arguments):
    """Likewise. E and damping are known as well as the ball's recordings leave them, by the medians of their errors and more."""
    generator = numpy.random.default_rng(seed)
    truth, motion = random_truth(generator), study.twist()
    keys = [study.ring_keys(**truth)] + [{} if arguments.same_mesh else study.ring_mesh(*one) for one in (study.RING_TRUTH, study.RING_FINER)]
    try:
        recording = study.record_twist(dict(keys[0], **keys[1]), motion, noise, generator)
        known = study.ring_keys(truth["youngs_modulus_pa"] * (1.0 + 0.02 * generator.standard_normal()),
                                truth["stiffness_s"] * (1.0 + 0.05 * generator.standard_normal()))
        tool = forward.Tool(study.RING, study.PLATE, {})
        found, _ = breakaway.find(study.RING, ("friction.0.static", "friction.0.kinetic"), tool, recording, (0.5, 0.4), keys[2], known,
                                  print if arguments.verbose else lambda line: None)
    finally:
        for one in keys[1:]:
            if one:
                os.remove(one["tissues.ring.mesh.file"])
    for name, one in zip(("static", "kinetic"), found):
        yield [seed, name, truth[name], one.value, *one.interval(), one.noise_half, one.model_half, 0]


def summary(rows):
    print("| parameter | error: median, largest | 95 % interval: median half width | truth inside | by noise alone |\n|---|---|---|---|---|")
    good = True
    for name in dict.fromkeys(row[1] for row in rows):
        mine = numpy.array([row[2:8] for row in rows if row[1] == name], float)
        scale = mine[:, 0] if name in ("E", "damping") else numpy.full(len(mine), 1e-3 if name == "offset" else 1.0)
        error, half = numpy.abs(mine[:, 1] - mine[:, 0]) / scale, 0.5 * (mine[:, 3] - mine[:, 2]) / scale
        inside = (mine[:, 2] <= mine[:, 0]) & (mine[:, 0] <= mine[:, 3])
        by_noise = numpy.abs(mine[:, 1] - mine[:, 0]) <= mine[:, 4]
        form = {"E": "%.1f %%", "damping": "%.1f %%", "offset": "%.3f mm"}.get(name, "%.3f")
        factor = 100.0 if name in ("E", "damping") else 1.0
        print("| %s | %s, %s | %s | %d of %d | %d of %d |" % (
            name, form % (factor * numpy.median(error)), form % (factor * error.max()), form % (factor * numpy.median(half)),
            inside.sum(), len(mine), by_noise.sum(), len(mine)))
        wanted = WANTED.get(name, numpy.inf)
        good = good and error.max() <= wanted and inside.sum() >= 0.9 * len(mine)
    return good


def write_twist_example(folder, generator):
    mesh = study.ring_mesh(*study.RING_TRUTH)
    try:
        recording = study.record_twist(dict(study.ring_keys(**EXAMPLE), **mesh), study.twist(count=6), study.Noise(), generator)
    finally:
        os.remove(mesh["tissues.ring.mesh.file"])
    os.remove(mesh["tissues.ring.mesh.file"])
    study.write_twist(os.path.join(folder, recording.name + ".csv"), study.measured.thin(recording, 50.0))


def write_example(folder, workers):
    generator = numpy.random.default_rng(1)
    made, offset_m = recordings(EXAMPLE, study.Noise(), generator, ["press", "swing", "drag", "deeper"], workers, study.TRUTH)
    for recording in made:
        study.write_table(os.path.join(folder, recording.name + ".csv"), study.measured.thin(recording, 250.0))
    write_twist_example(folder, generator)
    print("%s: %s, tool deeper than recorded by %.4g mm" % (folder, EXAMPLE, 1e3 * offset_m[2]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--trials", type=int, default=10, help="default: %(default)s")
    parser.add_argument("--first-seed", type=int, default=1, help="default: %(default)s")
    parser.add_argument("--no-pose-noise", action="store_true", help="poses are off by the session's constant alone")
    parser.add_argument("--static", action="store_true")
    parser.add_argument("--same-mesh", action="store_true")
    parser.add_argument("--csv", help="table of every trial")
    parser.add_argument("--verbose", action="store_true", help="the fits' progress")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--write-example", metavar="FOLDER")
    arguments = parser.parse_args()
    workers = forward.Workers(arguments.workers)
    if arguments.write_example:
        return write_example(arguments.write_example, workers)
    noise, rows = study.Noise(pose_m=0.0 if arguments.no_pose_noise else 1e-4), []
    for seed in range(arguments.first_seed, arguments.first_seed + arguments.trials):
        rows += list(static_trial(seed, noise, arguments) if arguments.static else trial(seed, noise, arguments, workers))
        for row in [row for row in rows if row[0] == seed]:
            print("trial %d %-8s truth %.5g found %.5g  95 %%: %.5g .. %.5g  noise ± %.3g model ± %.3g  %d evaluations" % tuple(row), flush=True)
    good = summary(rows)
    if arguments.csv:
        with open(arguments.csv, "w", newline="", encoding="utf-8") as stream:
            csv.writer(stream).writerows([["trial", "parameter", "truth", "found", "low", "high", "noise_half", "model_half", "evaluations"]] + rows)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
