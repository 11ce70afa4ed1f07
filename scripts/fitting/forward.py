"""The scene's forces on the tool for a measured motion. Runs are independent, so that many go on at once: the core lets go of
Python's lock while it steps, and the same run gives the same bits whatever runs beside it."""
import concurrent.futures
import math
import types
import typing

import numpy
from scipy.interpolate import CubicSpline

import tissue_contact
from fitting import FitError

TIP_WITHIN_M, TIP_WITHIN_RAD = 1e-6, 1e-4
CHECKED_POSES = 20


def rotation(quaternion):
    """3 x 3 of x, y, z, w."""
    x, y, z, w = quaternion / numpy.linalg.norm(quaternion)
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def load_scene(path, settings=None):
    try:
        return tissue_contact.load_scene(path, set=settings or {})
    except (ValueError, RuntimeError) as error:
        raise FitError("the scene: %s" % error) from error


class Tool:
    """One instrument of a scene: its joints from what was recorded."""

    def __init__(self, scene_path, name, renamed):
        """renamed: recorded joint name -> joint of the URDF."""
        self.name, self._renamed = name, renamed
        self._simulator = tissue_contact.Simulator(load_scene(scene_path))
        self.joint_names = list(self._simulator.joint_names(name))

    def recorded_names(self):
        back = {urdf: recorded for recorded, urdf in self._renamed.items()}
        return [back.get(name, name) for name in self.joint_names]

    def start(self):
        return numpy.array(self._simulator.joint_positions(self.name))

    def _pose(self, joints):
        self._simulator.place(self.name, joints)
        return numpy.array(self._simulator.tip_pose(self.name))

    def motion(self, recording):
        """Joint positions, a row for each sample."""
        if recording.joints is None:
            return self._from_poses(recording)
        motion = numpy.tile(self.start(), (len(recording.times_s), 1))
        for column, name in enumerate(self.recorded_names()):
            if name in recording.joints:
                motion[:, column] = recording.joints[name]
        return motion

    def _from_poses(self, recording):
        """Joints of a tool whose URDF moves it along x, y, z and, where it has more, then turns it by yaw, pitch, roll at its tip
        (urdf/indenter.urdf): solved by three, and checked."""
        zero = numpy.zeros(len(self.joint_names))
        home = self._pose(zero)
        if len(zero) not in (3, 6):
            self._refuse(recording)
        columns = numpy.stack([self._pose(numpy.eye(len(zero))[i] * 1e-2)[:3, 3] - home[:3, 3] for i in range(3)], axis=1) / 1e-2
        if abs(numpy.linalg.det(columns)) < 1e-3:
            self._refuse(recording)
        motion = numpy.zeros((len(recording.times_s), len(zero)))
        motion[:, :3] = numpy.linalg.solve(columns, (recording.positions_m - home[:3, 3]).T).T
        if recording.quaternions is not None:
            if len(zero) != 6:
                raise FitError("%s: it has quaternions, but instrument '%s' has no joints to turn it: use urdf/indenter.urdf, or leave qx, qy, qz, qw out of a table" %
                               (recording.name, self.name))
            turned = numpy.stack([home[:3, :3].T @ rotation(q) for q in recording.quaternions])
            motion[:, 3] = numpy.unwrap(numpy.arctan2(turned[:, 1, 0], turned[:, 0, 0]))
            motion[:, 4] = -numpy.arcsin(numpy.clip(turned[:, 2, 0], -1.0, 1.0))
            motion[:, 5] = numpy.unwrap(numpy.arctan2(turned[:, 2, 1], turned[:, 2, 2]))
        self._check(recording, motion)
        return motion

    def to_world(self, recording, motion):
        """The recording's forces, measured in the axes of the tip, in those of the world."""
        if len(recording.measured()) < 3:
            raise FitError("%s: --axes tip takes fx_n, fy_n and fz_n" % recording.name)
        return numpy.stack([self._pose(joints)[:3, :3] @ force for joints, force in zip(motion, recording.force_n)])

    def _check(self, recording, motion):
        for row in numpy.linspace(0, len(motion) - 1, CHECKED_POSES).astype(int):
            pose = self._pose(motion[row])
            if not numpy.abs(pose[:3, 3] - recording.positions_m[row]).max() <= TIP_WITHIN_M:
                self._refuse(recording)
            if recording.quaternions is not None and not numpy.abs(pose[:3, :3] - rotation(recording.quaternions[row])).max() <= TIP_WITHIN_RAD:
                self._refuse(recording)

    def _refuse(self, recording):
        raise FitError("%s: it has poses of the tip, which instrument '%s' cannot be put into: its joints (%s) must be the pose, x, y, z and "
                       "perhaps yaw, pitch, roll, as in urdf/probe.urdf and urdf/indenter.urdf; or give its joints instead (columns of a table, joint states of a bag)" %
                       (recording.name, self.name, ", ".join(self.joint_names)))


def _pieces(times_s, motion, step_s):
    """[(duration, joints) up to each sample after the first]: a spline through the samples, in pieces of a step. Straight from sample to sample, the speed
    at each would be that of half an interval before, and so would the damping."""
    spline = CubicSpline(times_s, motion)
    for start, end in zip(times_s, times_s[1:]):
        count = max(int(math.ceil((end - start) / step_s - 1e-6)), 1)
        yield [((end - start) / count, spline(start + (i + 1) * (end - start) / count)) for i in range(count)]


class Simulated(typing.NamedTuple):
    """A run of the scene; arrays have a row for each sample."""
    force_n: numpy.ndarray  # what the tissue exerts on the tool, axes of the world
    error_n: numpy.ndarray  # how wrong it likely is
    doubts: typing.Mapping = types.MappingProxyType({})  # field of the report -> in how many steps
    torque_nm: numpy.ndarray = None  # about the tip


SOLVER = {"solver.tolerance": 1e-4}  # differences of runs are taken, which want less than a run's own error of 1e-3

DOUBTS = {  # by the report's field
    "jumped": "the tool went too far to be swept and was put there: are the positions in metres, is the recording of one piece?",
    "discarded": "the scene had no finite answer and stopped the tissue where it was, without forces: take smaller steps or a finer mesh",
    "implausible_load": "the tissue bore more than any does (elements inside out, or pressures far above the stiffness): is the tool so deep?"}


def _doubt(doubts, report):
    for field in DOUBTS:
        if getattr(report, field):
            doubts[field] = doubts.get(field, 0) + 1


def forces(scene_path, settings, tool_name, times_s, motion):
    """Simulated; forces are those after each sample's step: the first sample only places the tool."""
    try:
        scene = tissue_contact.load_scene(scene_path, set=dict(SOLVER, **settings))
        simulator = tissue_contact.Simulator(scene)
        simulator.place(tool_name, motion[0])
        index = list(simulator.instruments).index(tool_name)
        wrench, error, doubts = numpy.zeros((len(times_s), 6)), numpy.zeros(len(times_s)), {}
        for i, pieces in enumerate(_pieces(times_s, motion, scene.max_step_s), 1):
            for duration, joints in pieces:
                simulator.advance(duration, {tool_name: joints})
                _doubt(doubts, simulator.report())
            wrench[i] = simulator.wrench(tool_name, "world")
            error[i] = simulator.force_errors()["total_n"][index]
    except (ValueError, RuntimeError) as problem:
        raise FitError("%s with %s: %s" % (scene_path, ", ".join("%s=%s" % (key, "%.6g" % value if isinstance(value, float) else value)
                                                                  for key, value in settings.items()), problem)) from problem
    return Simulated(wrench[:, :3], error, doubts, wrench[:, 3:])


class Workers:
    """Calls, as many at once as there are workers; results in the order asked for."""

    def __init__(self, count):
        self._pool = concurrent.futures.ThreadPoolExecutor(count)

    def map(self, function, arguments):
        tasks = [self._pool.submit(function, *one) for one in arguments]
        try:
            return [task.result() for task in tasks]
        except BaseException:
            for task in tasks:
                task.cancel()
            raise
