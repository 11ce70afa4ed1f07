"""Shared by the rostests: joint states out, messages in, programs run; every wait has a deadline."""
import contextlib
import csv
import hashlib
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import rosbag
import roslib.packages
import rospkg
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped, WrenchStamped
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage
from tissue_contact_testing import open_connections

SLOWNESS = float(os.environ.get("TISSUE_CONTACT_SLOWNESS", "1"))  # of builds with sanitizers
DEADLINE_S = 120.0 * SLOWNESS  # generous: the machine may be busy with other tests
NODE = "/tissue_contact"
TOPIC = "/probe/joint_states"
PACKAGE = rospkg.RosPack().get_path("tissue_contact")
SCENE = os.path.join(PACKAGE, "test", "ros", "press.yaml")
START_S = 1000


def main(test_case):
    """Of the node of a rostest: it and its test are called as its file is."""
    name = os.path.splitext(os.path.basename(sys.argv[0]))[0]
    rospy.init_node(name)
    rostest.rosrun("tissue_contact", name, test_case, sys.argv)


def wait_until(condition, what, deadline_s=DEADLINE_S):
    end = time.monotonic() + deadline_s
    while not condition():
        if time.monotonic() > end:
            raise AssertionError("not within %g s: %s" % (deadline_s, what))
        time.sleep(0.01)


class TestCase(unittest.TestCase):
    """With a directory of its own, removed afterwards."""

    def setUp(self):
        self.directory = tempfile.mkdtemp(prefix="a test ")  # with blanks, as people name their folders
        self.addCleanup(shutil.rmtree, self.directory)

    def path(self, name):
        return os.path.join(self.directory, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as stream:
            stream.write(text)
        return self.path(name)

    def bag_of(self, name, samples, **options):
        """A bag of joint states, see write_bag()."""
        write_bag(self.path(name), samples, **options)
        return self.path(name)

    def replayed(self, scene, bag, csv_file, *more):
        """A replay that must succeed; returns what it said."""
        code, errors = replay(scene, bag, csv_file, *more)
        self.assertEqual(code, 0, errors)
        return errors

    def refined_scene(self, refinement="auto", name="refined.yaml"):
        """press.yaml with a mesh, of 10 mm cells, that follows the probe."""
        damping = "    damping: {stiffness_s: 0.003}\n"
        return self.changed_scene({damping: damping + "    refinement: %s\n" % refinement}, name=name)

    def changed_scene(self, changes, source=SCENE, name="scene.yaml"):
        """A scene of test/ros, or one with a path, each of whose `changes` {old text: new one} was made once."""
        with open(os.path.join(os.path.dirname(SCENE), source), encoding="utf-8") as stream:
            text = stream.read()
        for old, new in changes.items():
            self.assertEqual(text.count(old), 1, old)
            text = text.replace(old, str(new))
        return self.write(name, text)


def joint_state(stamp, positions, names=("x", "y", "z")):
    message = JointState(name=list(names), position=list(positions))
    message.header.stamp = stamp
    return message


class Listener:
    """Collects the messages of a topic."""

    def __init__(self, topic, message_type, connect=True):
        self.topic = topic
        self.messages = []
        self._arrived = threading.Condition()
        self._subscriber = rospy.Subscriber(topic, message_type, self._take, tcp_nodelay=True)
        if connect:
            wait_until(lambda: open_connections(self._subscriber) > 0, "a publisher of " + topic)

    def _take(self, message):
        with self._arrived:
            self.messages.append(message)
            self._arrived.notify_all()

    def wait(self, condition, what, deadline_s=DEADLINE_S):
        """Until condition(messages) holds; returns a copy of the messages."""
        with self._arrived:
            if not self._arrived.wait_for(lambda: condition(self.messages), deadline_s):
                raise AssertionError("%s: not within %g s: %s (%d messages)" %
                                     (self.topic, deadline_s, what, len(self.messages)))
            return list(self.messages)

    def wait_for_stamp(self, stamp):
        return self.wait(lambda all: any(m.header.stamp == stamp for m in all), "stamp %s" % stamp)

    def close(self):
        self._subscriber.unregister()


def wrenches(instrument="probe"):
    return Listener("%s/%s/wrench" % (NODE, instrument), WrenchStamped)


def diagnostics():
    return Listener("/diagnostics", DiagnosticArray)


class JointSource:
    """Publishes joint states to the node; returns once the node listens."""

    def __init__(self, topic=TOPIC):
        self._publisher = rospy.Publisher(topic, JointState, queue_size=100000, tcp_nodelay=True)
        wait_until(self.is_heard, "a subscriber of " + topic)

    def is_heard(self):
        return open_connections(self._publisher) > 0

    def send(self, stamp, positions, names=("x", "y", "z")):
        self._publisher.publish(joint_state(stamp, positions, names))

    def send_all(self, samples):
        for stamp, positions in samples:
            self.send(stamp, positions)

    def close(self):
        self._publisher.unregister()


def press(count=100, start_s=START_S, depth_m=0.005):
    """(stamp, positions) at 100 Hz: down 1 mm + depth, a little sideways, and up again."""
    samples = []
    for i in range(count):
        down = 1.0 - abs(2.0 * i / (count - 1) - 1.0)
        stamp = rospy.Time(start_s) + rospy.Duration.from_sec(0.01) * i
        samples.append((stamp, (0.0001 * i, 0.0, -(0.001 + depth_m) * down)))
    return samples


def press_and_drag(count=50, start_s=START_S):
    """(stamp, positions) at 100 Hz for the scene of press(): down 2.5 mm, 1.5 mm deep, in a fifth of them, then 12 mm along x."""
    samples = []
    for i in range(count):
        way = 5.0 * i / (count - 1)
        stamp = rospy.Time(start_s) + rospy.Duration.from_sec(0.01) * i
        samples.append((stamp, (-0.006 + 0.003 * max(way - 1.0, 0.0), 0.0, -0.0025 * min(way, 1.0))))
    return samples


def write_messages(file, messages, **options):
    """messages: (topic, message, time of recording)."""
    with rosbag.Bag(file, "w", **options) as bag:
        for message in messages:
            bag.write(*message)


def write_bag(file, samples, topic=TOPIC, **options):
    write_messages(file, [(topic, joint_state(stamp, positions), stamp) for stamp, positions in samples], **options)


def program(name):
    """Path of an executable of the package, as rosrun finds it."""
    found = roslib.packages.find_node("tissue_contact", name)
    if not found:
        raise AssertionError("rosrun does not find " + name)
    return found[0]


def run(command, **options):
    """Waits for a program; returns (exit code, what it printed, to stderr alone if that is piped)."""
    done = subprocess.run(command, **{"stderr": subprocess.STDOUT, **options}, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          universal_newlines=True, timeout=4 * DEADLINE_S, check=False)
    return done.returncode, done.stdout if done.stderr is None else done.stderr


def launch(*arguments, **options):
    """What scripts/demo ends with: roslaunch on a master of its own, without a display. `options` as of run()."""
    environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
    return run([program("run_launch.py")] + list(arguments), env=environment, **options)


def replay(scene, bag, csv_file, *more, **options):
    """Runs tissue_contact_replay; returns (exit code, stderr)."""
    command = [program("tissue_contact_replay"), "--scene", scene, "--bag", bag, "--csv", csv_file] + list(more)
    return run(command, stderr=subprocess.PIPE, **options)


@contextlib.contextmanager
def running(command):
    """A program that is stopped at the end of the block."""
    with tempfile.TemporaryFile("w+") as output:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT)
        process.output = output
        try:
            yield process
        finally:
            if process.poll() is None:
                process.terminate()
                try:
                    process.wait(DEADLINE_S)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()


def node(scene, *parameters):
    """The node as a child process, for tests that need to start it several times."""
    return running([program("tissue_contact_node"), "__name:=tissue_contact", "_scene:=" + scene] + list(parameters))


def output_of(process):
    """What running() has printed so far."""
    process.output.seek(0)
    return process.output.read()


def wrench_of(message):
    """The six numbers of a WrenchStamped."""
    return [getattr(vector, axis) for vector in [message.wrench.force, message.wrench.torque] for axis in "xyz"]


def wrench_bits(message):
    return struct.pack("<6d", *wrench_of(message))


def is_finite(message):
    return all(map(math.isfinite, wrench_of(message)))


def stage_at(z):
    """The tf of a frame "stage" above the world's origin."""
    transform = TransformStamped()
    transform.header.frame_id = "world"
    transform.child_frame_id = "stage"
    transform.transform.translation.z = z
    transform.transform.rotation.w = 1.0
    return TFMessage([transform])


WRENCH_COLUMNS = ["force_x_n", "force_y_n", "force_z_n", "torque_x_nm", "torque_y_nm", "torque_z_nm"]


def read_csv(file):
    """Rows of a replay's CSV: (stamp text, instrument, wrench bytes)."""
    return [(row["stamp_s"], row["instrument"], struct.pack("<6d", *[float(row[c]) for c in WRENCH_COLUMNS]))
            for row in read_table(file)]


def read_table(file):
    """All of a replay's CSV as a list of dictionaries."""
    with open(file, newline="", encoding="ascii") as stream:
        return list(csv.DictReader(stream))


def stamp_text(stamp):
    return "%d.%09d" % (stamp.secs, stamp.nsecs)


def digest(rows):
    """SHA-256 over stamps and wrench bits."""
    hashed = hashlib.sha256()
    for stamp, bits in rows:
        hashed.update(stamp.encode("ascii"))
        hashed.update(bits)
    return hashed.hexdigest()


def play_through_node(scene, bag, topic, instrument, count, rate, deadline_s=DEADLINE_S):
    """Plays a bag into a fresh node at `rate` times real time; returns (stamp text, wrench bytes) of every wrench."""
    with node(scene):
        listener = wrenches(instrument)
        # The queue holds what piles up while the player has no processor; by default it is a hundred messages.
        # Nor does it end when it has played, with what it has not sent yet.
        with running([program_of("rosbag", "play"), "--quiet", "--wait-for-subscribers", "--keep-alive", "--queue", "100000", "--rate",
                      str(rate), bag, "--topics", topic]) as player:
            got = listener.wait(lambda all: len(all) >= count or player.poll() is not None, "%d wrenches" % count, deadline_s)
            assert player.poll() is None, "rosbag play: exit code %d" % player.returncode
        listener.close()
    return [(stamp_text(w.header.stamp), wrench_bits(w)) for w in got]


def program_of(package, name):
    return roslib.packages.find_node(package, name)[0]
