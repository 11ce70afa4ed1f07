"""Static friction from a ring of tissue on which a flat plate turns, in many slow starts from rest.

While the plate turns, every point of the ring carries kinetic friction. After a rest the torque rises from there, until the point that is first at
static friction gives way, and all others with it. Each start so has a peak above the level that it falls back to. How much of (static - kinetic)
the peak shows depends on the ring's shape (a wider one is sheared less at its inner rim), hardly on its mesh, and is taken from the simulation.
Peaks and levels are compared, not torques sample by sample as fit.py does: those of a start that is off by milliseconds would differ by the whole
fall, whatever the coefficients."""
import dataclasses

import numpy
from scipy import stats

from fitting import FitError, forward, measured

AXIS = 2              # of force and torque: the world's z
SMOOTH_S = 0.8        # of the turn, to see when it moves
SHORTEST_S = 0.5      # of a start
REST_S = 0.3          # that is looked at before a start; between starts there is more
END_S = 0.1           # of a start that is left out: the plate slows down
RATE_HZ = 100.0       # of what is compared
FALL_S = 0.06         # in which the torque falls: neither rise nor level
LEVEL_SHARE = 0.2     # of a start at least
FEWEST_STARTS = 4
EARLIEST_S = 5.0 * REST_S  # of a start: before it the simulated plate comes down, turns once, and rests for a fifth of that time
SIMULATED_STARTS = 3  # without noise they are alike
LEAST_APART = 0.05    # of the coefficients where the simulation is to show what the peak is of them
LEAST_SHOWN = 0.2     # of their difference
FAR_ABOVE_M, LOWERED_M, MOST_LOWERINGS = 2e-4, 1e-4, 10
ITERATIONS, CLOSE, FARTHEST = 6, 5e-4, 0.01  # changes of the coefficients: no more iterations then; no answer
LONGEST_S = 20.0      # of a start: all pairs of its times are compared, some 0.5 GB
LEVEL = 0.95
LEAST_CLEAR = 4.0     # of a mean, in half intervals by its noise: as doc/calibration.md has it of fit.py
LEAST_ABOVE = 2.0     # ... of peaks above those of noise: equal coefficients come to 1.2 at most in ten trials, 0.05 apart to more than 3
NOISE_DRAWS = 5       # of each start


@dataclasses.dataclass
class Seen:
    """Of each start: torque over normal force (m) where the ring gives way, and after it."""
    peak_m: numpy.ndarray
    level_m: numpy.ndarray
    force_n: float  # mean


@dataclasses.dataclass
class Match:
    """Coefficients with which the simulation shows what was seen."""
    static: float
    kinetic: float
    offset_m: float      # how much deeper the plate is than recorded
    arm_m: float = 0.0   # torque over normal force and coefficient, while it turns
    shown: float = 0.0   # share of (static - kinetic) by which a peak is above its level
    changes: tuple = (0.0, 0.0)  # of static and kinetic in the last iteration


@dataclasses.dataclass
class Coefficient:
    value: float
    noise_half: float  # of the 95 % interval
    model_half: float  # mesh and step, and the last iteration

    def interval(self):
        half = (self.noise_half ** 2 + self.model_half ** 2) ** 0.5
        return self.value - half, self.value + half


def _turning(speed):
    """The speed of turns, also where rests are much longer than they are: half of the way is made at less. Noise makes way, too."""
    slowest_first = numpy.sort(speed)
    way = numpy.cumsum(slowest_first)
    return slowest_first[numpy.searchsorted(way, 0.5 * way[-1])]


def _turns(moves, interval):
    """[begin, end) of samples that move but for short rests, and long enough."""
    turns = []
    for begin, end in numpy.flatnonzero(numpy.diff(moves.astype(int), prepend=0, append=0)).reshape(-1, 2):
        if turns and (begin - turns[-1][1]) * interval < REST_S:
            turns[-1][1] = end
        else:
            turns.append([begin, end])
    return [(begin, end) for begin, end in turns if (end - begin) * interval >= SHORTEST_S]


def starts(times_s, turn_rad):
    """[(begins, ends) (s)] of the turns that begin from rest, but for the first: it is there to make all of the ring slide."""
    interval = float(numpy.median(numpy.diff(times_s)))
    samples = 2 * int(0.5 * SMOOTH_S / interval) + 1
    if not 3 <= samples <= len(times_s):
        return []
    speed = numpy.abs(measured.parabolas(times_s, turn_rad, samples, derivative=1))
    first = _turns(speed > 0.5 * _turning(speed), interval)[:1]  # it may be fast
    after = speed[first[0][1]:] if first else speed
    turns = _turns(speed > 0.5 * _turning(after), interval) if len(after) else []
    return [(float(times_s[begin]), float(times_s[end - 1])) for begin, end in turns][1:]


def peak_and_level(times_s, ratio):
    """Of one start, by least squares over all pairs of times: level, from the one on a rise along a line, from the other on a level again."""
    count, fall = len(times_s), max(int(round(FALL_S / (times_s[1] - times_s[0]))), 1)
    rise = numpy.maximum(times_s[None, :] - times_s[:, None], 0.0)  # a row for each time at which it begins
    number, last = numpy.arange(1, count + 1), numpy.arange(count)
    y, yy, x, xx, xy = (numpy.cumsum(values, axis=-1) for values in (ratio, ratio ** 2, rise, rise ** 2, rise * ratio))
    together = xy - x * y / number
    slope = together / numpy.maximum(xx - x ** 2 / number, 1e-300)
    after = numpy.minimum(last + fall, count - 1)
    rest = numpy.maximum(count - 1 - after, 1)
    level = (y[-1] - y[after]) / rest
    falling = yy[-1] - yy - 2.0 * level * (y[-1] - y) + (count - number) * level ** 2
    wrong = yy - y ** 2 / number - slope * together + falling
    allowed = (slope > 0.0) & (last[None, :] - last[:, None] >= fall) & (rest >= LEVEL_SHARE * count) & (last >= fall)[:, None]
    if not allowed.any():
        raise FitError("in the start %.2f s after the first row the torque does not rise" % times_s[0])
    begin, end = numpy.unravel_index(numpy.where(allowed, wrong, numpy.inf).argmin(), wrong.shape)
    return (y[end] - slope[begin, end] * x[begin, end]) / number[end] + slope[begin, end] * rise[begin, end], level[end]


def ratios(times_s, force_n, torque_nm, turn_rad, turns):
    """([(times (s), torque against the turn over normal force (m)) of each start], mean force (N)); force and torque on the plate, along the
    axis. None if the plate does not press."""
    found, forces = [], []
    for begin, end in turns:
        rows = (times_s >= begin - REST_S) & (times_s <= end - END_S)
        forces.append(float(force_n[rows].mean()))
        if not forces[-1] > 0.0:
            return None
        way = numpy.sign(((times_s[rows] - times_s[rows].mean()) * turn_rad[rows]).sum())  # of the line through it
        found.append((times_s[rows], -way * torque_nm[rows] / forces[-1]))
    return found, float(numpy.mean(forces))


def see(found, force_n):
    """Of what ratios() found."""
    peaks, levels = numpy.array([peak_and_level(*one) for one in found]).T
    return Seen(peaks, levels, force_n)


def peak_of_noise(found, seen):
    """What peak_and_level() takes for a peak, on average, of levels alone with noise as that at the end of each start."""
    generator, peaks = numpy.random.default_rng(1), []
    for (times_s, ratio), level in zip(found, seen.level_m):
        size = 1e-9 * level + numpy.std(ratio[-max(int(LEVEL_SHARE * len(ratio)), 2):])
        for _ in range(NOISE_DRAWS):
            peak, low = peak_and_level(times_s, level + size * generator.standard_normal(len(ratio)))
            peaks.append(peak - low)
    return float(numpy.mean(peaks))


def see_measured(name, recording, turns):
    """Likewise, of what was measured, or a sentence on why it tells nothing."""
    found = ratios(recording.times_s, recording.force_n[:, AXIS], recording.torque_nm[:, AXIS], recording.joints["yaw"], turns)
    if not found:
        raise FitError("%s: fz_n is not above 0 while the plate turns; forces are those on the tool" % name)
    late = 1e3 * numpy.array([ratio[len(ratio) // 2:].mean() for _, ratio in found[0]])  # before a torque that does not rise is looked for in it
    if not late.mean() > LEAST_CLEAR * _noise_half(late):
        raise FitError("%s: tz_nm against the turn, over fz_n, is %.3g ± %.2g mm; it must be above 0, and known to a quarter: torque is that on the tool, "
                       "against its turn (yaw and tz_nm about the same axis, with opposite signs), in N m" % (name, late.mean(), _noise_half(late)))
    seen = see(*found)
    above = 100.0 * (seen.peak_m - seen.level_m) / seen.level_m.mean()
    least = 100.0 * peak_of_noise(found[0], seen) / seen.level_m.mean()
    if not above.mean() > least + LEAST_ABOVE * _noise_half(above):
        raise FitError("%s: the torque's peaks are %.2g ± %.2g %% above its level, and those of noise alone would be %.2g %%: static friction is not told "
                       "from kinetic friction; take more starts, or less noise" % (name, above.mean(), _noise_half(above), least))
    return seen


class Ring:
    """The scene's plate and ring, moved as recorded, but without the noise of that: pressed to the mean depth, turned evenly."""

    def __init__(self, scene, keys, tool, recording, turns):
        """keys: names of static and kinetic friction in the scene."""
        self.scene, self.keys, self.tool, self.turns = scene, keys, tool, turns[:SIMULATED_STARTS]
        times, turn = recording.times_s, recording.joints["yaw"]

        def mean(joint, begin, end):
            return float(recording.joints[joint][(times >= begin) & (times <= end)].mean())

        self.depth_m = -mean("z", turns[0][0], turns[-1][1])
        first, last = self.turns[0][0], self.turns[-1][1]
        rests = [mean("yaw", begin - REST_S, begin) for begin, _ in self.turns] + [mean("yaw", last, last + REST_S)]
        at = [0.0, 0.4 * first, 0.8 * first] + [edge for one in self.turns for edge in one]
        to = [float(turn[0])] * 2 + [rests[0]] + [level for pair in zip(rests, rests[1:]) for level in pair]
        self.times_s = numpy.arange(0.0, last + 1.5 / RATE_HZ, 1.0 / RATE_HZ)
        self.turn_rad = numpy.interp(self.times_s, at, to)

    def seen(self, static, kinetic, offset_m, settings):
        motion = numpy.tile(self.tool.start(), (len(self.times_s), 1))
        z, yaw = (self.tool.joint_names.index(name) for name in ("z", "yaw"))
        motion[:, z] = -numpy.interp(self.times_s, [0.0, 0.3 * self.turns[0][0]], [-FAR_ABOVE_M, self.depth_m + offset_m])
        motion[:, yaw] = self.turn_rad
        done = forward.forces(self.scene, dict(settings, **dict(zip(self.keys, (static, kinetic)))), self.tool.name, self.times_s, motion)
        if done.doubts:
            raise FitError("in the simulation of the ring: %s" % "; ".join(forward.DOUBTS[field] for field in done.doubts))
        found = ratios(self.times_s, done.force_n[:, AXIS], done.torque_nm[:, AXIS], self.turn_rad, self.turns)
        return found and see(*found)

    def touching(self, match, settings):
        """(what is seen with the friction of the match, the friction that was simulated, the offset)."""
        tried, offset_m = (max(match.static, match.kinetic + LEAST_APART), match.kinetic), match.offset_m
        for _ in range(MOST_LOWERINGS):
            seen = self.seen(*tried, offset_m, settings)
            if seen:
                return seen, tried, offset_m
            offset_m += LOWERED_M
        raise FitError("the plate of the scene never touches; is joint z 0 where it touches the ring?")

    def match(self, real, match, settings, say):
        """From a first guess."""
        for _ in range(ITERATIONS):
            seen, tried, offset_m = self.touching(match, settings)
            depth_m = self.depth_m + offset_m
            deeper = min(max(real.force_n / seen.force_n, 0.3), 3.0) * depth_m - depth_m
            arm = seen.level_m.mean() / tried[1]
            shown = (seen.peak_m - seen.level_m).mean() / arm / (tried[0] - tried[1])
            if not shown > LEAST_SHOWN:
                raise FitError("in the simulation the torque's peak shows %.2f of static less kinetic friction; %g or more is needed: a flat plate on a "
                               "narrow ring, and turned slowly" % (shown, LEAST_SHOWN))
            kinetic = real.level_m.mean() / arm
            found = Match(kinetic + (real.peak_m - real.level_m).mean() / arm / shown, kinetic, offset_m + deeper, arm, shown)
            say("static %.4f, kinetic %.4f; of their difference the ring shows %.2f; arm %.4g mm, offset %.3f mm" %
                (found.static, kinetic, shown, 1e3 * arm, 1e3 * found.offset_m))
            found.changes = abs(found.static - match.static), abs(kinetic - match.kinetic)
            match = found
            if max(match.changes) < CLOSE:
                break
        if max(match.changes) > FARTHEST:
            raise FitError("after %d iterations the coefficients still change by %.3f; %g or less is needed" % (ITERATIONS, max(match.changes), FARTHEST))
        return match


def _noise_half(values):
    """Of the 95 % interval of their mean: they scatter by it."""
    return float(stats.t.ppf(0.5 + 0.5 * LEVEL, len(values) - 1) * numpy.std(values, ddof=1) / len(values) ** 0.5)


def find(scene, keys, tool, recording, guess, finer=None, settings=None, say=print):
    """(static, kinetic) as Coefficients, number of starts. The recording has joints z and yaw, force and torque along the axis; guess: of both;
    settings: of the scene; finer: more of them, a finer mesh or step, to whose answer the scene's is corrected."""
    turns = starts(recording.times_s, recording.joints["yaw"])
    if len(turns) < FEWEST_STARTS:
        raise FitError("%s: %d turns begin from rest after the first one; %d or more are needed, each of %g s or more after a rest of more than %g s" % (
            recording.name, len(turns), FEWEST_STARTS, SHORTEST_S, REST_S))
    if turns[0][0] < EARLIEST_S:
        raise FitError("%s: the second turn begins %.2f s after the first row; %g s or more are needed, in which the plate comes down, turns once and rests" % (
            recording.name, turns[0][0], EARLIEST_S))
    for begin, end in turns:
        if end - begin > LONGEST_S:
            raise FitError("%s: the turn that begins %.2f s after the first row lasts %.1f s; up to %g s are allowed: turn less far or faster (0.5 mm at the "
                           "ring, at 0.2 mm/s, takes 2.5 s)" % (recording.name, begin, end - begin, LONGEST_S))
    thinned = measured.thin(recording, RATE_HZ)
    real = see_measured(recording.name, thinned, turns)
    ring = Ring(scene, keys, tool, recording, turns)
    match = before = ring.match(real, Match(*guess, 0.0), settings or {}, say)
    if finer:
        match = ring.match(real, before, dict(settings or {}, **finer), say)
    level, peak = real.level_m / match.arm_m, (real.peak_m - real.level_m) / match.arm_m / match.shown
    # All that the finer mesh has corrected, not half as of fit.py's: what a ring shows does not go one way from mesh to mesh.
    return (Coefficient(match.static, _noise_half(level + peak), abs(match.static - before.static) + match.changes[0]),
            Coefficient(match.kinetic, _noise_half(level), abs(match.kinetic - before.kinetic) + match.changes[1])), len(turns)
