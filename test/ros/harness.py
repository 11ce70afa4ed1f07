"""Shared by the rostests: joint states out, messages in, programs run; every wait has a deadline."""
import contextlib
import csv
import hashlib
import os
import shutil
import struct
import subprocess
import tempfile
import threading
import time
import unittest

import rosbag
import roslib.packages
import rospkg
import rospy
from sensor_msgs.msg import JointState

SLOWNESS = float(os.environ.get("TISSUE_CONTACT_SLOWNESS", "1"))  # of builds with sanitizers
DEADLINE_S = 120.0 * SLOWNESS  # generous: the machine may be busy with other tests
TOPIC = "/probe/joint_states"
PACKAGE = rospkg.RosPack().get_path("tissue_contact")
SCENE = os.path.join(PACKAGE, "test", "ros", "press.yaml")
START_S = 1000


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

    def changed_scene(self, changes, source=SCENE, name="scene.yaml"):
        """A scene of test/ros, or one with a path, each of whose `changes` {old text: new one} was made once."""
        with open(os.path.join(os.path.dirname(SCENE), source), encoding="utf-8") as stream:
            text = stream.read()
        for old, new in changes.items():
            self.assertEqual(text.count(old), 1, old)
            text = text.replace(old, str(new))
        return self.write(name, text)


class Listener:
    """Collects the messages of a topic."""

    def __init__(self, topic, message_type, connect=True):
        self.topic = topic
        self.messages = []
        self._arrived = threading.Condition()
        self._subscriber = rospy.Subscriber(topic, message_type, self._take, tcp_nodelay=True)
        if connect:
            wait_until(lambda: self._subscriber.get_num_connections() > 0, "a publisher of " + topic)

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


class JointSource:
    """Publishes joint states to the node; returns once the node listens."""

    def __init__(self, topic=TOPIC):
        self._publisher = rospy.Publisher(topic, JointState, queue_size=100000, tcp_nodelay=True)
        wait_until(lambda: self._publisher.get_num_connections() > 0, "a subscriber of " + topic)

    def send(self, stamp, positions, names=("x", "y", "z")):
        message = JointState(name=list(names), position=list(positions))
        message.header.stamp = stamp
        self._publisher.publish(message)

    def send_all(self, samples):
        for stamp, positions in samples:
            self.send(stamp, positions)


def press(count=100, start_s=START_S, depth_m=0.005):
    """(stamp, positions) at 100 Hz: down 1 mm + depth, a little sideways, and up again."""
    samples = []
    for i in range(count):
        down = 1.0 - abs(2.0 * i / (count - 1) - 1.0)
        stamp = rospy.Time(start_s) + rospy.Duration.from_sec(0.01) * i
        samples.append((stamp, (0.0001 * i, 0.0, -(0.001 + depth_m) * down)))
    return samples


def write_bag(file, samples, topic=TOPIC):
    with rosbag.Bag(file, "w") as bag:
        for stamp, positions in samples:
            message = JointState(name=["x", "y", "z"], position=list(positions))
            message.header.stamp = stamp
            bag.write(topic, message, stamp)


def program(name):
    """Path of an executable of the package, as rosrun finds it."""
    found = roslib.packages.find_node("tissue_contact", name)
    if not found:
        raise AssertionError("rosrun does not find " + name)
    return found[0]


def replay(scene, bag, csv_file, *more):
    """Runs tissue_contact_replay; returns (exit code, stderr)."""
    command = [program("tissue_contact_replay"), "--scene", scene, "--bag", bag, "--csv", csv_file] + list(more)
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                          timeout=4 * DEADLINE_S, check=False)
    return done.returncode, done.stderr


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


def wrench_bits(message):
    """The six doubles of a WrenchStamped as bytes."""
    w = message.wrench
    return struct.pack("<6d", w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z)


WRENCH_COLUMNS = ["force_x_n", "force_y_n", "force_z_n", "torque_x_nm", "torque_y_nm", "torque_z_nm"]


def read_csv(file):
    """Rows of a replay's CSV: (stamp text, instrument, wrench bytes)."""
    with open(file, newline="", encoding="ascii") as stream:
        return [(row["stamp_s"], row["instrument"], struct.pack("<6d", *[float(row[c]) for c in WRENCH_COLUMNS]))
                for row in csv.DictReader(stream)]


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


def play_through_node(scene, bag, topic, wrench_topic, count, rate, deadline_s=DEADLINE_S):
    """Plays a bag into a fresh node at `rate` times real time; returns (stamp text, wrench bytes) of every wrench."""
    from geometry_msgs.msg import WrenchStamped
    with node(scene):
        wrenches = Listener(wrench_topic, WrenchStamped)
        # The queue holds what piles up while the player has no processor; by default it is a hundred messages.
        with running([program_of("rosbag", "play"), "--quiet", "--wait-for-subscribers", "--queue", "100000", "--rate",
                      str(rate), bag, "--topics", topic]) as player:
            wait_until(lambda: player.poll() is not None, "the end of the bag", deadline_s)
            assert player.returncode == 0, "rosbag play: exit code %d" % player.returncode
        all_wrenches = wrenches.wait(lambda all: len(all) >= count, "%d wrenches" % count, deadline_s)
        wrenches.close()
    return [(stamp_text(w.header.stamp), wrench_bits(w)) for w in all_wrenches]


def program_of(package, name):
    return roslib.packages.find_node(package, name)[0]
