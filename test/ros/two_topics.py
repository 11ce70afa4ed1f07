#!/usr/bin/python3
"""Two topics, of two instruments or of an arm and its jaw: moments in the order of their stamps, whichever way they arrive;
the bits of the replay."""
import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from rosgraph_msgs.msg import Log
from tf2_msgs.msg import TFMessage

import harness

SECOND_PROBE = """  - name: other
    urdf: package://tissue_contact/urdf/probe.urdf
    base_pose: {position_m: [0.02, 0, 0.026]}
    joint_state_topics: [/other/joint_states]
    tip_link: tip
    contact_links: [tip]

friction:
"""


class TwoTopics(harness.TestCase):
    def setUp(self):
        super().setUp()
        # Both probes have the same link names, which tf cannot hold.
        self.scene = self.changed_scene({"friction:\n": SECOND_PROBE, "tf: true": "tf: false"})
        self.samples = harness.press(100)
        self.shift = rospy.Duration(0, 3000000)

    def write_bag(self, name, messages):
        """messages: (topic, stamp, names, positions), recorded in this order."""
        bag = self.path(name)
        harness.write_messages(bag, [
            (topic, harness.joint_state(stamp, positions, names), self.samples[0][0] + rospy.Duration(0, 1000) * i)
            for i, (topic, stamp, names, positions) in enumerate(messages)])
        return bag

    def rows(self, scene, bag):
        table = bag + ".csv"
        self.replayed(scene, bag, table)
        return harness.read_table(table)

    def test_equal_stamps_are_one_moment(self):
        tables = []
        for name, order in [("one.bag", 1), ("other.bag", -1)]:
            messages = []
            for stamp, (x, y, z) in self.samples:
                messages += [(harness.TOPIC, stamp, "xyz", (x, y, z)),
                             ("/other/joint_states", stamp, "xyz", (2 * x, y, 0.5 * z))][::order]
            tables.append(self.rows(self.scene, self.write_bag(name, messages)))
        self.assertEqual(tables[0], tables[1])
        self.assertEqual([row["instrument"] for row in tables[0]], 100 * ["probe", "other"])
        bases = {"probe": (0.0, 0.026), "other": (0.02, 0.026)}
        for i, (stamp, (x, _, z)) in enumerate(self.samples):
            for row, (dx, dz) in zip(tables[0][2 * i:2 * i + 2], [(x, z), (2 * x, 0.5 * z)]):
                base_x, base_z = bases[row["instrument"]]
                self.assertEqual(row["stamp_s"], harness.stamp_text(stamp))
                # The pose of this stamp, not of the one before, 60 um away; a sum of a few doubles away.
                self.assertAlmostEqual(float(row["tip_x_m"]), base_x + dx, delta=1e-12)
                self.assertAlmostEqual(float(row["tip_z_m"]), base_z + dz, delta=1e-12)

    def test_a_jaw_beside_its_arm_gives_no_wrench_of_its_own(self):
        arm, jaw = "/probe/measured_js", "/probe/jaw/measured_js"
        scene = self.changed_scene({"[%s]" % harness.TOPIC: "[%s, %s]" % (arm, jaw)}, name="jaw.yaml")
        messages = []
        for i, (stamp, (x, y, z)) in enumerate(self.samples):  # the "jaw" has the probe's z
            messages.append((arm, stamp, "xy", (x, y)))
            if i % 2 == 0:
                messages.append((jaw, stamp, "z", (z,)))
            messages.append((jaw, stamp + self.shift, "z", (z - 0.00001,)))
        bag = self.write_bag("jaw.bag", messages)
        rows = self.rows(scene, bag)
        self.assertEqual([row["stamp_s"] for row in rows], [harness.stamp_text(stamp) for stamp, _ in self.samples])
        expected = harness.read_csv(bag + ".csv")
        self.assertGreater(len({bits for _, _, bits in expected}), 50)  # not all zero

        with harness.node(scene):
            wrenches = harness.wrenches()
            sources = {topic: harness.JointSource(topic) for topic in [arm, jaw]}
            for begin in range(0, len(messages), 25):  # 0.1 s of one topic, then of the other; max_gap_s is 0.2 s
                for topic in [arm, jaw] if begin % 50 else [jaw, arm]:
                    for to, stamp, names, positions in messages[begin:begin + 25]:
                        if to == topic:
                            sources[topic].send(stamp, positions, names)
                played = [stamp for to, stamp, _, _ in messages[:begin + 25] if to == arm]
                wrenches.wait_for_stamp(played[-2])  # the last may wait for the next batch
            got = wrenches.wait_for_stamp(self.samples[-1][0])
        self.assertEqual([(harness.stamp_text(w.header.stamp), harness.wrench_bits(w)) for w in got],
                         [(stamp, bits) for stamp, _, bits in expected])

    def test_a_jaw_with_a_clock_ahead_is_told(self):
        arm, jaw = "/ahead/measured_js", "/ahead/gripper/measured_js"  # of no other test, which would publish on them still
        scene = self.changed_scene({"[%s]" % harness.TOPIC: "[%s, %s]" % (arm, jaw)}, name="ahead.yaml")
        messages = []
        for stamp, (x, y, z) in self.samples:
            messages += [(jaw, stamp + rospy.Duration(3600), "z", (z,)), (arm, stamp, "xy", (x, y))]
        told = "the stamps on %s, which only updates, are ahead of those that give wrenches by up to 3600 s (step.max_gap_s is 0.2)" % jaw
        bag = self.write_bag("ahead.bag", messages)
        errors = self.replayed(scene, bag, bag + ".csv")
        self.assertEqual(errors.count(told), 1, errors)
        self.assertIn("100 joint states accepted, 100 later than the last that gives a wrench;", errors)
        with harness.node(scene):
            log, diagnostics, wrenches = harness.Listener("/rosout", Log), harness.diagnostics(), harness.wrenches()
            sources = {topic: harness.JointSource(topic) for topic in [arm, jaw]}
            for topic, stamp, names, positions in messages:
                sources[topic].send(stamp, positions, names)
            wrenches.wait_for_stamp(self.samples[-1][0])
            diagnostics.wait(lambda all: any(told in status.message and status.level == DiagnosticStatus.WARN
                                             for message in all for status in message.status), "a warning of " + jaw)
            log.wait(lambda all: any(told in line.msg for line in all), "a line about " + jaw)
        self.assertEqual(sum(told in line.msg for line in log.messages), 1)

    def test_arrival_order_does_not_matter(self):
        bag = self.path("two.bag")
        harness.write_messages(bag, [(topic, harness.joint_state(at, positions), at) for stamp, positions in self.samples
                                     for topic, at in [(harness.TOPIC, stamp), ("/other/joint_states", stamp + self.shift)]])
        csv = self.path("out.csv")
        self.replayed(self.scene, bag, csv)
        rows = harness.read_csv(csv)
        self.assertEqual(len(rows), 200)

        with harness.node(self.scene):
            listeners = {name: harness.wrenches(name) for name in ["probe", "other"]}
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

    def test_what_waits_for_a_topic_that_ended_first_is_played_once_nobody_publishes(self):
        topics = "/ends_last", "/ends_first"  # of no other test, which would publish on them still
        scene = self.changed_scene({"[%s]" % harness.TOPIC: "[%s]" % topics[0], "[/other/joint_states]": "[%s]" % topics[1]},
                                   source=self.scene, name="ends.yaml")
        samples = self.samples, self.samples[:-15]  # 0.15 s of stamps less; max_gap_s is 0.2 s
        bag = self.path("ends.bag")
        harness.write_messages(bag, [(topic, harness.joint_state(*sample), sample[0])
                                     for topic, all in zip(topics, samples) for sample in all])
        csv = self.path("out.csv")
        self.replayed(scene, bag, csv)
        expected = [(stamp, bits) for stamp, instrument, bits in harness.read_csv(csv) if instrument == "probe"]
        with harness.node(scene):
            wrenches = harness.wrenches()
            sources = [harness.JointSource(topic) for topic in topics]
            for begin in range(0, len(samples[0]), 10):  # 0.1 s
                for source, all in zip(sources, samples):
                    source.send_all(all[begin:begin + 10])
            wrenches.wait_for_stamp(samples[1][-1][0])
            harness.diagnostics().wait(  # longer than max_gap_s: both may go on
                lambda all: sum(value.key == "joint states: waiting" and value.value == "15"
                                for message in all for status in message.status for value in status.values) >= 2,
                "15 joint states that wait, twice")
            self.assertEqual(len(wrenches.messages), len(samples[1]))
            for source in sources:
                source.close()
            got = wrenches.wait_for_stamp(samples[0][-1][0])
        self.assertEqual([(harness.stamp_text(w.header.stamp), harness.wrench_bits(w)) for w in got], expected)

    def test_frames_of_links_with_one_name_have_the_instruments(self):
        with harness.node(self.changed_scene({"tf: false": "tf: true"}, source=self.scene, name="tf.yaml")):
            tf = harness.Listener("/tf", TFMessage)
            listeners = {name: harness.wrenches(name) for name in ["probe", "other"]}
            sources = [harness.JointSource(topic) for topic in (harness.TOPIC, "/other/joint_states")]
            for sample in self.samples[:3]:
                for source in sources:
                    source.send(*sample)
            for name, listener in listeners.items():
                self.assertEqual(listener.wait(len, "a wrench")[0].header.frame_id, name + "/tip")
            frames = tf.wait(len, "transforms")[0].transforms
        parents = {one.child_frame_id: one.header.frame_id for one in frames}
        self.assertEqual(len(parents), len(frames))
        for name in listeners:
            way = [name + "/tip"]
            while way[-1] in parents:
                way.append(parents[way[-1]])
            self.assertEqual((way[-2], way[-1]), (name + "/base", "world"))


if __name__ == "__main__":
    harness.main(TwoTopics)
