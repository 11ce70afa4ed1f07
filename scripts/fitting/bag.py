"""Measured motion of a tool with measured forces, from a bag: poses of the tip or joint states, and wrenches, matched by their stamps."""
import bisect
import dataclasses

import numpy
import rosbag

from fitting import FitError
from fitting.measured import FEWEST_ROWS, FORCE, MOST_ROWS, POSITION, QUATERNION, limit_of, require_no_gap, unwrapped

STATES, WRENCHES = ("sensor_msgs/JointState",), ("geometry_msgs/WrenchStamped",)
POSES = ("geometry_msgs/PoseStamped", "geometry_msgs/TransformStamped")
MOST_CLOCK_S = 0.2  # between the clocks of two topics: far above any delay on the way to the recorder


@dataclasses.dataclass
class Series:
    """The messages of a topic."""
    topic: str
    stamps_s: list = dataclasses.field(default_factory=list)
    recorded_s: list = dataclasses.field(default_factory=list)  # by the recorder's clock
    values: list = dataclasses.field(default_factory=list)
    frames: list = dataclasses.field(default_factory=list)
    children: list = dataclasses.field(default_factory=list)  # whose pose it is, where it is said

    def age_s(self):
        """How far its clock is behind the recorder's, and what the way took."""
        return float(numpy.median(numpy.subtract(self.recorded_s, self.stamps_s)))

    def within(self, times_s):
        """Its messages from the first to the last of the times, and one more on each side where none is at that very time: what is looked at of it."""
        part = slice(max(bisect.bisect_right(self.stamps_s, times_s[0]) - 1, 0), bisect.bisect_left(self.stamps_s, times_s[-1]) + 1)
        return Series(self.topic, *(rows[part] for rows in (self.stamps_s, self.recorded_s, self.values, self.frames, self.children)))


def columns(path, joint_names, joint_topics, force_topic, pose_topic):
    """(columns as a table has them, frame of the forces, frame of the poses). The samples are the poses, or the joint states of the first
    topic; forces and other joints there are linear between theirs."""
    motion_topics = [pose_topic] if pose_topic else list(joint_topics)
    if not motion_topics:
        raise FitError("%s: the scene's instrument has no joint_state_topics; add the bag's topic of joint states, or give one of poses of the "
                       "tip by --pose-topic" % path)
    if force_topic in motion_topics:
        raise FitError("%s: %s is the topic of the motion (%s) and of the forces (--force-topic); give each its own" %
                       (path, force_topic, "--pose-topic" if pose_topic else "the scene's joint_state_topics"))
    kinds = dict({topic: POSES if pose_topic else STATES for topic in motion_topics}, **{force_topic: WRENCHES})
    series = _series(path, kinds, motion_topics[0], joint_names)
    motion, force = series[motion_topics[0]], series[force_topic]
    for one in series.values():
        _require_ascending(path, one)
        if one is not force:
            _require_one_clock(path, one, force)
    joints = {} if pose_topic else _joints(path, [series[topic] for topic in motion_topics if topic in series], joint_names)
    times = _sampled(path, motion, force, joints.values())
    motion, force = motion.within(times), force.within(times)
    forces = _checked(path, force, FORCE)
    found = dict({"time_s": times - times[0]}, **{name: numpy.interp(times, force.stamps_s, row) for name, row in zip(FORCE, forces)})
    if pose_topic:
        found.update(_poses(path, motion))
    else:
        found.update({name: _joint_at(path, times, joint, name) for name, joint in joints.items()})
    return found, ", ".join(sorted(set(force.frames))), ", ".join(sorted(set(motion.frames))) if pose_topic else ""


def _series(path, kinds, needed, joint_names):
    """{topic: Series}, of topics that have messages; `needed` and that of the forces have."""
    try:
        with rosbag.Bag(path) as bag:
            info = bag.get_type_and_topic_info().topics
            _require_topics(path, kinds, needed, info)
            series = {}
            for topic, message, recorded in bag.read_messages(list(kinds)):
                one = series.setdefault(topic, Series(topic))
                one.stamps_s.append(message.header.stamp.to_sec())
                one.recorded_s.append(recorded.to_sec())
                one.values.append(_values(message, joint_names))
                one.frames.append(message.header.frame_id.lstrip("/"))
                one.children.append(getattr(message, "child_frame_id", "").lstrip("/"))
            return series
    except FitError:
        raise
    except Exception as error:  # rosbag raises what its parts raise
        raise FitError("%s cannot be read as a bag: %s" % (path, error)) from error


def _require_topics(path, kinds, needed, info):
    for topic, types in kinds.items():
        count = info[topic].message_count if topic in info else 0
        if count and info[topic].msg_type not in types:
            raise FitError("%s: %s has %s; %s is needed" % (path, topic, info[topic].msg_type, " or ".join(types)))
        if count > MOST_ROWS:
            raise FitError("%s: %s has %d messages; up to %d are allowed; cut the bag with rosbag filter" % (path, topic, count, MOST_ROWS))
        if not count and (topic == needed or types is WRENCHES):
            option, offered = ("--force-topic", WRENCHES) if types is WRENCHES else ("--pose-topic", POSES)
            others = [other for other, one in sorted(info.items()) if one.msg_type in offered]
            raise FitError("%s has no messages on %s; its topics are: %s; %s" % (
                path, topic, ", ".join(sorted(info)), "%s takes: %s" % (option, ", ".join(others)) if others else
                "none of them has %s, which %s takes" % (" or ".join(offered), option)))


def _values(message, joint_names):
    if message._type in STATES:
        return {name: at for name, at in zip(message.name, message.position) if name in joint_names}
    if message._type in WRENCHES:
        force = message.wrench.force
        return force.x, force.y, force.z
    if hasattr(message, "pose"):
        position, turned = message.pose.position, message.pose.orientation
    else:
        position, turned = message.transform.translation, message.transform.rotation
    return position.x, position.y, position.z, turned.x, turned.y, turned.z, turned.w


def _require_ascending(path, series):
    late = numpy.flatnonzero(~(numpy.diff(series.stamps_s) > 0.0))
    if len(late):
        at = int(late[0])
        raise FitError("%s: on %s the stamp %.6f s is not after %.6f s before it; correct header.stamp" %
                       (path, series.topic, series.stamps_s[at + 1], series.stamps_s[at]))


def _require_one_clock(path, motion, force):
    apart = motion.age_s() - force.age_s()
    if not abs(apart) <= MOST_CLOCK_S:
        raise FitError("%s: the clocks of %s and %s differ: by the time at which the bag's messages were recorded the stamps of one are %.3g s old, of the "
                       "other %.3g s; up to %g s between them are allowed: run both machines on one clock (chrony), or correct header.stamp" %
                       (path, motion.topic, force.topic, motion.age_s(), force.age_s(), MOST_CLOCK_S))


def _sampled(path, motion, force, joints):
    """Stamps of the motion while forces were recorded. Each joint is to be there all along, too; what it is short of at the ends, by less
    than a gap, is left out."""
    times = _shared(path, motion, numpy.array(motion.stamps_s), force)
    for one in (force, *joints):
        _require_recorded(path, one, times)
    for joint in joints:
        times = _shared(path, motion, times, joint)
    return times


def _shared(path, motion, times, other):
    """Those of the times at which the other was recorded."""
    times = times[(times >= other.stamps_s[0]) & (times <= other.stamps_s[-1])]
    if not FEWEST_ROWS <= len(times) <= MOST_ROWS:
        raise FitError("%s: %d messages of %s (%.3f to %.3f s) while there were some of %s (%.3f to %.3f s); %d to %d are needed" % (
            path, len(times), motion.topic, motion.stamps_s[0], motion.stamps_s[-1], other.topic, other.stamps_s[0], other.stamps_s[-1], FEWEST_ROWS,
            MOST_ROWS))
    return times


def _require_recorded(path, series, times):
    """From the first to the last of the times."""
    stamps = numpy.array(series.within(times).stamps_s)
    if len(stamps) < FEWEST_ROWS:
        raise FitError("%s: %d messages of %s from %.3f to %.3f s, while the tool moved; %d or more are needed" %
                       (path, len(stamps), series.topic, times[0], times[-1], FEWEST_ROWS))
    require_no_gap(path, numpy.concatenate([times[:1][times[:1] < stamps[0]], stamps, times[-1:][times[-1:] > stamps[-1]]]), " on " + series.topic)


def _checked(path, series, names):
    """A row for each name."""
    rows = numpy.array(series.values).T
    for name, row in zip(names, rows):
        most, unit = limit_of(name)
        wrong = row[~(numpy.abs(row) <= most)]
        if wrong.size:
            raise FitError("%s: on %s '%s' is %g; a number from %g to %g %s" % (path, series.topic, name, wrong[0], -most, most, unit))
    return rows


def _poses(path, series):
    for names, what in ((series.frames, "in several frames"), (series.children, "of several tools")):
        if len(set(names)) > 1:
            raise FitError("%s: %s has poses %s (%s); give a topic of one tool in one frame" %
                           (path, series.topic, what, ", ".join("'%s'" % name for name in sorted(set(names)))))
    rows = _checked(path, series, POSITION + QUATERNION)
    turned = rows[len(POSITION):].any()  # all zero is how a message says nothing of it
    return dict(zip(POSITION + QUATERNION if turned else POSITION, rows))


def _joints(path, all_series, joint_names):
    """{name: Series of its positions alone}: a message need not have all joints."""
    joints = {}
    for series in all_series:
        for name in joint_names:
            samples = [(stamp, (state[name],)) for stamp, state in zip(series.stamps_s, series.values) if name in state]
            if samples:
                joints[name] = Series("%s (joint '%s')" % (series.topic, name), stamps_s=[stamp for stamp, _ in samples], values=[at for _, at in samples])
    if not joints:
        raise FitError("%s: no joint state names a joint of the scene; those are: %s" % (path, ", ".join(joint_names)))
    return joints


def _joint_at(path, times, joint, name):
    joint = joint.within(times)
    return numpy.interp(times, joint.stamps_s, unwrapped(_checked(path, joint, [name])[0]))
