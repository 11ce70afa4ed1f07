#!/usr/bin/python3
"""What shows a running node to people: the configuration RViz is opened with, without RViz, and the plots of watch.py."""
import os
import unittest

import rospy
import yaml

import harness


class Pictures(harness.TestCase):
    def run_program(self, name, *arguments):
        code, output = harness.run([harness.program(name)] + list(arguments))
        self.assertEqual(code, 0, output)
        self.assertNotIn("Traceback", output)
        return output

    def configuration(self, scene):
        """RViz's, of a node that has had no joint state yet."""
        file = self.path("view.rviz")
        with harness.node(scene):
            harness.wrenches().close()  # waits for the publisher
            self.run_program("open_rviz.py", "--write", file)
        with open(file, encoding="utf-8") as stream:
            manager = yaml.safe_load(stream)["Visualization Manager"]
        return manager["Global Options"]["Fixed Frame"], manager["Views"]["Current"], manager["Displays"]

    def test_rviz_looks_at_the_tissue(self):
        frame, view, displays = self.configuration(harness.SCENE)
        self.assertEqual(frame, "world")
        self.assertIn("/tissue_contact/markers", [display.get("Marker Topic") for display in displays])
        self.assertFalse(view["Invert Z Axis"])
        self.assertAlmostEqual(view["Yaw"], 5.3, 6)
        self.assertTrue(0.05 < view["Distance"] < 0.5, view)  # a block of 60 mm
        for axis in "XYZ":
            self.assertLess(abs(view["Focal Point"][axis]), 0.05, view)

    def test_rviz_follows_a_scene_to_its_place_and_frame(self):
        _, before, _ = self.configuration(harness.SCENE)
        scene = self.changed_scene({"tissues:": "world_frame: room\ngravity_m_per_s2: [0, 0, 9.81]\ntissues:",
                                    "    damping:": "    pose: {position_m: [3, -2, 1]}\n    damping:",
                                    "position_m: [0, 0, 0.026]": "position_m: [3, -2, 0.98]"})
        frame, view, _ = self.configuration(scene)
        self.assertEqual(frame, "room")
        self.assertTrue(view["Invert Z Axis"])  # what falls, falls downwards in the picture
        self.assertTrue(0.5 < view["Distance"] / before["Distance"] < 2.0, view)
        for axis, place in zip("XYZ", (3.0, -2.0, 1.0)):
            self.assertAlmostEqual(view["Focal Point"][axis], place, delta=0.1)

    def test_watch_draws_what_comes(self):
        picture = self.path("my plots.png")
        watching = [harness.program("watch.py"), "--png", picture, "--seconds", "0.9"]
        with harness.node(harness.SCENE), harness.running(watching) as watch:
            source = harness.JointSource()
            harness.wait_until(lambda: self.is_heard("/tissue_contact/status"), "watch.py listening")
            wrenches = harness.wrenches()
            source.send_all(harness.press(100))
            wrenches.wait(lambda all: len(all) == 100, "the wrenches")
            harness.wait_until(lambda: watch.poll() is not None, "the picture")
            self.assertEqual(watch.returncode, 0, harness.output_of(watch))
            self.assertIn("wrote " + picture, harness.output_of(watch))
        with open(picture, "rb") as stream:
            data = stream.read()
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        self.assertGreater(len(data), 10000)

    @staticmethod
    def is_heard(topic):
        return any(name == topic for name, _ in rospy.get_master().getSystemState()[2][1])

    def test_watch_refuses_what_cannot_be(self):
        for arguments, words in [(["--seconds", "0"], "0.1 to 600"), (["--seconds", "nan"], "0.1 to 600"), (["--pgn", "x"], "--pgn")]:
            code, output = harness.run([harness.program("watch.py")] + arguments)
            self.assertEqual(code, 2, output)
            self.assertIn(words, output)


if __name__ == "__main__":
    harness.main(Pictures)
