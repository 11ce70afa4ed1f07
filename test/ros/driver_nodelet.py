#!/usr/bin/python3
"""A driver and the node in one nodelet manager: joint states are handed over as they are, neither copied nor sent, with the same wrenches as of
the node, bit for bit; for a subscriber outside they are serialized, which shows that the count can see it."""
import subprocess
import xmlrpc.client

import rosgraph
from sensor_msgs.msg import JointState

import harness


class DriverNodelet(harness.TestCase):
    samples = harness.press(60)

    def bits(self, wrenches):
        got = wrenches.wait(lambda all: len(all) >= len(self.samples), "all wrenches")
        wrenches.close()
        return [(w.header.stamp, harness.wrench_bits(w)) for w in got]

    def through_the_manager(self, listens=False):
        """Wrenches; transports of its joint states; what it said. `listens`: somebody outside takes the joint states too."""
        command = [harness.program("driver_nodelet"), harness.SCENE]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, universal_newlines=True) as manager:
            self.addCleanup(manager.kill)
            wrenches = harness.wrenches()
            outside = harness.Listener(harness.TOPIC, JointState) if listens else None
            harness.wait_until(lambda: len(self.transports()) == (2 if listens else 1), "the connections of the driver")
            transports = self.transports()
            for stamp, positions in self.samples:
                manager.stdin.write("%d %d %r %r %r\n" % (stamp.secs, stamp.nsecs, *positions))
            manager.stdin.flush()
            bits = self.bits(wrenches)
            if outside:
                outside.wait(lambda all: len(all) == len(self.samples), "every joint state")
                outside.close()
            said, _ = manager.communicate(timeout=harness.DEADLINE_S)
        self.assertEqual(manager.returncode, 0, said)
        return bits, transports, said

    @staticmethod
    def transports():
        """Of the links that carry joint states within or out of the manager."""
        manager = xmlrpc.client.ServerProxy(rosgraph.Master("/test").lookupNode("/manager"))
        return [link[3] for link in manager.getBusInfo("/test")[2] if link[4] == harness.TOPIC and link[2] == "o"]

    def test_no_copy_within_the_manager(self):
        with harness.node(harness.SCENE):
            wrenches = harness.wrenches()
            harness.JointSource().send_all(self.samples)
            expected = self.bits(wrenches)
        self.assertTrue(any(any(bits) for _, bits in expected))
        bits, transports, said = self.through_the_manager()
        self.assertEqual(bits, expected)
        self.assertEqual(transports, ["INTRAPROCESS"])
        self.assertIn("0 of 60 serialized", said)
        bits, transports, said = self.through_the_manager(listens=True)
        self.assertEqual(bits, expected)
        self.assertEqual(sorted(transports), ["INTRAPROCESS", "TCPROS"])
        self.assertIn("60 of 60 serialized", said)


if __name__ == "__main__":
    harness.main(DriverNodelet)
