/// @file
/// Room `contact`: vertices of one tissue surface against the faces of another.
///
/// A vertex touches where its distance to the other surface has a local minimum: inside a face, or on an edge or a
/// vertex if that is the nearest point of every triangle around it. So a vertex over a flat part has one contact
/// wherever it is, none with the edges beside it that it could catch on, and two in a corner between two faces.
///
/// Which of them count:
///  - From outside, the vertex must be where its own surface is nearest too: the surface leads away from the contact,
///    within kSharp. Else the tip of one surface would catch on the vertices of a flat one that it slides along.
///  - The nearest minimum tells whether the vertex lies inside a volume. Outside, all within the margin count; inside,
///    only the nearest one that it faces: one way out is enough.
///  - A vertex on the surface of a volume that it does not face there may have come in elsewhere, as where the sides of
///    two blocks are flush and one has sunk into the other: through any face that it is behind but for round-off.
///  - A volume's vertex faces what some triangle around it faces (contact normal . triangle normal < -kFacing), which
///    rules out the far side of a thin layer. A sheet faces both ways.
///  - A sheet holds a vertex on the side it lies on; a volume's vertex, whose normal tells the side, also when it has
///    come half the thickness through.
#pragma once

#include <vector>

#include "contact/pair/surface_pair.h"

namespace tissue_contact {

/// Scratch memory that grows to what is needed.
class VertexFace {
 public:
  /// Appends contacts of pair.own's vertices with pair.other's faces, unsorted.
  /// @param swapped the pair is the mirror image of the one asked for: a vertex at a vertex is turned round then, to
  ///   have the same key from both sides.
  void find(const SurfacePair& pair, bool swapped, std::vector<Contact>& contacts);

 private:
  /// The point of a triangle nearest to the vertex.
  struct Foot {
    int triangle;
    SurfaceFeature feature;
    Vector3 weights;
    Vector3 q;                         ///< m, world frame
    double distance;                   ///< m, >= 0, until measure() gives it a sign
    Vector3 normal = Vector3::Zero();  ///< from the other surface to the vertex's, unit
  };

  bool search(const SurfacePair& pair, int node, double reach, bool swapped, std::vector<Contact>& contacts);
  void findFeet(const SurfacePair& pair, int node, double reach);
  void findMinima(const SurfacePair& pair, int node);
  static bool coincide(const SurfacePair& pair, const Foot& a, const Foot& b);
  bool isMinimum(const SurfacePair& pair, const Foot& foot) const;
  const Foot* wayOut(const SurfacePair& pair, int node, bool on_surface);
  static bool measureBehindFace(const SurfacePair& pair, int node, Foot& foot);
  static bool measure(const SurfacePair& pair, int node, Foot& foot);
  static void add(const SurfacePair& pair, int node, const Foot& foot, bool swapped, std::vector<Contact>& contacts);

  std::vector<int> candidates_;
  std::vector<Foot> feet_;    ///< one per triangle within reach, ascending
  std::vector<Foot> minima_;  ///< those where the distance to the surface has a local minimum, measured, nearest first
};

}  // namespace tissue_contact
