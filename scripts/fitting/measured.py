"""Measured motion of a tool with measured forces, from a table (CSV) or a bag."""
import array
import csv
import dataclasses
import difflib
import math
import os
import stat

import numpy

from fitting import FitError

POSITION = ("x_m", "y_m", "z_m")
QUATERNION = ("qx", "qy", "qz", "qw")
FORCE = ("fx_n", "fy_n", "fz_n")
TWIST = ("z", "yaw", "fz_n", "tz_nm")  # columns of a plate that turns on a ring
MOST_ROWS = 1000000
LONGEST_LINE = 10000
FEWEST_ROWS = 10
CHUNK = 1000000  # samples of windows at a time
FEWEST_SMOOTHED = 5  # three make a parabola that smooths nothing
FARTHEST_M, LARGEST_N, LARGEST_NM, LARGEST_JOINT, LATEST_S = 10.0, 1000.0, 100.0, 1000.0, 1.0e10
WIDEST_M, LONGEST_S = 1.0, 3600.0  # of a recording
WIDEST_GAP = 20.0  # between samples, in usual intervals
NORM_WITHIN = 0.01
SLOWEST_TWIST_HZ = 20.0  # of a twist: three rows in the 60 ms that are kept free for its fall, where slower ones have peaks between rows
FARTHEST_TWIST_M = 0.05  # above a ring of some mm: room to begin; what is pressed by 0.1 mm is beyond it in millimetres
LONGEST_TWIST_RAD = 2.0 * math.pi  # the starts take some 0.4 rad, 20 degrees


@dataclasses.dataclass
class Recording:
    """One run of the tool, which starts with it off the tissue. Arrays have a row for each sample."""
    name: str
    times_s: numpy.ndarray
    force_n: numpy.ndarray  # 3 columns; NaN in one that was not measured
    positions_m: numpy.ndarray = None  # 3 columns, of the tip in the world; or else joints
    quaternions: numpy.ndarray = None  # x, y, z, w
    joints: dict = None  # recorded name -> positions, rad or m
    force_frame: str = ""  # as a bag names it
    pose_frame: str = ""
    torque_nm: numpy.ndarray = None  # as force_n, about the tip; of a twist alone

    def measured(self):
        return [axis for axis in range(3) if not numpy.isnan(self.force_n[:, axis]).any()]

    def peak_n(self):
        """The largest magnitude of what was measured of the force."""
        return float(numpy.sqrt((self.force_n[:, self.measured()] ** 2).sum(axis=1)).max())


def printable(text):
    """File names need not be UTF-8; reports, tables and pictures are."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def name_of(path):
    return printable(os.path.splitext(os.path.basename(path))[0])


def read(path, joint_names, joint_topics, force_topic, pose_topic=None):
    """joint_names: as recorded; topics: of a bag, whose joint states are not looked at where it has a topic of poses."""
    is_bag = _beginning(path).startswith(b"#ROSBAG V")
    recording = _read_bag(path, joint_names, joint_topics, force_topic, pose_topic) if is_bag else _read_table(path, joint_names)
    _require_plausible(path, recording)
    return recording


def read_twist(path, joint_names):
    """Of a plate that turns on a ring, from a table. Its times then begin at 0."""
    for name in TWIST[:2]:
        if name not in joint_names:
            raise FitError("the scene's instrument has no joint '%s'; the plate is moved by z and yaw, as in urdf/indenter.urdf" % name)
    _beginning(path)
    recording = _read_table(path, joint_names, TWIST)
    _require_plausible(path, recording)
    _require_twist(path, recording)
    recording.times_s = recording.times_s - recording.times_s[0]  # which may be stamps since 1970; the simulation begins at 0
    return recording


def _require_twist(path, recording):
    rate_hz = 1.0 / float(numpy.median(numpy.diff(recording.times_s)))
    if rate_hz < 0.999 * SLOWEST_TWIST_HZ:
        raise FitError("%s: it has %.3g rows a second; %g or more are needed: the torque falls within some 20 ms" % (path, rate_hz, SLOWEST_TWIST_HZ))
    far = float(numpy.abs(recording.joints["z"]).max())
    if far > FARTHEST_TWIST_M:
        raise FitError("%s: 'z' is up to %.3g; up to %g m is allowed: joints are in rad / m; cut it to the contact" % (path, far, FARTHEST_TWIST_M))
    way = float(numpy.ptp(recording.joints["yaw"]))
    if way > LONGEST_TWIST_RAD:
        raise FitError("%s: 'yaw' spans %.3g; up to %.3g rad, one turn, is allowed: joints are in rad / m" % (path, way, LONGEST_TWIST_RAD))


def _beginning(path):
    """Of a file that may be read whole."""
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):  # a FIFO would wait for ever, a device might not end
            raise FitError("%s cannot be read: it is not a file" % path)
        with open(path, "rb") as stream:
            beginning = stream.read(100)
    except OSError as error:
        raise FitError("%s cannot be read: %s" % (path, error.strerror)) from error
    if not beginning:
        raise FitError("%s is empty; a table (CSV) with a header or a bag is needed" % path)
    if beginning.startswith(b"version https://git-lfs"):
        raise FitError("%s is a git-lfs pointer, not the data itself; fetch it with: git lfs pull" % path)
    return beginning


def _require_plausible(path, recording):
    force = recording.force_n[:, recording.measured()]
    if not numpy.ptp(force, axis=0).max() > 0.0:
        raise FitError("%s: the force is the same in every row (%s N); nothing can be fitted to it: is the sensor connected?" %
                       (path, ", ".join("%g" % one for one in force[0])))
    require_no_gap(path, recording.times_s)
    duration = recording.times_s[-1] - recording.times_s[0]
    if not duration <= LONGEST_S:
        raise FitError("%s: it lasts %g s; up to %g s are allowed: cut it to the contact; times are in seconds" % (path, duration, LONGEST_S))
    if recording.positions_m is not None:
        span = numpy.ptp(recording.positions_m, axis=0)
        if not span.max() <= WIDEST_M:
            raise FitError("%s: '%s' spans %g m; up to %g m are allowed: positions are in metres; cut it to the contact" %
                           (path, POSITION[int(span.argmax())], span.max(), WIDEST_M))


def require_no_gap(path, times_s, where=""):
    """The motion between samples is a spline, which swings where there are none, and forces there are made up."""
    intervals = numpy.diff(times_s)
    longest, usual = int(intervals.argmax()), float(numpy.median(intervals))
    if intervals[longest] > WIDEST_GAP * usual:
        raise FitError("%s: nothing is recorded%s from %.3f to %.3f s; up to %g s are allowed, samples are usually %g s apart: cut it into two recordings, each of "
                       "which begins off the tissue" % (path, where, times_s[longest], times_s[longest + 1], WIDEST_GAP * usual, usual))


def _without_flips(quaternions):
    """q and -q are the same rotation; a row is taken as that which continues the one before, so that they can be smoothed."""
    flips = numpy.concatenate([[1.0], numpy.where((quaternions[1:] * quaternions[:-1]).sum(axis=1) < 0.0, -1.0, 1.0)])
    return quaternions * numpy.cumprod(flips)[:, None]


def _require_columns(path, names, joint_names, needed):
    joints = [name for name in names if name in joint_names]
    known = ("time_s",) + (needed or POSITION + QUATERNION + FORCE + tuple(joint_names))
    for name in names:
        if name not in known:
            near = difflib.get_close_matches(name.lower(), known, 1)
            raise FitError("%s:1: column '%s' is not known%s; allowed are %s" %
                           (path, name, "; did you mean '%s'?" % near[0] if near else "", ", ".join(known)))
        if names.count(name) > 1:
            raise FitError("%s:1: column '%s' is there twice" % (path, name))
    if "time_s" not in names:
        raise FitError("%s:1: there is no column time_s (s)" % path)
    for name in needed:
        if name not in names:
            raise FitError("%s:1: there is no column %s; %s are needed" % (path, name, ", ".join(known)))
    if not any(name in FORCE for name in names):
        raise FitError("%s:1: there is no force; give one or more of %s (N)" % (path, ", ".join(FORCE)))
    for group in (POSITION, QUATERNION):
        if 0 < sum(name in names for name in group) < len(group):
            raise FitError("%s:1: of %s all are needed, or none" % (path, ", ".join(group)))
    if bool(joints) == (POSITION[0] in names):
        raise FitError("%s:1: either the tip's position (%s) or joints (%s) are needed, and not both" %
                       (path, ", ".join(POSITION), ", ".join(joint_names)))
    if QUATERNION[0] in names and joints:
        raise FitError("%s:1: a quaternion goes with a position, not with joints" % path)
    return joints


def limit_of(name):
    """Of a column's magnitude, and its unit with advice."""
    if name in POSITION:
        return FARTHEST_M, "m; positions are in metres"
    if name in FORCE:
        return LARGEST_N, "N; forces are in newtons"
    if name == "tz_nm":
        return LARGEST_NM, "N m; torques are in newton metres"
    if name in QUATERNION:
        return 1.0 + NORM_WITHIN, "for a part of a unit quaternion"
    return (LATEST_S, "s") if name == "time_s" else (LARGEST_JOINT, "rad or m")


def _number(path, line, name, text):
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    largest, unit = limit_of(name)
    if not abs(value) <= largest:
        raise FitError("%s:%d: column '%s' is '%s'; a number from %g to %g %s" %
                       (path, line, name, text[:40], -largest, largest, unit))
    return value


def _lines(path, stream):
    """Of text, none so long that it fills the memory."""
    number = 0
    while line := stream.readline(LONGEST_LINE + 1):
        number += 1
        if len(line) > LONGEST_LINE:
            raise FitError("%s:%d: a line of more than %d characters; is it a table (CSV)?" % (path, number, LONGEST_LINE))
        yield line


def _rows(path):
    """(line number, fields) of the lines that are not empty."""
    try:
        with open(path, newline="", encoding="utf-8-sig") as stream:  # spreadsheets put a mark first
            for row in (reader := csv.reader(_lines(path, stream))):
                if row:
                    yield reader.line_num, row
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise FitError("%s cannot be read as a table (CSV, UTF-8): %s" % (path, error)) from error


def _read_table(path, joint_names, needed=()):
    """needed: columns that must be there, and no others."""
    rows = _rows(path)
    _, names = next(rows, (0, []))
    names = [name.strip() for name in names]
    joints = _require_columns(path, names, joint_names, needed)
    values, before, time_at = array.array("d"), -math.inf, names.index("time_s")  # a tenth of the memory of lists
    for line, row in rows:
        if len(row) != len(names):
            raise FitError("%s:%d: %d values under %d columns" % (path, line, len(row), len(names)))
        if len(values) >= MOST_ROWS * len(names):
            raise FitError("%s:%d: more than %d rows; cut it, or thin it out" % (path, line, MOST_ROWS))
        values.extend(_number(path, line, name, text) for name, text in zip(names, row))
        now = values[time_at - len(names)]
        if not now > before:
            raise FitError("%s:%d: column 'time_s' is %s, not after %.9g of the row before; times must ascend" % (path, line, row[time_at], before))
        before = now
    count = len(values) // len(names)
    if count < FEWEST_ROWS:
        raise FitError("%s: %d rows; %d or more are needed" % (path, count, FEWEST_ROWS))
    return _recording(path, dict(zip(names, numpy.array(values).reshape(count, len(names)).T)), joints)


def _recording(path, columns, joints):
    _require_unit_quaternions(path, columns)
    unmeasured = numpy.full(len(columns["time_s"]), numpy.nan)
    return Recording(
        name=name_of(path), times_s=columns["time_s"],
        force_n=numpy.stack([columns.get(name, unmeasured) for name in FORCE], axis=1),
        torque_nm=numpy.stack([unmeasured, unmeasured, columns["tz_nm"]], axis=1) if "tz_nm" in columns else None,
        positions_m=None if joints else numpy.stack([columns[name] for name in POSITION], axis=1),
        quaternions=_without_flips(numpy.stack([columns[name] for name in QUATERNION], axis=1)) if QUATERNION[0] in columns else None,
        joints={name: unwrapped(columns[name]) for name in joints} or None)


def _require_unit_quaternions(path, columns):
    if QUATERNION[0] not in columns:
        return
    norms = numpy.sqrt(sum(columns[name] ** 2 for name in QUATERNION))
    worst = int(numpy.abs(norms - 1.0).argmax())
    if abs(norms[worst] - 1.0) > NORM_WITHIN:
        raise FitError("%s: sample %d: the quaternion's norm is %.4g; 1 within %g is allowed" % (path, worst + 1, norms[worst], NORM_WITHIN))


def _read_bag(path, joint_names, joint_topics, force_topic, pose_topic):
    from fitting import bag  # here, since tables need no ROS
    columns, force_frame, pose_frame = bag.columns(path, joint_names, joint_topics, force_topic, pose_topic)
    recording = _recording(path, columns, [name for name in columns if name in joint_names])
    return dataclasses.replace(recording, force_frame=force_frame, pose_frame=pose_frame)


def tare(recording, time_s):
    """Takes the mean force (and torque) of the first `time_s` off, in which nothing touches."""
    first = recording.times_s < recording.times_s[0] + time_s
    if time_s > 0.0:
        recording.force_n = recording.force_n - recording.force_n[first].mean(axis=0)
        if recording.torque_nm is not None:
            recording.torque_nm = recording.torque_nm - recording.torque_nm[first].mean(axis=0)
    return recording


def _per_sample(recording, change):
    """The recording with `change` applied to every array of motion."""
    def changed(array):
        return None if array is None else change(array)
    return dataclasses.replace(
        recording, positions_m=changed(recording.positions_m), quaternions=changed(recording.quaternions),
        joints=recording.joints and {name: changed(array) for name, array in recording.joints.items()})


def unwrapped(positions):
    """Of a joint: without turns of 2 pi from one sample to the next, as joints that go on turning are recorded between -pi and pi. No joint moves
    by half a turn, or by metres, in the time between two samples."""
    return numpy.unwrap(positions)


def parabolas(times_s, values, samples, derivative=0):
    """Of ascending times: value, or derivative by time, at each sample of the parabola by least squares through `samples` (odd) samples around it; near the ends that of
    the first and the last so many (Savitzky & Golay 1964, here for samples at any times)."""
    last, windows = len(times_s) - samples, max(1, CHUNK // samples)
    result = numpy.empty(numpy.shape(values))
    for begin in range(0, len(times_s), windows):
        at = numpy.arange(begin, min(begin + windows, len(times_s)))
        window = numpy.clip(at - samples // 2, 0, last)[:, None] + numpy.arange(samples)
        away = times_s[window] - times_s[at][:, None]
        scale = numpy.abs(away).max(axis=1, keepdims=True)
        powers = numpy.stack([numpy.ones_like(away), away / scale, (away / scale) ** 2], axis=2)
        weights = numpy.linalg.pinv(powers)[:, derivative, :] / scale ** derivative
        result[at] = numpy.einsum("ij,ij...->i...", weights, values[window])
    return result


def smooth(recording, time_s):
    """Motion by the parabola through `time_s` around each sample: what a heavy tool's cannot be is noise of its measurement. Forces stay as
    they are."""
    interval = float(numpy.median(numpy.diff(recording.times_s)))
    samples = 2 * int(round(0.5 * time_s / interval)) + 1
    if time_s <= 0.0:
        return recording
    if samples < FEWEST_SMOOTHED:
        raise FitError("--smooth %g s has %d samples of %s, which are %g s apart; %d or more are needed: give %.3g s, or --smooth %s=0" %
                       (time_s, samples, recording.name, interval, FEWEST_SMOOTHED, (FEWEST_SMOOTHED - 1) * interval, recording.name))
    if samples > len(recording.times_s):
        raise FitError("--smooth %g s is longer than %s" % (time_s, recording.name))
    return _per_sample(recording, lambda array: parabolas(recording.times_s, array, samples))


def thin(recording, rate_hz):
    """Means over intervals of 1 / rate_hz, of all samples in each; 0: as it is."""
    if rate_hz <= 0.0:
        return recording
    slot = numpy.floor((recording.times_s - recording.times_s[0]) * rate_hz + 1e-6).astype(int)
    starts = numpy.flatnonzero(numpy.diff(slot, prepend=-1))
    counts = numpy.diff(numpy.append(starts, len(slot)))

    def mean(array):
        return numpy.add.reduceat(array, starts, axis=0) / (counts if array.ndim == 1 else counts[:, None])

    thinned = _per_sample(recording, mean)
    thinned.times_s, thinned.force_n = mean(recording.times_s), mean(recording.force_n)
    thinned.torque_nm = None if recording.torque_nm is None else mean(recording.torque_nm)
    if len(starts) < FEWEST_ROWS:
        raise FitError("--rate %g leaves %d samples of %s; %d or more are needed" % (rate_hz, len(starts), recording.name, FEWEST_ROWS))
    return thinned
