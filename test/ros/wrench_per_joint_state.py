#!/usr/bin/python3
"""One wrench for every accepted joint state, with its stamp, in the tip link's frame."""
import math
import sys
import unittest

import rospy
import rostest
from geometry_msgs.msg import WrenchStamped

import harness


class WrenchPerJointState(unittest.TestCase):
    def test_wrenches(self):
        wrenches = harness.Listener("/tissue_contact/probe/wrench", WrenchStamped)
        source = harness.JointSource()
        samples = harness.press(200)
        source.send_all(samples)  # as fast as it goes: nothing may be dropped
        got = wrenches.wait_for_stamp(samples[-1][0])

        self.assertEqual([w.header.stamp for w in got], [stamp for stamp, _ in samples])
        self.assertEqual({w.header.frame_id for w in got}, {"tip"})
        for w in got:
            values = (w.wrench.force.x, w.wrench.force.y, w.wrench.force.z,
                      w.wrench.torque.x, w.wrench.torque.y, w.wrench.torque.z)
            self.assertTrue(all(math.isfinite(v) for v in values), w)
        self.assertEqual(got[0].wrench.force.z, 0.0)
        # The tissue pushes the probe up; 5 mm into 5 kPa is a few tenths of a newton.
        self.assertGreater(got[100].wrench.force.z, 0.05)
        self.assertLess(got[100].wrench.force.z, 2.0)
        # Dragged in +x, so friction pulls the probe back.
        self.assertLess(got[100].wrench.force.x, 0.0)
        self.assertAlmostEqual(got[-1].wrench.force.z, 0.0, delta=1e-9)


if __name__ == "__main__":
    rospy.init_node("wrench_per_joint_state")
    rostest.rosrun("tissue_contact", "wrench_per_joint_state", WrenchPerJointState, sys.argv)
