#!/usr/bin/python3
"""Offline replay: what it refuses, what it says, and that it never leaves half a result behind."""
import os
import struct
import sys

import rosbag
import rospy
import rostest
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

import harness


class ReplayErrors(harness.TestCase):
    def setUp(self):
        super().setUp()
        self.bag = self.path("press.bag")
        self.csv = self.path("out.csv")
        self.samples = harness.press(20)
        harness.write_bag(self.bag, self.samples)

    def scene_with(self, old, new):
        return self.changed_scene({old: new})

    def assert_refused(self, scene, bag, *words, csv=None):
        self.write("out.csv", "what was there before")
        code, errors = harness.replay(scene, bag, csv or self.csv)
        self.assertEqual(code, 1, errors)
        for word in words:
            self.assertIn(word, errors)
        with open(self.csv, encoding="utf-8") as stream:
            self.assertEqual(stream.read(), "what was there before")
        self.assertEqual([name for name in os.listdir(self.directory) if ".part" in name], [])
        return errors

    def test_good_run_replaces_the_result(self):
        self.write("out.csv", "what was there before")
        code, errors = harness.replay(harness.SCENE, self.bag, self.csv)
        self.assertEqual(code, 0, errors)
        self.assertIn("20 joint states accepted", errors)
        self.assertEqual(len(harness.read_csv(self.csv)), 20)
        self.assertEqual(sorted(os.listdir(self.directory)), ["out.csv", "press.bag"])

    def test_missing_files(self):
        self.assert_refused(self.path("none.yaml"), self.bag, "none.yaml")
        errors = self.assert_refused(harness.SCENE, self.path("none.bag"), "none.bag", "does not exist")
        self.assertNotIn("reindex", errors)
        self.assert_refused(harness.SCENE, self.bag, "no_such_folder", csv=self.path("no_such_folder/out.csv"))

    def test_no_bag_and_half_a_bag(self):
        self.assert_refused(harness.SCENE, self.write("text.bag", "not a bag"), "text.bag")
        self.assert_refused(harness.SCENE, self.write("empty.bag", ""), "empty.bag")
        with open(self.bag, "rb") as stream:
            whole = stream.read()
        for size, advice in [(3000, "copy it again"), (len(whole) // 2, "reindex"), (len(whole) - 1, "reindex")]:
            with open(self.path("half.bag"), "wb") as stream:
                stream.write(whole[:size])
            self.assert_refused(harness.SCENE, self.path("half.bag"), "half.bag", advice)

    def test_pipes_and_devices_are_not_waited_for(self):
        os.mkfifo(self.path("pipe.bag"))
        self.assert_refused(harness.SCENE, self.path("pipe.bag"), "pipe.bag", "not a regular file")
        self.assert_refused(harness.SCENE, "/dev/zero", "/dev/zero", "not a regular file")

    def spoilt(self, message, offset, value):
        """A bag of 20 joint states, one of which has other bytes at an offset of its data."""
        plain = self.path("plain.bag")
        with rosbag.Bag(plain, "w", compression=rosbag.Compression.NONE) as out:
            for stamp, positions in self.samples:
                state = JointState(name=["x", "y", "z"], position=positions)
                state.header.stamp = stamp
                out.write(harness.TOPIC, state, stamp)
        with open(plain, "rb") as stream:
            whole = bytearray(stream.read())
        stamp = self.samples[message][0]
        # Behind sequence number, seconds and nanoseconds.
        data = whole.index(struct.pack("<III", 0, stamp.secs, stamp.nsecs))
        whole[data + offset:data + offset + len(value)] = value
        with open(self.path("spoilt.bag"), "wb") as stream:
            stream.write(whole)
        return self.path("spoilt.bag")

    def test_length_without_bytes(self):
        bag = self.spoilt(10, 16, struct.pack("<I", 2**28))
        self.assert_refused(harness.SCENE, bag, "spoilt.bag", harness.TOPIC, str(2**28))

    def test_impossible_stamp_is_counted(self):
        bag = self.spoilt(10, 4, b"\xff" * 8)
        code, errors = harness.replay(harness.SCENE, bag, self.csv)
        self.assertEqual(code, 0, errors)
        self.assertIn("19 joint states accepted, 1 bad stamp", errors)
        self.assertEqual(len(harness.read_csv(self.csv)), 19)

    def test_bag_without_the_topic_names_those_it_has(self):
        bag = self.path("other.bag")
        harness.write_bag(bag, self.samples, topic="/other/joint_states")
        self.assert_refused(harness.SCENE, bag, harness.TOPIC, "/other/joint_states")

    def test_wrong_message_type(self):
        bag = self.path("typed.bag")
        with rosbag.Bag(bag, "w") as out:
            out.write(harness.TOPIC, String("x"), rospy.Time(1))
        self.assert_refused(harness.SCENE, bag, "std_msgs/String", "sensor_msgs/JointState")

    def test_nothing_acceptable(self):
        bag = self.path("nan.bag")
        harness.write_bag(bag, [(stamp, (0.0, float("nan"), 0.0)) for stamp, _ in self.samples])
        self.assert_refused(harness.SCENE, bag, "no joint state", "'y' is nan")

    def test_refused_joint_states_are_counted(self):
        bag = self.path("some.bag")
        harness.write_bag(bag, self.samples + [(self.samples[-1][0], (0.0, 0.0, 0.0))])
        code, errors = harness.replay(harness.SCENE, bag, self.csv)
        self.assertEqual(code, 0, errors)
        self.assertIn("20 joint states accepted, 1 duplicate stamp", errors)

    def test_urdf_from_a_parameter_needs_its_text(self):
        scene = self.scene_with("urdf: package://tissue_contact/urdf/probe.urdf",
                                "robot_description: robot_description")
        self.assert_refused(scene, self.bag, "robot_description", "--urdf")
        code, errors = harness.replay(scene, self.bag, self.csv, "--urdf", self.path("none.urdf"))
        self.assertEqual(code, 1)
        self.assertIn("none.urdf", errors)
        urdf = os.path.join(harness.PACKAGE, "urdf", "probe.urdf")
        code, errors = harness.replay(scene, self.bag, self.csv, "--urdf", urdf)
        self.assertEqual(code, 0, errors)
        code, errors = harness.replay(harness.SCENE, self.bag, self.path("direct.csv"))
        self.assertEqual(code, 0, errors)
        self.assertEqual(harness.read_csv(self.csv), harness.read_csv(self.path("direct.csv")))

    def test_frames_come_from_the_bag(self):
        scene = self.scene_with("position_m: [0, 0, 0.026]", "tf_frame: stage")
        self.assert_refused(scene, self.bag, "stage", "world")
        transform = TransformStamped()
        transform.header.frame_id = "world"
        transform.child_frame_id = "stage"
        transform.transform.translation.z = 0.026
        transform.transform.rotation.w = 1.0
        code, errors = harness.replay(harness.SCENE, self.bag, self.path("direct.csv"))
        self.assertEqual(code, 0, errors)
        for topic in ["/tf_static", "/tf"]:
            bag = self.path("tf.bag")
            harness.write_bag(bag, self.samples)
            with rosbag.Bag(bag, "a") as out:
                out.write(topic, TFMessage([transform]), self.samples[5][0])
            code, errors = harness.replay(scene, bag, self.csv)
            self.assertEqual(code, 0, errors)
            self.assertEqual(harness.read_csv(self.csv), harness.read_csv(self.path("direct.csv")), topic)


if __name__ == "__main__":
    rospy.init_node("replay_errors")
    rostest.rosrun("tissue_contact", "replay_errors", ReplayErrors, sys.argv)
