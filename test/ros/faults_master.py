#!/usr/bin/python3
"""The ROS master is killed, restarted, stopped: the node and the output to a haptic device go on, and whoever comes later finds them. On a
master of its own, since rostest's must not be killed."""
import os
import signal
import subprocess
import sys
import time

import rosgraph
import rospy
import rostest

import faults
import harness
from tissue_contact_testing import free_port

PORT = free_port()


class Master:
    def __init__(self):
        self.start()

    def start(self):
        self._process = subprocess.Popen(["rosmaster", "--core", "-p", str(PORT)], stdin=subprocess.DEVNULL,
                                         stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        harness.wait_until(rosgraph.is_master_online, "a ROS master on port %d" % PORT)

    def signal(self, number):
        self._process.send_signal(number)

    def kill(self):
        self._process.kill()
        self._process.wait()


# A node and a device that were not there before: a wrench of 0.5 N until it is felt.
NEW_HAND = """
import rospy
from geometry_msgs.msg import WrenchStamped
rospy.init_node("new_hand")
wrench = WrenchStamped()
wrench.wrench.force.z = 0.5
source = rospy.Publisher("/new/wrench", WrenchStamped, queue_size=1)
felt = []
rospy.Subscriber("/new/servo_cf", WrenchStamped, lambda message: felt.append(message.wrench.force.z))
while 0.5 not in felt:
    source.publish(wrench)
    rospy.sleep(0.01)
"""


def registrations(node=harness.NODE):
    """What the master knows of a node: (kind, topic or service), and where its services are."""
    master = rosgraph.Master("/test")
    known = {(kind, name) for kind, entries in enumerate(master.getSystemState()) for name, nodes in entries if node in nodes}
    for name in [name for kind, name in known if kind == 2]:
        try:
            known.add(master.lookupService(name))
        except rosgraph.MasterError:
            pass  # gone since: a client may come and go
    return known


class FaultsMaster(harness.TestCase):
    def setUp(self):
        super().setUp()
        self.master = Master()
        self.addCleanup(self.master.kill)

    def master_status(self, diagnostics, condition, what, deadline_s=harness.DEADLINE_S):
        def holds(messages):
            status = faults.status_named(messages[-1], "ROS master") if messages else None
            return status is not None and condition(status)
        return faults.status_named(diagnostics.wait(holds, what, deadline_s)[-1], "ROS master")

    def play(self, samples):
        """By a program that was not there before either."""
        bag = self.bag_of("more.bag", samples)
        command = [harness.program_of("rosbag", "play"), "--quiet", "--wait-for-subscribers", "--rate", "10", bag]
        subprocess.run(command, check=True, timeout=harness.DEADLINE_S, stdin=subprocess.DEVNULL)

    def seen_by_newcomer(self):
        """Stamp of the latched topology, by a program that was not there before."""
        program = ("import rospy; from tissue_contact.msg import TissueTopology; rospy.init_node('newcomer'); "
                   "print(rospy.wait_for_message('%s/block/topology', TissueTopology).header.stamp.to_nsec())" % harness.NODE)
        return int(subprocess.run([sys.executable, "-c", program], check=True, stdout=subprocess.PIPE, text=True,
                                  timeout=harness.DEADLINE_S).stdout)

    def assert_wrench_for_each(self, source, wrenches, samples):
        source.send_all(samples)
        wrenches.wait_for_stamp(samples[-1][0])

    def test_stopped_then_killed_and_restarted(self):
        samples = harness.press(160)
        with harness.node(harness.SCENE) as process:
            wrenches = harness.wrenches()
            diagnostics = harness.diagnostics()
            source = harness.JointSource()
            self.master_status(diagnostics, lambda s: s.level == faults.OK, "a node that is registered")
            before = registrations()
            self.assertGreater(len(before), 5)

            self.master.signal(signal.SIGSTOP)  # answers nothing, closes nothing
            # A second to the next call, five of patience, a second to the next diagnostics, and one more.
            status = self.master_status(diagnostics, lambda s: s.level == faults.WARN, "a warning that it is stopped",
                                        8.0 * harness.SLOWNESS)
            self.assertIn("does not answer", status.message)
            self.assert_wrench_for_each(source, wrenches, samples[:50])
            self.master.signal(signal.SIGCONT)
            status = self.master_status(diagnostics, lambda s: s.level == faults.OK, "that it answers again")
            self.assertEqual(faults.values_of(status)["times registered again"], "0")

            self.master.kill()
            self.master_status(diagnostics, lambda s: s.level == faults.WARN, "a warning that the master is gone")
            self.assert_wrench_for_each(source, wrenches, samples[50:100])  # over the connections that live
            self.master.start()
            status = self.master_status(diagnostics, lambda s: s.level == faults.OK, "a node that registered again")
            self.assertEqual(faults.values_of(status)["times lost"], "2")
            self.assertEqual(faults.values_of(status)["times registered again"], "1")
            self.assertEqual(registrations(), before)
            self.assert_wrench_for_each(source, wrenches, samples[100:110])  # they were not cut by it
            self.assertEqual(self.seen_by_newcomer(), samples[0][0].to_nsec())
            self.play(samples[110:])
            everything = wrenches.wait_for_stamp(samples[-1][0])
            self.assertEqual([w.header.stamp for w in everything], [stamp for stamp, _ in samples])

            self.master.signal(signal.SIGSTOP)
            try:
                counts = faults.counts_at_the_end(process)
            finally:
                self.master.signal(signal.SIGCONT)
        self.assertEqual(counts["received"], len(samples))
        self.assertEqual(counts["wrenches"], len(samples))

    def test_a_hand_finds_the_haptic_output_at_another_master(self):
        with harness.running([harness.program("tissue_contact_haptics"), "wrench:=/new/wrench", "servo_cf:=/new/servo_cf"]) as haptics:
            kinds = [(0, "/new/servo_cf"), (1, "/new/wrench"), (2, "/haptics/get_loggers")]  # its services come first
            harness.wait_until(lambda: set(kinds) <= registrations("/haptics"), "haptics, registered")
            before = registrations("/haptics")
            self.master.kill()
            self.master.start()
            harness.wait_until(lambda: registrations("/haptics") == before, "haptics, registered again")
            subprocess.run([sys.executable, "-c", NEW_HAND], check=True, timeout=harness.DEADLINE_S)
            self.master.signal(signal.SIGSTOP)
            try:
                haptics.send_signal(signal.SIGINT)
                start = time.monotonic()
                self.assertEqual(haptics.wait(harness.DEADLINE_S), 0, harness.output_of(haptics))
                self.assertLess(time.monotonic() - start, harness.SLOWNESS)
            finally:
                self.master.signal(signal.SIGCONT)


if __name__ == "__main__":
    os.environ["ROS_MASTER_URI"] = "http://localhost:%d" % PORT
    first = Master()  # for init_node; every test begins with one that knows nothing
    rospy.init_node("faults_master")
    first.kill()
    rostest.rosrun("tissue_contact", "faults_master", FaultsMaster, sys.argv)
