#include "mesh/shell_notes.h"

#include <cstddef>
#include <sstream>

#include "core/disjoint_sets.h"
#include "mesh/coincident_nodes.h"

namespace tissue_contact {

std::vector<std::string> shellNotes(const TriangleMesh& mesh) {
  std::vector<std::string> notes;
  const NearNodes near = findNearNodes(mesh);
  if (near.count > 0) {
    const Vector3 one = mesh.vertices.col(near.one);
    std::ostringstream text;
    text << near.count
         << " nodes of its border lie nearer to others than a hundredth of the edges there and are not joined with "
            "them, "
            "the first "
         << (mesh.vertices.col(near.other) - one).norm() << " m away at (" << one.x() << ", " << one.y() << ", "
         << one.z()
         << ") m: the shell is cut open there; if it is one, merge them in the program that made it (Blender: Merge by "
            "Distance)";
    notes.push_back(text.str());
  }
  DisjointSets joined(static_cast<std::size_t>(mesh.vertices.cols()));
  for (const Triangle& t : mesh.triangles) {
    for (const int other : {t[1], t[2]}) joined.join(t[0], other);
  }
  std::size_t parts = 0;
  for (int node = 0; node < static_cast<int>(mesh.vertices.cols()); ++node) parts += joined.first(node) == node ? 1 : 0;
  if (parts > 1) {
    notes.push_back(std::to_string(parts) + " parts that share no node: each is held only by what is fixed of it");
  }
  return notes;
}

}  // namespace tissue_contact
