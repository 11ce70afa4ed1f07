#!/usr/bin/python3
"""34 s of a real dVRK PSM over a slab: 3420 wrenches, all finite, the same bits twice offline, twice at rate 5, and in real time.

Skipped where the recording is absent (TISSUE_CONTACT_SHARED_DATA, default ../shared/data beside the package).
"""
import math
import os
import shutil
import struct
import sys
import tempfile
import unittest

import rospy
import rostest

import harness

DATA = os.environ.get("TISSUE_CONTACT_SHARED_DATA") or os.path.join(harness.PACKAGE, "..", "shared", "data")
BAG = os.path.join(DATA, "dvrk", "psm2_classic_motion.bag")
SCENE = os.path.join(harness.PACKAGE, "config", "psm_dvrk.yaml")
JOINT_STATES = 3420


class RealBag(unittest.TestCase):
    @unittest.skipUnless(os.path.exists(BAG), "no recording at " + BAG)
    def test_one_wrench_per_joint_state_with_the_same_bits(self):
        directory = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, directory)
        digests = {}
        for run in ["first", "second"]:
            csv = os.path.join(directory, run + ".csv")
            code, errors = harness.replay(SCENE, BAG, csv)
            self.assertEqual(code, 0, errors)
            rows = harness.read_csv(csv)
            self.assertEqual(len(rows), JOINT_STATES)
            forces = [struct.unpack("<6d", bits) for _, _, bits in rows]
            self.assertTrue(all(math.isfinite(value) for force in forces for value in force))
            self.assertGreater(sum(any(force) for force in forces), 100)  # it does touch
            digests["replay, %s time" % run] = harness.digest((stamp, bits) for stamp, _, bits in rows)
        for run, rate in [("first", 5), ("second", 5), ("only", 1)]:
            wrenches = harness.play_through_node(SCENE, BAG, "/PSM2/measured_js", "/tissue_contact/psm/wrench",
                                                 JOINT_STATES, rate, deadline_s=60.0)
            self.assertEqual(len(wrenches), JOINT_STATES)
            digests["node, rate %d, %s time" % (rate, run)] = harness.digest(wrenches)
        self.assertEqual(len(digests), 5)
        self.assertEqual(len(set(digests.values())), 1, digests)


if __name__ == "__main__":
    rospy.init_node("real_bag")
    rostest.rosrun("tissue_contact", "real_bag", RealBag, sys.argv)
