#!/usr/bin/python3
"""Joint states that cannot be used: no wrench, a count, a warning; the next good one goes on as if they had not come."""
import rospy
from rosgraph_msgs.msg import Log

import faults
import harness

NAN = float("nan")
INFINITY = float("inf")


def all_bits_set():
    """As a message may hold it: later than any time that ROS computes with."""
    stamp = rospy.Time(0)
    stamp.secs = stamp.nsecs = 0xFFFFFFFF
    return stamp


class BadJointStates(harness.TestCase):
    def test_are_refused_counted_and_forgotten(self):
        wrenches = harness.wrenches()
        diagnostics = harness.diagnostics()
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
            source.send(all_bits_set(), positions)
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
                  "names and positions differ in number": bad, "bad stamp": 2 * bad, "duplicate stamp": bad, "too late": 0}

        def told(messages):
            values = faults.figures(messages[-1]) if messages else {}
            return all(values.get("joint states: " + key) == str(count) for key, count in counts.items())
        diagnostics.wait(told, "the counts %s" % counts)

        warnings = [m.msg for m in log.messages if m.name == "/tissue_contact" and m.level == Log.WARN]
        for words in ["'y' is nan", "names but", "elbow", "stamp must be > 0", "same stamp"]:
            self.assertTrue(any(words in w for w in warnings), (words, warnings))
        self.assertLess(len(warnings), bad)  # throttled

        source.send(last + rospy.Duration(0.01), (0.0, 0.0, 10.0))  # taken, but is no metre of this robot
        log.wait(lambda messages: any("z at 10 (-1 to 1)" in m.msg for m in messages), "a warning of far outside limits")


if __name__ == "__main__":
    harness.main(BadJointStates)
