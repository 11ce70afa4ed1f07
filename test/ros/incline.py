#!/usr/bin/python3
"""The shipped incline: a block of known weight on a plate that tilts rests by static friction below atan(mu), and slides above it; the
launch file draws plots."""
import math
import os

import roslaunch.substitution_args

import harness

SCENE = os.path.join(harness.PACKAGE, "config", "incline.yaml")
BAG = roslaunch.substitution_args.resolve_args("$(find tissue_contact)/config/incline.bag")
JOINT_STATES = 2501  # 5 s at 500 Hz
WEIGHT_N = 0.06 * 0.06 * 0.03 * 1000 * 9.81
FRICTION = 0.3


class Incline(harness.TestCase):
    def test_it_holds_and_slides_as_coulomb_has_it(self):
        self.replayed(SCENE, BAG, self.path("out.csv"))
        rows = harness.read_table(self.path("out.csv"))
        self.assertEqual(len(rows), JOINT_STATES)
        along, across = [[float(row["force_%s_n" % axis]) for row in rows] for axis in "xz"]  # in the plate's axes

        def mean(forces, begin_s, end_s):
            part = forces[int(500 * begin_s):int(500 * end_s)]
            return sum(part) / len(part)
        for begin, end, tilt in [(0.1, 0.3, 0.0), (2.6, 3.3, 0.28972)]:  # at rest: statics
            self.assertAlmostEqual(mean(across, begin, end), -WEIGHT_N * math.cos(tilt), delta=0.01 * WEIGHT_N)
            self.assertAlmostEqual(mean(along, begin, end), WEIGHT_N * math.sin(tilt), delta=0.01 * WEIGHT_N)
        self.assertAlmostEqual(mean(along, 3.7, 4.1), -FRICTION * mean(across, 3.7, 4.1), delta=0.01 * FRICTION * WEIGHT_N)
        self.assertEqual({row["static_contacts"] for row in rows[int(500 * 3.7):int(500 * 4.1)]}, {"0"})  # slides
        self.assertGreater(min(int(row["static_contacts"]) for row in rows[int(500 * 2.6):int(500 * 3.3)]), 0)

    def test_launch_file(self):
        plots = self.path("plots")
        code, output = harness.launch("incline.launch", "output:=" + plots, "rate:=2")
        self.assertEqual(code, 0, output)
        self.assertEqual(sorted(os.listdir(plots)), ["plate_force.png", "plate_friction.png"])


if __name__ == "__main__":
    harness.main(Incline)
