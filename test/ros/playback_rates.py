#!/usr/bin/python3
"""A bag gives the same bits at any playback rate, through the node and offline."""
import contextlib

import rospy
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool

import harness


class PlaybackRates(harness.TestCase):
    @contextlib.contextmanager
    def played_with_a_clock(self, bag, *options):
        """Wrenches of a node with simulated time, while `rosbag play --clock` plays."""
        rospy.set_param("/use_sim_time", True)
        try:
            with harness.node(harness.SCENE):
                wrenches = harness.wrenches()
                with harness.running([harness.program_of("rosbag", "play"), "__name:=player", "--quiet", "--clock",
                                      "--wait-for-subscribers", "--queue", "100000", *options, bag, "--topics", harness.TOPIC]):
                    yield wrenches
                wrenches.close()
        finally:
            rospy.delete_param("/use_sim_time")

    def test_node_and_replay_agree_to_the_last_bit(self):
        samples = harness.press(100, start_s=1644257420)
        bag = self.bag_of("press.bag", samples)

        digests = {}
        tables = []
        for run in ["first", "second"]:
            csv = self.path(run + ".csv")
            self.replayed(harness.SCENE, bag, csv)
            tables.append(harness.read_table(csv))
            rows = harness.read_csv(csv)
            self.assertEqual([stamp for stamp, _, _ in rows], [harness.stamp_text(stamp) for stamp, _ in samples])
            self.assertEqual({instrument for _, instrument, _ in rows}, {"probe"})
            self.assertGreater(len({bits for _, _, bits in rows}), 25)  # not all zero
            digests["replay, %s time" % run] = harness.digest((stamp, bits) for stamp, _, bits in rows)
        self.assertEqual(tables[0], tables[1])
        for rate in [0.2, 1, 10]:
            digests["node, rate %g" % rate] = harness.digest(harness.play_through_node(
                harness.SCENE, bag, harness.TOPIC, "probe", len(samples), rate))
        self.assertEqual(len(set(digests.values())), 1, digests)

    def test_simulated_time_with_a_pause_and_a_loop(self):
        """Every round has the bits of the first: the loop resets the scene, and a clock that stands still changes nothing."""
        samples = harness.press(100)
        bag = self.bag_of("press.bag", samples)
        with self.played_with_a_clock(bag, "--loop", "--rate", "2") as wrenches:
            wrenches.wait(lambda all: len(all) >= 130, "a round and a third")
            pause = rospy.ServiceProxy("/player/pause_playback", SetBool)
            self.assertTrue(pause(True).success)
            clock = harness.Listener("/clock", Clock)  # which is told on, and stands still
            clock.wait(lambda all: len(all) > 20 and len({one.clock for one in all[-20:]}) == 1, "a clock that stands still")
            clock.close()
            seen = len(wrenches.messages)
            self.assertTrue(pause(False).success)
            wanted = 100 * (seen // 100 + 3)  # the round of the pause, however far it was, and two more
            got = wrenches.wait(lambda all: len(all) >= wanted, "two rounds after the pause")[:wanted]
        rounds = [[(w.header.stamp, harness.wrench_bits(w)) for w in got[i:i + 100]] for i in range(0, wanted, 100)]
        self.assertEqual([stamp for stamp, _ in rounds[0]], [stamp for stamp, _ in samples])
        self.assertTrue(any(any(bits) for _, bits in rounds[0]))
        for later in rounds[1:]:
            self.assertEqual(later, rounds[0])

    def test_simulated_time_at_any_rate(self):
        samples = harness.press(100)
        bag = self.bag_of("press.bag", samples)
        self.replayed(harness.SCENE, bag, self.path("replay.csv"))
        expected = [(stamp, bits) for stamp, _, bits in harness.read_csv(self.path("replay.csv"))]
        for rate in ["0.2", "10"]:
            with self.played_with_a_clock(bag, "--rate", rate) as wrenches:
                got = wrenches.wait(lambda all: len(all) >= 100, "every wrench")
            self.assertEqual([(harness.stamp_text(w.header.stamp), harness.wrench_bits(w)) for w in got], expected, rate)

    def test_a_mesh_that_follows_the_tool_gives_the_same_bytes(self):
        samples = harness.press_and_drag(30)
        bag = self.bag_of("drag.bag", samples)
        scene = self.refined_scene()
        tables = []
        for run in ["first.csv", "second.csv"]:
            self.replayed(scene, bag, self.path(run))
            with open(self.path(run), "rb") as stream:
                tables.append(stream.read())
        self.assertEqual(tables[0], tables[1])
        rows = harness.read_csv(self.path("first.csv"))
        self.assertGreater(len({bits for _, _, bits in rows}), 20)  # not all zero
        self.replayed(harness.SCENE, bag, self.path("unrefined.csv"))
        self.assertNotEqual(harness.read_csv(self.path("unrefined.csv")), rows)
        played = harness.play_through_node(scene, bag, harness.TOPIC, "probe", len(samples), 5)
        self.assertEqual(played, [(stamp, bits) for stamp, _, bits in rows])


if __name__ == "__main__":
    harness.main(PlaybackRates)
