#!/usr/bin/python3
"""A looped bag: the scene resets, says so once per loop, and gives the same bits again; meshes come from the start on."""
import unittest

from rosgraph_msgs.msg import Log

import harness
from tissue_contact.msg import Status, TissueMesh


class TimeBackwards(unittest.TestCase):
    def test_scene_resets_once_per_loop(self):
        wrenches = harness.wrenches()
        meshes = harness.Listener("/tissue_contact/block/mesh", TissueMesh)
        statuses = harness.Listener("/tissue_contact/status", Status)
        diagnostics = harness.diagnostics()
        log = harness.Listener("/rosout", Log)
        source = harness.JointSource()
        samples = harness.press()[:50]  # ends while pressing: the next loop must not inherit that
        for loop in range(1, 4):
            source.send_all(samples)
            wrenches.wait(lambda all, n=loop * len(samples): len(all) >= n, "loop %d" % loop)
        got = wrenches.messages
        loops = [[harness.wrench_bits(w) for w in got[i * 50:(i + 1) * 50]] for i in range(3)]
        self.assertEqual(len(got), 150)
        self.assertGreater(got[49].wrench.force.z, 0.01)
        self.assertEqual(loops[0], loops[1])
        self.assertEqual(loops[0], loops[2])

        first = samples[0][0]
        statuses.wait(lambda all: [m.resets for m in all if m.header.stamp == first] == [0, 1, 2], "counted resets")
        restarted = meshes.wait(lambda all: sum(m.header.stamp == first for m in all) == 3, "a mesh of every start")
        self.assertEqual([m.step for m in restarted if m.header.stamp == first], [0, 0, 0])

        def said(messages):
            return [m.msg for m in messages if m.name == "/tissue_contact" and "backwards" in m.msg]
        warnings = said(log.wait(lambda all: len(said(all)) >= 2, "two warnings"))
        self.assertEqual(len(warnings), 2, warnings)
        self.assertIn(harness.TOPIC, warnings[0])
        self.assertIn("reset", warnings[0])
        # "running" was all that /diagnostics had of it.
        diagnostics.wait(lambda all: any("time went backwards: the scene was reset" in s.message for m in all for s in m.status), "the reset told")


if __name__ == "__main__":
    harness.main(TimeBackwards)
