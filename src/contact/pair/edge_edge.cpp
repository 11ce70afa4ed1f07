#include "contact/pair/edge_edge.h"

#include <algorithm>
#include <cmath>

#include "contact/tolerances.h"
#include "mesh/surface/triangle_geometry.h"

namespace tissue_contact {
namespace {

using Edge = EdgeTable::Edge;

/// Sine of the angle below which two edges are parallel: they have no crossing, and their ends are what touches.
constexpr double kParallelSine = 1e-3;

SurfacePoint edgePoint(const Edge& edge, double u) {
  return {{edge.nodes[0], edge.nodes[1], edge.nodes[1]}, {1.0 - u, u, 0.0}};
}

/// Calls `visit` with the unit vector from the edge into each of the triangles beside it, square to the edge.
template <typename Visitor>
void forEachSide(const MovingSurface& surface, const Edge& edge, const Visitor& visit) {
  const Vector3 a = surface.x(edge.nodes[0]);
  const Vector3 along = (surface.x(edge.nodes[1]) - a).normalized();
  for (const EdgeUse& use : surface.edges().usesOf(edge)) {
    const Vector3 to_third = surface.x(surface.triangles()[use.triangle][(use.side + 2) % 3]) - a;
    visit(Vector3((to_third - to_third.dot(along) * along).normalized()));
  }
}

/// Whether the edge can count as sharp in some direction (see Slopes).
bool maybeSharp(MovingSurface& surface, const Edge& edge) {
  const EdgeTable::Uses sides = surface.edges().usesOf(edge);
  if (sides.size() == 1) return true;
  // Two sides at an angle of pi - a to each other have a sum of length 2 sin(a / 2), and normals of product cos a.
  const double product = surface.normal(sides[0].triangle).dot(surface.normal(sides[1].triangle));
  if (sides.size() == 2 && product >= 1.0 - 0.5 * kFlat * kFlat) return false;
  Vector3 sum = Vector3::Zero();
  forEachSide(surface, edge, [&](const Vector3& side) { sum += side; });
  if (!(sum.norm() > kFlat)) return false;
  return !surface.isVolume() || sum.dot(surface.featureNormal(edgeFeature(edge))) < 0.0;
}

/// How the surface beside an edge rises along a direction that leads away from what it touches.
struct Slopes {
  double lowest = 1.0;  ///< of the sides; > 0: the edge is a ridge, 0: there is a flat part beside it
  double sum = 0.0;     ///< over the sides; the missing side of a sheet's boundary counts as 1

  Slopes(const MovingSurface& surface, const Edge& edge, const Vector3& away) {
    forEachSide(surface, edge, [&](const Vector3& side) {
      lowest = std::min(lowest, away.dot(side));
      sum += away.dot(side);
    });
    if (edge.count == 1) sum += 1.0;
  }
  bool nearest() const { return lowest >= -kSharp; }
  bool sharp() const { return sum > kFlat; }
  bool ridge() const { return lowest > kFlat; }
};

bool shareANode(const Edge& a, const Edge& b) {
  return a.nodes[0] == b.nodes[0] || a.nodes[0] == b.nodes[1] || a.nodes[1] == b.nodes[0] || a.nodes[1] == b.nodes[1];
}

/// Not where a fold's crossing would have another key than the same crossing found from its other edge.
bool isInOrder(const SurfacePair& pair, const Edge& own, const Edge& other) {
  return !pair.folds() || own.nodes < other.nodes;
}

}  // namespace

void EdgeEdge::find(const SurfacePair& pair, const std::vector<ContactKey>& known, std::vector<Contact>& contacts) {
  for (const ContactKey& key : known) {
    if (key.tissue != pair.own.tissue() || key.other_tissue != pair.other.tissue()) continue;
    const Edge* const own = pair.own.edges().find(key.feature);
    const Edge* const other = pair.other.edges().find(key.other_feature);
    if (own == nullptr || other == nullptr) continue;
    const bool in_order = isInOrder(pair, *own, *other);  // a mesh that has changed numbers nodes anew
    test(pair, in_order ? *own : *other, in_order ? *other : *own, true, contacts);
  }
  // Every pair in which an edge is sharp, once: sharp edges of own with all of other, then the others way round with
  // those of own that are not sharp.
  for (const Edge& edge : pair.own.edges()) {
    collectNear(pair, pair.own, edge, pair.other);
    for (const int i : near_) {
      const Edge& near = pair.other.edges()[i];
      if (pair.folds() && !(edge.nodes < near.nodes) && maybeSharp(pair.own, near)) continue;
      const bool in_order = isInOrder(pair, edge, near);
      test(pair, in_order ? edge : near, in_order ? near : edge, false, contacts);
    }
  }
  if (pair.folds()) return;
  for (const Edge& edge : pair.other.edges()) {
    collectNear(pair, pair.other, edge, pair.own);
    for (const int i : near_) {
      const Edge& near = pair.own.edges()[i];
      if (!maybeSharp(pair.own, near)) test(pair, near, edge, false, contacts);
    }
  }
}

/// Fills `near_` with the edges of `among` near a sharp edge of `surface`; with none if the edge is not sharp.
void EdgeEdge::collectNear(const SurfacePair& pair, MovingSurface& surface, const Edge& edge, MovingSurface& among) {
  near_.clear();
  const Vector3 around = Vector3::Constant(std::max(pair.reach(), pair.depth()));
  const Vector3 a = surface.x(edge.nodes[0]);
  const Vector3 b = surface.x(edge.nodes[1]);
  const Eigen::AlignedBox3d box(Vector3(a.cwiseMin(b) - around), Vector3(a.cwiseMax(b) + around));
  if (!box.intersects(among.box()) || !maybeSharp(surface, edge)) return;
  among.overlapping(box, triangles_);
  for (const int t : triangles_) {
    for (const int i : among.edges().edgesOf(t)) {
      const Edge& near = among.edges()[i];
      if (among.edges().usesOf(near)[0].triangle != t) continue;
      const Vector3 c = among.x(near.nodes[0]);
      const Vector3 d = among.x(near.nodes[1]);
      if (box.intersects(Eigen::AlignedBox3d(Vector3(c.cwiseMin(d)), Vector3(c.cwiseMax(d))))) near_.push_back(i);
    }
  }
}

void EdgeEdge::test(const SurfacePair& pair, const Edge& own, const Edge& other, bool is_known,
                    std::vector<Contact>& contacts) {
  if (pair.folds() && shareANode(own, other)) return;
  Crossing crossing;
  if (!cross(pair, own, other, crossing)) return;
  const SurfacePoint on_own = edgePoint(own, crossing.u);
  const SurfacePoint on_other = edgePoint(other, crossing.v);
  if (pair.nearAtRest(on_own, on_other) || !orient(pair, own, other, crossing)) return;
  const Slopes ours(pair.own, own, crossing.normal);
  const Slopes theirs(pair.other, other, -crossing.normal);
  const bool matters = is_known || (ours.sharp() && theirs.sharp()) || ours.ridge() || theirs.ridge();
  if (!ours.nearest() || !theirs.nearest() || !matters) return;
  pair.add(edgeFeature(own), on_own, edgeFeature(other), on_other, crossing.normal, crossing.distance, contacts);
}

/// False when the edges' nearest points are not inside both or too far apart. The normal may still be turned round.
bool EdgeEdge::cross(const SurfacePair& pair, const Edge& own, const Edge& other, Crossing& crossing) {
  const Vector3 a = pair.own.x(own.nodes[0]);
  const Vector3 c = pair.other.x(other.nodes[0]);
  const Vector3 ab = pair.own.x(own.nodes[1]) - a;
  const Vector3 cd = pair.other.x(other.nodes[1]) - c;
  const Vector3 ac = c - a;
  const Vector3 square = ab.cross(cd);
  const double squared = square.squaredNorm();
  if (!(squared > kParallelSine * kParallelSine * ab.squaredNorm() * cd.squaredNorm())) return false;
  crossing.u = ac.cross(cd).dot(square) / squared;
  crossing.v = ac.cross(ab).dot(square) / squared;
  const double u_end = std::min(crossing.u, 1.0 - crossing.u);
  const double v_end = std::min(crossing.v, 1.0 - crossing.v);
  if (!(u_end > kSnapWeight && v_end > kSnapWeight)) return false;
  crossing.normal = square / std::sqrt(squared);
  crossing.distance = -crossing.normal.dot(ac);
  crossing.to_an_end = std::min(u_end * ab.norm(), v_end * cd.norm());
  return std::abs(crossing.distance) <= std::max(pair.reach(), pair.depth());
}

/// Turns the normal from other into own. False when the surfaces do not face each other there or are too deep.
bool EdgeEdge::orient(const SurfacePair& pair, const Edge& own, const Edge& other, Crossing& crossing) {
  const Vector3 ours = pair.own.featureNormal(edgeFeature(own));
  const Vector3 theirs = pair.other.featureNormal(edgeFeature(other));
  const bool own_volume = pair.own.isVolume();
  const bool other_volume = pair.other.isVolume();
  double along = crossing.distance;  // sheets: the side they are on
  if (own_volume || other_volume) {
    along = (other_volume ? crossing.normal.dot(theirs) : 0.0) - (own_volume ? crossing.normal.dot(ours) : 0.0);
  } else if (std::abs(along) <= kTouch * pair.size()) {
    along = crossing.normal.dot(theirs);
  }
  if (along < 0.0) {
    crossing.normal = -crossing.normal;
    crossing.distance = -crossing.distance;
  }
  if (own_volume && !(crossing.normal.dot(ours) < -kFacing)) return false;
  if (other_volume && !(crossing.normal.dot(theirs) > kFacing)) return false;
  if (crossing.distance - pair.apart() > pair.margin) return false;
  const double deepest = own_volume && other_volume ? pair.depth() : pair.apart();
  return crossing.distance >= -std::min(deepest, crossing.to_an_end);
}

}  // namespace tissue_contact
