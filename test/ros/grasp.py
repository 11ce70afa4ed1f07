#!/usr/bin/python3
"""The grasp's recording: one finite wrench per joint state, the same bits from the replay twice and from the node; its
launch file draws plots."""
import math
import os
import struct

import roslaunch.substitution_args

import harness

SCENE = os.path.join(harness.PACKAGE, "config", "grasp.yaml")
BAG = roslaunch.substitution_args.resolve_args("$(find tissue_contact)/config/grasp.bag")
JOINT_STATES = 4001  # 8 s at 500 Hz


class Grasp(harness.TestCase):
    def test_same_bits_from_replay_and_node(self):
        digests = []
        for run in ["first", "second"]:
            csv = self.path(run + ".csv")
            self.replayed(SCENE, BAG, csv)
            rows = harness.read_csv(csv)
            self.assertEqual(len(rows), JOINT_STATES)
            wrenches = [struct.unpack("<6d", bits) for _, _, bits in rows]
            self.assertTrue(all(math.isfinite(value) for wrench in wrenches for value in wrench))
            self.assertGreater(max(wrench[2] for wrench in wrenches), 0.05)  # N; the tip's z axis points down
            self.assertEqual(set(wrenches[-1]), {0.0})  # open again
            digests.append(harness.digest((stamp, bits) for stamp, _, bits in rows))
        wrenches = harness.play_through_node(SCENE, BAG, "/PSM1/joint_states", "psm",
                                             JOINT_STATES, 2)
        self.assertEqual(len(wrenches), JOINT_STATES)
        digests.append(harness.digest(wrenches))
        self.assertEqual(len(set(digests)), 1, digests)

    def test_launch_file(self):
        plots = self.path("plots")
        code, output = harness.launch("grasp.launch", "output:=" + plots, "rate:=2")
        self.assertEqual(code, 0, output)
        self.assertEqual(sorted(os.listdir(plots)), ["psm_force.png", "psm_friction.png"])

    def test_table_that_makes_no_recording(self):
        for text, complaint in [("time_s,jaw\n0,0\n0,1\n", "path.csv:3: time_s is 0, not after 0"),
                                ("time_s,jaw\n0,0\n1,nan\n", "path.csv:3: 2 finite numbers are needed"),
                                ("time_s,jaw\n0,0\n1\n", "path.csv:3: 2 finite numbers are needed"),
                                ("jaw\n0\n1\n", "the first line must name time_s and joints")]:
            bag = self.path("path.bag")
            code, output = harness.run([harness.program("make_joint_bag.py"), self.write("path.csv", text), bag, "--topic",
                                        "/joints"])
            self.assertEqual(code, 1)
            self.assertIn(complaint, output)
            self.assertFalse(os.path.exists(bag))


if __name__ == "__main__":
    harness.main(Grasp)
