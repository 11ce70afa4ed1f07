#!/usr/bin/python3
"""Writes the demo's recording: the probe of urdf/probe.urdf presses into a block, drags over it and lifts.

The same bytes every time: stamps, positions and record times follow from the message number alone.
For config/press_drag.yaml: with all joints at 0 the ball (radius 5 mm) is centred 15 mm above the block's top face.
"""
import argparse
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from make_joint_bag import write

TOPIC = "/probe/joint_states"
SPEED_M_PER_S = 0.020
CLEARANCE_M = 0.010  # between ball and block at the start
PRESS_M = 0.0045
DRAG_M = 0.020
HOLD_S = 0.25

# Corners of the path: duration (s) to get there, then x and z (m).
PATH = [
    (0.0, 0.0, 0.0),
    (HOLD_S, 0.0, 0.0),
    ((CLEARANCE_M + PRESS_M) / SPEED_M_PER_S, 0.0, -(CLEARANCE_M + PRESS_M)),
    (HOLD_S, 0.0, -(CLEARANCE_M + PRESS_M)),
    (DRAG_M / SPEED_M_PER_S, DRAG_M, -(CLEARANCE_M + PRESS_M)),
    (HOLD_S, DRAG_M, -(CLEARANCE_M + PRESS_M)),
    ((CLEARANCE_M + PRESS_M) / SPEED_M_PER_S, DRAG_M, 0.0),
    (HOLD_S, DRAG_M, 0.0),
]


def positions(time):
    """x, y and z (m) at `time` (s) since the start, straight from corner to corner."""
    begin = 0.0
    for (_, x0, z0), (duration, x1, z1) in zip(PATH, PATH[1:]):
        if time <= begin + duration:
            part = (time - begin) / duration
            return [x0 + part * (x1 - x0), 0.0, z0 + part * (z1 - z0)]
        begin += duration
    return [PATH[-1][1], 0.0, PATH[-1][2]]


def main():
    default = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "config", "press_drag.bag")
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("output", nargs="?", default=os.path.normpath(default), help="default: %(default)s")
    arguments = parser.parse_args()
    write(arguments.output, {TOPIC: list(enumerate("xyz"))}, lambda time: (positions(time), []), sum(duration for duration, _, _ in PATH))


if __name__ == "__main__":
    main()
