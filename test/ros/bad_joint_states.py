#!/usr/bin/python3
"""Joint states that cannot be used: no wrench, a count, a warning; the next good one goes on as if they had not come."""
import sys
import unittest

import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from rosgraph_msgs.msg import Log

import harness

NAN = float("nan")
INFINITY = float("inf")


class BadJointStates(unittest.TestCase):
    def test_are_refused_counted_and_forgotten(self):
        wrenches = harness.Listener("/tissue_contact/probe/wrench", WrenchStamped)
        diagnostics = harness.Listener("/diagnostics", DiagnosticArray)
        log = harness.Listener("/rosout", Log)
        source = harness.JointSource()
        samples = harness.press()
        source.send_all(samples)
        undisturbed = wrenches.wait_for_stamp(samples[-1][0])

        source.send(samples[0][0], samples[0][1])  # once more from the start, now with bad ones in between
        for stamp, positions in samples[1:]:
            source.send(stamp, (0.0, NAN, 0.0))
            source.send(stamp, (0.0, 0.0, INFINITY))
            source.send(stamp, (0.0, 0.0, -INFINITY))
            source.send(stamp, (0.0, 0.0))
            source.send(stamp, (1.0,), names=["elbow"])
            source.send(rospy.Time(0), (0.0, 0.0, 0.01))
            source.send(rospy.Time(1), (0.0, 0.0, NAN))
            source.send(rospy.Time(4000000000), (NAN, 0.0, 0.0))
            source.send(stamp, positions)
            source.send(stamp, (0.0, 0.0, 0.0))
        got = wrenches.wait(lambda all: len(all) >= 2 * len(samples), "the second run")

        self.assertEqual([w.header.stamp for w in got], 2 * [stamp for stamp, _ in samples])
        self.assertEqual([harness.wrench_bits(w) for w in got[len(samples):]],
                         [harness.wrench_bits(w) for w in undisturbed])

        last = samples[-1][0] + rospy.Duration(0.01)
        source.send(last, (0.0, 0.0, 0.0))
        wrenches.wait_for_stamp(last)
        bad = len(samples) - 1
        counts = {"accepted": 2 * len(samples) + 1, "position not finite": 5 * bad, "no known joint": bad,
                  "names and positions differ in number": bad, "bad stamp": bad, "duplicate stamp": bad, "too late": 0}

        def told(messages):
            values = {v.key: v.value for v in messages[-1].status[0].values} if messages else {}
            return all(values.get("joint states: " + key) == str(count) for key, count in counts.items())
        diagnostics.wait(told, "the counts %s" % counts)

        warnings = [m.msg for m in log.messages if m.name == "/tissue_contact" and m.level == Log.WARN]
        for words in ["'y' is nan", "names but", "elbow", "stamp must be > 0", "same stamp"]:
            self.assertTrue(any(words in w for w in warnings), (words, warnings))
        self.assertLess(len(warnings), bad)  # throttled


if __name__ == "__main__":
    rospy.init_node("bad_joint_states")
    rostest.rosrun("tissue_contact", "bad_joint_states", BadJointStates, sys.argv)
