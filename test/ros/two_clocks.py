#!/usr/bin/python3
"""Two publishers on one topic whose clocks are an hour apart: one is followed, the other refused, counted and named; a
single stamp an hour off changes next to nothing; recordings and floods of such stamps end as promptly as any."""
import math
import signal
import time
import unittest

import rospy
from rosgraph_msgs.msg import Log

import faults
import harness

HOUR = rospy.Duration(3600)


class TwoClocks(unittest.TestCase):
    def drive(self, offset, rate_hz, seconds):
        """Alternately by the present and `offset` from it; returns the stamps sent by the present, and what was seen."""
        with harness.node(harness.SCENE) as process:
            log = harness.Listener("/rosout", Log)
            diagnostics = harness.diagnostics()
            wrenches = harness.wrenches()
            source = harness.JointSource()
            sent = [[], []]
            start = time.monotonic()
            count = int(rate_hz * seconds)
            for i in range(count):
                time.sleep(max(0.0, start + i / rate_hz - time.monotonic()))
                stamp = rospy.Time.from_sec(time.time()) + (offset if i % 2 else rospy.Duration(0))
                sent[i % 2].append(stamp)
                source.send(stamp, (0.0, 0.0, -0.003 + 0.002 * math.cos(6.28 * i / rate_hz)))

            def all_played(messages):
                values = faults.figures(messages[-1]) if messages else {}
                return values.get("joint states: received") == str(count) and int(values["joint states: waiting"]) <= 2
            told = diagnostics.wait(all_played, "%d joint states" % count)
            start = time.monotonic()
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(harness.DEADLINE_S), 0)
            self.assertLess(time.monotonic() - start, 1.0)
        values = faults.figures(told[-1])
        merged = int(values["joint states: merged"])  # a busy machine has no wrench for each of them, but counts them
        followed = [w for w in wrenches.messages if w.header.stamp in set(sent[0])]
        print("offset %d s: %d wrenches and %d merged of %d; %s" % (offset.to_sec(), len(followed), merged, len(sent[0]), values))
        self.assertGreaterEqual(len(followed) + merged, 0.95 * len(sent[0]))
        self.assertLessEqual(len(wrenches.messages) - len(followed), 1)
        self.assertGreaterEqual(int(values["joint states: two clocks"]), 0.95 * len(sent[1]))
        self.assertEqual(values["resets"], "0")
        self.assertLessEqual(int(values["gaps"]), 1)
        self.assertEqual(max(d.status[0].level for d in told), faults.ERROR)
        self.assertTrue(any("two clocks" in d.status[0].message for d in told))
        warnings = [m.msg for m in log.messages if m.name == "/tissue_contact" and m.level >= Log.WARN]
        self.assertLess(len(warnings), 8, warnings)
        named = [w for w in warnings if "(two clocks)" in w]
        self.assertTrue(named, warnings)
        for words in [harness.TOPIC, rospy.get_name(), "NTP", "off by"]:
            self.assertIn(words, named[0])

    def test_one_behind_the_present(self):
        self.drive(-HOUR, 500.0, 3.0)

    def test_one_ahead_of_the_present(self):
        self.drive(HOUR, 500.0, 3.0)

    def test_a_single_stamp_ahead(self):
        with harness.node(harness.SCENE):
            diagnostics = harness.diagnostics()
            wrenches = harness.wrenches()
            source = harness.JointSource()
            samples = harness.press(100)
            for i, (stamp, positions) in enumerate(samples):
                source.send(stamp + HOUR if i == 50 else stamp, positions)
            got = wrenches.wait_for_stamp(samples[-1][0])
            self.assertEqual(len(got), 100)
            for now, then in zip(got[51:60], got[50:59]):
                self.assertGreater(now.wrench.force.z, 0.5 * then.wrench.force.z)  # still pressed, not started again

            def told(messages):
                values = faults.figures(messages[-1]) if messages else {}
                return (values.get("joint states: accepted"), values.get("resets"), values.get("gaps")) == ("100", "0", "1")
            diagnostics.wait(told, "one gap and no reset")


if __name__ == "__main__":
    harness.main(TwoClocks)
