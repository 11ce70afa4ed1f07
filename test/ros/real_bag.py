#!/usr/bin/python3
"""A dVRK PSM over a slab: a wrench for every joint state, all finite, the same bits offline and through the node at any rate.

As test psm_sweep a sweep of our own, psm_sweep.csv; as real_bag 34 s of a real robot, also in real time, skipped where they are
absent (TISSUE_CONTACT_SHARED_DATA, default ../shared/data beside the package).
"""
import math
import os
import struct
import subprocess
import sys
import unittest

import harness

DATA = os.environ.get("TISSUE_CONTACT_SHARED_DATA") or os.path.join(harness.PACKAGE, "..", "shared", "data")
RECORDING = os.path.join(DATA, "dvrk", "psm2_classic_motion.bag")
SCENE = os.path.join(harness.PACKAGE, "config", "psm_dvrk.yaml")
TOPIC = "/PSM2/measured_js"


class OverASlab(harness.TestCase):
    def check(self, bag, count, rates):
        digests = set()
        for run in ["first", "second"]:
            csv = self.path(run + ".csv")
            self.replayed(SCENE, bag, csv)
            rows = harness.read_csv(csv)
            self.assertEqual(len(rows), count)
            forces = [struct.unpack("<6d", bits) for _, _, bits in rows]
            self.assertTrue(all(math.isfinite(value) for force in forces for value in force))
            self.assertGreater(sum(any(force) for force in forces), 100)  # it does touch
            digests.add(harness.digest((stamp, bits) for stamp, _, bits in rows))
        for rate in rates:
            wrenches = harness.play_through_node(SCENE, bag, TOPIC, "psm", count, rate,
                                                 deadline_s=max(harness.DEADLINE_S, 0.1 * count))
            self.assertEqual(len(wrenches), count)
            digests.add(harness.digest(wrenches))
        self.assertEqual(len(digests), 1)


class Sweep(OverASlab):
    def test_our_own(self):
        bag = self.path("sweep.bag")
        table = os.path.join(os.path.dirname(harness.SCENE), "psm_sweep.csv")
        subprocess.run([harness.program("make_joint_bag.py"), table, bag, "--topic", TOPIC], check=True,
                       timeout=harness.DEADLINE_S)
        self.check(bag, 851, [1, 5])


class Recording(OverASlab):
    @unittest.skipUnless(os.path.exists(RECORDING), "no recording at " + RECORDING)
    def test_recorded(self):
        self.check(RECORDING, 3420, [5, 5, 1])


if __name__ == "__main__":
    harness.main(Recording if "real_bag" in sys.argv else Sweep)
