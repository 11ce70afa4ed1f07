"""How well the data identify the parameters: covariance, 95 % intervals, correlation, and what they do not identify.

Near the answer residuals are r = r0 + J d, and the answer's covariance is C = H^-1 M H^-1 (the sandwich) with H = J^T J (Huber's: of the
residuals not clipped) and M = sum over recordings of tau sum r_i^2 J_i^T J_i: each residual's own square, since noise is not alike on and off the
tissue (White 1980), and tau = 1 + 2 sum rho_k, their autocorrelation time in samples, since neighbours that err alike tell less than as many
independent samples. What mesh, step and solver make of the forces is no noise. Twice the simulator's own estimate of it (a likely size: eight times
in ten within a factor of two) moves all forces one way, and the answer by H^-1 J^T e; where the answer was corrected to a finer scene, half the
correction is left to do (second order, cells two thirds the size; Roache's grid convergence): the larger of the two counts.
"""
import dataclasses

import numpy
from scipy import stats

from fitting.solve import HUBER

LEVEL = 0.95
IDENTIFIED_LOG = 0.25    # half an interval, as a share of the value, up to which a parameter known by its order of magnitude is identified
IDENTIFIED_RANGE = 0.25  # ... and as a share of the way between its bounds
ALIKE = 0.9        # correlation from which on two parameters are named together
LIKELY = 2.0       # times the simulator's estimate of its error
LEFT_TO_CORRECT = 0.5
FLAT = 1e-9        # of the largest curvature
AT_BOUND = 1e-3    # of the way between bounds


@dataclasses.dataclass
class Answer:
    parameters: list
    point: numpy.ndarray
    values: list
    half: numpy.ndarray         # of the 95 % interval, in parts of the way
    noise_half: numpy.ndarray   # what of it is noise
    model_half: numpy.ndarray   # ... and mesh, step, solver
    alone_half: numpy.ndarray   # if all others were known
    correlation: numpy.ndarray
    singular: numpy.ndarray     # of the Jacobian per part of the way, weighted forces
    shares: numpy.ndarray       # runs x parameters: of what is known about it
    unidentified: list          # sentences; empty: all are identified

    def interval(self, i):
        parameter = self.parameters[i]
        return tuple(parameter.value(self.point[i] + sign * self.half[i]) for sign in (-1.0, 1.0))


def autocorrelation_time(residual, fitted=0):
    """1 + 2 sum of rho; 1 for white noise. Of the sum up to the first rho not above 0, and that of the first-order process with this rho_1, the
    larger: a short piece of slow noise shows less of it than there is. The mean is not taken off, and rho_1 is freed of the bias that
    estimating it (Kendall 1954) and `fitted` parameters have."""
    count = len(residual)
    power = float(residual @ residual) / max(count, 1)
    if count < 8 or not power > 0.0:
        return 1.0

    def rho(lag):
        return float(residual[:-lag] @ residual[lag:]) / (count - lag) / power

    total, lag = 1.0, 1
    while lag < count // 2 and rho(lag) > 0.0:
        total, lag = total + 2.0 * rho(lag), lag + 1
    first = rho(1)
    first = min(first + ((1.0 + 3.0 * first) + fitted * (1.0 + first)) / count, 0.99) if first > 2.0 / count ** 0.5 else 0.0
    return min(max(total, (1.0 + first) / (1.0 - first)), 0.5 * count)


def _groups(problem):
    """Rows of the residual that are of one axis of one run."""
    start = 0
    for index, run in enumerate(problem.runs):
        count = int(run.fitted[1:].sum())
        for _ in run.recording.measured():
            yield index, slice(start, start + count)
            start += count


def _model_error(problem, forces):
    """Of each force along itself, weighted as the residuals are."""
    parts = []
    for run, done in zip(problem.runs, forces):
        force, error = done.force_n, done.error_n
        size = numpy.maximum(numpy.linalg.norm(force, axis=1), 1e-300)
        rows = run.fitted & (numpy.arange(len(size)) > 0)
        parts += [(LIKELY * error * force[:, axis] / size)[rows] / run.scale_n for axis in run.recording.measured()]
    return numpy.concatenate(parts)


def assess(problem, point, correction=0.0):
    """correction: of the point, by the finer scene."""
    forces = problem.forces([point])[0]
    residual, jacobian = problem.residual(forces), problem.jacobian(point)
    inlier = numpy.abs(residual) <= HUBER
    curvature = jacobian[inlier].T @ jacobian[inlier]
    sums, information, independent = {}, numpy.zeros((len(problem.runs), len(point))), 0.0
    for run, rows in _groups(problem):
        clipped = numpy.clip(residual[rows], -HUBER, HUBER)
        time = autocorrelation_time(clipped, len(point))
        scores = time ** 0.5 * clipped[:, None] * jacobian[rows]
        sums[run] = sums.get(run, 0.0) + scores  # of its axes, sample by sample: an error of the pose moves all of them
        information[run] += (jacobian[rows] ** 2).sum(axis=0)
        independent += len(clipped) / time
    # Directions in which nothing is known become very long ones, not none.
    least = FLAT * max(numpy.linalg.norm(curvature, 2), 1e-100) * numpy.eye(len(point))
    inverse, meat = numpy.linalg.inv(curvature + least), sum(scores.T @ scores for scores in sums.values()) + least
    freedom = max(independent - len(point), 1.0)
    meat *= independent / freedom  # the fit has taken its share of the residuals
    covariance = inverse @ meat @ inverse
    quantile = stats.t.ppf(0.5 + 0.5 * LEVEL, freedom)
    deviation = numpy.sqrt(numpy.maximum(numpy.diag(covariance), 0.0))
    hardly = numpy.diag(curvature) <= 1e-12 * max(numpy.diag(curvature).max(), 1e-300)
    noise = numpy.where(hardly, numpy.inf, quantile * deviation)
    alone = quantile * numpy.sqrt(numpy.diag(meat)) / numpy.maximum(numpy.diag(curvature), 1e-300)
    # A residual that is clipped stays where it is, whatever the model errs by.
    shift = inverse @ (jacobian[inlier].T @ _model_error(problem, forces)[inlier])
    model = numpy.maximum(numpy.abs(shift), LEFT_TO_CORRECT * numpy.abs(correction))
    safe = numpy.where(deviation > 0.0, deviation, 1.0)
    answer = Answer(
        parameters=problem.parameters, point=point, values=problem.values(point), half=numpy.sqrt(noise ** 2 + model ** 2), noise_half=noise,
        model_half=model, alone_half=numpy.where(hardly, numpy.inf, alone), correlation=covariance / numpy.outer(safe, safe),
        singular=numpy.linalg.svd(jacobian, compute_uv=False), shares=information / numpy.maximum(information.sum(axis=0), 1e-300), unidentified=[])
    answer.unidentified = [sentence for i in range(len(point)) for sentence in _unidentified(answer, i)]
    return answer


def _limit(parameter):
    """Half an interval, in parts of the way, up to which a parameter is identified."""
    if parameter.is_log:
        return min(IDENTIFIED_RANGE, numpy.log1p(IDENTIFIED_LOG) / numpy.log(parameter.high / parameter.low))
    return IDENTIFIED_RANGE


def _percent(answer, i, half):
    parameter = answer.parameters[i]
    unit = parameter.slope(answer.point[i]) * half
    return "%.0f %%" % (100.0 * unit / answer.values[i]) if parameter.is_log else "%.2g %s" % (unit, parameter.unit)


def _unidentified(answer, i):
    parameter, half, alone = answer.parameters[i], answer.noise_half[i], answer.alone_half[i]
    limit = _limit(parameter)
    if half <= limit:
        return
    if alone > limit:
        yield ("these data do not identify %s: they hardly depend on it where it is %.3g %s; leave its --fit out, or measure what depends on it" %
               (parameter.label, answer.values[i], parameter.unit)).replace("  ", " ")
        return
    others = sorted((j for j in range(len(answer.values)) if j != i), key=lambda j: -abs(answer.correlation[i, j]))
    alike = [j for j in others if abs(answer.correlation[i, j]) >= ALIKE] or others[:1]
    yield ("these data cannot separate %s from %s: known to ± %s if the other were known, to ± %s without (correlation %s); "
           "measure one of them otherwise and leave its --fit out, or add recordings that they change differently" % (
               parameter.label, " and ".join(answer.parameters[j].label for j in alike), _percent(answer, i, alone),
               _percent(answer, i, half), ", ".join("%+.3f" % answer.correlation[i, j] for j in alike)))


def at_bounds(answer):
    """Sentences on parameters that the search would have taken beyond a bound."""
    for parameter, part, value in zip(answer.parameters, answer.point, answer.values):
        if min(part, 1.0 - part) < AT_BOUND:
            yield "%s is at its bound %.4g %s: widen the bounds, or the scene is not what was measured" % (parameter.label, value, parameter.unit)
