#!/usr/bin/python3
"""Two instruments on two topics: played in the order of their stamps, whichever way they arrive; the bits of the replay."""
import os
import shutil
import sys
import tempfile
import unittest

import rosbag
import rospy
import rostest
from geometry_msgs.msg import WrenchStamped
from sensor_msgs.msg import JointState

import harness

SECOND_PROBE = """  - name: other
    urdf: package://tissue_contact/urdf/probe.urdf
    base_pose: {position_m: [0.02, 0, 0.026]}
    joint_state_topics: [/other/joint_states]
    tip_link: tip
    contact_links: [tip]

friction:
"""


class TwoTopics(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.directory)
        with open(harness.SCENE, encoding="utf-8") as stream:
            text = stream.read()
        self.scene = os.path.join(self.directory, "scene.yaml")
        with open(self.scene, "w", encoding="utf-8") as stream:
            # Both probes have the same link names, which tf cannot hold.
            stream.write(text.replace("friction:\n", SECOND_PROBE).replace("tf: true", "tf: false"))
        self.samples = harness.press(100)
        self.shift = rospy.Duration(0, 3000000)

    def test_arrival_order_does_not_matter(self):
        bag = os.path.join(self.directory, "two.bag")
        with rosbag.Bag(bag, "w") as out:
            for stamp, positions in self.samples:
                for topic, at in [(harness.TOPIC, stamp), ("/other/joint_states", stamp + self.shift)]:
                    message = JointState(name=["x", "y", "z"], position=list(positions))
                    message.header.stamp = at
                    out.write(topic, message, at)
        csv = os.path.join(self.directory, "out.csv")
        code, errors = harness.replay(self.scene, bag, csv)
        self.assertEqual(code, 0, errors)
        rows = harness.read_csv(csv)
        self.assertEqual(len(rows), 200)

        with harness.node(self.scene):
            listeners = {name: harness.Listener("/tissue_contact/%s/wrench" % name, WrenchStamped)
                         for name in ["probe", "other"]}
            first = harness.JointSource(harness.TOPIC)
            second = harness.JointSource("/other/joint_states")
            for begin in range(0, 100, 10):  # alternately one topic and the other 0.1 s ahead; max_gap_s is 0.2 s
                batch = self.samples[begin:begin + 10]
                sends = [lambda b=batch: first.send_all(b),
                         lambda b=batch: second.send_all([(stamp + self.shift, p) for stamp, p in b])]
                for send in sends if begin % 20 else reversed(sends):
                    send()
                # What both have delivered must be played before one of them may run ahead again.
                listeners["probe"].wait_for_stamp(batch[-1][0])
            # Only a later sample, or waiting in vain, ends the wait of the last one.
            first.send(self.samples[-1][0] + rospy.Duration(0.01), (0.0, 0.0, 0.0))
            got = {name: listener.wait(lambda all: len(all) >= 100, "100 wrenches")
                   for name, listener in listeners.items()}
        for name, wrenches in got.items():
            expected = [(stamp, bits) for stamp, instrument, bits in rows if instrument == name]
            self.assertEqual([(harness.stamp_text(w.header.stamp), harness.wrench_bits(w)) for w in wrenches[:100]],
                             expected, name)

    def test_tf_of_two_links_with_one_name_is_refused(self):
        with open(self.scene, encoding="utf-8") as stream:
            text = stream.read()
        with open(self.scene, "w", encoding="utf-8") as stream:
            stream.write(text.replace("tf: false", "tf: true"))
        with harness.node(self.scene) as node:
            harness.wait_until(lambda: node.poll() is not None, "the end of the node")
            self.assertEqual(node.returncode, 1)
            node.output.seek(0)
            self.assertIn("publish.tf", node.output.read())


if __name__ == "__main__":
    rospy.init_node("two_topics")
    rostest.rosrun("tissue_contact", "two_topics", TwoTopics, sys.argv)
