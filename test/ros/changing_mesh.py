#!/usr/bin/python3
"""Meshes that change while they are published: who comes late gets the newest topology, and nobody gets two revisions mixed."""
import subprocess
import unittest

from visualization_msgs.msg import MarkerArray

import harness
from tissue_contact.msg import TissueMesh, TissueTopology

BLOCK = harness.NODE + "/block/"


class ChangingMesh(unittest.TestCase):
    def setUp(self):
        command = [harness.program("changing_mesh"), "__name:=tissue_contact"]
        self.publisher = subprocess.Popen(command, stdin=subprocess.PIPE, universal_newlines=True)
        self.addCleanup(self.end)
        self.meshes = harness.Listener(BLOCK + "mesh", TissueMesh)

    def end(self):
        self.publisher.stdin.close()
        try:
            self.assertEqual(self.publisher.wait(harness.DEADLINE_S), 0)
        finally:
            self.publisher.kill()
            self.meshes.close()

    def show(self, *revisions):
        """Waits for the last of their meshes."""
        for revision in revisions:
            self.publisher.stdin.write("%d\n" % revision)
        self.publisher.stdin.flush()
        self.meshes.wait(lambda all: all and all[-1].revision == revisions[-1], "a mesh of revision %d" % revisions[-1])

    def test_who_comes_late_gets_the_newest_topology(self):
        self.show(0, 1, 2)
        late = harness.Listener(BLOCK + "topology", TissueTopology)
        newest = late.wait(len, "the latched message")[0]
        self.assertEqual(newest.revision, 2)
        self.assertEqual(newest.rest_positions, self.meshes.messages[-1].positions)
        self.show(2, 3)
        late.wait(lambda all: all[-1].revision == 3, "the topology of the next mesh")
        self.assertEqual([t.revision for t in late.messages], [2, 3])
        late.close()

    def test_no_two_revisions_are_mixed(self):
        topologies = harness.Listener(BLOCK + "topology", TissueTopology)
        markers = harness.Listener(harness.NODE + "/markers", MarkerArray)
        shown = [0, 0, 1, 3, 3, 4, 6]
        for revision in shown:
            self.show(revision)
        topologies.wait(lambda all: len(all) >= 5, "the topologies")
        markers.wait(lambda all: len(all) >= len(shown), "the markers")
        self.assertEqual([t.revision for t in topologies.messages], sorted(set(shown)))
        of_revision = {t.revision: t for t in topologies.messages}
        self.assertEqual(len({len(t.rest_positions) for t in topologies.messages}), 4)
        meshes = self.meshes.messages
        self.assertEqual([m.revision for m in meshes], shown)
        for mesh, array in zip(meshes, markers.messages):
            topology = of_revision[mesh.revision]
            self.assertLessEqual(topology.header.stamp, mesh.header.stamp)
            self.assertEqual(mesh.positions, topology.rest_positions)
            self.assertEqual(array.markers[0].points, [mesh.positions[i] for i in topology.surface_triangles])
        topologies.close()
        markers.close()


if __name__ == "__main__":
    harness.main(ChangingMesh)
