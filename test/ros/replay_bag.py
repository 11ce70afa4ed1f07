#!/usr/bin/python3
"""The bag that a replay writes: the node's own messages, a part of a recording, plots, and what an early end leaves."""
import hashlib
import io
import os
import signal
import subprocess

import rosbag
import rospy
from geometry_msgs.msg import WrenchStamped
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

import harness
from tissue_contact.msg import ContactArray, Status, TissueMesh, TissueTopology

TYPES = {harness.NODE + "/probe/wrench": WrenchStamped, harness.NODE + "/block/mesh": TissueMesh,
         harness.NODE + "/block/topology": TissueTopology, harness.NODE + "/contacts": ContactArray,
         harness.NODE + "/status": Status, "/tf": TFMessage}
BEFORE = "what was there before"


def messages_of(file):
    """topic -> [(message, time of recording)]."""
    found = {}
    with rosbag.Bag(file) as bag:
        for topic, message, recorded in bag.read_messages():
            found.setdefault(topic, []).append((message, recorded))
    return found


def bytes_of(message):
    """All but what only a clock or a connection can tell, and the node tells after a moment on its way between threads."""
    if hasattr(message, "header"):
        message.header.seq = 0
    if message._type == Status._type:
        message.step_time = message.lag = message.real_time_factor = 0.0
        message.joint_states_received = message.joint_states_waiting = 0
    buffer = io.BytesIO()
    message.serialize(buffer)  # rosbag's messages have types of their own, which differ from ours
    return buffer.getvalue()


class ReplayBag(harness.TestCase):
    def setUp(self):
        super().setUp()
        self.samples = harness.press(60)
        self.out = self.path("out.bag")
        self.bag = self.path("press.bag")
        # Recorded 5 s after their stamps, as by another machine.
        harness.write_messages(self.bag, [(harness.TOPIC, harness.joint_state(*sample), sample[0] + rospy.Duration(5))
                                          for sample in self.samples])

    def run_replay(self, *more, bag=None, scene=harness.SCENE):
        command = [harness.program("tissue_contact_replay"), "--scene", scene, "--bag", bag or self.bag, "--out", self.out]
        return harness.run(command + list(more), stderr=subprocess.PIPE)

    def replay_bag(self, *more, **options):
        code, errors = self.run_replay(*more, **options)
        self.assertEqual(code, 0, errors)
        return errors

    def stamps(self):
        return [message.header.stamp for message, _ in messages_of(self.out)[harness.NODE + "/probe/wrench"]]

    def test_the_messages_are_the_nodes(self):
        self.replay_bag()
        recorded = messages_of(self.out)
        self.assertEqual(set(recorded), set(TYPES) | {harness.NODE + "/markers"})
        with harness.node(harness.SCENE):
            listeners = {topic: harness.Listener(topic, kind) for topic, kind in TYPES.items()}
            markers = harness.Listener(harness.NODE + "/markers", MarkerArray)
            harness.JointSource().send_all(self.samples)
            for topic, listener in listeners.items():
                wanted = [bytes_of(message) for message, _ in recorded[topic]]
                got = listener.wait(lambda all, count=len(wanted): len(all) >= count, "as many messages as in the bag")
                self.assertEqual([bytes_of(message) for message in got], wanted, topic)
            shown = [bytes_of(message) for message, _ in recorded[harness.NODE + "/markers"]]
            # The node shows the scene once more, to whom has just subscribed.
            got = markers.wait(lambda all: len(all) >= len(shown) + 1, "the markers")
            self.assertEqual([bytes_of(message) for message in got[-len(shown):]], shown)

    def test_it_is_in_time_with_the_bag_played_and_always_the_same(self):
        self.replay_bag()
        with open(self.out, "rb") as stream:
            first = hashlib.sha256(stream.read()).digest()
        for messages in messages_of(self.out).values():
            for message, recorded in messages:
                stamped = message.header if hasattr(message, "header") else getattr(message, message.__slots__[0])[0].header
                self.assertEqual(recorded, stamped.stamp + rospy.Duration(5))
        self.replay_bag()
        with open(self.out, "rb") as stream:
            self.assertEqual(hashlib.sha256(stream.read()).digest(), first)
        with rosbag.Bag(self.out) as bag:
            latched = {c.topic for c in bag._get_connections() if c.header.get("latching") in (b"1", "1")}
        self.assertEqual(latched, {harness.NODE + "/block/topology"})

    def test_a_player_shows_the_latched_topology_late(self):
        self.replay_bag()
        with harness.running([harness.program_of("rosbag", "play"), "--quiet", "--keep-alive", self.out]):
            harness.Listener(harness.NODE + "/probe/wrench", WrenchStamped).wait(len, "the first wrench")
            late = harness.Listener(harness.NODE + "/block/topology", TissueTopology)
            self.assertEqual(late.wait(len, "the latched topology")[0].tissue, "block")

    def test_meshes_that_change_are_recorded_with_their_topologies(self):
        harness.write_bag(self.bag, harness.press_and_drag(20))
        self.replay_bag(scene=self.refined_scene())
        recorded = messages_of(self.out)
        nodes = {m.revision: len(m.rest_positions) for m, _ in recorded[harness.NODE + "/block/topology"]}
        self.assertGreater(len(nodes), 1)
        for mesh, _ in recorded[harness.NODE + "/block/mesh"]:
            self.assertEqual(len(mesh.positions), nodes[mesh.revision])

    def test_a_recording_that_begins_in_contact_is_told(self):
        """Only of --from it was: the same part as a bag of its own gave the same forces without a word."""
        bag = self.bag_of("late.bag", self.samples[25:50])
        self.assertIn("touches tissue where the recording begins", self.replayed(harness.SCENE, bag, self.path("late.csv")))
        (start, (x, y, _)), down = self.samples[0], [0.0, -0.0005, -0.001]
        just = [(start + rospy.Duration(0.01 * i), (x, y, -0.001 + z)) for i, z in enumerate(down)]  # the ball hangs 1 mm above the block
        self.assertNotIn("touches tissue where", self.replayed(harness.SCENE, self.bag_of("just.bag", just), self.path("just.csv")))

    def test_a_part_of_the_recording(self):
        errors = self.replay_bag("--csv", self.path("part.csv"), "--from", "0.04", "--duration", "0.2")
        self.assertIn("begins 0.04 s into the recording with undeformed tissue", errors)
        wanted = [stamp for stamp, _ in self.samples[4:25]]
        self.assertEqual(self.stamps(), wanted)
        self.assertEqual([row[0] for row in harness.read_csv(self.path("part.csv"))], [harness.stamp_text(s) for s in wanted])
        self.assertNotIn("touches tissue where", errors)
        self.assertIn("touches tissue where --from begins", self.replay_bag("--from", "0.25"))
        self.replay_bag("--duration", "0.05")
        self.assertEqual(self.stamps(), [stamp for stamp, _ in self.samples[:6]])
        self.replay_bag("--from", "0.5", "--duration", "1000")
        self.assertEqual(self.stamps(), [stamp for stamp, _ in self.samples[50:]])
        # What there is before does not count: as if the recording began there.
        harness.write_bag(self.path("rest.bag"), self.samples[4:25])
        self.replayed(harness.SCENE, self.path("rest.bag"), self.path("rest.csv"))
        self.assertEqual(harness.read_csv(self.path("part.csv")), harness.read_csv(self.path("rest.csv")))

    def test_what_cannot_be_is_refused(self):
        for options, words in [(["--from", "5"], ["--from 5", "last only 0.59 s"]), (["--from", "-1"], ["--from", "'-1'"]),
                               (["--duration", "0"], ["--duration", "'0'"]), (["--csv", self.out], ["--csv", "--out"]),
                               (["--from", "0.015", "--duration", "0.001"], ["no joint state was recorded"])]:
            with self.subTest(options=options):
                code, errors = self.run_replay(*options)
                self.assertEqual(code, 1, errors)
                for word in words:
                    self.assertIn(word, errors.splitlines()[-1])
        self.assertEqual(sorted(os.listdir(self.directory)), ["press.bag"])
        os.rename(self.bag, self.out + ".partial")
        code, errors = self.run_replay(bag=self.out + ".partial")
        self.assertEqual(code, 1, errors)
        self.assertIn("is the same file as --bag", errors)

    def test_plots(self):
        self.replay_bag("--plot", self.path("plots"))
        self.assertEqual(sorted(os.listdir(self.path("plots"))), ["probe_force.png", "probe_friction.png"])
        for name in os.listdir(self.path("plots")):
            with open(os.path.join(self.path("plots"), name), "rb") as stream:
                self.assertEqual(stream.read(8), b"\x89PNG\r\n\x1a\n")
        code, errors = self.run_replay("--plot", self.write("file", BEFORE))
        self.assertEqual(code, 1, errors)
        self.assertIn("plot_forces.py", errors)
        self.assertEqual(len(self.stamps()), 60)

    def test_an_early_end_leaves_a_part_that_says_so(self):
        long_bag = self.bag_of("long.bag", harness.press(60000, depth_m=0.002))
        for number in [signal.SIGINT, signal.SIGTERM]:
            with self.subTest(signal=number):
                self.write("out.bag", BEFORE)
                child = subprocess.Popen([harness.program("tissue_contact_replay"), "--scene", harness.SCENE, "--bag", long_bag,
                                          "--out", self.out, "--dump-step", "5", "--dump-file", self.path("begun")],
                                         stderr=subprocess.PIPE, universal_newlines=True)
                harness.wait_until(lambda: os.path.exists(self.path("begun")) or child.poll() is not None, "its first steps")
                child.send_signal(number)
                _, errors = child.communicate(timeout=harness.DEADLINE_S)
                self.assertEqual(child.returncode, -number, errors)
                self.assertRegex(errors.splitlines()[-1], "ended after .* s of 599.99 s; what was recorded is in '.*/out.bag.partial'")
                with open(self.out, encoding="ascii") as stream:
                    self.assertEqual(stream.read(), BEFORE)
                wrenches = messages_of(self.out + ".partial")[harness.NODE + "/probe/wrench"]
                self.assertGreater(len(wrenches), 1)
                self.assertLess(len(wrenches), 60000)
                os.remove(self.out + ".partial")
                os.remove(self.path("begun"))

    def test_a_failure_leaves_a_part_and_nothing_where_it_failed_to_write(self):
        # Behind the first joint states, the recording is damaged.
        harness.write_bag(self.bag, harness.press(200), chunk_threshold=2000, compression="bz2")
        with open(self.bag, "r+b") as stream:
            data = stream.read()
            stream.seek(data.rindex(b"BZh9") + 20)
            stream.write(b"damaged" * 4)
        code, errors = self.run_replay()
        self.assertEqual(code, 1, errors)
        self.assertIn("the file is damaged", errors)
        self.assertFalse(os.path.exists(self.out))
        self.assertGreater(len(messages_of(self.out + ".partial")[harness.NODE + "/probe/wrench"]), 100)

    def test_a_bag_cut_off_names_what_is_left(self):
        harness.write_bag(self.bag, harness.press(200), chunk_threshold=2000)
        os.truncate(self.bag, os.path.getsize(self.bag) // 2)
        code, errors = self.run_replay()
        self.assertEqual(code, 1, errors)
        self.assertRegex(errors, r"it is cut off; \d+ whole chunks, recorded until 100\d\.\d{9} s, can be recovered: `rosbag reindex`")
        self.assertEqual(os.listdir(self.directory), ["press.bag"])
        until = float(errors.split("recorded until ")[1].split()[0])
        self.assertEqual(harness.run(["rosbag", "reindex", self.bag])[0], 0)
        self.replay_bag()
        self.assertAlmostEqual(self.stamps()[-1].to_sec(), until, delta=0.11)  # of a chunk whose index is lost, too


if __name__ == "__main__":
    harness.main(ReplayBag)
