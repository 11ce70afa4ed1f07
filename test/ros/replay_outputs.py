#!/usr/bin/python3
"""Offline replay: what it writes and says when all is well."""
import hashlib
import os
import re
import subprocess

import rospy
import yaml
from geometry_msgs.msg import WrenchStamped

import harness


class ReplayOutputs(harness.TestCase):
    def setUp(self):
        super().setUp()
        self.samples = harness.press(40)
        self.bag = self.bag_of("press.bag", self.samples)

    def read(self, name):
        with open(self.path(name), "rb") as stream:
            return stream.read()

    def replay(self, name, *more, scene=harness.SCENE):
        return self.replayed(scene, self.bag, self.path(name), *more)

    def test_a_law_out_of_its_range_is_told_with_the_fix(self):
        errors = self.replay("out.csv")
        self.assertEqual(errors.count("warning: "), 2, errors)
        self.assertIn("warning: advisor: mesh of tissue 'block'", errors)  # cells of 10 mm under a ball of 5 mm
        for words in ["beyond the range of the corotational law", "{model: neo_hookean, dilatation: patch}", "1 times: forces likely wrong by up to -"]:
            self.assertIn(words, errors)
        scene = self.changed_scene({"material: {": "material: {model: neo_hookean, dilatation: patch, "})
        self.assertNotIn("beyond the range", self.replay("neo.csv", scene=scene))

    def test_settings_are_as_if_the_scene_said_so(self):
        self.replay("said.csv", scene=self.changed_scene({"youngs_modulus_pa: 5000": "youngs_modulus_pa: 4000", "static: 0.6": "static: 0.7"}))
        self.replay("set.csv", "--set", "tissues.block.material.youngs_modulus_pa=4000", "--set=friction.0.static=0.7")
        self.replay("out.csv")
        self.assertEqual(self.read("set.csv"), self.read("said.csv"))
        self.assertNotEqual(self.read("set.csv"), self.read("out.csv"))

    def test_the_node_takes_the_same_settings(self):
        settings = ["tissues.block.material.youngs_modulus_pa=4000", "friction.0.static=0.7"]
        self.replay("set.csv", *["--set=" + setting for setting in settings])
        expected = [float(row["force_z_n"]) for row in harness.read_table(self.path("set.csv"))]
        for given in [settings, "[%s]" % ", ".join(settings)]:
            rospy.set_param(harness.NODE + "/set", given)
            with harness.node(harness.SCENE) as node:
                wrenches = harness.Listener(harness.NODE + "/probe/wrench", WrenchStamped)
                harness.JointSource().send_all(self.samples)
                self.assertEqual([w.wrench.force.z for w in wrenches.wait_for_stamp(self.samples[-1][0])], expected)
                node.terminate()  # with which its output is written
                node.wait(harness.DEADLINE_S)
                self.assertIn("the scene is changed by %s/set" % harness.NODE, harness.output_of(node))
            rospy.delete_param(harness.NODE + "/set")

    def test_a_manifest_tells_what_became_of_its_files(self):
        self.replay("out.csv", "--manifest", self.path("made.yaml"), "--set", "friction.0.static=0.7")
        with open(self.path("made.yaml"), encoding="utf-8") as stream:
            manifest = yaml.safe_load(stream)
        self.assertEqual(manifest["set"], ["friction.0.static=0.7"])
        self.assertIn(self.bag, manifest["arguments"])
        self.assertEqual(manifest["counts"]["joint states: accepted"], 40)
        roles = [one["role"] for one in manifest["inputs"]]
        self.assertEqual(roles[:3], ["--bag", "--scene", "the scene's URDF"])
        self.assertEqual(len(manifest["program"]), 3)
        self.assertNotIn("gmsh", manifest["versions"])  # it filled nothing
        with open(self.path("out.csv"), "rb") as stream:
            self.assertEqual([(one["role"], one["sha256"]) for one in manifest["results"]], [("--csv", hashlib.sha256(stream.read()).hexdigest())])
        check = [harness.program("check_manifest.py"), self.path("made.yaml")]
        code, output = harness.run(check)
        self.assertEqual((code, "all as they were" in output), (0, True), output)
        with open(self.path("out.csv"), "a", encoding="ascii") as stream:
            stream.write("\n")
        code, output = harness.run(check)
        self.assertEqual((code, "--csv %s: has another content" % self.path("out.csv") in output), (1, True), output)

    def test_a_batch_is_the_same_bytes_as_replays_alone(self):
        self.replay("out.csv")
        lines = [["--scene=" + harness.SCENE, "--bag=" + self.bag, "--csv=" + self.path(name), *more]
                 for name, more in [("a.csv", []), ("b.csv", ["--set=step.max_step=1"]), ("c.csv", ["--set=friction.0.static=0.7"]), ("d.csv", [])]]
        with open(self.path("lines"), "w", encoding="utf-8") as stream:
            stream.write("".join("\t".join(line) + "\n" for line in lines))
        done = subprocess.run([harness.program("tissue_contact_replay"), "--batch", self.path("lines")], stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, timeout=harness.DEADLINE_S, check=True)
        answers = [line.split("\t") for line in done.stdout.splitlines()]
        self.assertEqual([answer[0] for answer in answers], ["ok", "failed", "ok", "ok"])
        self.assertIn('unknown key; did you mean "max_step_s"', answers[1][2])
        self.assertEqual(self.read("a.csv"), self.read("out.csv"))
        self.assertEqual(self.read("d.csv"), self.read("out.csv"))
        self.assertNotEqual(self.read("c.csv"), self.read("out.csv"))
        self.assertFalse(os.path.exists(self.path("b.csv")))

    def test_likely_errors_of_the_force_are_columns_and_a_line(self):
        errors = self.replay("out.csv")
        rows = harness.read_table(self.path("out.csv"))
        for row in rows:
            parts = [float(row[name]) for name in ["mesh_error_n", "step_error_n", "solver_error_n"]]
            self.assertAlmostEqual(float(row["force_error_n"]), sum(p ** 2 for p in parts) ** 0.5, delta=1e-5)
        size = [sum(float(row["force_%s_n" % axis]) ** 2 for axis in "xyz") for row in rows]
        share = (sum(float(row["force_error_n"]) ** 2 for row in rows) / sum(size)) ** 0.5
        self.assertIn("force on 'probe' likely wrong by %g %% (RMS; mesh " % float("%.2g" % (100 * share)), errors)
        self.assertGreater(share, 0.1)
        self.assertIn("smaller cells where it touches (tissues[].refinement)", errors)

    def test_cells_longer_than_asked_for_are_told_with_the_fix(self):
        few = "{cell_m: 0.0015, nodes_at_most: 250}"  # 147 unrefined
        harness.write_bag(self.bag, harness.press_and_drag(20))
        errors = self.replay("few.csv", scene=self.refined_scene(few))
        self.assertEqual(errors.count("times as long as its refinement asks for, since"), 1, errors)
        for words in ["warning: ", "Raise tissues[].refinement.nodes_at_most", "cells of tissue 'block' up to ", "such cells in 19 intervals"]:
            self.assertIn(words, errors)
        self.assertNotIn("its refinement asks", self.replay("enough.csv", scene=self.refined_scene(name="auto.yaml")))

    def test_grips_that_are_not_solved_to_the_end_are_told(self):
        errors = self.replay("cut.csv", "--set", "solver.iterations=1", "--set", "solver.tolerance=1e-9")
        told = re.search(r"static friction held in (\d+) intervals, of which (\d+) ended before the solver's tolerance", errors)
        rows = [row for row in harness.read_table(self.path("cut.csv")) if int(row["static_contacts"]) > 0]
        self.assertEqual(int(told[1]), len(rows), errors)
        self.assertEqual(int(told[2]), len(rows), errors)
        self.assertIn("--set solver.iterations=10 (now 1) or --set solver.relaxation=cholesky\n", errors)
        self.assertNotIn("ended before", self.replay("out.csv"))

    def test_contacts_that_are_not_solved_to_the_end_are_told(self):
        no_grip = ["--set", "friction[0].static=0", "--set", "friction[0].kinetic=0", "--set", "solver.tolerance=1e-9", "--set", "solver.iterations=1"]
        told = "something touched in (\\d+) intervals, of which (\\d+) ended before the solver's tolerance"
        found = re.search(told, self.replay("cut.csv", *no_grip))
        rows = [row for row in harness.read_table(self.path("cut.csv")) if int(row["kinetic_contacts"]) > 0]
        self.assertEqual([int(found[1]), int(found[2])], [len(rows)] * 2)
        solved = ["--set", "solver.relaxation=cholesky", "--set", "solver.iterations=200"]
        self.assertNotIn("something touched", self.replay("solved.csv", *no_grip[:4], *solved))

    def test_times_go_to_a_file_of_their_own(self):
        self.replay("out.csv", "--timing", self.path("timing.csv"))
        self.replay("without.csv")
        self.assertEqual(self.read("out.csv"), self.read("without.csv"))
        rows = harness.read_table(self.path("timing.csv"))
        # The first joint state only places the instrument: no interval ends there.
        self.assertEqual([row["stamp_s"] for row in rows], [harness.stamp_text(stamp) for stamp, _ in self.samples[1:]])
        for row in rows:
            self.assertEqual(list(row), ["stamp_s", "step_time_s", "steps"])
            self.assertGreater(float(row["step_time_s"]), 0.0)
            self.assertGreaterEqual(int(row["steps"]), 1)
        self.assertEqual(sorted(os.listdir(self.directory)), ["out.csv", "press.bag", "timing.csv", "without.csv"])

    def test_a_jump_is_told_once(self):
        # 10 m in 10 ms; the state 10 us after it is no interval of its own, so nothing jumped there.
        (first, _), (second, _) = self.samples[:2]
        stamps = [first, second, second + rospy.Duration(nsecs=10000), second + rospy.Duration(nsecs=10000000)]
        harness.write_bag(self.bag, [(stamp, (x, 0.0, 0.01)) for stamp, x in zip(stamps, [-5.0, 5.0, 5.0, 5.0])])
        errors = self.replay("out.csv")
        self.assertIn("1 jumps", errors)
        self.assertEqual([row["jumped"] for row in harness.read_table(self.path("out.csv"))], ["0", "1", "0", "0"])

    def test_no_half_file_of_times(self):
        for name in ["out.csv", "timing.csv"]:
            self.write(name, "what was there before")
        harness.write_bag(self.bag, [(stamp, (0.0, float("nan"), 0.0)) for stamp, _ in self.samples])
        code, errors = harness.replay(harness.SCENE, self.bag, self.path("out.csv"), "--timing",
                                      self.path("timing.csv"))
        self.assertEqual(code, 1, errors)
        self.assertEqual(self.read("timing.csv"), b"what was there before")
        self.assertEqual(sorted(os.listdir(self.directory)), ["out.csv", "press.bag", "timing.csv"])

    def test_scene_of_a_package(self):
        bag = os.path.join(harness.PACKAGE, "config", "press_drag.bag")
        for name, scene in [("path.csv", os.path.join(harness.PACKAGE, "config", "press_drag.yaml")),
                            ("uri.csv", "package://tissue_contact/config/press_drag.yaml")]:
            self.replayed(scene, bag, self.path(name))
        self.assertEqual(self.read("path.csv"), self.read("uri.csv"))

    def test_unknown_package_is_one_message(self):
        code, errors = harness.replay("package://no_such_package/scene.yaml", self.bag, self.path("out.csv"))
        self.assertEqual(code, 1, errors)
        self.assertRegex(errors, "^tissue_contact_replay: [^\n]*no_such_package[^\n]*\n$")

    def test_a_bag_that_never_touches_says_how_near_it_came(self):
        # press.yaml: the ball's lowest point is 1 mm above the block when all joints are 0; sample 20 is the nearest.
        samples = [(stamp, (0.0, 0.0, 0.002 + 0.0001 * abs(i - 20))) for i, (stamp, _) in enumerate(self.samples)]
        harness.write_bag(self.bag, samples)
        errors = self.replay("out.csv")
        found = re.search("no instrument touched tissue; closest approach ([^ ]+) m at ([^ ]+) s: 'probe', link 'tip', "
                          "shape 1 of 2, to tissue 'block'", errors)
        self.assertTrue(found, errors)
        self.assertAlmostEqual(float(found.group(1)), 0.003, delta=1e-8)
        self.assertEqual(found.group(2), harness.stamp_text(samples[20][0]))

    def test_a_joint_that_goes_by_another_name_is_told(self):
        def said(names):
            stamped = [(harness.TOPIC, harness.joint_state(stamp, (0.0,) * len(names), names), stamp) for stamp, _ in self.samples]
            harness.write_messages(self.path("names.bag"), stamped)
            return self.replayed(harness.SCENE, self.path("names.bag"), self.path("names.csv"))

        errors = said(["x", "y", "depth", "lamp"])
        for words in ["these joints of 'probe'", "them: z;", "joints: depth, lamp.", "joint_names"]:
            self.assertIn(words, errors)
        for usual in [["x", "y"], ["x", "y", "z", "lamp"]]:  # a joint that was not recorded; joints of others
            self.assertNotIn("joint_names", said(usual))

    def test_a_bag_that_touches_says_nothing_of_it(self):
        self.assertNotIn("approach", self.replay("out.csv"))


if __name__ == "__main__":
    harness.main(ReplayOutputs)
