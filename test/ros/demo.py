#!/usr/bin/python3
"""The launch files without a display: they play, print a line per second, write plots and end by themselves."""
import glob
import os
import re
import shutil
import subprocess
import sys
import unittest

import rosbag
import rosgraph
import rospy
import rostest

import harness


class Demo(harness.TestCase):
    def launch(self, *arguments):
        """What scripts/demo ends with: roslaunch on a master of its own. Returns the exit code and all it printed."""
        environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
        command = [harness.program("run_launch.py")] + list(arguments)
        done = subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, universal_newlines=True, timeout=2 * harness.DEADLINE_S,
                              check=False)
        return done.returncode, done.stdout

    def assert_pictures(self, names):
        found = sorted(os.path.basename(path) for path in glob.glob(os.path.join(self.directory, "plots", "*")))
        self.assertEqual(found, names)
        for name in names:
            with open(os.path.join(self.directory, "plots", name), "rb") as stream:
                data = stream.read()
            self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n", name)
            self.assertGreater(len(data), 10000, name)

    @unittest.skipIf(harness.SLOWNESS > 1.0, "a slow build is still before the first contact when the demo's recording ends")
    def test_demo(self):
        plots = self.path("plots")
        code, output = self.launch("demo.launch", "output:=" + plots)
        self.assertEqual(code, 0, output)
        self.assertNotIn("has died", output)  # it ended well, so it must not read like a failure
        self.assert_pictures(["probe_force.png", "probe_friction.png"])
        self.assertIn("wrote " + plots, output)
        lines = re.findall(r"^t +([\d.]+) s  force probe ([\d.]+) N  contacts (\d+) static (\d+) kinetic  "
                           r"deepest displacement ([\d.]+) mm$", output, re.MULTILINE)
        self.assertGreaterEqual(len(lines), 2, output)
        self.assertGreater(max(float(force) for _, force, _, _, _ in lines), 0.05, output)
        self.assertGreater(max(float(depth) for _, _, _, _, depth in lines), 1.0, output)

    @unittest.skipIf(harness.SLOWNESS > 1.0, "a slow build is still before the first contact when the demo's recording ends")
    def test_bare_roslaunch_ends_well_too(self):
        plots = self.path("plots")
        done = subprocess.run(["roslaunch", "tissue_contact", "demo.launch", "rviz:=false", "output:=" + plots, "rate:=3"],
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True, timeout=2 * harness.DEADLINE_S, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertNotIn("has died", done.stdout)
        self.assert_pictures(["probe_force.png", "probe_friction.png"])

    def test_psm_launch_takes_any_bag_and_scene(self):
        bag = self.path("my press.bag")  # with blanks, as people name their files
        harness.write_bag(bag, harness.press(50))
        scene = shutil.copy(harness.SCENE, self.path("my scene.yaml"))
        plots = self.path("plots")
        code, output = self.launch("psm_bag.launch", "bag:=" + bag, "scene:=" + scene, "output:=" + plots)
        self.assertEqual(code, 0, output)
        self.assert_pictures(["probe_force.png", "probe_friction.png"])

    def scene_without_urdf(self):
        return self.changed_scene({"    urdf: package://tissue_contact/urdf/probe.urdf\n": ""}, name="no urdf.yaml")

    def test_model_goes_to_a_scene_that_names_none(self):
        bag = self.path("press.bag")
        harness.write_bag(bag, harness.press(20))
        code, output = self.launch("psm_bag.launch", "bag:=" + bag, "scene:=" + self.scene_without_urdf(),
                                   "model:=package://tissue_contact/urdf/probe.urdf",
                                   "output:=" + self.path("plots"))
        self.assertEqual(code, 0, output)
        self.assert_pictures(["probe_force.png", "probe_friction.png"])

    def test_model_that_cannot_be_used_is_said_without_a_trace(self):
        bag = self.path("press.bag")
        harness.write_bag(bag, harness.press(5))
        xacro = self.path("robot.urdf.xacro")
        with open(xacro, "w", encoding="utf-8") as stream:
            stream.write("<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:nonsense/></robot>")
        cases = [(harness.SCENE, "package://tissue_contact/urdf/probe.urdf", "without the key urdf of 'probe'"),
                 (self.scene_without_urdf(), xacro, "robot.urdf.xacro"),
                 (self.scene_without_urdf(), "none.urdf", "none.urdf does not exist")]
        for scene, model, words in cases:
            code, output = self.launch("play_bag.launch", "bag:=" + bag, "scene:=" + scene, "model:=" + model,
                                       "output:=" + self.path("plots"))
            self.assertEqual(code, 1, output)
            self.assertIn(words, output)
            self.assertIn("read_model.py: ", output)
            self.assertNotIn("Traceback", output)

    def test_bag_without_the_topic_ends_with_its_name(self):
        bag = self.path("other.bag")
        harness.write_bag(bag, harness.press(5), topic="/other/joint_states")
        code, output = self.launch("psm_bag.launch", "bag:=" + bag, "scene:=" + harness.SCENE,
                                   "output:=" + self.path("plots"))
        self.assertEqual(code, 1, output)
        self.assertIn("has no message on " + harness.TOPIC, output)
        self.assertIn("/other/joint_states", output)
        self.assert_pictures([])

    def test_node_that_does_not_start_is_a_failure_even_beside_older_plots(self):
        plots = self.path("plots")
        os.mkdir(plots)
        with open(os.path.join(plots, "probe_force.png"), "wb"):
            pass
        bag = self.path("press.bag")
        harness.write_bag(bag, harness.press(5))
        code, output = self.launch("psm_bag.launch", "bag:=" + bag, "scene:=no_such_scene.yaml", "output:=" + plots)
        self.assertEqual(code, 1, output)
        self.assertIn("no_such_scene.yaml", output)
        self.assertIn("REQUIRED process [tissue_contact-", output)
        code, output = self.launch("no_such.launch")
        self.assertEqual(code, 1, output)

    def test_the_master_of_others_is_left_alone(self):
        bag = self.path("press.bag")
        harness.write_bag(bag, harness.press(20))
        master = rosgraph.Master(rospy.get_name())
        before = (master.getParam("/run_id"), sorted(rospy.get_param_names()), master.getSystemState())
        code, output = self.launch("psm_bag.launch", "bag:=" + bag,
                                   "scene:=package://tissue_contact/test/ros/press.yaml",
                                   "output:=" + self.path("plots"))
        self.assertEqual(code, 0, output)
        self.assertEqual((master.getParam("/run_id"), sorted(rospy.get_param_names()), master.getSystemState()), before)

    def test_recording_is_what_its_script_makes(self):
        bags = [self.path(name) for name in ["first.bag", "second.bag"]]
        for bag in bags:
            subprocess.run([harness.program("make_demo_bag.py"), bag], check=True, stdout=subprocess.DEVNULL,
                           timeout=harness.DEADLINE_S)
        data = []
        for bag in bags:
            with open(bag, "rb") as stream:
                data.append(stream.read())
        self.assertEqual(data[0], data[1])
        contents = []
        for bag in [bags[0], os.path.join(harness.PACKAGE, "config", "press_drag.bag")]:
            with rosbag.Bag(bag) as opened:
                contents.append([(topic, message, time) for topic, message, time in opened.read_messages()])
        self.assertGreater(len(contents[0]), 1000)
        self.assertEqual(contents[0], contents[1])


if __name__ == "__main__":
    rospy.init_node("demo")
    rostest.rosrun("tissue_contact", "demo", Demo, sys.argv)
