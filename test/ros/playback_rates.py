#!/usr/bin/python3
"""A bag gives the same bits at any playback rate, through the node and offline."""
import harness


class PlaybackRates(harness.TestCase):
    def test_node_and_replay_agree_to_the_last_bit(self):
        samples = harness.press(200, start_s=1644257420)
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
            self.assertGreater(len({bits for _, _, bits in rows}), 50)  # not all zero
            digests["replay, %s time" % run] = harness.digest((stamp, bits) for stamp, _, bits in rows)
        self.assertEqual(tables[0], tables[1])
        for rate in [0.5, 1, 5]:
            digests["node, rate %g" % rate] = harness.digest(harness.play_through_node(
                harness.SCENE, bag, harness.TOPIC, "probe", len(samples), rate))
        self.assertEqual(len(set(digests.values())), 1, digests)

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
