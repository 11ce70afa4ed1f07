#!/usr/bin/python3
"""What shows a running node to people: the configuration RViz is opened with and how the view follows a tip, without RViz, and the plots of
watch.py."""
import itertools
import math
import os
import subprocess
import xml.etree.ElementTree

import roslib.message
import rospy
import yaml
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

import harness


NUMBERS = {"float32", "float64", "bool"} | {sign + "int" + bits for sign in ("", "u") for bits in ("8", "16", "32", "64")}


def field_type(message_type, path):
    """Of a field of a message, by its names; a list has [i] behind its own. KeyError: there is none."""
    for part in path.split("/"):
        name, bracket, _ = part.partition("[")
        message = roslib.message.get_message_class(message_type)
        message_type = dict(zip(message.__slots__, message._slot_types))[name]
        if bracket:
            message_type = message_type[:message_type.index("[")]
    return message_type


class Pictures(harness.TestCase):
    def run_program(self, name, *arguments):
        code, output = harness.run([harness.program(name)] + list(arguments))
        self.assertEqual(code, 0, output)
        self.assertNotIn("Traceback", output)
        return output

    def configuration(self, scene, instrument="probe"):
        """RViz's, of a node that has had no joint state yet."""
        file = self.path("view.rviz")
        with harness.node(scene):
            harness.wrenches(instrument).close()  # waits for the publisher
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

    def test_nothing_of_the_first_picture_is_cut_off(self):
        """Of a flap that stands upright, and the force above the jaws that are to grasp it."""
        scene = os.path.join(harness.PACKAGE, "config", "grasp.yaml")
        _, view, _ = self.configuration(scene, "psm")
        with harness.node(scene):
            markers = harness.Listener(harness.NODE + "/markers", MarkerArray).wait(len, "markers")[0].markers
        force = next(m for m in markers if m.ns == "force_texts")
        edges = next(m for m in markers if m.ns == "flap" and m.type == Marker.LINE_LIST)
        top = force.pose.position.z + force.scale.z / 2
        points = [(p.x, p.y, p.z) for p in edges.points] + [(force.pose.position.x, force.pose.position.y, top)]
        focus, yaw, pitch = [view["Focal Point"][axis] for axis in "XYZ"], view["Yaw"], view["Pitch"]
        for point in points:
            x, y, z = (a - b for a, b in zip(point, focus))
            level = x * math.cos(yaw) + y * math.sin(yaw)  # towards the eye
            depth = view["Distance"] - level * math.cos(pitch) - z * math.sin(pitch)
            half = depth * math.tan(math.radians(22.5))
            self.assertLess(abs(y * math.cos(yaw) - x * math.sin(yaw)), half, point)
            self.assertLess(abs(z * math.cos(pitch) - level * math.sin(pitch)), half, point)

    @staticmethod
    def view_frames(tf):
        """{frame of the views: its newest place}"""
        frames = {}
        for message in list(tf.messages):
            for one in message.transforms:
                if one.child_frame_id.startswith("tissue_contact_view"):
                    place = one.transform.translation
                    frames[one.child_frame_id] = (place.x, place.y, place.z)
        return frames

    def test_the_view_follows_a_tip_that_leaves_it(self):
        """With a program in the place of RViz that keeps what it is started with."""
        rviz = self.write("rviz", '#!/bin/sh\ncp "$2" "%s"\nexec sleep 1000\n' % self.path("shown.rviz"))
        os.chmod(rviz, 0o755)
        opened = ["env", "PATH=%s:%s" % (self.directory, os.environ["PATH"]), harness.program("open_rviz.py")]
        all_of_it, tip = "tissue_contact_view", "tissue_contact_view/probe"
        with harness.node(harness.SCENE), harness.running(opened):
            tf = harness.Listener("/tf", TFMessage, connect=False)
            source = harness.JointSource()
            harness.wait_until(lambda: os.path.exists(self.path("shown.rviz")), "RViz")

            harness.wait_until(lambda: {all_of_it, tip} <= set(self.view_frames(tf)), "the views before the first joint state")

            stamps = (rospy.Time(1000) + rospy.Duration.from_sec(0.02) * i for i in itertools.count())

            def go(heights):
                """The probe to the last of these heights, where it stays until tf has it there."""
                for height in heights:
                    source.send(next(stamps), (0.0, 0.0, height))
                place = 0.026 + heights[-1]  # base_pose, and the ball hangs on it

                def is_there():
                    source.send(next(stamps), (0.0, 0.0, heights[-1]))
                    return abs(self.view_frames(tf).get(tip, (0, 0, -1))[2] - place) < 1e-6
                harness.wait_until(is_there, "the tip at %g m" % place)
                return self.view_frames(tf)

            near = go([0.0005 * i for i in range(10)])
            far = go([0.005 + 0.01 * i for i in range(40)])
            back = go([0.395 - 0.01 * i for i in range(40)])
            tf.close()
            late = harness.Listener("/tf", TFMessage, connect=False)  # as RViz, when nothing moves any more
            harness.wait_until(lambda: self.view_frames(late) == back, "the views told to who comes late")
            late.close()
        with open(self.path("shown.rviz"), encoding="utf-8") as stream:
            views = yaml.safe_load(stream)["Visualization Manager"]["Views"]
        self.assertEqual(views["Current"]["Target Frame"], all_of_it)
        self.assertEqual({view["Name"]: view["Target Frame"] for view in views["Saved"]}, {"All": all_of_it, "Tip of probe": tip})
        height = 2 * views["Current"]["Distance"] * math.tan(math.radians(22.5))  # of what is in the picture, in its middle
        self.assertLess(math.dist(near[tip], near[all_of_it]), height / 2)
        self.assertLess(math.dist(far[tip], far[all_of_it]), height / 2)
        self.assertGreater(math.dist(far[tip], near[all_of_it]), height)  # it would be out of a view that stays
        for a, b in zip(back[all_of_it], near[all_of_it]):
            self.assertAlmostEqual(a, b, 9)

    def test_the_layout_of_plotjuggler_names_what_is_published(self):
        """PlotJuggler calls a curve TOPIC/FIELD/..., with [i] behind a list."""
        layout = xml.etree.ElementTree.parse(os.path.join(harness.PACKAGE, "config", "plotjuggler.xml"))
        curves = [curve.get("name") for curve in layout.iter("curve")]
        with harness.node(harness.SCENE):
            harness.wrenches().close()  # waits for the publisher
            harness.wait_until(lambda: "/tissue_contact/status" in dict(rospy.get_published_topics()), "the status")  # of those, the last
            published = dict(rospy.get_published_topics())
        for part in ["wrench/force/x", "lag", "momentum_residual", "error"]:
            self.assertTrue(any(curve.endswith("/" + part) for curve in curves), part)
        for curve in curves:
            topics = [topic for topic in published if curve.startswith(topic + "/")]
            self.assertEqual(len(topics), 1, curve)
            self.assertIn(field_type(published[topics[0]], curve[len(topics[0]) + 1:]), NUMBERS, curve)

    def test_watch_draws_what_comes(self):
        picture = self.path("my plots.png")
        watching = [harness.program("watch.py"), "--png", picture, "--seconds", "0.9"]
        with harness.node(harness.SCENE), harness.running(watching) as watch:
            source = harness.JointSource()
            harness.wait_until(lambda: self.is_heard("/tissue_contact/status"), "watch.py listening")
            wrenches = harness.wrenches()
            rounds = itertools.count()

            def is_drawn():  # on a busy machine it is known to listen some time before anything reaches it
                samples = harness.press(100, harness.START_S + next(rounds))
                source.send_all(samples)
                wrenches.wait(lambda all: all and all[-1].header.stamp == samples[-1][0], "the wrenches")
                try:
                    watch.wait(1.0)
                except subprocess.TimeoutExpired:
                    return False
                return True
            harness.wait_until(is_drawn, "the picture")
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
