#!/usr/bin/python3
"""Joint states that cannot be used: no wrench, a count, a warning; the next good one goes on as if they had not come."""
import sys

import rosbag
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import WrenchStamped
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import JointState

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
            values = {v.key: v.value for v in messages[-1].status[0].values} if messages else {}
            return all(values.get("joint states: " + key) == str(count) for key, count in counts.items())
        diagnostics.wait(told, "the counts %s" % counts)

        warnings = [m.msg for m in log.messages if m.name == "/tissue_contact" and m.level == Log.WARN]
        for words in ["'y' is nan", "names but", "elbow", "stamp must be > 0", "same stamp"]:
            self.assertTrue(any(words in w for w in warnings), (words, warnings))
        self.assertLess(len(warnings), bad)  # throttled

    def test_a_recorded_stamp_past_the_end_of_time_is_refused_by_replay(self):
        samples = harness.press(20)
        tables = []
        for name, more in [("clean", []), ("bad", [(all_bits_set(), (0.0, 0.0, 0.0))])]:
            bag = self.path(name + ".bag")
            with rosbag.Bag(bag, "w") as out:
                for i, (stamp, positions) in enumerate(samples[:10] + more + samples[10:]):
                    message = JointState(name=["x", "y", "z"], position=list(positions))
                    message.header.stamp = stamp
                    out.write(harness.TOPIC, message, rospy.Time(harness.START_S + i))
            code, errors = harness.replay(harness.SCENE, bag, bag + ".csv")
            self.assertEqual(code, 0, errors)
            tables.append(harness.read_csv(bag + ".csv"))
        self.assertIn("1 bad stamp", errors)
        self.assertIn("stamp out of range", errors)
        self.assertEqual(tables[0], tables[1])


if __name__ == "__main__":
    rospy.init_node("bad_joint_states")
    rostest.rosrun("tissue_contact", "bad_joint_states", BadJointStates, sys.argv)
