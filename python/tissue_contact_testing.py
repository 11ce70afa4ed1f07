"""For tests of controllers against tissue, by rostest or pytest: listens to a tissue_contact node and says how it went.

    tissue = TissueFixture("/tissue_contact", ["probe"])    # after rospy.init_node(); waits for the node
    tissue.tell_to_start("/start")                          # or start the controller in your own way
    tissue.wait_for(150)                                    # wrenches
    assert tissue.complaints() == []
    assert tissue.peak_force_n("probe") < 0.6               # newtons
    assert tissue.digest() == other.digest()                # the same bits

Every wait has a deadline. In one process and without a ROS master, from C++: tissue_contact/ros/lock_step.h.
"""
import contextlib
import math
import os
import random
import select
import signal
import socket
import struct
import subprocess
import threading
import time

import rosgraph
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from std_msgs.msg import Empty
from tissue_contact.msg import Status

DEADLINE_S = 60.0  # a machine may be busy with other tests
DEFAULT_PORTS = (11311, 11345)  # of ROS and Gazebo: whoever starts there later would come to this master
HASH_START, HASH_FACTOR = 0xcbf29ce484222325, 0x100000001b3  # of ContentHash in C++


def open_connections(topic):
    """Of a rospy.Publisher or Subscriber, those over which messages may come. Its get_num_connections() also has a subscriber's before they
    are made, and for half a second those of a node that has ended: taken for the next one's, what is sent over them comes nowhere."""
    impl = topic.impl  # None once it is unregistered
    # What a subscriber is sent before the publisher has answered with its header is lost; a publisher adds connections after that.
    answers = isinstance(topic, rospy.Subscriber)
    sockets = [one.socket for one in (impl.connections if impl else [])
               if one.local_endpoint[0] is not None and (one.header is not None or not answers)]
    made = {one.fileno() for one in sockets if one is not None} - {-1}
    poll = select.poll()
    for one in made:
        poll.register(one, select.POLLRDHUP)
    return len(made) - len(poll.poll(0))


class TissueFixture:
    """All wrenches and states of a node from here on. The scene's publish.status_rate_hz must be that of the joint states or more."""

    def __init__(self, node, instruments, deadline_s=DEADLINE_S):
        """instruments: names, in the order of the scene. Waits until the node publishes."""
        self.deadline_s = deadline_s
        self._changed = threading.Condition()
        self._wrenches = {name: [] for name in instruments}
        self._statuses = []
        self._diagnosis = "no diagnostics came"
        self._starter = None
        self._name = node.strip("/")
        self._diagnostics = rospy.Subscriber("/diagnostics", DiagnosticArray, self._diagnose)
        self._subscribers = [self._subscribe("%s/%s/wrench" % (node, name), WrenchStamped, self._wrenches[name].append)
                             for name in instruments]
        self._subscribers.append(self._subscribe(node + "/status", Status, self._statuses.append))
        for subscriber in self._subscribers:
            self._wait(lambda one=subscriber: open_connections(one) > 0, "a publisher of " + subscriber.name)

    def _subscribe(self, topic, kind, keep):
        def take(message):
            with self._changed:
                keep(message)
                self._changed.notify_all()
        return rospy.Subscriber(topic, kind, take, tcp_nodelay=True)

    def _diagnose(self, message):
        for status in message.status:
            if status.name.startswith(self._name + ": tissue"):
                figures = ", ".join("%s %s" % (v.key, v.value) for v in status.values if v.key.startswith("joint states: "))
                self._diagnosis = "diagnostics say: %s (%s)" % (status.message, figures)

    def _wait(self, condition, what):
        end = time.monotonic() + self.deadline_s
        with self._changed:
            while not condition():
                if time.monotonic() > end:
                    raise AssertionError("not within %g s: %s; %s" % (self.deadline_s, what, self._diagnosis))
                self._changed.wait(0.05)

    def tell_to_start(self, topic):
        """A std_msgs/Empty for a controller that waits for one: latched, so that it may also come up later."""
        self._starter = rospy.Publisher(topic, Empty, queue_size=1, latch=True)
        self._starter.publish(Empty())

    def wait_for(self, count):
        """Until each instrument has that many wrenches, and the last a status."""
        for name, wrenches in self._wrenches.items():
            self._wait(lambda got=wrenches: len(got) >= count, "%d wrenches of '%s'" % (count, name))
        last = max(wrenches[count - 1].header.stamp for wrenches in self._wrenches.values())
        self._wait(lambda: self._statuses and self._statuses[-1].header.stamp >= last,
                   "the status of %.9g s (publish.status_rate_hz must be that of the joint states or more)" % last.to_sec())

    def wrenches(self, instrument):
        """geometry_msgs/WrenchStamped of the tissue on the instrument, in the order of their stamps."""
        with self._changed:
            return list(self._wrenches[instrument])

    def forces_n(self, instrument):
        """Norms of the forces."""
        return [math.sqrt(w.wrench.force.x ** 2 + w.wrench.force.y ** 2 + w.wrench.force.z ** 2) for w in self.wrenches(instrument)]

    def peak_force_n(self, instrument):
        return max(self.forces_n(instrument))

    def _before(self, first):
        """Counts of a node that has served another test before, by the first status heard. One that is new tells of this test's own from its
        start: its first status has accepted what its first moment has, which is no more than an arm's and a jaw's for each instrument."""
        return Status() if first.joint_states_accepted <= 2 * len(self._wrenches) else first

    def complaints(self):
        """What a test should not let pass, a sentence each; empty: all is well. Of what came since this fixture was made; a reset that was
        asked for (~reset) is no complaint."""
        with self._changed:
            statuses = list(self._statuses)
        found = []
        for status in statuses:
            when = "at %.9g s: " % status.header.stamp.to_sec()
            if status.jumped:
                found.append(when + "an instrument moved too far at once, and was placed without a path")
            if status.discarded:
                found.append(when + "a step had no finite answer")
            if status.implausible_load:
                at = status.implausible_at
                found.append(when + "a load that no tissue bears at (%.4g, %.4g, %.4g) m: %d elements turned inside out, %.3g Pa" %
                             (at.x, at.y, at.z, status.inverted_elements, status.contact_pressure))
        if not statuses:
            return ["no status came"]
        before, last = self._before(statuses[0]), statuses[-1]
        for name, what in [("joint_states_refused", "joint states were refused (the node's log says why)"),
                           ("joint_states_dropped", "joint states were dropped: they came faster than the node could take them"),
                           ("joint_states_merged", "joint states were merged: set step.joint_states to every_state, and give each publisher a topic of its own"),
                           ("gaps", "intervals were longer than step.max_gap_s, and were cut"),
                           ("resets", "times time went back, and the scene was reset")]:
            count = getattr(last, name) - getattr(before, name)
            if count:
                found.append("%d %s" % (count, what))
        return found

    def digest(self):
        """Of all wrenches with their stamps, to compare runs with: that of LockStep::digest() in C++ for the same joint states."""
        rows = [(wrench.header.stamp.to_nsec(), place, wrench.wrench)
                for place, name in enumerate(self._wrenches) for wrench in self.wrenches(name)]
        digest = HASH_START
        for stamp_ns, _, wrench in sorted(rows, key=lambda row: row[:2]):
            numbers = [getattr(vector, axis) for vector in [wrench.force, wrench.torque] for axis in "xyz"]
            for word in struct.unpack("<7Q", struct.pack("<Q6d", stamp_ns, *numbers)):
                digest = (digest ^ word) * HASH_FACTOR % 2 ** 64
                digest ^= digest >> 29
        return digest


def free_port():
    """For a ROS master. Below those that the system gives to outgoing connections: one of them could take the port before the master does."""
    with open("/proc/sys/net/ipv4/ip_local_port_range", encoding="ascii") as limits:
        end = max(int(limits.read().split()[0]), 2048)  # some let the system give any
    for port in random.sample(range(1024, end), 1000):
        if port in DEFAULT_PORTS:
            continue
        with socket.socket() as probe:
            try:
                probe.bind(("", port))
                return port
            except OSError:
                continue  # somebody's
    raise OSError("no free port among 1000 below %d" % end)


@contextlib.contextmanager
def launched(package, launch_file, *arguments, deadline_s=DEADLINE_S):
    """A launch file on a ROS master of its own, which this process uses from then on; ended with the block. For pytest: rostest does it itself."""
    port = str(free_port())
    os.environ["ROS_MASTER_URI"] = "http://localhost:" + port
    with subprocess.Popen(["roslaunch", "--port", port, package, launch_file, *arguments], stdin=subprocess.DEVNULL) as roslaunch:
        try:
            end = time.monotonic() + deadline_s
            while not rosgraph.is_master_online():
                if roslaunch.poll() is not None:
                    raise AssertionError("roslaunch ended with exit code %d" % roslaunch.returncode)
                if time.monotonic() > end:
                    raise AssertionError("no ROS master within %g s" % deadline_s)
                time.sleep(0.05)
            yield roslaunch
        finally:
            roslaunch.send_signal(signal.SIGINT)  # not SIGKILL, which would leave its nodes behind
            roslaunch.wait(deadline_s)
