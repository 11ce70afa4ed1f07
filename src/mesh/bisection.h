/// @file
/// Room `mesh`, private: tetrahedral meshes refined by bisection of longest edges. A mesh and how long edges may be where in; a
/// conforming mesh out that holds all nodes of the first, and for each new one the edge in the middle of which it lies.
///
/// A tetrahedron that is too long is cut in two through the middle of its longest edge, together with all others around that
/// edge, once it is the longest of each of them; those with a longer one are cut first (longest-edge propagation: Rivara and
/// Levin, Communications in Applied Numerical Methods 8, 1992). How a tetrahedron is cut depends on its edges alone, so
/// that the meshes of different limits are nested: a place that two of them cut equally far has the same elements in both. Three
/// cuts halve a cell of six tetrahedra (makeBlockMesh(), BlockSplit::kSix) into cells of the same kind, so that their shapes
/// stay three whatever the depth (Maubach, SIAM Journal on Scientific Computing 16, 1995); of other meshes nothing is proven, in
/// practice they stay near those at the start.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {

/// The longest edge that a tetrahedron with its centroid there may have, m; > 0.
using EdgeLimit = std::function<double(const Vector3&)>;
/// A tetrahedron of the unrefined mesh, or a part of one.
struct ElementPart {
  std::array<Vector3, 4> corners;  ///< m
  bool at_surface;                 ///< whether one of its faces lies there
  std::size_t unrefined;           ///< index of that tetrahedron
};
/// Likewise the longest edge that it may have.
using PartLimit = std::function<double(const ElementPart&)>;

struct BisectedMesh {
  TetMesh mesh;                   ///< nodes of the unrefined mesh first, in its order
  std::vector<Triangle> surface;  ///< boundaryTriangles() of it
  /// Of each further node the two, both before it, in the middle between which it lies.
  std::vector<std::array<int, 2>> parents;
  int lasting = 0;  ///< how many of these, the first, every mesh has: Bisection::refineLasting()
  /// Groups of neighbouring tetrahedra as patchesByFaces() makes them. Where two limits make the same elements they are the same.
  std::vector<int> patch_of;
  /// Per tetrahedron, and per surface triangle: centroid of the one of the mesh with lasting cuts alone that it is a part of, m. Regions
  /// are decided by these, so that they do not change with the mesh.
  NodalVectors element_places, surface_places;

  int unrefinedNodes() const { return static_cast<int>(mesh.positions.cols()) - static_cast<int>(parents.size()); }
};

/// Centroids of a tetrahedron or outer face that lasting cuts have made, and of the one of the unrefined mesh that it is a part of, m.
struct LastingPart {
  Vector3 part, whole;
};

/// Keeps its memory from call to call.
class Bisection {
 public:
  /// @param base a mesh that checkTetMesh() passes.
  /// @param patch_of of its tetrahedra.
  Bisection(const TetMesh& base, const std::vector<int>& patch_of);

  /// From now on every mesh has these cuts, before its own: until no tetrahedron has an edge beyond the limit.
  /// @return false, and there are none, if that would take more than `most_nodes` nodes.
  bool refineLasting(const PartLimit& limit, std::size_t most_nodes);

  std::vector<LastingPart> lastingParts() const;

  /// Refines the unrefined mesh, its lasting cuts kept, until no tetrahedron has an edge beyond the limit at its centroid.
  /// @return false, with `result` as it was, if that would take more than `most_nodes` nodes.
  bool refine(const EdgeLimit& limit, std::size_t most_nodes, BisectedMesh& result);

  int unrefinedNodes() const { return static_cast<int>(base_nodes_); }

 private:
  struct Element {
    Tetrahedron nodes;
    std::array<int, 2> longest;  ///< its longest edge, lower node first
    double squared_m2;           ///< length of that
    int first_child = -1;        ///< of two that follow one another; -1: not cut
    int place;                   ///< of element_places_: of the one, uncut or lasting, that it is a part of
    /// Of the face opposite to node i: likewise of triangle_places_; -1: a tetrahedron lies beyond.
    std::array<int, 4> outer;
    int leaves = 1;  ///< scratch: of the mesh, into which it has been cut
  };
  void start();
  std::array<Vector3, 4> corners(const Element& element) const;
  template <typename LimitOf>
  bool cutBeyond(const LimitOf& limit_of, std::size_t most_nodes);
  int add(const Tetrahedron& nodes, int place, const std::array<int, 4>& outer);
  void nameParts();
  bool comesBefore(const std::array<int, 2>& a, const std::array<int, 2>& b) const;
  void findLongest(Element& element) const;
  Vector3 centroid(const Element& element) const;
  Vector3 faceCentroid(const Element& element, std::size_t opposite) const;
  bool cut(int element, std::size_t most_nodes);
  int firstWithLonger(const std::array<int, 2>& edge);
  void cutRing(const std::array<int, 2>& edge);
  void countLeaves();
  void write(BisectedMesh& result);
  void writePatches(int root, BisectedMesh& result);
  void writeLeaves(int element, int patch, BisectedMesh& result);
  void joinSmall(int small, int other, BisectedMesh& result);

  std::size_t base_nodes_;
  std::size_t base_triangles_ = 0;
  std::vector<Vector3> element_places_;   ///< centroids, m: of the unrefined mesh, then of what lasting cuts made
  std::vector<Vector3> triangle_places_;  ///< likewise of the surface
  std::vector<int> whole_elements_, whole_triangles_;  ///< of the latter: that of the unrefined mesh
  std::vector<int> base_patch_of_;
  std::vector<std::vector<int>> base_patches_;    ///< their elements
  std::size_t lasting_nodes_, lasting_elements_;  ///< with the unrefined ones
  std::vector<Vector3> x_;
  std::vector<std::array<int, 2>> parents_;                ///< of nodes beyond the unrefined ones
  std::vector<Element> elements_;                          ///< unrefined ones first; children after their parents
  std::vector<std::vector<int>> uncut_at_;                 ///< per node: elements of the mesh as it is, ascending
  std::vector<int> ring_, waiting_;                        ///< scratch
  int patches_ = 0;                                        ///< written so far
  std::vector<int> element_place_of_, triangle_place_of_;  ///< of what is written so far
};

}  // namespace tissue_contact
