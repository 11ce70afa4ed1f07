#!/usr/bin/python3
"""Time that stands still or jumps: the node is stopped for 10 s beside a driver, the clock is stepped. Every state is counted,
and the answers that follow are right."""
import math
import signal
import time
import unittest

import rospy
from rosgraph_msgs.msg import Clock

import faults
import harness


def path(time_s):
    return (0.0, 0.0, -0.002 + 0.001 * math.sin(6.0 * time_s))


class FaultsTime(unittest.TestCase):
    def test_node_stopped_for_ten_seconds(self):
        with harness.node(harness.SCENE) as process:
            wrenches = harness.wrenches()
            diagnostics = harness.diagnostics()
            driver = faults.Driver(200, path)
            try:
                wrenches.wait(lambda all: len(all) > 100, "wrenches before")
                process.send_signal(signal.SIGSTOP)
                end = time.monotonic() + 10.0
                harness.wait_until(lambda: time.monotonic() > end, "ten seconds")
                process.send_signal(signal.SIGCONT)
                # Not only of what has piled up: wrenches of what is sent now.
                now = rospy.Time.from_sec(time.time())
                wrenches.wait(lambda all: len([w for w in all if w.header.stamp > now]) > 100, "wrenches after")
            finally:
                process.send_signal(signal.SIGCONT)
                sent = driver.stop()
            wrenches.wait_for_stamp(driver.stamps[-1])
            values = faults.all_told(diagnostics, sent)
            counts = faults.counts_at_the_end(process)
        self.assertEqual(values["policy"], "newest_state")
        self.assertEqual((counts["received"], counts["dropped"], counts["refused"]), (sent, 0, 0))
        self.assertEqual(counts["accepted"] + counts["merged"], sent)
        self.assertEqual(len(wrenches.messages), counts["wrenches"])
        self.assertEqual(values["joint states: missing by header.seq"], "0")
        self.assertTrue(all(map(harness.is_finite, wrenches.messages)))

    def test_clock_stepped(self):
        rospy.set_param("/use_sim_time", True)
        self.addCleanup(rospy.delete_param, "/use_sim_time")
        blocks = [harness.press(40, start_s=10 * harness.START_S + offset) for offset in [0, 3600, 10, -3600, -3590]]
        with harness.node(harness.SCENE) as process:
            wrenches = harness.wrenches()
            diagnostics = harness.diagnostics()
            clock = rospy.Publisher("/clock", Clock, queue_size=10)
            harness.wait_until(lambda: clock.get_num_connections() > 0, "the node listening to /clock")
            source = harness.JointSource()
            for block in blocks:
                now = block[0][0]
                clock.publish(Clock(now))
                # The node's own stamps tell that it has seen the clock.
                diagnostics.wait(lambda all, now=now: all and all[-1].header.stamp == now, "the node at %s" % now)
                source.send_all(block)
                wrenches.wait_for_stamp(block[-1][0])
            sent = sum(map(len, blocks))
            values = faults.all_told(diagnostics, sent)
            counts = faults.counts_at_the_end(process)
        self.assertEqual((counts["received"], counts["wrenches"]), (sent, counts["accepted"]))
        self.assertEqual(len(wrenches.messages), counts["wrenches"])
        self.assertTrue(all(map(harness.is_finite, wrenches.messages)))
        # Each step back starts the scene again, so what follows is what came first.
        by_stamp = {w.header.stamp: w.wrench.force.z for w in wrenches.messages}
        forces = [[by_stamp[stamp] for stamp, _ in block if stamp in by_stamp] for block in blocks]
        self.assertEqual(forces[2], forces[0])
        self.assertEqual(forces[3], forces[0])
        self.assertGreater(max(forces[0]), 0.01)


if __name__ == "__main__":
    harness.main(FaultsTime)
