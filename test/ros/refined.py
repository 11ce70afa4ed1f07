#!/usr/bin/python3
"""A mesh that follows the tool, through the node: each mesh with its topology, the same wrenches however it is shown, and what is said when
it may have no more nodes."""
import math

import faults
import harness
from tissue_contact.msg import TissueMesh, TissueTopology

BLOCK = harness.NODE + "/block/"
UNREFINED_NODES = 7 * 7 * 3


class Refined(harness.TestCase):
    def setUp(self):
        super().setUp()
        self.samples = harness.press_and_drag()

    def run_of(self, *parameters):
        """(topologies, meshes, bits of all wrenches) of a node that plays the samples."""
        last = self.samples[-1][0]
        with harness.node(self.refined_scene(), *parameters):
            topologies = harness.Listener(BLOCK + "topology", TissueTopology)
            meshes = harness.Listener(BLOCK + "mesh", TissueMesh)
            wrenches = harness.wrenches()
            harness.JointSource().send_all(self.samples)
            bits = [harness.wrench_bits(w) for w in wrenches.wait(lambda all: len(all) >= len(self.samples), "all wrenches")]
            shown = meshes.wait(lambda all: all and (last - all[-1].header.stamp).to_sec() < 0.05, "the last mesh")  # 20 Hz
            known = topologies.wait(lambda all: {m.revision for m in shown} <= {t.revision for t in all}, "their topologies")
            for listener in [topologies, meshes, wrenches]:
                listener.close()
        return known, shown, bits

    def assert_whole(self, topology):
        nodes = len(topology.rest_positions)
        for indices in [topology.tetrahedra, topology.surface_triangles, topology.fixed_nodes]:
            self.assertGreater(len(indices), 0)
            self.assertLess(max(indices), nodes)
            self.assertGreaterEqual(min(indices), 0)
        self.assertEqual(set(topology.tetrahedra), set(range(nodes)))
        self.assertEqual((len(topology.tetrahedra) % 4, len(topology.surface_triangles) % 3), (0, 0))
        self.assertTrue(all(math.isfinite(value) for p in topology.rest_positions for value in (p.x, p.y, p.z)))

    def assert_belong_together(self, topologies, meshes):
        """Revisions grow, each topology is whole, each mesh is of one."""
        revisions = [t.revision for t in topologies]
        self.assertEqual(revisions, sorted(set(revisions)))
        for topology in topologies:
            self.assert_whole(topology)
        nodes = {t.revision: len(t.rest_positions) for t in topologies}
        shown = [m.revision for m in meshes]
        self.assertEqual(shown, sorted(shown))
        for mesh in meshes:
            self.assertEqual(len(mesh.positions), nodes[mesh.revision])
            self.assertTrue(all(math.isfinite(value) for p in mesh.positions for value in (p.x, p.y, p.z)))

    def test_the_mesh_follows_and_showing_it_unrefined_changes_no_wrench(self):
        topologies, meshes, wrenches = self.run_of()
        self.assert_belong_together(topologies, meshes)
        self.assertGreater(len(set(m.revision for m in meshes)), 3)
        self.assertEqual(meshes[0].revision, 0)
        self.assertEqual(len(meshes[0].positions), UNREFINED_NODES)
        self.assertGreater(len(meshes[-1].positions), 2 * UNREFINED_NODES)
        self.assertGreater(len(set(wrenches)), 30)  # not all zero

        topologies, unrefined, same_wrenches = self.run_of("_publish_mesh:=unrefined")
        self.assert_belong_together(topologies, unrefined)
        self.assertEqual([t.revision for t in topologies], [0])
        self.assertEqual({m.revision for m in unrefined}, {0})
        self.assertEqual({len(m.positions) for m in unrefined}, {UNREFINED_NODES})
        self.assertEqual(same_wrenches, wrenches)
        shown = {m.header.stamp: m.positions for m in meshes}
        for mesh in unrefined:  # its nodes are the first of the refined mesh
            if mesh.header.stamp in shown:
                self.assertEqual(mesh.positions, shown[mesh.header.stamp][:UNREFINED_NODES])

    def test_a_mesh_that_may_have_no_more_nodes_says_so(self):
        samples = self.samples[:20]
        with harness.node(self.refined_scene("{cell_m: 0.0015, nodes_at_most: 250}")) as node:
            diagnostics = harness.diagnostics()
            wrenches = harness.wrenches()
            source = harness.JointSource()
            source.send_all(samples)
            wrenches.wait(lambda all: len(all) >= len(samples), "all wrenches")
            told = diagnostics.wait(lambda all: any(faults.figures(m).get("intervals with such cells") == "19" for m in all),
                                    "what is said of the cells")
            for listener in [diagnostics, wrenches]:
                listener.close()
            log = harness.output_of(node)
        figures = faults.figures(told[-1])
        self.assertGreater(float(figures["refined cells, times longer than asked for"]), 1.3)
        self.assertGreaterEqual(float(figures["largest of that"]), float(figures["refined cells, times longer than asked for"]))
        words = ["tissue 'block': cells are ", "Raise tissues[].refinement.nodes_at_most"]
        summaries = [status for status in (faults.status_named(m, "tissue contact") for m in told) if status]
        if not any("late" in status.message for status in summaries):  # on a slow machine, which comes first
            warned = [status.message for status in summaries if status.level == faults.WARN]
            self.assertTrue(any(all(word in message for word in words) for message in warned), summaries)
        self.assertEqual(log.count(words[1]), 1, log)


if __name__ == "__main__":
    harness.main(Refined)
