#!/usr/bin/python3
"""Plays a bag into tissue_contact_node and plots the force it gives: what launch/*.launch run beside the node.

Waits for the node, plays those topics of the bag that the node listens to, and writes the pictures of plot_forces.py into
the output folder. Prints one line per second where there is no display. With `--show true` it first waits for RViz, and repeats the bag
until RViz is closed. When the plots are written it creates the file that TISSUE_CONTACT_DONE_FILE in the environment
names, if any: roslaunch does not pass exit codes on (see run_launch.py).
"""
import argparse
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from xmlrpc.client import Error, ServerProxy, Transport

import numpy
import rosbag
import rosgraph
import roslib.packages
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from sensor_msgs.msg import JointState

from tissue_contact.msg import ContactArray, ContactPoint, Status, TissueMesh, TissueTopology

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from plot_forces import Forces, friction_of, plot

QUIET_S = 10.0  # without a wrench, after the last joint state: the node will not answer it
RVIZ_START_S = 30.0
DIAGNOSTICS_S = 5.0  # they come every second
LAUNCH_END_S = 10.0  # roslaunch ends its nodes within this, us among them


def fail(message):
    sys.exit("play_and_plot.py: " + message)


class Graph:
    """What the master knows about the node."""

    def __init__(self, node):
        self._node = node
        self._master = rosgraph.Master(rospy.get_name())

    def _topics(self, kind):
        return sorted(topic for topic, nodes in self._master.getSystemState()[kind] if self._node in nodes)

    def published(self):
        return self._topics(0)

    def heard(self):
        """Joint-state topics the node listens to, once they are complete: the same in two looks."""
        types = dict(self._master.getTopicTypes())
        before = None
        while not rospy.is_shutdown():
            now = [topic for topic in self._topics(1) if types.get(topic) == JointState._type]
            if now and now == before:
                return now
            before = now
            types = dict(self._master.getTopicTypes())
            rospy.rostime.wallsleep(0.1)
        return []

    def is_shown(self):
        """Whether RViz listens to the node's markers, or anybody but open_rviz.py, which looks at them before it opens RViz."""
        listeners = dict(self._master.getSystemState()[1]).get(self._node + "/markers", [])
        return any(not name.startswith("/open_rviz_") for name in listeners)

    def hears(self, topics):
        """Whether the node is connected with a publisher of each."""
        try:
            _, _, connections = ServerProxy(self._master.lookupNode(self._node), ShortTransport()).getBusInfo(rospy.get_name())
        except (OSError, Error, rosgraph.MasterException):
            return False
        return set(topics) <= {topic for _, _, direction, _, topic, *_ in connections if direction == "i"}


class ShortTransport(Transport):
    """A node that does not answer must not hold up the end."""

    def make_connection(self, host):
        connection = super().make_connection(host)
        connection.timeout = 2.0  # s
        return connection


class Recorder:
    """Collects what the node publishes; all times are of the messages."""

    def __init__(self, node, graph):
        self.lock = threading.Lock()
        self.forces = Forces()
        self.last_joint_state = None
        self.last_wrench = None
        self.last_contacts = None
        self.counts = None  # of the newest diagnostics
        self.open = True  # until the first pass is over
        self._rest = {}
        self._meshes = {}
        for topic in graph.published():
            name = topic[len(node) + 1:]
            if name.endswith("/wrench"):
                rospy.Subscriber(topic, WrenchStamped, self._take_wrench, name[:-len("/wrench")], tcp_nodelay=True)
            elif name.endswith("/topology"):
                rospy.Subscriber(topic, TissueTopology, self._take_topology)
            elif name.endswith("/mesh"):
                rospy.Subscriber(topic, TissueMesh, self._take_mesh)
        rospy.Subscriber(node + "/status", Status, self._take_status)
        rospy.Subscriber("/diagnostics", DiagnosticArray, self._take_diagnostics, node)
        rospy.Subscriber(node + "/contacts", ContactArray, self._take_contacts, tcp_nodelay=True)

    def hear(self, joint_topics):
        for topic in joint_topics:
            rospy.Subscriber(topic, JointState, self._take_joint_state, tcp_nodelay=True)

    def _take_joint_state(self, message):
        with self.lock:
            self.last_joint_state = message.header.stamp

    def _take_wrench(self, message, instrument):
        with self.lock:
            self.last_wrench = message.header.stamp
            if self.open:
                self.forces.take_wrench(instrument, message)

    def _take_status(self, message):
        with self.lock:
            if self.open:
                self.forces.take_status(message)

    def _take_contacts(self, message):
        with self.lock:
            self.last_contacts = message
            if self.open:
                self.forces.take_contacts(message)

    def _take_topology(self, message):
        with self.lock:
            self._rest[message.tissue] = (message.revision, message.rest_positions)

    def _take_mesh(self, message):
        with self.lock:
            self._meshes[message.tissue] = (message.revision, message.positions)

    def is_answered(self):
        """Whether the newest joint state heard has its wrench."""
        with self.lock:
            return self.last_joint_state is not None and self.last_joint_state == self.last_wrench

    def _take_diagnostics(self, message, node):
        for status in message.status:
            if status.name == node.lstrip("/") + ": tissue contact":
                with self.lock:
                    self.counts = {value.key: value.value for value in status.values}

    def lost(self, sent):
        """How many of `sent` joint states did not reach the node, or were dropped there; waits for the next diagnostics."""
        with self.lock:
            self.counts = None
        if not wait_quietly(lambda: self.counts is not None, DIAGNOSTICS_S):
            print("no /diagnostics of the node, so whether all joint states reached it is not known", flush=True)
            return 0
        return sent - int(self.counts["joint states: received"]) + int(self.counts["joint states: dropped"])

    def line(self):
        """One line on how things are now."""
        with self.lock:
            forces = {name: samples[-1][1] for name, samples in self.forces.wrenches.items()}
            begin = min((samples[0][0] for samples in self.forces.wrenches.values()), default=0.0)
            now = self.last_wrench.to_sec() - begin if self.last_wrench else 0.0
            contacts = self.last_contacts.contacts if self.last_contacts else []
            meshes = [(self._rest[name][1], mesh) for name, (revision, mesh) in self._meshes.items()
                      if name in self._rest and self._rest[name][0] == revision]  # else the other one is on its way
        deepest = 0.0
        for rest, mesh in meshes:
            moved = numpy.array([(p.x - r.x, p.y - r.y, p.z - r.z) for p, r in zip(mesh, rest)])
            deepest = max(deepest, numpy.linalg.norm(moved, axis=1).max())
        states = [contact.state for contact in contacts]
        text = "  ".join("%s %.3f N" % (name, numpy.linalg.norm(force)) for name, force in sorted(forces.items()))
        return "t %6.2f s  force %s  contacts %d static %d kinetic  deepest displacement %.2f mm" % (
            now, text or "-", states.count(ContactPoint.STATIC), states.count(ContactPoint.KINETIC), 1e3 * deepest)


def bag_topics(file):
    """How many messages there are, by topic."""
    try:
        with rosbag.Bag(file) as bag:
            return {name: topic.message_count for name, topic in bag.get_type_and_topic_info().topics.items()}
    except (OSError, rosbag.ROSBagException) as error:
        fail("bag %s cannot be read: %s" % (file, error))


def start_player(arguments, topics, loop):
    """rosbag play as a child that ends with us."""
    player = roslib.packages.find_node("rosbag", "play")
    if not player:
        fail("rosbag play is not installed")
    command = [player[0], "--quiet", "--wait-for-subscribers", "--queue", "100000", "--rate", str(arguments.rate)]
    command += ["--clock"] if arguments.show == "true" else []
    command += (["--loop"] if loop else []) + [arguments.bag, "--topics"] + topics
    child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    rospy.on_shutdown(lambda: child.poll() is None and child.send_signal(signal.SIGTERM))
    return child


def watch(recorder, is_over, talk):
    """Until is_over() or shutdown, with a line per second if `talk`."""
    next_line = time.monotonic() + 1.0
    while not rospy.is_shutdown() and not is_over():
        rospy.rostime.wallsleep(0.02)
        if talk and time.monotonic() >= next_line:
            next_line += 1.0
            print(recorder.line(), flush=True)


def wait_quietly(condition, limit_s):
    """Whether condition() came true within the limit."""
    end = time.monotonic() + limit_s
    while not rospy.is_shutdown() and not condition() and time.monotonic() < end:
        rospy.rostime.wallsleep(0.05)
    return condition()


def wait_for_the_rest(recorder, talk):
    """Whether the last joint state gets its wrench. A node slower than the recording is still at work, with a wrench now and then."""
    while not wait_quietly(recorder.is_answered, 1.0):
        last = recorder.last_wrench
        wait_quietly(lambda: recorder.last_wrench != last, QUIET_S)
        if rospy.is_shutdown() or recorder.last_wrench == last:
            return recorder.is_answered()
        if talk:
            print(recorder.line(), flush=True)
    return True


def end_launch():
    """Ends the roslaunch that started us as Ctrl-C would. The launch file's nodes are `required`, so that it ends when one
    fails; were we just to return, it would call our good end a death, in red."""
    try:
        uris = rosgraph.Master(rospy.get_name()).getParam("/roslaunch/uris").values()
    except rosgraph.MasterException:
        return  # started by hand
    for uri in uris:
        try:
            code, _, pid = ServerProxy(uri).get_pid()
        except (OSError, Error):
            continue  # a roslaunch that is gone
        if code == 1 and pid == os.getppid():
            os.kill(pid, signal.SIGINT)
            wait_quietly(rospy.is_shutdown, LAUNCH_END_S)
            return


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--bag", required=True)
    parser.add_argument("--output", required=True, help="folder for the plots; made if it does not exist")
    parser.add_argument("--node", default="/tissue_contact", help="default: %(default)s")
    parser.add_argument("--rate", type=float, default=1.0, help="playback speed, default: %(default)s")
    parser.add_argument("--show", type=str.lower, choices=["true", "false"], default="false",
                        help="wait for RViz and repeat the bag until it is closed")
    return parser.parse_args(rospy.myargv()[1:])


def main():
    arguments = parse_arguments()
    in_bag = bag_topics(arguments.bag)
    rospy.init_node("play_and_plot")
    arguments.node = rospy.resolve_name(arguments.node)  # of a launch file in a namespace
    graph = Graph(arguments.node)
    heard = graph.heard()
    topics = [topic for topic in heard if topic in in_bag]
    if rospy.is_shutdown():
        return
    if not topics:
        fail("%s has no message on %s; its topics are: %s" %
             (arguments.bag, ", ".join(heard), ", ".join(sorted(in_bag))))
    shown = arguments.show == "true" and shutil.which("rviz") is not None and wait_quietly(graph.is_shown, RVIZ_START_S)
    recorder = Recorder(arguments.node, graph)
    child = start_player(arguments, topics, loop=False)
    # It begins with the first subscriber of each topic. Were that we, on a busy machine the node would miss what comes till it is connected as well.
    watch(recorder, lambda: graph.hears(topics) or child.poll() is not None, talk=not shown)
    recorder.hear(topics)
    watch(recorder, lambda: child.poll() is not None, talk=not shown)
    if not rospy.is_shutdown() and child.returncode != 0:
        fail("rosbag play ended with exit code %s" % child.returncode)
    answered = wait_for_the_rest(recorder, talk=not shown)
    recorder.open = False
    lost = recorder.lost(sum(in_bag[topic] for topic in topics))
    if rospy.is_shutdown():
        return
    if not recorder.forces.wrenches:
        fail("the node gave no wrench; its warnings say why")
    if not answered:
        print("the last joint state has no wrench; the node's warnings say why", flush=True)
    try:
        for path in plot(recorder.forces, friction_of(rospy.get_param(arguments.node + "/scene")), arguments.output):
            print("wrote " + os.path.abspath(path), flush=True)
    except OSError as error:
        fail("cannot write %s: %s" % (error.filename, error.strerror))
    if lost > 0:
        fail("%d of the recording's joint states did not reach the node or were dropped by it, so the forces are not those of the recording: "
             "play it slower (now rate %g), or use tissue_contact_replay" % (lost, arguments.rate))
    if os.environ.get("TISSUE_CONTACT_DONE_FILE"):
        with open(os.environ["TISSUE_CONTACT_DONE_FILE"], "w", encoding="utf-8"):
            pass
    if shown and graph.is_shown():
        print("repeating the bag until RViz is closed", flush=True)
        start_player(arguments, topics, loop=True)
        watch(recorder, lambda: not graph.is_shown(), talk=False)
    if not rospy.is_shutdown():
        end_launch()


if __name__ == "__main__":
    main()
