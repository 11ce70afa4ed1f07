#!/usr/bin/python3
"""Wrenches, topology (latched, once for each mesh), mesh, contacts, status, markers and tf: what they hold and how often they come."""
import unittest

import rospy
from geometry_msgs.msg import WrenchStamped
from roscpp.srv import GetLoggers, SetLoggerLevel
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

import faults
import harness
from tissue_contact.msg import ContactArray, ContactPoint, Status, TissueMesh, TissueTopology

NODE = "/tissue_contact/"
ACCEPTED = "joint states: accepted"
RATES_HZ = {"block/mesh": 20, "contacts": 50, "status": 10}  # of test/ros/press.yaml


class Topics(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.samples = harness.press(200)  # 2 s of message time
        cls.last = cls.samples[-1][0]
        listeners = {name: harness.Listener(NODE + name, kind) for name, kind in [
            ("probe/wrench", WrenchStamped), ("block/mesh", TissueMesh), ("contacts", ContactArray), ("status", Status),
            ("markers", MarkerArray), ("block/topology", TissueTopology)]}
        tf = harness.Listener("/tf", TFMessage)
        diagnostics = harness.diagnostics()
        source = harness.JointSource()
        for first in range(0, len(cls.samples), 10):  # at their pace: all at once, a busy machine drops what is only to be seen
            source.send_all(cls.samples[first:first + 10])
            rospy.sleep(0.1)
        cls.wrenches = listeners["probe/wrench"].wait_for_stamp(cls.last)
        for name, rate in RATES_HZ.items():
            listeners[name].wait(lambda all, count=2 * rate: len(all) >= count, "2 s of messages")
        newest = rospy.Duration.from_sec(0.11)  # markers come every 0.1 s
        listeners["block/topology"].wait(len, "the topology")
        listeners["markers"].wait(lambda all: all and cls.last - all[-1].markers[0].header.stamp < newest, "the end")
        cls.transforms = tf.wait(lambda all: all and all[-1].transforms[0].header.stamp == cls.last, "the last transform")
        cls.diagnostics = diagnostics.wait(lambda all: all and faults.figures(all[-1]).get(ACCEPTED) == "200", "200 states")[-1]
        cls.listeners = listeners

    def stamps(self, name):
        return [m.header.stamp for m in self.listeners[name].messages]

    def test_rates_are_of_message_time(self):
        for name, rate in RATES_HZ.items():
            stamps = self.stamps(name)
            self.assertEqual(len(stamps), 2 * rate, name)
            self.assertEqual(stamps[0], self.samples[0][0], name)
            self.assertEqual(stamps, sorted(stamps), name)
        # One more than by rate: the scene as it was is shown to whoever subscribes.
        self.assertEqual(len(self.listeners["markers"].messages), 21)

    def test_a_wrench_for_every_joint_state(self):
        self.assertEqual([w.header.stamp for w in self.wrenches], [stamp for stamp, _ in self.samples])
        self.assertEqual({w.header.frame_id for w in self.wrenches}, {"tip"})
        self.assertTrue(all(map(harness.is_finite, self.wrenches)))
        first, deepest, last = [self.wrenches[i].wrench.force for i in [0, 100, -1]]
        self.assertEqual(first.z, 0.0)
        # The tissue pushes the probe up; 5 mm into 5 kPa is a few tenths of a newton.
        self.assertGreater(deepest.z, 0.05)
        self.assertLess(deepest.z, 2.0)
        self.assertLess(deepest.x, 0.0)  # dragged in +x, so friction pulls the probe back
        self.assertAlmostEqual(last.z, 0.0, delta=1e-9)

    def test_every_mesh_has_its_topology(self):
        nodes = {t.revision: len(t.rest_positions) for t in self.listeners["block/topology"].messages}
        self.assertEqual(len(nodes), len(self.listeners["block/topology"].messages))
        for mesh in self.listeners["block/mesh"].messages:
            self.assertEqual(len(mesh.positions), nodes[mesh.revision])

    def test_topology_is_latched_and_published_once(self):
        late = harness.Listener(NODE + "block/topology", TissueTopology)
        topology = late.wait(len, "the latched message")[0]
        self.assertEqual(topology.header.stamp, self.samples[0][0])
        self.assertEqual(topology.header.frame_id, "world")
        self.assertEqual(topology.tissue, "block")
        self.assertEqual(topology.revision, 0)
        nodes = len(topology.rest_positions)
        self.assertEqual(nodes, 7 * 7 * 3)
        self.assertEqual(len(topology.tetrahedra), 4 * 5 * 6 * 6 * 2)
        self.assertLess(max(topology.tetrahedra), nodes)
        self.assertEqual(len(topology.surface_triangles), 3 * 2 * (2 * 36 + 4 * 12))
        self.assertEqual([i for i, p in enumerate(topology.rest_positions) if abs(p.z) < 1e-12],
                         sorted(topology.fixed_nodes))
        first = self.listeners["block/mesh"].messages[0]
        self.assertEqual(first.positions, topology.rest_positions)
        self.assertEqual(first.tissue, "block")
        self.assertEqual(first.step, 0)
        pressed = self.listeners["block/mesh"].messages[20]
        self.assertGreater(max(r.z - p.z for r, p in zip(topology.rest_positions, pressed.positions)), 0.001)
        again = harness.Listener(NODE + "block/topology", TissueTopology)
        self.assertEqual(again.wait(len, "the latched message"), [topology])
        self.assertEqual(late.messages, [topology])

    def test_contacts_add_up_to_the_wrench(self):
        wrench_at = {w.header.stamp: w.wrench for w in self.wrenches}
        states = set()
        for message in self.listeners["contacts"].messages:
            self.assertEqual(message.header.frame_id, "world")
            for axis in "xyz":  # the probe's tip keeps the world's axes
                felt = -sum(getattr(c.force, axis) for c in message.contacts)
                self.assertAlmostEqual(felt, getattr(wrench_at[message.header.stamp].force, axis), delta=1e-9)
            for c in message.contacts:
                self.assertEqual((c.instrument, c.link, c.tissue), ("probe", "tip", "block"))
                self.assertAlmostEqual(c.normal.x ** 2 + c.normal.y ** 2 + c.normal.z ** 2, 1.0, delta=1e-9)
                self.assertLess(c.normal.z, 0.0)  # from the probe down into the tissue
                states.add(c.state)
        self.assertIn(ContactPoint.KINETIC, states)

    def test_loggers_are_listed_more_than_once(self):
        """rosconsole's own service ends the process at the second call."""
        level_of = rospy.ServiceProxy(NODE + "get_loggers", GetLoggers)
        set_level = rospy.ServiceProxy(NODE + "set_logger_level", SetLoggerLevel)
        for level in ["warn", "error", "info"]:
            set_level("ros.tissue_contact", level)
            levels = {logger.name: logger.level for logger in level_of().loggers}
            self.assertEqual(levels["ros.tissue_contact"], level)
            self.assertEqual(levels["ros.roscpp"], "info")

    def test_status(self):
        last = self.listeners["status"].messages[-1]
        self.assertEqual(last.joint_states_accepted, 191)
        self.assertEqual(last.joint_states_refused, 0)
        self.assertEqual((last.resets, last.gaps), (0, 0))
        self.assertGreaterEqual(last.substeps, 5)  # 10 ms in steps of at most 2 ms
        self.assertGreaterEqual(last.step, 190 * 5)
        self.assertGreater(last.step_time, 0.0)
        self.assertLess(last.step_time, 1.0)

    def test_status_tells_the_strain_under_the_tool(self):
        """A 5 mm ball, 5 mm deep in corotational tissue, is out of that law's range, and over it before it touches."""
        messages = self.listeners["status"].messages
        self.assertEqual((messages[0].strain, messages[0].law_error), (0.0, 0.0))
        worst = min(messages, key=lambda m: m.law_error)
        self.assertGreater(worst.strain, 0.1)
        self.assertLess(worst.law_error, -0.05)
        self.assertGreater(worst.law_error, -0.5)
        figures = faults.figures(self.diagnostics)
        self.assertLessEqual(float(figures["largest law error, likely"]), worst.law_error + 1e-3)

    def test_status_tells_how_wrong_the_force_likely_is(self):
        messages = self.listeners["status"].messages
        wrench_at = {w.header.stamp: w.wrench for w in self.listeners["probe/wrench"].messages}
        for message in messages:
            self.assertEqual([e.instrument for e in message.force_errors], ["probe"])
            error = message.force_errors[0]
            force = wrench_at[message.header.stamp].force
            self.assertAlmostEqual(error.force, (force.x ** 2 + force.y ** 2 + force.z ** 2) ** 0.5, delta=1e-12)
            self.assertTrue(error.knows_mesh)
            self.assertAlmostEqual(error.error, (error.mesh ** 2 + error.step ** 2 + error.solver ** 2) ** 0.5, delta=1e-12)
        self.assertEqual(messages[0].force_errors[0].error, 0.0)  # nothing touches yet
        pressed = max((m.force_errors[0] for m in messages), key=lambda e: e.force)
        self.assertGreater(pressed.mesh, 0.2 * pressed.force)  # cells as wide as the ball
        self.assertLess(pressed.error, pressed.force)
        figures = faults.figures(self.diagnostics)
        self.assertEqual(figures["likely force error: instrument"], "probe")
        self.assertGreater(float(figures["largest likely force error_n"]), 0.0)

    def test_markers(self):
        for message in self.listeners["markers"].messages:
            self.assertEqual({m.header.frame_id for m in message.markers}, {"world"})
        pressed = self.listeners["markers"].messages[11].markers
        self.assertEqual({m.ns for m in pressed}, {"block", "probe", "probe/tip", "contact_forces", "force_texts", "legend"})
        surface = [m for m in pressed if m.ns == "block" and m.id == 0][0]
        self.assertEqual(surface.type, Marker.TRIANGLE_LIST)
        self.assertEqual(len(surface.points), 3 * 2 * (2 * 36 + 4 * 12))
        self.assertEqual(len(surface.colors), len(surface.points))
        self.assertGreater(len({(c.r, c.g, c.b) for c in surface.colors}), 10)
        self.assertEqual({m.type for m in pressed if m.ns == "contact_forces"}, {Marker.ARROW})

    def test_tf_leads_from_the_world_to_the_tip(self):
        self.assertEqual(len(self.transforms), 200)
        for (stamp, position), message in zip(self.samples, self.transforms):
            self.assertEqual({t.header.stamp for t in message.transforms}, {stamp})
            parents = {t.child_frame_id: t for t in message.transforms}
            frame, x, y, z = "tip", 0.0, 0.0, 0.0
            while frame != "world":
                transform = parents[frame]
                self.assertEqual(transform.transform.rotation.w, 1.0)
                x += transform.transform.translation.x
                y += transform.transform.translation.y
                z += transform.transform.translation.z
                frame = transform.header.frame_id
            self.assertAlmostEqual(x, position[0], delta=1e-12)
            self.assertAlmostEqual(y, position[1], delta=1e-12)
            self.assertAlmostEqual(z, 0.026 + position[2], delta=1e-12)

    def test_diagnostics(self):
        status = self.diagnostics.status[0]
        values = faults.figures(self.diagnostics)
        if "late" not in status.message:  # two seconds of motion are sent at once: a slow machine lags
            self.assertEqual(status.level, 0, status)
        self.assertEqual(values[ACCEPTED], "200")
        self.assertEqual(values["resets"], "0")


if __name__ == "__main__":
    harness.main(Topics)
