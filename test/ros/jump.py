#!/usr/bin/python3
"""An instrument that is suddenly a kilometre away, and back: placed, not swept; said in Status and CSV; all finite."""
import math

import faults
import harness
from tissue_contact.msg import Status, TissueMesh

AWAY = 40  # joint states with the instrument away: after one while pressing
BACK = 60


class Jump(harness.TestCase):
    def setUp(self):
        super().setUp()
        # A message for every joint state.
        self.scene = self.changed_scene({"status_rate_hz: 10": "status_rate_hz: 100", "mesh_rate_hz: 20": "mesh_rate_hz: 100"})
        self.samples = [(stamp, (position[0] + 1e3, position[1], position[2]) if AWAY <= i < BACK else position)
                        for i, (stamp, position) in enumerate(harness.press(100))]

    def assert_all_finite(self, values):
        values = list(values)
        self.assertGreater(len(values), 0)
        self.assertEqual([v for v in values if not math.isfinite(v)], [])

    def test_replay(self):
        out = self.path("jump.csv")
        errors = self.replayed(self.scene, self.bag_of("jump.bag", self.samples), out)
        self.assertIn("2 jumps", errors)
        rows = harness.read_table(out)
        self.assertEqual([i for i, row in enumerate(rows) if row["jumped"] == "1"], [AWAY, BACK])
        self.assertEqual({row["jumped"] for row in rows}, {"0", "1"})
        self.assertEqual({row["discarded"] for row in rows}, {"0"})
        self.assert_all_finite(float(value) for row in rows for key, value in row.items() if key != "instrument")
        self.assertGreater(float(rows[AWAY - 1]["force_z_n"]), 0.05)
        self.assertEqual({float(row["force_z_n"]) for row in rows[AWAY:BACK]}, {0.0})

    def test_node(self):
        with harness.node(self.scene):
            wrenches = harness.wrenches()
            statuses = harness.Listener("/tissue_contact/status", Status)
            meshes = harness.Listener("/tissue_contact/block/mesh", TissueMesh)
            diagnostics = harness.diagnostics()
            source = harness.JointSource()
            for stamp, position in self.samples:  # one by one: a status or mesh may be dropped by a full queue
                source.send(stamp, position)
                for listener in [wrenches, statuses, meshes]:
                    listener.wait_for_stamp(stamp)

            def told(messages):
                return bool(messages) and faults.figures(messages[-1]).get("jumps") == "2"
            diagnostics.wait(told, "two jumps")
        self.assertEqual([i for i, status in enumerate(statuses.messages) if status.jumped], [AWAY, BACK])
        self.assertFalse(any(status.discarded for status in statuses.messages))
        self.assertEqual(len(wrenches.messages), len(self.samples))
        self.assert_all_finite(value for w in wrenches.messages for value in harness.wrench_of(w))
        self.assert_all_finite(getattr(p, axis) for m in meshes.messages for p in m.positions for axis in "xyz")
        self.assert_all_finite(getattr(status, name) for status in statuses.messages for name in [
            "momentum_residual", "penetration", "adhesion", "complementarity", "cone_violation", "static_slip",
            "kinetic_angle"])


if __name__ == "__main__":
    harness.main(Jump)
