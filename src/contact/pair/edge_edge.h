/// @file
/// Room `contact`: edges of one tissue surface crossing edges of another, where no vertex is nearest.
///
/// A crossing counts when
///  - the nearest points lie inside both edges, and neither surface comes nearer beside its edge (n leads away from the
///    triangles next to it, within kSharp);
///  - the edges are sharp enough to matter: both are the rim of something or one is a ridge. A flat edge crossing
///    another flat edge or a rim is covered by vertices on faces; without this, flat surfaces lying on each other would
///    have a contact at every crossing of their grids. A crossing goes on to count until it is farther away
///    than the margin, however flat: where what presses makes the edges flat, they would let go and sink in in turn, and
///    the force swing from step to step.
///  - where they penetrate, no end of an edge is nearer than the depth: that end has a shorter way out.
#pragma once

#include <vector>

#include "contact/pair/surface_pair.h"

namespace tissue_contact {

/// Scratch memory that grows to what is needed.
class EdgeEdge {
 public:
  /// Appends contacts of pair.own's edges with pair.other's edges, unsorted, some twice.
  /// @param known contacts of the step before, of these surfaces and of others.
  void find(const SurfacePair& pair, const std::vector<ContactKey>& known, std::vector<Contact>& contacts);

 private:
  using Edge = EdgeTable::Edge;

  /// Nearest points of two edges, which lie inside both.
  struct Crossing {
    double u, v;       ///< parameters along the edge of own and of other, in (0, 1)
    Vector3 normal;    ///< unit, square to both edges, from other into own
    double distance;   ///< m, along the normal
    double to_an_end;  ///< m, along either edge
  };

  void collectNear(const SurfacePair& pair, MovingSurface& surface, const Edge& edge, MovingSurface& among);
  static void test(const SurfacePair& pair, const Edge& own, const Edge& other, bool is_known,
                   std::vector<Contact>& contacts);
  static bool cross(const SurfacePair& pair, const Edge& own, const Edge& other, Crossing& crossing);
  static bool orient(const SurfacePair& pair, const Edge& own, const Edge& other, Crossing& crossing);

  std::vector<int> triangles_;
  std::vector<int> near_;  ///< edges
};

}  // namespace tissue_contact
