#!/usr/bin/python3
"""One stamp of a recording lies 280 ns before the one before it: it is refused as late, and nothing else changes.

On the demo, through the node and offline; on a real dVRK recording offline, skipped where that is absent
(TISSUE_CONTACT_SHARED_DATA, default ../shared/data beside the package).
"""
import os
import struct
import unittest

import rosbag
import rospy

import harness

DEMO = os.path.join(harness.PACKAGE, "config", "press_drag")
DATA = os.environ.get("TISSUE_CONTACT_SHARED_DATA") or os.path.join(harness.PACKAGE, "..", "shared", "data")
REAL_BAG = os.path.join(DATA, "dvrk", "psm2_classic_motion.bag")
REAL_SCENE = os.path.join(harness.PACKAGE, "config", "psm_dvrk.yaml")
BACK = rospy.Duration(0, 280)


def copy(source, target, topic, disturbed, change, begin=0, end=None):
    """Messages [begin, end) of `topic`; number `disturbed` goes through change(message, stamp of the one before)."""
    with rosbag.Bag(source) as bag, rosbag.Bag(target, "w") as out:
        before = None
        for i, (_, message, recorded) in enumerate(bag.read_messages([topic])):
            if i < begin or (end is not None and i >= end):
                continue
            stamp = message.header.stamp
            if i == disturbed:
                message = change(message, before)
            before = stamp
            if message is not None:
                out.write(topic, message, recorded)


def set_back(message, before):
    message.header.stamp = before - BACK
    return message


def leave_out(_message, _before):
    return None


def force(bits):
    return sum(value * value for value in struct.unpack("<6d", bits)[:3]) ** 0.5


class Jitter(harness.TestCase):
    def make(self, source, topic, disturbed, **part):
        bags = [self.path(name + ".bag") for name in ["jittered", "without"]]
        for bag, change in zip(bags, [set_back, leave_out]):
            copy(source, bag, topic, disturbed, change, **part)
        return bags

    def check(self, scene, bags, disturbed, least_force_n):
        said, _ = [self.replayed(scene, bag, bag + ".csv") for bag in bags]
        got, expected = [harness.read_csv(bag + ".csv") for bag in bags]
        self.assertGreater(force(expected[disturbed][2]), least_force_n)  # in mid-contact
        self.assertIn("1 too late", said)
        self.assertIn("0 resets", said)
        self.assertEqual(got, expected)
        return got

    def test_demo_through_node_and_offline(self):
        disturbed = 900
        topic = "/probe/joint_states"
        bags = self.make(DEMO + ".bag", topic, disturbed)
        rows = self.check(DEMO + ".yaml", bags, disturbed, 0.1)
        played = harness.play_through_node(DEMO + ".yaml", bags[0], topic, "probe", len(rows), 2)
        self.assertEqual(played, [(stamp, bits) for stamp, _, bits in rows])

    @unittest.skipUnless(os.path.exists(REAL_BAG), "no recording at " + REAL_BAG)
    def test_real_recording(self):
        begin, disturbed = 1400, 2209  # from before a dip to its deepest
        bags = self.make(REAL_BAG, "/PSM2/measured_js", disturbed, begin=begin, end=2330)
        self.check(REAL_SCENE, bags, disturbed - begin, 0.5)


if __name__ == "__main__":
    harness.main(Jitter)
