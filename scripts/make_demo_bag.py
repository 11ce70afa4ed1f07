#!/usr/bin/python3
"""Writes the demo's recording: the probe of urdf/probe.urdf presses into a block, drags over it and lifts.

The same bytes every time: stamps, positions and record times follow from the message number alone.
For config/press_drag.yaml: with all joints at 0 the ball (radius 5 mm) is centred 15 mm above the block's top face.
"""
import argparse
import os
import sys

import genpy
import rosbag
from sensor_msgs.msg import JointState

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from whole_file import whole_file

TOPIC = "/probe/joint_states"
RATE_HZ = 500
START_S = 1700000000  # a fixed wall-clock time, so that the recording does not depend on when it was made
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


def position(time):
    """x and z (m) at `time` (s) since the start, straight from corner to corner."""
    begin = 0.0
    for (_, x0, z0), (duration, x1, z1) in zip(PATH, PATH[1:]):
        if time <= begin + duration:
            part = (time - begin) / duration
            return x0 + part * (x1 - x0), z0 + part * (z1 - z0)
        begin += duration
    return PATH[-1][1], PATH[-1][2]


def messages():
    length = sum(duration for duration, _, _ in PATH)
    for i in range(int(round(length * RATE_HZ)) + 1):
        stamp = genpy.Time(START_S + i // RATE_HZ, i % RATE_HZ * (1000000000 // RATE_HZ))
        x, z = position(i / RATE_HZ)
        message = JointState(name=["x", "y", "z"], position=[x, 0.0, z])
        message.header.seq = i
        message.header.stamp = stamp
        yield stamp, message


def main():
    default = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "config", "press_drag.bag")
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("output", nargs="?", default=os.path.normpath(default), help="default: %(default)s")
    arguments = parser.parse_args()
    count = 0
    try:
        with whole_file(arguments.output) as part, rosbag.Bag(part, "w", compression=rosbag.Compression.BZ2) as bag:
            for stamp, message in messages():
                bag.write(TOPIC, message, stamp)
                count += 1
    except OSError as error:
        sys.exit("make_demo_bag.py: cannot write %s: %s" % (arguments.output, error.strerror))
    print("%s: %d joint states on %s" % (arguments.output, count, TOPIC))


if __name__ == "__main__":
    main()
