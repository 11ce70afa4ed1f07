"""A whole fit: from a scene, recordings and parameters to an Answer and to how well it predicts what it was not fitted to."""
import dataclasses

import numpy

from fitting import FitError, forward, solve, uncertainty

BLOCKS, HELD_OUT_OF = 20, 5  # in time; every fifth of them is held out of the first fit


@dataclasses.dataclass
class Setup:
    scene: str
    keys: object  # SceneKeys
    tool: object  # forward.Tool
    parameters: list
    approach: numpy.ndarray  # unit vector in the world, of the tool towards the tissue
    workers: object
    starts: int = 8
    seed: int = 1
    say: object = print

    def settings(self, values):
        return self.keys.settings(self.parameters, values, self.tool.name, self.approach)

    def forces(self, values, run, more=None):
        """more: {key: value} besides those that are fitted."""
        return forward.forces(self.scene, dict(self.settings(values), **(more or {})), self.tool.name, run.recording.times_s, run.motion)

    def problem(self, runs, more=None):
        return solve.Problem(runs, self.parameters, lambda values, run: self.forces(values, run, more), self.workers, self.say, self.settings)


@dataclasses.dataclass
class HeldOut:
    """Of one recording that had no part in the fit, or of the parts of one."""
    name: str
    rms_n: float
    share: float    # of the RMS of what was measured there
    median: float   # median of |error| over |measured|, of samples with a tenth of the peak force or more
    samples: int
    doubts: dict = dataclasses.field(default_factory=dict)  # of a run that nothing else tells of
    coarse: bool = False  # predicted by the scene without the finer mesh or step


def _force_errors(run, force, rows):
    axes = run.recording.measured()
    return (force - run.recording.force_n)[numpy.ix_(rows, axes)], run.recording.force_n[numpy.ix_(rows, axes)]


def prediction_error(run, force, rows, doubts=None, coarse=False):
    wrong, measured = _force_errors(run, force, rows)
    size, error = numpy.linalg.norm(measured, axis=1), numpy.linalg.norm(wrong, axis=1)
    loud = size >= 0.1 * run.recording.peak_n()
    rms = float(numpy.sqrt((error ** 2).mean()))
    return HeldOut(run.recording.name, rms, rms / max(float(numpy.sqrt((size ** 2).mean())), 1e-300),
                   float(numpy.median(error[loud] / size[loud])) if loud.any() else float("nan"), len(error), doubts or {}, coarse)


def runs_of(setup, recordings):
    return [solve.Run(recording, setup.tool.motion(recording), numpy.ones(len(recording.times_s), bool)) for recording in recordings]


def hold_out_blocks(runs):
    for run in runs:
        block = numpy.arange(len(run.fitted)) * BLOCKS // len(run.fitted)
        run.fitted = block % HELD_OUT_OF != HELD_OUT_OF // 2


def fit(setup, recordings, held_out=(), cross_check=True, finer=None):
    """(Answer, [HeldOut], problem, costs of the descents). Without recordings that are held out, blocks of all are, and the answer
    is then refined on everything. finer: settings of a finer mesh or step; the answer is then that of the scene with them."""
    runs = runs_of(setup, recordings)
    count = sum(int(run.fitted.sum()) * len(run.recording.measured()) for run in runs)
    if count <= 3 * len(setup.parameters):
        raise FitError("%d forces for %d parameters; record more" % (count, len(setup.parameters)))
    by_blocks = cross_check and not held_out
    if by_blocks:
        hold_out_blocks(runs)
    problem = setup.problem(runs)
    point, costs = solve.search(problem, setup.starts, setup.seed)
    tolerance = solve.FIRST_TOLERANCE if finer else solve.TOLERANCE  # of a point that is corrected anyway
    point = solve.refine(problem, point, tolerance)
    quality = []
    if by_blocks:
        for run, done in zip(runs, problem.forces([point])[0]):
            quality.append(prediction_error(run, done.force_n, ~run.fitted, done.doubts if finer else {}, bool(finer)))
            run.fitted = numpy.ones(len(run.fitted), bool)
        point = solve.refine(problem, point, tolerance)
    before = point
    if finer:
        coarse, problem = problem, setup.problem(runs, finer)
        point = solve.corrected(coarse, point, problem)
    answer = uncertainty.assess(problem, point, point - before)
    if held_out:
        others = runs_of(setup, held_out)
        done = setup.workers.map(setup.forces, [(answer.values, run, finer) for run in others])
        quality = [prediction_error(run, one.force_n, numpy.arange(len(one.force_n)) > 0, one.doubts) for run, one in zip(others, done)]
    return answer, quality, problem, costs
