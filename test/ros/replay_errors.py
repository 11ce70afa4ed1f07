#!/usr/bin/python3
"""Offline replay: what it refuses, what it says, and that it never leaves half a result behind."""
import filecmp
import os

import rosbag
import rospy

import harness


class ReplayErrors(harness.TestCase):
    def setUp(self):
        super().setUp()
        self.csv = self.path("out.csv")
        self.samples = harness.press(20)
        self.bag = self.bag_of("press.bag", self.samples)

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
        errors = self.replayed(harness.SCENE, self.bag, self.csv)
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
        os.truncate(self.bag, os.path.getsize(self.bag) // 2)
        self.assert_refused(harness.SCENE, self.bag, self.bag, "it is cut off; not one chunk of it is whole")

    def test_impossible_stamp_is_counted(self):
        all_bits_set = rospy.Time(0)
        all_bits_set.secs = all_bits_set.nsecs = 0xFFFFFFFF
        self.samples[10] = (all_bits_set, self.samples[10][1])
        harness.write_messages(self.bag, [(harness.TOPIC, harness.joint_state(*sample), rospy.Time(harness.START_S + i))
                                          for i, sample in enumerate(self.samples)])
        errors = self.replayed(harness.SCENE, self.bag, self.csv)
        self.assertIn("19 joint states accepted, 1 bad stamp", errors)
        self.assertIn("stamp out of range", errors)
        self.assertEqual(len(harness.read_csv(self.csv)), 19)

    def test_bag_without_the_topic_names_those_it_has(self):
        bag = self.bag_of("other.bag", self.samples, topic="/other/joint_states")
        self.assert_refused(harness.SCENE, bag, harness.TOPIC, "/other/joint_states")

    def test_nothing_acceptable(self):
        bag = self.bag_of("nan.bag", [(stamp, (0.0, float("nan"), 0.0)) for stamp, _ in self.samples])
        self.assert_refused(harness.SCENE, bag, "no joint state", "'y' is nan")

    def test_refused_joint_states_are_counted(self):
        bag = self.bag_of("some.bag", self.samples + [(self.samples[-1][0], (0.0, 0.0, 0.0))])
        errors = self.replayed(harness.SCENE, bag, self.csv)
        self.assertIn("20 joint states accepted, 1 duplicate stamp", errors)

    def test_urdf_from_a_parameter_needs_its_text(self):
        scene = self.changed_scene({"urdf: package://tissue_contact/urdf/probe.urdf": "robot_description: robot_description"})
        self.assert_refused(scene, self.bag, "robot_description", "--urdf")
        code, errors = harness.replay(scene, self.bag, self.csv, "--urdf", self.path("none.urdf"))
        self.assertEqual(code, 1)
        self.assertIn("none.urdf", errors)
        urdf = os.path.join(harness.PACKAGE, "urdf", "probe.urdf")
        self.replayed(scene, self.bag, self.csv, "--urdf", urdf)
        self.replayed(scene, self.bag, self.path("same.csv"), "--urdf", "package://tissue_contact/urdf/probe.urdf")
        self.assertTrue(filecmp.cmp(self.csv, self.path("same.csv"), shallow=False))
        for unused in [urdf, self.path("none.urdf")]:
            code, errors = harness.replay(harness.SCENE, self.bag, self.path("unused.csv"), "--urdf", unused)
            self.assertEqual(code, 1)
            self.assertIn("--urdf would change nothing: no instrument of scene '%s'" % harness.SCENE, errors)
            self.assertFalse(os.path.exists(self.path("unused.csv")))
        self.replayed(harness.SCENE, self.bag, self.path("direct.csv"))
        self.assertEqual(harness.read_csv(self.csv), harness.read_csv(self.path("direct.csv")))

    def test_frames_come_from_the_bag(self):
        scene = self.changed_scene({"position_m: [0, 0, 0.026]": "tf_frame: stage"})
        self.assert_refused(scene, self.bag, "stage", "world")
        self.replayed(harness.SCENE, self.bag, self.path("direct.csv"))
        for topic in ["/tf_static", "/tf"]:
            bag = self.bag_of("tf.bag", self.samples)
            with rosbag.Bag(bag, "a") as out:
                out.write(topic, harness.stage_at(0.026), self.samples[5][0])
            self.replayed(scene, bag, self.csv)
            self.assertEqual(harness.read_csv(self.csv), harness.read_csv(self.path("direct.csv")), topic)
        with rosbag.Bag(bag, "a") as out:
            out.write("/tf", harness.stage_at(0.028), self.samples[9][0])
        self.assertIn("tf frame 'stage' has moved by 2 mm", self.replayed(scene, bag, self.csv))
        self.assertEqual(harness.read_csv(self.csv), harness.read_csv(self.path("direct.csv")))


if __name__ == "__main__":
    harness.main(ReplayErrors)
