#!/usr/bin/python3
"""Numbers changed while the node runs, by dynamic_reconfigure: in force with the next wrench, refused as a whole, and played back by a replay
of the recording to the last bit."""
import re

import dynamic_reconfigure.client
import rospy
from dynamic_reconfigure.msg import BoolParameter, Config, DoubleParameter
from dynamic_reconfigure.srv import Reconfigure
from std_srvs.srv import Trigger
from tissue_contact.msg import Changes, TissueMesh

import harness

YOUNG = "tissues/block/youngs_modulus_pa"
STATIC, KINETIC = "friction/probe/block/static", "friction/probe/block/kinetic"


class Tuning(harness.TestCase):
    """In lock step: each joint state is sent when the wrench of the one before has come."""

    def setUp(self):
        super().setUp()
        self.recorded = []  # (topic, message, time of recording)
        self.forces = []

    def connect(self):
        self.wrenches = harness.wrenches()
        self.changes = harness.Listener(harness.NODE + "/changes", Changes)
        self.source = harness.JointSource()
        self.client = dynamic_reconfigure.client.Client(harness.NODE, timeout=harness.DEADLINE_S)
        self.addCleanup(self.client.close)
        for listener in [self.wrenches, self.changes]:
            self.addCleanup(listener.close)

    def play(self, samples):
        for stamp, positions in samples:
            self.recorded.append((harness.TOPIC, harness.joint_state(stamp, positions), stamp))
            seen = len(self.wrenches.messages)
            self.source.send(stamp, positions)
            self.forces.append(self.wrenches.wait(lambda all, n=seen: len(all) > n, "a wrench")[-1].wrench.force)

    def change(self, numbers):
        """Changes what is echoed; returns the echo."""
        seen = len(self.changes.messages)
        now = self.client.update_configuration(dict(numbers))
        for key, value in numbers.items():
            self.assertEqual(now[key], value)
        echo = self.changes.wait(lambda all: len(all) > seen, "an echo")[-1]
        self.recorded.append((harness.NODE + "/changes", echo, self.recorded[-1][2] if self.recorded else rospy.Time(1)))
        return echo

    def replayed_bits(self, *more):
        """Of a bag in which each change comes late: after the joint states of a tenth of a second that followed it."""
        messages = sorted(((topic, message, stamp + rospy.Duration.from_sec(0.1 if topic != harness.TOPIC else 0.0))
                           for topic, message, stamp in self.recorded), key=lambda one: one[2])
        harness.write_messages(self.path("run.bag"), messages)
        said = self.replayed(harness.SCENE, self.path("run.bag"), self.path("run.csv"), *more)
        return [bits for _, _, bits in harness.read_csv(self.path("run.csv"))], said

    def test_changes_in_contact_and_out_of_it_are_played_back_to_the_last_bit(self):
        path = harness.press_and_drag(60)
        down, half, rest = path[:20], path[20:40], path[40:]
        still = [(half[-1][0] + rospy.Duration(0, 1000000 * k), half[-1][1]) for k in range(1, 9)]
        with harness.node(harness.SCENE):
            self.connect()
            first = self.change({"tissues/block/damping_stiffness_s": 0.004})  # before anything was played
            self.assertEqual((first.header.stamp, first.loop, first.keys), (rospy.Time(0), 0, ["tissues/block/damping_stiffness_s"]))
            self.play(down[:2])  # above the tissue
            self.assertEqual(self.forces[-1].z, 0.0)
            self.change({"tissues/block/poissons_ratio": 0.42})
            self.play(down[2:])
            self.play(half)
            before = self.forces[-1]
            self.assertGreater(before.z, 0.01)
            echo = self.change({YOUNG: 10000.0})
            self.assertEqual((echo.header.stamp, dict(zip(echo.keys, echo.values))),
                             (half[-1][0], {YOUNG: 10000.0, "tissues/block/poissons_ratio": 0.42, "tissues/block/damping_stiffness_s": 0.004}))
            self.play(still)
            self.assertGreater(self.forces[-len(still)].z, 1.8 * before.z)  # in the next wrench
            self.assertLess(self.forces[-1].z, 2.2 * before.z)
            shear = self.forces[-1]
            self.change({STATIC: 0.02, KINETIC: 0.02, "solver/iterations": 25})
            self.play([(stamp + rospy.Duration(0, 1000000 * len(still)), position) for stamp, position in still])
            self.assertLess(abs(self.forces[-1].x), 0.6 * abs(shear.x), shear)  # what was held slides
            self.change({YOUNG: 5000.0, STATIC: 0.6, KINETIC: 0.4})
            self.play([(stamp + rospy.Duration(0, 50000000), position) for stamp, position in rest])
            self.change({YOUNG: 4000.0})  # of which no moment follows
            bits = [harness.wrench_bits(message) for message in self.wrenches.messages]
        replayed, said = self.replayed_bits()
        self.assertEqual(replayed, bits)
        self.assertRegex(said, "6 of 6 changes")
        unchanged, said = self.replayed_bits("--changes", "none")
        self.assertNotEqual(unchanged, bits)
        self.assertNotIn("changes of", said)

    def test_a_loop_is_played_back_with_the_changes_of_its_own_time(self):
        samples = harness.press(60)
        with harness.node(harness.SCENE):
            self.connect()
            self.play(samples[:30])
            self.play_loop(samples[:3])
            self.play(samples[3:30])
            echo = self.change({YOUNG: 9000.0})
            self.assertEqual((echo.header.stamp, echo.loop), (samples[29][0], 1))
            self.play(samples[30:])
            bits = [harness.wrench_bits(message) for message in self.wrenches.messages]
        for i, (topic, message, _) in enumerate(self.recorded):  # recorded one after the other
            self.recorded[i] = (topic, message, rospy.Time(5000) + rospy.Duration.from_sec(0.01) * i)
        self.assertEqual(self.replayed_bits()[0], bits)

    def test_a_recording_that_begins_after_a_reset_knows_its_loop(self):
        samples = harness.press(60)
        with harness.node(harness.SCENE):
            self.connect()
            self.play(samples[:10])
            self.assertTrue(rospy.ServiceProxy(harness.NODE + "/reset", Trigger)().success)
            told = self.changes.wait(lambda all: all, "what is said where a loop begins")[-1]
            self.assertEqual((told.header.stamp, told.loop, told.keys), (rospy.Time(0), 1, []))
            before = len(self.wrenches.messages)
            self.recorded = [(harness.NODE + "/changes", told, rospy.Time(1))]
            self.play(samples[:40])
            self.change({YOUNG: 20000.0})
            self.play(samples[40:])
            bits = [harness.wrench_bits(message) for message in self.wrenches.messages[before:]]
        replayed, said = self.replayed_bits()
        self.assertEqual(replayed, bits)
        self.assertRegex(said, "1 of 1 changes")

    def play_loop(self, samples):
        """The first samples of a loop, which is one once the third has come."""
        seen = len(self.wrenches.messages)
        for stamp, positions in samples:
            self.recorded.append((harness.TOPIC, harness.joint_state(stamp, positions), stamp))
            self.source.send(stamp, positions)
        self.wrenches.wait(lambda all: len(all) >= seen + len(samples), "the loop's first wrenches")

    def test_a_bad_request_changes_nothing_and_the_log_says_why(self):
        with harness.node(harness.SCENE) as process:
            self.connect()
            before = self.client.get_configuration(timeout=harness.DEADLINE_S)
            service = rospy.ServiceProxy(harness.NODE + "/set_parameters", Reconfigure)

            def request(**lists):
                config = service(Config(**lists)).config
                return {one.name: one.value for one in config.doubles + config.ints}

            def doubles(**numbers):
                return {"doubles": [DoubleParameter(name=name, value=value) for name, value in numbers.items()]}
            for lists, words in [
                    (doubles(**{YOUNG: -1.0}), "youngs_modulus_pa is -1 Pa; it must be >= 1"),
                    (doubles(**{YOUNG: float("nan")}), "nan"),
                    (doubles(**{YOUNG: 6000.0, STATIC: 0.1}), "kinetic"),
                    (doubles(**{"tissues/liver/youngs_modulus_pa": 6000.0}), "did you mean 'tissues/block/youngs_modulus_pa'"),
                    (doubles(**{"publish/mesh_rate_hz": 1e9}), "publish/mesh_rate_hz"),
                    ({"bools": [BoolParameter(name="fast", value=True)]}, "'fast' is a bool")]:
                now = request(**lists)
                self.assertEqual(now, {key: value for key, value in before.items() if key != "groups"}, words)
                harness.wait_until(lambda words=words: words in harness.output_of(process), words)
            self.assertEqual(len(re.findall("nothing was changed", harness.output_of(process))), 6)
            self.play(harness.press(5))
            self.assertEqual(self.changes.messages, [])

    def test_rates_and_the_lag_bound_are_the_nodes_own(self):
        samples = [(rospy.Time(harness.START_S) + rospy.Duration.from_sec(0.01) * i, (0.0, 0.0, 0.0)) for i in range(100)]
        with harness.node(harness.SCENE):
            self.connect()
            meshes = harness.Listener(harness.NODE + "/block/mesh", TissueMesh)
            self.play(samples[:10])
            now = self.client.update_configuration({"publish/mesh_rate_hz": 1000.0, "step/max_lag_s": 0.05})
            self.assertEqual((now["publish/mesh_rate_hz"], now["step/max_lag_s"]), (1000.0, 0.05))
            self.play(samples[10:60])
            meshes.wait(lambda all: {m.header.stamp for m in all} >= {stamp for stamp, _ in samples[10:60]}, "a mesh for each state")
            self.client.update_configuration({"publish/mesh_rate_hz": 0.0})
            self.play(samples[60:80])
            self.client.update_configuration({"publish/mesh_rate_hz": 1000.0})
            self.play(samples[80:])
            shown = meshes.wait(lambda all: all and all[-1].header.stamp == samples[-1][0], "the last mesh")
            self.assertFalse({m.header.stamp for m in shown} & {stamp for stamp, _ in samples[60:80]})
            self.assertEqual(self.changes.messages, [])

    def test_dynparam_lists_and_sets(self):
        dynparam = [harness.program_of("dynamic_reconfigure", "dynparam")]
        with harness.node(harness.SCENE):
            self.connect()
            code, text = harness.run(dynparam + ["set", harness.NODE, YOUNG, "7000"])
            self.assertEqual(code, 0, text)
            code, text = harness.run(dynparam + ["get", harness.NODE])
            self.assertEqual(code, 0, text)
            self.assertIn("'%s': 7000.0" % YOUNG, text)
            described = {one["name"]: one for one in self.client.get_parameter_descriptions(timeout=harness.DEADLINE_S)}
            self.assertEqual((described[YOUNG]["min"], described[YOUNG]["max"], described[YOUNG]["default"]), (1.0, 1e12, 5000.0))
            self.assertEqual(described["solver/iterations"]["type"], "int")
            self.assertTrue(all(one["description"] for one in described.values()))


if __name__ == "__main__":
    harness.main(Tuning)
