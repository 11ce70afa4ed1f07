#!/usr/bin/python3
"""tissue_contact_haptics without a device: scaled and bounded wrenches at a rate; zero when none comes, when one is not finite, and when it
ends by a signal or rosnode kill; by its launch file behind the node itself."""
import contextlib
import math
import signal
import threading
import time
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
from geometry_msgs.msg import WrenchStamped
from roscpp.srv import GetLoggers

import harness

WRENCH, COMMAND = "/test/wrench", "/test/servo_cf"


class Feeder:
    """Publishes the wrench it holds a hundred times a second, as a node does, until stopped."""

    def __init__(self):
        self._publisher = rospy.Publisher(WRENCH, WrenchStamped, queue_size=1, tcp_nodelay=True)
        self._force = None
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def hold(self, *force):
        self._force = force or None

    def _run(self):
        while not self._end.wait(0.01):
            if self._force:
                message = WrenchStamped()
                message.header.frame_id = "tip"
                message.wrench.force.x, message.wrench.force.y, message.wrench.force.z = self._force
                self._publisher.publish(message)

    def stop(self):
        self._end.set()
        self._thread.join()
        self._publisher.unregister()


def force_of(message):
    return tuple(harness.wrench_of(message)[:3])


def is_zero(message):
    return not any(harness.wrench_of(message))


class Haptics(harness.TestCase):
    @contextlib.contextmanager
    def haptics(self, *parameters):
        with harness.running([harness.program("tissue_contact_haptics"), "wrench:=" + WRENCH, "servo_cf:=" + COMMAND, *parameters]) as node:
            self.commands = harness.Listener(COMMAND, WrenchStamped)
            yield node
            self.commands.close()

    def setUp(self):
        super().setUp()
        self.feeder = Feeder()
        self.addCleanup(self.feeder.stop)

    @staticmethod
    def haptics_is_connected():
        """Whether wrenches come in: a publisher does not keep what it sent before."""
        node = ServerProxy(rosgraph.Master("/test").lookupNode("/haptics"))
        return any(link[2] == "i" and link[4].endswith("/wrench") for link in node.getBusInfo("/test")[2])

    def wait_for_force(self, expected, after=0):
        """Until a command after so many has that force; returns how many had come by then."""
        got = self.commands.wait(lambda all: any(math.dist(force_of(m), expected) < 1e-12 for m in all[after:]), "the force %s" % (expected,))
        return len(got)

    def test_ten_seconds_without_input_are_told_of(self):
        with harness.node(harness.SCENE) as node, harness.running(
                [harness.program("tissue_contact_haptics"), "wrench:=" + WRENCH, "servo_cf:=" + COMMAND]) as haptics:
            harness.wait_until(lambda: "no joint state yet, within 10 s, on %s" % harness.TOPIC in harness.output_of(node),
                               "the node's warning")
            harness.wait_until(lambda: "no wrench yet on %s, which has 1 publishers" % WRENCH in harness.output_of(haptics),
                               "the warning of the haptic output")

    def test_scales_bounds_and_falls_to_zero(self):
        with self.haptics("_force_scale:=0.5", "_max_force_n:=1", "_stale_after_s:=0.5"):
            first = self.commands.wait(len, "a command")[0]
            self.assertTrue(is_zero(first))  # none has come yet
            self.feeder.hold(0.2, -0.4, 0.6)
            count = self.wait_for_force((0.1, -0.2, 0.3))
            self.assertEqual(self.commands.messages[-1].header.frame_id, "tip")
            self.feeder.hold(0.0, 60.0, 80.0)
            count = self.wait_for_force((0.0, 0.6, 0.8), count)
            self.assertLessEqual(max(math.hypot(*force_of(m)) for m in self.commands.messages), 1.0 + 1e-12)
            self.feeder.hold(math.nan, 0.0, 1.0)
            count = self.wait_for_force((0.0, 0.0, 0.0), count)
            self.feeder.hold(0.0, 0.0, 1.0)
            count = self.wait_for_force((0.0, 0.0, 0.5), count)
            self.feeder.hold()  # stale from here on
            begin = time.monotonic()
            self.wait_for_force((0.0, 0.0, 0.0), count)
            self.assertGreater(time.monotonic() - begin, 0.3)  # not before its time

    def test_last_commands_are_zero(self):
        def interrupt(node):
            node.send_signal(signal.SIGINT)

        def kill(_):  # as rosnode kill does
            ServerProxy(rosgraph.Master("/test").lookupNode("/haptics")).shutdown("/test", "a test")

        for end in [interrupt, kill]:
            with self.subTest(end=end.__name__), self.haptics() as node:
                self.feeder.hold(0.0, 0.0, 1.0)
                self.wait_for_force((0.0, 0.0, 1.0))
                end(node)
                harness.wait_until(lambda child=node: child.poll() is not None, "the end of the node")
                self.assertEqual(node.returncode, 0, harness.output_of(node))
                self.commands.wait(lambda all: is_zero(all[-1]), "a last zero")

    def test_loggers_are_listed_more_than_once(self):
        """rosconsole's own service ends the process at the second call."""
        with self.haptics() as node:
            self.commands.wait(len, "a command")
            list_loggers = rospy.ServiceProxy("/haptics/get_loggers", GetLoggers)
            for _ in range(3):
                self.assertIn("ros.roscpp", [logger.name for logger in list_loggers().loggers])
            self.assertIsNone(node.poll())

    def test_bad_parameters(self):
        for bad, complaint in [("_rate_hz:=0", "rate_hz' is 0"), ("_max_force_n:=-1", "max_force_n' is -1"),
                               ("_stale_after_s:=soon", "stale_after_s' is \"soon\"; it must be a number >= 0.001 and <= 10 s"),
                               ("_max_force:=1", "max_force' is none that this node reads; did you mean 'max_force_n'?")]:
            name = "/haptics/" + bad[1:].split(":=")[0]
            code, output = harness.run([harness.program("tissue_contact_haptics"), bad])
            if "is none" in complaint:  # or every later start would be refused for it
                self.assertFalse(rospy.has_param(name))
            else:
                rospy.delete_param(name)
            self.assertEqual(code, 1, output)
            self.assertIn(complaint, output)

    def test_launch_file_behind_the_node(self):
        """What the tissue exerts on a probe, felt by the hand; nothing once the joint states end."""
        with harness.node(harness.SCENE), harness.running(
                ["roslaunch", "tissue_contact", "haptics.launch", "wrench:=%s/probe/wrench" % harness.NODE, "servo_cf:=" + COMMAND,
                 "max_force_n:=0.1", "stale_after_s:=0.2"]):
            self.commands = harness.Listener(COMMAND, WrenchStamped)
            wrenches = harness.wrenches()
            harness.wait_until(self.haptics_is_connected, "its connection")
            # Down alone: on a busy machine the output may meet none but the last wrench, which is zero after the way up.
            harness.JointSource().send_all(harness.press(50)[:25])
            wrenches.wait(lambda all: len(all) >= 25, "all wrenches")
            self.assertGreater(max(math.hypot(*force_of(m)) for m in wrenches.messages), 0.1)
            felt = self.commands.wait(lambda all: any(not is_zero(m) for m in all) and is_zero(all[-1]), "a force, then zero")
            self.assertLessEqual(max(math.hypot(*force_of(m)) for m in felt), 0.1 + 1e-12)
            self.assertGreater(max(force_of(m)[2] for m in felt), 0.01)  # upwards
            self.commands.close()


if __name__ == "__main__":
    harness.main(Haptics)
