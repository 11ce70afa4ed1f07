#!/usr/bin/python3
"""The grasp's recording: one finite wrench per joint state, the same bits from the replay twice and from the node; its
launch file draws plots."""
import glob
import math
import os
import struct
import subprocess
import sys

import roslaunch.substitution_args
import rospy
import rostest

import harness

SCENE = os.path.join(harness.PACKAGE, "config", "grasp.yaml")
BAG = roslaunch.substitution_args.resolve_args("$(find tissue_contact)/config/grasp.bag")
JOINT_STATES = 4001  # 8 s at 500 Hz


class Grasp(harness.TestCase):
    def test_same_bits_from_replay_and_node(self):
        digests = []
        for run in ["first", "second"]:
            csv = self.path(run + ".csv")
            code, errors = harness.replay(SCENE, BAG, csv)
            self.assertEqual(code, 0, errors)
            rows = harness.read_csv(csv)
            self.assertEqual(len(rows), JOINT_STATES)
            wrenches = [struct.unpack("<6d", bits) for _, _, bits in rows]
            self.assertTrue(all(math.isfinite(value) for wrench in wrenches for value in wrench))
            self.assertGreater(max(wrench[2] for wrench in wrenches), 0.05)  # N; the tip's z axis points down
            self.assertEqual(set(wrenches[-1]), {0.0})  # open again
            digests.append(harness.digest((stamp, bits) for stamp, _, bits in rows))
        wrenches = harness.play_through_node(SCENE, BAG, "/PSM1/joint_states", "/tissue_contact/psm/wrench",
                                             JOINT_STATES, 2)
        self.assertEqual(len(wrenches), JOINT_STATES)
        digests.append(harness.digest(wrenches))
        self.assertEqual(len(set(digests)), 1, digests)

    def test_launch_file(self):
        environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
        plots = self.path("plots")
        done = subprocess.run([harness.program("run_launch.py"), "grasp.launch", "output:=" + plots, "rate:=2"],
                              env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=2 * harness.DEADLINE_S,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stdout)
        found = sorted(os.path.basename(path) for path in glob.glob(os.path.join(plots, "*")))
        self.assertEqual(found, ["psm_force.png", "psm_friction.png"])

    def test_table_that_makes_no_recording(self):
        table = self.path("path.csv")
        for text, complaint in [("time_s,jaw\n0,0\n0,1\n", "path.csv:3: time_s is 0, not after 0"),
                                ("time_s,jaw\n0,0\n1,nan\n", "path.csv:3: 2 finite numbers are needed"),
                                ("time_s,jaw\n0,0\n1\n", "path.csv:3: 2 finite numbers are needed"),
                                ("jaw\n0\n1\n", "the first line must name time_s and joints")]:
            with open(table, "w", encoding="ascii") as stream:
                stream.write(text)
            bag = self.path("path.bag")
            done = subprocess.run([harness.program("make_joint_bag.py"), table, bag, "--topic", "/joints"],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                                  timeout=harness.DEADLINE_S, check=False)
            self.assertEqual(done.returncode, 1)
            self.assertIn(complaint, done.stderr)
            self.assertFalse(os.path.exists(bag))


if __name__ == "__main__":
    rospy.init_node("grasp")
    rostest.rosrun("tissue_contact", "grasp", Grasp, sys.argv)
