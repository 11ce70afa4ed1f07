"""Least squares over runs of the scene. Unknowns are parts of the way between bounds, 0 to 1; residuals are divided by their recording's scale, a
robust standard deviation."""
import dataclasses
import time

import numpy
from scipy import optimize

from fitting import FitError
from fitting.latin_hypercube import latin_hypercube

FIRST_SCALE = 0.05  # of the peak force, until residuals give it
LEAST_SCALE = 1e-4  # of the peak force: what a run's solver leaves, see SOLVER in forward.py
LEAST_TOUCHING = 10  # samples, to tell a scale from those alone
HUBER = 1.5          # scales from which on a residual counts by its magnitude only; 96 % efficient with normal noise
STEP = 0.01          # of the way between bounds, for differences: far above the solver's tolerance, far below what bends
MOST_ITERATIONS, MOST_CORRECTIONS = 25, 6
CORRECTED, LONGEST_CORRECTION = 2e-3, 0.2  # of the way between bounds: the last correction is as small as that
FIRST_TOLERANCE, TOLERANCE = 1e-2, 1e-4  # of cost and point: of the descent that finds the valley, and of the one to its bottom


@dataclasses.dataclass
class Run:
    """A recording prepared for the scene."""
    recording: object
    motion: numpy.ndarray
    fitted: numpy.ndarray  # samples that count
    scale_n: float = 0.0

    def __post_init__(self):
        self.scale_n = FIRST_SCALE * self.recording.peak_n()


class Problem:
    """Forces of all runs at a point (an array of parts)."""

    def __init__(self, runs, parameters, forces_of, workers, say, settings_of=lambda values: {}):
        """forces_of(values, run) -> forward.Simulated; settings_of(values) -> {key of the scene: value}."""
        self.runs, self.parameters, self._settings_of = runs, parameters, settings_of
        self._forces_of, self._workers, self._say = forces_of, workers, say
        self._known = {}
        self._began, self.evaluations = time.monotonic(), 0

    def values(self, point):
        return [float(parameter.value(part)) for parameter, part in zip(self.parameters, point)]

    def in_order(self, point):
        """The same forces by the parameters as they are reported: of a pair of frictions the larger one is static."""
        settings = self._settings_of(self.values(point))
        ordered = [p.part(settings[p.key]) if p.key in settings else part for p, part in zip(self.parameters, point)]
        return numpy.clip(ordered, 0.0, 1.0)

    def forces(self, points):
        """[[forward.Simulated of each run] of each point]; points seen before are not run again."""
        keys = [tuple(float(part) for part in point) for point in points]
        fresh = [key for i, key in enumerate(keys) if key not in self._known and key not in keys[:i]]
        done = self._workers.map(self._forces_of, [(self.values(key), run) for key in fresh for run in self.runs])
        for i, key in enumerate(fresh):
            self._known[key] = done[i * len(self.runs):(i + 1) * len(self.runs)]
        self.evaluations += len(fresh)
        return [self._known[key] for key in keys]

    def residual(self, forces):
        """All weighted residuals of one point."""
        return numpy.concatenate([part for run, done in zip(self.runs, forces) for part in _weighted(run, done.force_n, run.fitted)])

    def at(self, point):
        return self.residual(self.forces([point])[0])

    def jacobian(self, point, both_sides=True):
        """By differences to both sides, or to the side with more room: half the runs, and good enough to go on by."""
        inwards = numpy.where(point > 0.5, -STEP, STEP)
        low, high = numpy.clip(point - STEP, 0.0, 1.0) if both_sides else point, numpy.clip(point + STEP, 0.0, 1.0) if both_sides else point + inwards
        points = [numpy.where(numpy.arange(len(point)) == i, end, point) for i in range(len(point)) for end in (low, high)]
        residuals = [self.residual(forces) for forces in self.forces(points)]
        return numpy.stack([(residuals[2 * i + 1] - residuals[2 * i]) / (high[i] - low[i]) for i in range(len(point))], axis=1)

    def tell(self, what, point):
        residual = self.at(point)
        self._say("%s: %d evaluations, %.0f s, cost %.4g; %s" % (
            what, self.evaluations, time.monotonic() - self._began, 0.5 * float(residual @ residual),
            ", ".join("%s %.4g" % (p.label, v) for p, v in zip(self.parameters, self.values(point)))))


def _weighted(run, force, rows):
    """Of each measured axis."""
    rows = rows & (numpy.arange(len(rows)) > 0)  # the first sample only places the tool
    return [(force[rows, axis] - run.recording.force_n[rows, axis]) / run.scale_n for axis in run.recording.measured()]


def set_scales(problem, point):
    """From the residuals at a point, each recording for itself: 1.48 median deviations are a standard deviation."""
    for run, done in zip(problem.runs, problem.forces([point])[0]):
        touching = run.fitted & done.force_n.any(axis=1)  # off the tissue there is the sensor's own noise alone
        rows = touching if touching.sum() > LEAST_TOUCHING else run.fitted
        residual = numpy.concatenate(_weighted(run, done.force_n, rows)) * run.scale_n
        run.scale_n = max(1.4826 * float(numpy.median(numpy.abs(residual))), LEAST_SCALE * run.recording.peak_n())


def starts(problem, count, seed):
    """The scene's own point, then a Latin hypercube."""
    own = [parameter.part(parameter.start) for parameter in problem.parameters]
    return [numpy.clip(own, 0.0, 1.0)] + list(latin_hypercube(count, len(own), seed))


def _require_contact(problem, point):
    for run, done in zip(problem.runs, problem.forces([point])[0]):
        if not numpy.abs(done.force_n).max() > 0.0:
            raise FitError("%s: up to %.3g N were measured, but the tool of the scene never touches: are its positions those of the tip in the "
                           "scene's world, in metres, or its joints as the URDF has them?" % (run.recording.name, run.recording.peak_n()))


def _descend(problem, point, loss, name, tolerance):
    def jacobian(at):
        problem.tell(name, at)
        return problem.jacobian(at, both_sides=tolerance <= TOLERANCE)

    point = numpy.clip(point, 1e-6, 1.0 - 1e-6)
    if not problem.jacobian(point, both_sides=tolerance <= TOLERANCE).any():  # nothing to go by, on which SciPy divides by 0
        return optimize.OptimizeResult(x=point, cost=0.5 * float(problem.at(point) @ problem.at(point)))
    try:
        return optimize.least_squares(problem.at, point, jacobian, bounds=(0.0, 1.0), loss=loss, f_scale=HUBER,
                                       ftol=tolerance, xtol=tolerance, gtol=None, max_nfev=MOST_ITERATIONS)
    except ValueError as error:  # a residual that is not finite
        raise FitError("the fit cannot go on: %s" % error) from error


def search(problem, count, seed):
    """(point, [costs of the descents that were tried])."""
    points = starts(problem, count, seed)
    costs = [float(numpy.abs(problem.residual(forces)).sum()) for forces in problem.forces(points)]
    order = numpy.argsort(costs, kind="stable")
    problem.tell("best of %d starts" % len(points), points[order[0]])
    _require_contact(problem, points[order[0]])
    tried = [_descend(problem, points[i], "soft_l1", "descent", FIRST_TOLERANCE) for i in _apart(points, order)]
    return min(tried, key=lambda found: found.cost).x, [found.cost for found in tried]


def _apart(points, order):
    """The best start, and the best of those away from it."""
    rest = [i for i in order[1:] if numpy.abs(points[i] - points[order[0]]).max() > 0.2]
    return [order[0]] + rest[:1]


def refine(problem, point, tolerance=TOLERANCE):
    """From a point near the answer: scales from its residuals, then robust least squares."""
    set_scales(problem, point)
    found = _descend(problem, point, "huber", "refinement", tolerance)
    point = problem.in_order(found.x)
    set_scales(problem, point)
    problem.tell("done", point)
    return point


def corrected(coarse, point, fine):
    """The point of a scene with a finer mesh: by residuals of that and derivatives of the coarse one, which differ little (chord method), a
    few runs of the finer scene do in place of a whole fit of it. `fine` then has the coarse one's derivatives as its own."""
    start = numpy.array(point)
    fine.jacobian = lambda at, both_sides=True: coarse.jacobian(start)  # run once; weighted by the scales of the moment
    for _ in range(MOST_CORRECTIONS):
        set_scales(fine, point)
        fine.tell("correction", point)
        residual = fine.at(point)
        weight = numpy.sqrt(numpy.minimum(1.0, HUBER / numpy.maximum(numpy.abs(residual), 1e-300)))
        step = numpy.linalg.lstsq(weight[:, None] * fine.jacobian(point), -weight * residual, rcond=1e-10)[0]
        moved = fine.in_order(numpy.clip(point + numpy.clip(step, -LONGEST_CORRECTION, LONGEST_CORRECTION), 0.0, 1.0))
        change, point = numpy.abs(moved - point).max(), moved
        if change < CORRECTED:
            break
    set_scales(fine, point)
    fine.tell("corrected", point)
    return point
