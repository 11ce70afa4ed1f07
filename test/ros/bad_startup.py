#!/usr/bin/python3
"""Every start-up that cannot work ends with one fatal message that names the fault, and an exit code other than 0."""
import os
import signal

import rosgraph
import rospy

import harness

URDF = "urdf: package://tissue_contact/urdf/probe.urdf"


class BadStartup(harness.TestCase):
    def changed(self, old, new):
        return self.changed_scene({old: new})

    def assert_refused(self, arguments, *words):
        command = [harness.program("tissue_contact_node"), "__name:=tissue_contact"] + list(arguments)
        with harness.running(command) as node:
            harness.wait_until(lambda: node.poll() is not None, "the end of the node")
            self.assertGreater(node.returncode, 0)  # an exit code, not a signal
            output = harness.output_of(node)
        self.assertEqual(output.count("[FATAL]"), 1, output)
        self.assertNotIn("rospack", output)  # says nothing that the message does not
        for word in words:
            self.assertIn(word, output)
        publishers = rosgraph.Master("/test").getSystemState()[0]
        self.assertEqual([topic for topic, nodes in publishers if topic.startswith("/tissue_contact/")], [])
        return output

    def assert_scene_refused(self, path, *words):
        self.assert_refused(["_scene:=" + path], path, *words)

    def test_scene_parameter_missing(self):
        self.assert_refused([], "/tissue_contact/scene", "_scene:=")
        self.assert_refused(["scene:=" + harness.SCENE], "underscore", "_scene:=")

    def test_scene_parameter_is_no_text(self):
        self.assert_refused(["_scene:=3"], "/tissue_contact/scene")

    def test_scene_file_missing(self):
        self.assert_scene_refused(self.path("none.yaml"), "/tissue_contact/scene")

    def test_typo_in_a_key(self):
        self.assert_scene_refused(self.changed("youngs_modulus_pa", "young_modulus_pa"), "young_modulus_pa", "scene.yaml:5")

    def test_bad_setting(self):
        for given, words in [("step.max_step=0.002", ["--set step.max_step=0.002", 'did you mean "max_step_s"']),
                             ("[step.max_step_s=0.002, 'tissues.block.block.cells=[1, 2]']", ["--set tissues.block.block.cells=[1, 2]", "3"]),
                             ("[step.max_step_s", ["/tissue_contact/set"]), ("7", ["/tissue_contact/set", "KEY=VALUE"])]:
            self.assert_refused(["_scene:=" + harness.SCENE, "_set:=" + given], *words)
            rospy.delete_param("/tissue_contact/set")

    def test_unknown_contact_link(self):
        self.assert_scene_refused(self.changed("contact_links: [tip]", "contact_links: [jaw]"), "jaw", "probe")

    def test_unknown_package(self):
        self.assert_scene_refused(self.changed(URDF, "urdf: package://no_such_package/probe.urdf"), "no_such_package")

    def test_urdf_parameter_missing(self):
        path = self.changed(URDF, "robot_description: no_description")
        self.assert_scene_refused(path, "/tissue_contact/no_description", "textfile")

    def test_urdf_parameter_is_no_text(self):
        path = self.changed(URDF, "robot_description: number_description")
        self.assert_refused(["_scene:=" + path, "_number_description:=7"], "number_description", "not a string")

    def test_malformed_urdf_parameter(self):
        path = self.changed(URDF, "robot_description: bad_description")
        rospy.set_param("/bad_description", "<robot")
        self.assert_scene_refused(path, "bad_description")

    def test_unknown_tf_frame(self):
        path = self.changed("position_m: [0, 0, 0.026]", "position_m: [0, 0, 0.026], tf_frame: nowhere")
        output = self.assert_refused(["_scene:=" + path, "_tf_timeout_s:=1"], "nowhere", "tf_timeout_s")
        self.assertLess(len(output), 2000)  # not once per look what tf2 says of it

    def test_bad_tf_timeout(self):
        for bad in ["-1.0", "soon"]:
            self.assert_refused(["_scene:=" + harness.SCENE, "_tf_timeout_s:=" + bad], "tf_timeout_s")

    def test_bad_marker_scale(self):
        for name in ["markers/displacement_full_scale_m", "markers/pressure_full_scale_pa", "markers/strain_full_scale",
                     "markers/force_arrow_m_per_n"]:
            for bad in ["0.0", "-1.0", "nan"]:
                self.assert_refused(["_scene:=" + harness.SCENE, "_%s:=%s" % (name, bad)], "/tissue_contact/" + name)
            rospy.delete_param("/tissue_contact/" + name)

    def test_bad_marker_color(self):
        self.assert_refused(["_scene:=" + harness.SCENE, "_markers/color:=stress"],
                            "parameter '/tissue_contact/markers/color' is \"stress\"", "displacement, pressure or strain")

    def test_pressure_of_a_mesh_that_is_not_the_one_computed_with(self):
        self.assert_refused(["_scene:=" + self.refined_scene(), "_markers/color:=pressure", "_publish_mesh:=unrefined"],
                            "'block'", "publish_mesh:=refined")

    def test_bad_mesh_to_publish(self):
        for bad in ["coarse", "1"]:
            self.assert_refused(["_scene:=" + harness.SCENE, "_publish_mesh:=" + bad],
                                "parameter '/tissue_contact/publish_mesh' is \"%s\"" % bad, "refined or unrefined")

    def test_misspelt_argument(self):
        self.assert_refused(["_sceen:=" + harness.SCENE], "/tissue_contact/sceen", "'scene'", "_sceen:=")
        self.assertFalse(rospy.has_param("/tissue_contact/sceen"))  # the next start must not meet it
        self.assert_refused(["_scene:=" + harness.SCENE, "_marker/force_arrow_m_per_n:=0.1"],
                            "/tissue_contact/marker/force_arrow_m_per_n", "'markers/force_arrow_m_per_n'")

    def test_misspelt_parameter_of_a_launch_file(self):
        rospy.set_param("/tissue_contact/tf_timeout", 1.0)
        self.assert_refused(["_scene:=" + harness.SCENE], "/tissue_contact/tf_timeout", "'tf_timeout_s'", "rosparam delete")

    def test_parameter_like_none(self):
        self.assert_refused(["_scene:=" + harness.SCENE, "_gravity:=9.81"], "/tissue_contact/gravity", "tf_timeout_s")

    def test_urdf_for_a_scene_that_names_its_own(self):
        self.assert_refused(["_scene:=" + harness.SCENE, "_robot_description:=<robot/>"],
                            "/tissue_contact/robot_description", "No instrument of the scene")

    def test_extra_argument(self):
        for extra in ["press.yaml", "--scene", "_scene=press.yaml", ""]:
            self.assert_refused(["_scene:=" + harness.SCENE, extra], "'" + extra + "'", "_scene:=")

    def test_parameters_of_others_are_a_warning(self):
        # Of a node below, of a scene that uses more URDFs, of an older version on a master that lives long.
        others = ["camera/tf_timeout_s", "left/description", "gravity", "robot_description"]
        for name in others:
            rospy.set_param("/tissue_contact/" + name, "x")
        with harness.node(harness.SCENE) as node:
            harness.wrenches()  # waits for the publisher
            node.send_signal(signal.SIGINT)
            self.assertEqual(node.wait(harness.DEADLINE_S), 0)
            warnings = [line for line in harness.output_of(node).splitlines() if "[ WARN]" in line and "does not read" in line]
        self.assertEqual(len(warnings), 1, warnings)
        for name in others:
            self.assertIn("/tissue_contact/" + name, warnings[0])
            self.assertTrue(rospy.has_param("/tissue_contact/" + name))

    def test_parameter_of_others_by_the_command_line_is_refused(self):
        rospy.set_param("/tissue_contact/left/description", "x")
        self.assert_refused(["_scene:=" + harness.SCENE, "_right/description:=x"], "/tissue_contact/right/description")
        self.assertFalse(rospy.has_param("/tissue_contact/right/description"))
        self.assertTrue(rospy.has_param("/tissue_contact/left/description"))

    def test_known_parameters_start_the_node(self):
        # Of the node, of diagnostic_updater, of roscpp and of nodes beside it.
        path = self.changed(URDF, "robot_description: arm/description")
        with open(os.path.join(harness.PACKAGE, "urdf", "probe.urdf"), encoding="utf-8") as stream:
            rospy.set_param("/tissue_contact/arm/description", stream.read())
        rospy.set_param("/tissue_contact_of_another/sceen", "x")
        for name, value in [("diagnostic_period", 1.0), ("publish_mesh", "unrefined"), ("tf_timeout_s", 1.0),
                            ("markers/force_arrow_m_per_n", 0.1), ("markers/displacement_full_scale_m", 0.01),
                            ("markers/color", "strain"), ("markers/strain_full_scale", 1)]:
            rospy.set_param("/tissue_contact/" + name, value)
        arguments = ["__log:=" + self.path("log"), "chatter:=elsewhere", "/tissue_contact/status:=/s"]
        with harness.node(path, *arguments):
            harness.wrenches()  # waits for the publisher

    def tearDown(self):
        if rospy.has_param("/tissue_contact"):
            rospy.delete_param("/tissue_contact")


if __name__ == "__main__":
    harness.main(BadStartup)
