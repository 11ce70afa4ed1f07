#!/usr/bin/python3
"""Turns a table of joint positions into a recording: joint states at 500 Hz, from row to row.

The table is a CSV file. Its first line names the columns: time_s, then joints as the scene knows them (rad or m), or /TOPIC:JOINT where
there are several topics. Each further line says where the joints are at a time; times ascend. Examples: config/grasp_path.csv,
config/two_psm_path.csv.

--smooth is for corners of a motion that somebody thought out: between two lines a joint follows the cubic that starts and ends at rest, so
nothing jerks, and the joint states have its velocities, too. --linear is for positions that were recorded or sampled: straight between them, at the speed that they have; to rest at
each of them would go and stop tens of times a second (drags 20 times a second: forces off by up to 42 %). Without either, lines that
are less than 0.1 s apart (the median) count as sampled, since nobody stops ten times a second and such a mistake is seen nowhere.
The same bytes every time: stamps, positions and record times follow from the table alone.
"""
import argparse
import bisect
import csv
import math
import os
import statistics
import sys

import genpy
import rosbag
from sensor_msgs.msg import JointState

sys.path.insert(0, os.path.dirname(os.path.realpath(__file__)))  # rosrun starts us through a relay elsewhere
from whole_file import whole_file

RATE_HZ = 500
START_S = 1700000000  # a fixed wall-clock time, so that the recording does not depend on when it was made
SAMPLED_S = 0.1  # rows closer than this are samples of a motion, not its corners


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


def is_sampled(rows):
    """Whether rows are samples of a motion, not corners of it, as far as can be told."""
    return statistics.median(after[0] - before[0] for before, after in zip(rows, rows[1:])) < SAMPLED_S


def unwrapped(rows):
    """Without turns of 2 pi from one sample to the next, as joints that go on turning are recorded between -pi and pi: said, since the way between
    is another."""
    turns, result = [0] * (len(rows[0]) - 1), [rows[0]]
    for before, after in zip(rows, rows[1:]):
        turns = [turn - round((b - a) / (2.0 * math.pi)) for turn, a, b in zip(turns, before[1:], after[1:])]
        result.append([after[0]] + [b + 2.0 * math.pi * turn for b, turn in zip(after[1:], turns)])
    if result != rows:
        print("joints that jump by a turn from row to row go on turning there")
    return result


def path(rows, linear):
    """(joint positions, their velocities) by time (s), held before the first row and after the last; in between at rest at each row, or straight: without
    velocities, which jump at rows."""
    times = [row[0] for row in rows]

    def states(time):
        after = bisect.bisect_left(times, time)
        if after == 0 or after == len(rows):
            return rows[min(after, len(rows) - 1)][1:], [] if linear else [0.0] * (len(rows[0]) - 1)
        duration = times[after] - times[after - 1]
        part, speed = (time - times[after - 1]) / duration, 0.0
        if not linear:
            part, speed = part * part * (3.0 - 2.0 * part), 6.0 * part * (1.0 - part) / duration
        ways = [(a, b - a) for a, b in zip(rows[after - 1][1:], rows[after][1:])]
        return [a + part * way for a, way in ways], [] if linear else [speed * way for _, way in ways]
    return states


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


def write(output, topics, states_at, length, inputs=()):
    """Joint states on {topic: [(place, joint name)]} from 0 to `length` (s), with those of the places in what `states_at` gives for a time:
    (positions, velocities or nothing). Says how many."""
    count = int(round(length * RATE_HZ)) + 1
    try:
        with whole_file(output, inputs) as part, rosbag.Bag(part, "w", compression=rosbag.Compression.BZ2) as bag:
            for i in range(count):
                at, velocities = states_at(i / RATE_HZ)
                for topic, joints in topics.items():
                    message = JointState(name=[joint for _, joint in joints], position=[at[place] for place, _ in joints],
                                         velocity=[velocities[place] for place, _ in joints] if velocities else [])
                    message.header.seq = i
                    message.header.stamp = genpy.Time(START_S + i // RATE_HZ, i % RATE_HZ * (1000000000 // RATE_HZ))
                    bag.write(topic, message, message.header.stamp)
    except OSError as error:
        fail("cannot write %s: %s" % (output, error.strerror))
    print("%s: %d joint states on %s" % (output, count, ", ".join(topics)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0], epilog="Without --linear and --smooth: straight where rows are less "
                                     "than %g s apart (the median), which is said; else smooth." % SAMPLED_S)
    parser.add_argument("table", help="CSV file: time_s and joint positions")
    parser.add_argument("output", help="bag to write")
    parser.add_argument("--topic", help="joint-state topic of the scene, such as /PSM1/joint_states, of columns that name none")
    between = parser.add_mutually_exclusive_group()
    between.add_argument("--linear", action="store_true", help="straight from row to row: for positions that were recorded or sampled")
    between.add_argument("--smooth", action="store_true", help="at rest at each row: for the corners of a motion")
    arguments = parser.parse_args()
    names, rows = read_table(arguments.table)
    linear = arguments.linear or (not arguments.smooth and is_sampled(rows))
    if is_sampled(rows):
        rows = unwrapped(rows)
    states = path(rows, linear)
    write(arguments.output, topics_of(names, arguments.topic), lambda time: states(rows[0][0] + time),
          rows[-1][0] - rows[0][0], [arguments.table])
    if linear and not arguments.linear:
        print("straight from row to row, since they are less than %g s apart (the median); --smooth rests at each" % SAMPLED_S)


if __name__ == "__main__":
    main()
