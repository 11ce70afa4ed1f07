#!/usr/bin/python3
"""Turns a table of joint positions into a recording: joint states at 500 Hz, smoothly from row to row.

The table is a CSV file. Its first line names the columns: time_s, then joints as the scene knows them (rad or m), or /TOPIC:JOINT where
there are several topics. Each further line says where the joints are at a time; times ascend. Between two lines a joint follows the
cubic that starts and ends at rest, so nothing jerks. Examples: config/grasp_path.csv, config/two_psm_path.csv.
The same bytes every time: stamps, positions and record times follow from the table alone.
"""
import argparse
import csv
import math
import os
import sys

import genpy
import rosbag
from sensor_msgs.msg import JointState

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from whole_file import whole_file

RATE_HZ = 500
START_S = 1700000000  # a fixed wall-clock time, so that the recording does not depend on when it was made


def fail(message):
    sys.exit("%s: %s" % (os.path.basename(sys.argv[0]), message))


def read_table(file):
    """(joint names, rows); a row is [time (s), position of each joint]."""
    try:
        with open(file, newline="", encoding="utf-8-sig") as stream:  # spreadsheets begin with a byte-order mark
            lines = [(number, [text.strip() for text in line]) for number, line in enumerate(csv.reader(stream), 1) if "".join(line).strip()]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        fail("%s cannot be read: %s" % (file, error))
    if len(lines) < 3 or lines[0][1][0] != "time_s" or len(lines[0][1]) < 2:
        fail("%s: the first line must name time_s and joints, with commas between them, and two rows or more must follow" % file)
    names = lines[0][1]
    rows = []
    for number, line in lines[1:]:
        try:
            row = [float(text) for text in line]
        except ValueError as error:
            fail("%s:%d: %s" % (file, number, error))
        if len(row) != len(names) or not all(math.isfinite(value) for value in row):
            fail("%s:%d: %d finite numbers are needed" % (file, number, len(names)))
        if rows and not row[0] > rows[-1][0]:
            fail("%s:%d: time_s is %g, not after %g of the row before" % (file, number, row[0], rows[-1][0]))
        rows.append(row)
    return names[1:], rows


def positions(rows, time):
    """Joint positions at `time` (s), held before the first row and after the last."""
    if time <= rows[0][0]:
        return rows[0][1:]
    for before, after in zip(rows, rows[1:]):
        if time <= after[0]:
            part = (time - before[0]) / (after[0] - before[0])
            part = part * part * (3.0 - 2.0 * part)
            return [a + part * (b - a) for a, b in zip(before[1:], after[1:])]
    return rows[-1][1:]


def topics_of(columns, topic):
    """{topic: [(place, joint name)]} of columns named JOINT, which are of `topic`, or /TOPIC:JOINT; a joint's own name may have a colon."""
    if topic and not topic.startswith("/"):
        fail("--topic %s must begin with /, as scenes name topics" % topic)
    topics = {}
    for place, column in enumerate(columns):
        of, _, joint = column.partition(":") if column.startswith("/") else ("", "", column)
        if not (of or topic) or not joint:
            fail("column '%s' names no %s: write /TOPIC:JOINT, or give --topic" % (column, "joint" if of else "topic"))
        topics.setdefault(of or topic, []).append((place, joint))
    return topics


def write(output, topics, positions_at, length, inputs=()):
    """Joint states on {topic: [(place, joint name)]} from 0 to `length` (s), with positions from the places of what `positions_at` gives
    for a time. Says how many."""
    count = int(round(length * RATE_HZ)) + 1
    try:
        with whole_file(output, inputs) as part, rosbag.Bag(part, "w", compression=rosbag.Compression.BZ2) as bag:
            for i in range(count):
                at = positions_at(i / RATE_HZ)
                for topic, joints in topics.items():
                    message = JointState(name=[joint for _, joint in joints], position=[at[place] for place, _ in joints])
                    message.header.seq = i
                    message.header.stamp = genpy.Time(START_S + i // RATE_HZ, i % RATE_HZ * (1000000000 // RATE_HZ))
                    bag.write(topic, message, message.header.stamp)
    except OSError as error:
        fail("cannot write %s: %s" % (output, error.strerror))
    print("%s: %d joint states on %s" % (output, count, ", ".join(topics)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("table", help="CSV file: time_s and joint positions")
    parser.add_argument("output", help="bag to write")
    parser.add_argument("--topic", help="joint-state topic of the scene, such as /PSM1/joint_states, of columns that name none")
    arguments = parser.parse_args()
    names, rows = read_table(arguments.table)
    write(arguments.output, topics_of(names, arguments.topic), lambda time: positions(rows, rows[0][0] + time),
          rows[-1][0] - rows[0][0], [arguments.table])


if __name__ == "__main__":
    main()
