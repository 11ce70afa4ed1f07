#!/usr/bin/python3
"""Writes the study whose costs doc/sweep.md tells: a press and drag of one second at 100 Hz over a block of 75 nodes, by stiffness and friction.

usage, after `source scripts/env.bash`: benchmark/drivers/sweep_study.py FOLDER [VALUES]      VALUES of each, 100: 10 000 variants
    scripts/sweep FOLDER/study.yaml
    time for i in $(seq 100); do rosrun tissue_contact tissue_contact_replay --scene FOLDER/press.yaml --bag FOLDER/press.bag \\
        --csv FOLDER/bare.csv --set tissues.block.material.youngs_modulus_pa=$((1000*i)) 2>FOLDER/log; done
"""
import os
import sys

import genpy
import rosbag
from sensor_msgs.msg import JointState

SCENE = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..", "test", "ros", "press.yaml")
STUDY = """bags: [press.bag]
scenes: [press.yaml]
grid:
  tissues.block.material.youngs_modulus_pa: {from: 1e3, to: 1e5, count: %d, spacing: log}
  friction.0.static: {from: 0.4, to: 1.39, count: %d}
"""


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    folder, values = sys.argv[1], int(sys.argv[2]) if len(sys.argv) == 3 else 100
    os.makedirs(folder, exist_ok=True)
    with open(SCENE, encoding="utf-8") as stream:
        scene = stream.read()
    for fine, coarse in (("cells: [6, 6, 2]", "cells: [4, 4, 2]"), ("max_step_s: 0.002", "max_step_s: 0.01")):
        if fine not in scene:
            sys.exit("%s has no '%s' any more" % (SCENE, fine))
        scene = scene.replace(fine, coarse)
    with open(os.path.join(folder, "press.yaml"), "w", encoding="utf-8") as stream:
        stream.write(scene)
    with open(os.path.join(folder, "study.yaml"), "w", encoding="utf-8") as stream:
        stream.write(STUDY % (values, values))
    with rosbag.Bag(os.path.join(folder, "press.bag"), "w") as bag:
        for i in range(101):
            state = JointState(name=["x", "y", "z"], position=[-0.006 + 1.5e-4 * max(i - 20, 0), 0.0, -1.25e-4 * min(i, 20)])
            state.header.stamp = genpy.Time(1700000000, 0) + genpy.Duration.from_sec(0.01 * i)
            bag.write("/probe/joint_states", state, state.header.stamp)


if __name__ == "__main__":
    main()
