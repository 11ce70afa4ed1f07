#!/usr/bin/python3
"""A bag shorter than max_gap_s in a loop with /clock: the clock going back starts the scene again. Time is simulated, so
every state is stepped to although their stamps are of the present."""
import time
import unittest

import rospy
from rosgraph_msgs.msg import Clock

import faults
import harness


class ClockBack(unittest.TestCase):
    def test_scene_starts_again(self):
        wrenches = harness.wrenches()
        diagnostics = harness.diagnostics()
        clock = rospy.Publisher("/clock", Clock, queue_size=10)
        harness.wait_until(lambda: clock.get_num_connections() >= 2, "the node listening to /clock")  # the test does as well
        source = harness.JointSource()
        samples = harness.press(100, start_s=int(time.time()))[40:58]  # 0.17 s, deepest at its end; max_gap_s is 0.2
        for loop in range(1, 4):
            for now in [samples[0][0], samples[-1][0]]:
                clock.publish(Clock(now))
                # The node's own stamps tell that it has seen the clock.
                diagnostics.wait(lambda all, now=now: all and all[-1].header.stamp == now, "the node at %s" % now)
                if now == samples[0][0]:
                    source.send_all(samples)
                    wrenches.wait(lambda all, n=loop * len(samples): len(all) >= n, "loop %d" % loop)
        got = wrenches.messages
        loops = [[harness.wrench_bits(w) for w in got[i * len(samples):(i + 1) * len(samples)]] for i in range(3)]
        self.assertEqual(len(got), 3 * len(samples))
        self.assertGreater(max(w.wrench.force.z for w in got), 0.01)
        self.assertEqual(loops[0], loops[1])
        self.assertEqual(loops[0], loops[2])

        def told(messages):
            values = faults.figures(messages[-1])
            return (values["resets"], values["joint states: too late"], values["policy"]) == ("2", "0", "every_state")
        diagnostics.wait(told, "two resets")


if __name__ == "__main__":
    harness.main(ClockBack)
