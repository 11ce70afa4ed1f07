#!/usr/bin/python3
"""The launch files without a display: they play, print a line per second, write plots and end by themselves."""
import filecmp
import os
import re
import shutil
import signal
import subprocess
import time
import unittest

import rosbag
import rosgraph
import rospy

import harness
from tissue_contact_testing import free_port


class Demo(harness.TestCase):
    def setUp(self):
        super().setUp()
        self.plots = self.path("plots")

    def assert_pictures(self, names=("probe_force.png", "probe_friction.png")):
        found = sorted(os.listdir(self.plots)) if os.path.exists(self.plots) else []
        self.assertEqual(found, list(names))
        for name in names:
            with open(os.path.join(self.plots, name), "rb") as stream:
                data = stream.read()
            self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n", name)
            self.assertGreater(len(data), 10000, name)

    @unittest.skipIf(harness.SLOWNESS > 1.0, "a slow build is still before the first contact when the demo's recording ends")
    def test_demo(self):
        code, output = harness.launch("demo.launch", "output:=" + self.plots)
        self.assertEqual(code, 0, output)
        self.assertNotIn("has died", output)  # it ended well, so it must not read like a failure
        self.assert_pictures()
        self.assertIn("wrote " + self.plots, output)
        lines = re.findall(r"^t +([\d.]+) s  force probe ([\d.]+) N  contacts (\d+) static (\d+) kinetic  "
                           r"deepest displacement ([\d.]+) mm$", output, re.MULTILINE)
        self.assertGreaterEqual(len(lines), 2, output)
        self.assertGreater(max(float(force) for _, force, _, _, _ in lines), 0.05, output)
        self.assertGreater(max(float(depth) for _, _, _, _, depth in lines), 1.0, output)

    @unittest.skipIf(harness.SLOWNESS > 1.0, "a slow build is still before the first contact when the demo's recording ends")
    def test_bare_roslaunch_ends_well_too(self):
        code, output = harness.run(["roslaunch", "tissue_contact", "demo.launch", "rviz:=false", "output:=" + self.plots,
                                    "rate:=3"])
        self.assertEqual(code, 0, output)
        self.assertNotIn("has died", output)
        self.assert_pictures()

    def test_scene_launch_takes_any_bag_and_scene(self):
        bag = self.bag_of("my press.bag", harness.press(50))  # with blanks, as people name their files
        scene = shutil.copy(harness.SCENE, self.path("my scene.yaml"))
        code, output = harness.launch("scene.launch", "bag:=" + bag, "scene:=" + scene, "output:=" + self.plots)
        self.assertEqual(code, 0, output)
        self.assert_pictures()

    def test_relative_paths_are_those_of_the_shell(self):
        """Nodes of roslaunch run elsewhere."""
        self.bag_of("press.bag", harness.press(20))
        shutil.copy(harness.SCENE, self.path("press.yaml"))
        shutil.copy(os.path.join(os.path.dirname(harness.SCENE), "../../urdf/probe.urdf"), self.directory)
        code, output = harness.launch("scene.launch", "bag:=press.bag", "scene:=press.yaml", "output:=plots", cwd=self.directory)
        self.assertEqual(code, 0, output)
        self.assert_pictures()
        shutil.rmtree(self.plots)
        self.scene_without_urdf()
        code, output = harness.run(["roslaunch", "-p", str(free_port()), "tissue_contact", "scene.launch", "rviz:=false", "bag:=press.bag", "scene:=no urdf.yaml", "model:=probe.urdf",
                                    "output:=2026"], cwd=self.directory, env=dict(os.environ, PWD=self.directory))
        self.assertEqual(code, 0, output)
        self.assertIn("wrote " + self.path("2026/probe_force.png"), output)

    def test_a_node_that_connects_late_misses_nothing(self):
        """On a busy machine: the player's own script was connected first, and the recording began for it."""
        bag = self.bag_of("late.bag", harness.press(50))
        with harness.node(harness.SCENE) as node:
            harness.diagnostics().wait(len, "the node")
            node.send_signal(signal.SIGSTOP)
            try:
                command = [harness.program("play_and_plot.py"), "--bag", bag, "--output", self.plots]
                with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True) as player:
                    time.sleep(4.0)
                    node.send_signal(signal.SIGCONT)
                    output, _ = player.communicate(timeout=harness.DEADLINE_S)
            finally:
                node.send_signal(signal.SIGCONT)
        self.assertEqual(player.returncode, 0, output)
        self.assert_pictures()

    def scene_without_urdf(self):
        return self.changed_scene({"    urdf: package://tissue_contact/urdf/probe.urdf\n": ""}, name="no urdf.yaml")

    def test_model_goes_to_a_scene_that_names_none(self):
        bag = self.bag_of("press.bag", harness.press(20))
        code, output = harness.launch("scene.launch", "bag:=" + bag, "scene:=" + self.scene_without_urdf(),
                                      "model:=package://tissue_contact/urdf/probe.urdf",
                                      "output:=" + self.plots)
        self.assertEqual(code, 0, output)
        self.assert_pictures()

    def test_model_in_another_encoding(self):
        model = self.path("umlaut.urdf")
        for encoding, text in [("ISO-8859-1", "latin-1"), ("utf-8", "utf-8-sig"), ("UTF-16", "utf-16")]:
            with open(model, "wb") as stream:
                stream.write(("<?xml version='1.0' encoding='%s'?><robot name='k\u00f6rper'/>" % encoding).encode(text))
            code, output = harness.run([harness.program("read_model.py"), model, self.scene_without_urdf()])
            if encoding == "UTF-16":
                self.assertEqual(code, 1, output)
                self.assertIn("save it as UTF-8", output)
            else:
                self.assertEqual((code, output), (0, "<?xml version='1.0' encoding='UTF-8'?><robot name='k\u00f6rper'/>"))

    def test_model_that_cannot_be_used_is_said_without_a_trace(self):
        bag = self.bag_of("press.bag", harness.press(5))
        xacro = self.write("robot.urdf.xacro",
                           "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:nonsense/></robot>")
        cases = [(harness.SCENE, "package://tissue_contact/urdf/probe.urdf", "without the key urdf of 'probe'"),
                 (self.scene_without_urdf(), xacro, "robot.urdf.xacro"),
                 (self.scene_without_urdf(), "none.urdf", "none.urdf does not exist")]
        for scene, model, words in cases:
            code, output = harness.launch("scene.launch", "bag:=" + bag, "scene:=" + scene, "model:=" + model,
                                          "output:=" + self.plots)
            self.assertEqual(code, 1, output)
            self.assertIn(words, output)
            self.assertIn("read_model.py: ", output)
            self.assertNotIn("Traceback", output)

    def test_bag_without_the_topic_ends_with_its_name(self):
        bag = self.bag_of("other.bag", harness.press(5), topic="/other/joint_states")
        code, output = harness.launch("scene.launch", "bag:=" + bag, "scene:=" + harness.SCENE,
                                      "output:=" + self.plots)
        self.assertEqual(code, 1, output)
        self.assertIn("has no message on " + harness.TOPIC, output)
        self.assertIn("/other/joint_states", output)
        self.assert_pictures([])

    def test_node_that_does_not_start_is_a_failure_even_beside_older_plots(self):
        os.mkdir(self.plots)
        with open(os.path.join(self.plots, "probe_force.png"), "wb"):
            pass
        bag = self.bag_of("press.bag", harness.press(5))
        code, output = harness.launch("scene.launch", "bag:=" + bag, "scene:=no_such_scene.yaml", "output:=" + self.plots)
        self.assertEqual(code, 1, output)
        self.assertIn("no_such_scene.yaml", output)
        self.assertIn("REQUIRED process [tissue_contact-", output)
        code, output = harness.launch("no_such.launch")
        self.assertEqual(code, 1, output)

    def test_the_master_of_others_is_left_alone(self):
        bag = self.bag_of("press.bag", harness.press(20))
        master = rosgraph.Master(rospy.get_name())
        before = (master.getParam("/run_id"), sorted(rospy.get_param_names()), master.getSystemState())
        code, output = harness.launch("scene.launch", "bag:=" + bag,
                                      "scene:=package://tissue_contact/test/ros/press.yaml",
                                      "output:=" + self.plots)
        self.assertEqual(code, 0, output)
        self.assertEqual((master.getParam("/run_id"), sorted(rospy.get_param_names()), master.getSystemState()), before)

    def test_no_outgoing_connection_gets_the_port_of_the_master(self):
        with open("/proc/sys/net/ipv4/ip_local_port_range", encoding="ascii") as limits:
            first_given = int(limits.read().split()[0])
        if first_given <= 2048:
            self.skipTest("this system gives any port to outgoing connections (net.ipv4.ip_local_port_range)")
        for _ in range(20):
            self.assertLess(free_port(), first_given)

    def test_recording_is_what_its_script_makes(self):
        bags = [self.path(name) for name in ["first.bag", "second.bag"]]
        for bag in bags:
            subprocess.run([harness.program("make_demo_bag.py"), bag], check=True, stdout=subprocess.DEVNULL,
                           timeout=harness.DEADLINE_S)
        self.assertTrue(filecmp.cmp(*bags, shallow=False))
        contents = []
        for bag in [bags[0], os.path.join(harness.PACKAGE, "config", "press_drag.bag")]:
            with rosbag.Bag(bag) as opened:
                contents.append([(topic, message, time) for topic, message, time in opened.read_messages()])
        self.assertGreater(len(contents[0]), 1000)
        self.assertEqual(contents[0], contents[1])


if __name__ == "__main__":
    harness.main(Demo)
