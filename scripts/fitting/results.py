"""What a fit says: its report, its picture, its files."""
import contextlib
import csv
import math
import os

import numpy
import yaml

from fitting import uncertainty
from fitting.fitted_scene import fitted_text
from fitting.forward import DOUBTS, load_scene
from fitting.parameters import OFFSET

MOST_DRAWN = 8


def _estimates(answer):
    yield "%-52s %12s %10s %26s %16s %16s" % ("parameter", "value", "unit", "95 % interval", "of it noise ±", "mesh, step ±")
    for i, parameter in enumerate(answer.parameters):
        slope = parameter.slope(answer.point[i])
        bounded = numpy.isfinite(answer.half[i]) and answer.half[i] < 5.0
        between = "%.5g .. %.5g" % answer.interval(i) if bounded else "not identified"
        yield "%-52s %12.5g %10s %26s %16.3g %16.3g" % (parameter.key, answer.values[i], parameter.unit, between,
                                                      slope * answer.noise_half[i], slope * answer.model_half[i])


def _correlations(answer):
    yield "correlation of the estimates"
    for i, row in enumerate(answer.correlation):
        yield "%-52s %s" % (answer.parameters[i].key, " ".join("%+7.3f" % one for one in row[:i + 1]))


def _shares(answer, problem):
    yield "what is known about each comes from"
    for i, parameter in enumerate(answer.parameters):
        yield "%-52s %s" % (parameter.key, ", ".join("%s %.0f %%" % (run.recording.name, 100.0 * answer.shares[at, i])
                                                   for at, run in enumerate(problem.runs)))


def _quality(problem, answer, held_out):
    for run, done in zip(problem.runs, problem.forces([answer.point])[0]):
        wrong = (done.force_n - run.recording.force_n)[1:, run.recording.measured()]
        rms, peak = float(numpy.sqrt((wrong ** 2).sum(axis=1).mean())), run.recording.peak_n()
        yield "fitted   %-20s RMS error %.3g N, %.1f %% of its peak force" % (run.recording.name, rms, 100.0 * rms / peak)
    for one in held_out:
        yield "held-out %-20s RMS error %.3g N, %.1f %% of the RMS force; median %.1f %% of the force; %d samples%s" % (
            one.name, one.rms_n, 100.0 * one.share, 100.0 * one.median, one.samples, ", by the scene without --finer" if one.coarse else "")


def _doubts(problem, answer, held_out):
    """Sentences on what the simulator itself does not believe of the answer's runs and of those that predict."""
    runs = [(run.recording.name, done.doubts, False) for run, done in zip(problem.runs, problem.forces([answer.point])[0])]
    for name, doubts, coarse in runs + [(one.name, one.doubts, one.coarse) for one in held_out]:
        for field, steps in doubts.items():
            yield "do not trust the forces of %s%s: in %d step%s %s" % (
                name, " by the scene without --finer" if coarse else "", steps, "" if steps == 1 else "s", DOUBTS[field])


def _descents(costs):
    if len(costs) > 1 and max(costs) > 1.05 * min(costs):
        yield ("descents from %d starts ended at costs %s: the lowest is taken; --starts tries more" %
               (len(costs), ", ".join("%.4g" % cost for cost in costs)))


def report(answer, problem, held_out, costs):
    parts = [_estimates(answer), _correlations(answer), _shares(answer, problem), _quality(problem, answer, held_out),
             ["singular values of the weighted Jacobian: " + ", ".join("%.3g" % one for one in answer.singular)],
             list(uncertainty.at_bounds(answer)) + list(_doubts(problem, answer, held_out)) + list(_descents(costs)) + answer.unidentified]
    return "\n\n".join("\n".join(part) for part in map(list, parts) if part)


def figures(answer, problem, held_out, made_by):
    """Plain data, for YAML."""
    return {
        "made_by": made_by,
        "parameters": [{"key": parameter.key, "value": float(answer.values[i]), "unit": parameter.unit,
                        "interval_95": [float(end) for end in answer.interval(i)], "bounds": [parameter.low, parameter.high],
                        "noise_half_interval": float(parameter.slope(answer.point[i]) * answer.noise_half[i]),
                        "model_half_interval": float(parameter.slope(answer.point[i]) * answer.model_half[i])}
                       for i, parameter in enumerate(answer.parameters)],
        "correlation": [[round(float(one), 4) for one in row] for row in answer.correlation],
        "singular_values": [float(one) for one in answer.singular],
        "scale_n": [{"recording": run.recording.name, "scale_n": float(run.scale_n)} for run in problem.runs],
        "doubts": list(_doubts(problem, answer, held_out)),
        "held_out": [{"recording": one.name, "rms_n": one.rms_n, "share_of_rms_force": one.share, "median_share": one.median,
                      "samples": one.samples, "without_finer": one.coarse} for one in held_out],
        "evaluations": problem.evaluations,
    }


def draw(path, answer, problem):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    runs = problem.runs[:MOST_DRAWN]
    figure, axes = pyplot.subplots(2, len(runs), figsize=(1.5 + 4.0 * len(runs), 6.0), squeeze=False, sharex="col",
                                   gridspec_kw={"height_ratios": [2, 1]}, constrained_layout=True)
    for column, (run, done) in enumerate(zip(runs, problem.forces([answer.point])[0])):
        recording, times, force = run.recording, run.recording.times_s, done.force_n
        for axis in recording.measured():
            colour = "C%d" % axis
            axes[0, column].plot(times, recording.force_n[:, axis], ".", ms=2, color=colour, alpha=0.5, label="%s measured" % "xyz"[axis])
            axes[0, column].plot(times[1:], force[1:, axis], "-", lw=1.2, color=colour, label="%s fitted" % "xyz"[axis])
            axes[1, column].plot(times[1:], (force - recording.force_n)[1:, axis], ".", ms=2, color=colour)
        axes[1, column].axhspan(-2.0 * run.scale_n, 2.0 * run.scale_n, color="0.9", zorder=0)
        axes[0, column].set_title(recording.name)
        axes[1, column].set_xlabel("time (s)")
    axes[0, 0].set_ylabel("force on the tool (N)")
    axes[1, 0].set_ylabel("fitted - measured (N)\ngrey: 2 standard deviations")
    axes[0, 0].legend(fontsize=7)
    figure.savefig(path, dpi=110, format="png")
    pyplot.close(figure)


def _write_residuals(path, answer, problem):
    with open(path, "w", newline="", encoding="utf-8") as stream:
        table = csv.writer(stream)
        table.writerow(["recording", "time_s"] + ["%s_%s_n" % (what, axis) for what in ("measured", "fitted") for axis in "xyz"])
        for run, done in zip(problem.runs, problem.forces([answer.point])[0]):
            for time, measured, fitted in list(zip(run.recording.times_s, run.recording.force_n, done.force_n))[1:]:
                table.writerow([run.recording.name, "%.6f" % time] + ["" if math.isnan(one) else "%.6g" % one for one in measured] +
                               ["%.6g" % one for one in fitted])


def write(folder, setup, finer, answer, problem, held_out, made_by, inputs, whole_file):
    """All of them or none: they take their names when each is written."""
    os.makedirs(folder, exist_ok=True)
    settings = dict(setup.settings(answer.values), **finer)
    settings.pop("instruments.%s.base_pose.position_m" % setup.tool.name, None)  # the offset is of the recordings
    heading = ["Fitted by %s" % made_by] + [
        "  %s %.5g %s, 95 %%: %.5g .. %.5g%s" % ((parameter.key, answer.values[i], parameter.unit) + answer.interval(i) + (
            " (of the recordings, not of this scene)" if parameter.key == OFFSET else "",)) for i, parameter in enumerate(answer.parameters)]
    heading += list(_doubts(problem, answer, held_out))
    text = fitted_text(setup.scene, settings, folder, heading)
    names = [os.path.join(folder, name) for name in ("scene.yaml", "fit.yaml", "residuals.csv", "residuals.png")]
    with contextlib.ExitStack() as stack:
        scene, numbers, residuals, picture = [stack.enter_context(whole_file(name, inputs)) for name in names]
        with open(scene, "w", encoding="utf-8") as stream:
            stream.write(text)
        load_scene(scene)
        with open(numbers, "w", encoding="utf-8") as stream:
            yaml.safe_dump(figures(answer, problem, held_out, made_by), stream, sort_keys=False)
        _write_residuals(residuals, answer, problem)
        draw(picture, answer, problem)
    return names
