#include "contact/pair/vertex_face.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "contact/tolerances.h"
#include "mesh/surface/triangle_geometry.h"

namespace tissue_contact {
namespace {

/// Of the size: a vertex this near to an edge or a vertex touches it, whatever the direction between them, which may
/// be mostly a small sideways shift. The surfaces' normals then give the contact normal.
constexpr double kTouching = 1e-3;

/// Of the size: points nearer to each other are one. Above kSnapWeight, by which each may have been moved.
constexpr double kSamePoint = 1e-8;

SurfacePoint vertexPoint(int node) { return {{node, node, node}, Vector3::UnitX()}; }

/// Whether triangles around the vertex face something whose contact normal is `n`.
bool faces(MovingSurface& surface, int node, const Vector3& n) {
  return !surface.isVolume() ||
         surface.anyTriangleOf(vertexFeature(node), [&](int t) { return n.dot(surface.normal(t)) < -kFacing; });
}

/// Whether the triangles around a feature lead away from the point `p` on it, or at least along, in direction `n`.
bool leadsAway(const MovingSurface& surface, const SurfaceFeature& feature, const Vector3& p, const Vector3& n) {
  return !surface.anyTriangleOf(feature, [&](int t) {
    const Triangle& nodes = surface.triangles()[t];
    return std::any_of(nodes.begin(), nodes.end(), [&](int node) {
      const Vector3 along = surface.x(node) - p;
      const double rise = n.dot(along);
      return rise < 0.0 && rise * rise > kSharp * kSharp * along.squaredNorm();
    });
  });
}

/// The contact normal where a vertex touches an edge or a vertex of another volume: the mean of those triangle normals
/// from which both surfaces lead away. Swapping the two turns it round. Zero: they do not face each other there.
Vector3 touchingNormal(MovingSurface& own, int node, MovingSurface& other, const SurfaceFeature& feature,
                       const Vector3& foot) {
  const auto flat = [](MovingSurface& surface, const SurfaceFeature& of, const Vector3& n) {
    return !surface.anyTriangleOf(of, [&](int t) { return n.dot(surface.normal(t)) < 1.0 - 0.5 * kSharp * kSharp; });
  };
  Vector3 between = (other.featureNormal(feature) - own.featureNormal(vertexFeature(node))).normalized();
  if (flat(other, feature, between) && flat(own, vertexFeature(node), -between)) return between;
  Vector3 sum = Vector3::Zero();
  const auto offer = [&](const Vector3& n) {
    const bool faces_own = other.anyTriangleOf(feature, [&](int t) { return n.dot(other.normal(t)) > kFacing; });
    if (faces_own && faces(own, node, n) && leadsAway(own, vertexFeature(node), own.x(node), n) &&
        leadsAway(other, feature, foot, -n)) {
      sum += n;
    }
    return false;
  };
  other.anyTriangleOf(feature, [&](int t) { return offer(other.normal(t)); });
  own.anyTriangleOf(vertexFeature(node), [&](int t) { return offer(-own.normal(t)); });
  return sum.normalized();
}

}  // namespace

void VertexFace::find(const SurfacePair& pair, bool swapped, std::vector<Contact>& contacts) {
  Eigen::AlignedBox3d near = pair.other.box();
  near.min().array() -= pair.reach();
  near.max().array() += pair.reach();
  for (const int node : pair.own.nodes()) {
    const Vector3 p = pair.own.x(node);
    if (!near.contains(p) || search(pair, node, pair.reach(), swapped, contacts)) continue;
    const bool may_be_inside = pair.other.isVolume() && pair.other.box().contains(p);
    if (may_be_inside && pair.depth() > pair.reach()) search(pair, node, pair.depth(), swapped, contacts);
  }
}

/// @returns whether looking farther than `reach` could find nothing else.
bool VertexFace::search(const SurfacePair& pair, int node, double reach, bool swapped, std::vector<Contact>& contacts) {
  findFeet(pair, node, reach);
  findMinima(pair, node);
  if (minima_.empty()) return false;
  const double round_off = kTouch * pair.size();
  const Foot& nearest = minima_.front();
  const bool inside = nearest.distance < -round_off;
  const bool on_surface = std::abs(nearest.distance) <= kTouching * pair.size() && pair.other.isVolume() &&
                          !faces(pair.own, node, nearest.normal);
  if (inside || on_surface) {
    const Foot* const way_out = wayOut(pair, node, on_surface);
    if (way_out != nullptr) add(pair, node, *way_out, swapped, contacts);
    return way_out != nullptr;
  }
  for (const Foot& foot : minima_) {
    const bool near = foot.distance >= -round_off && foot.distance - pair.apart() <= pair.margin;
    if (near && faces(pair.own, node, foot.normal) &&
        leadsAway(pair.own, vertexFeature(node), pair.own.x(node), foot.normal)) {
      add(pair, node, foot, swapped, contacts);
    }
  }
  return true;
}

/// The nearest foot that the vertex faces from inside, null if there is none.
const VertexFace::Foot* VertexFace::wayOut(const SurfacePair& pair, int node, bool on_surface) {
  if (on_surface) {
    for (Foot& foot : feet_) {
      if (measureBehindFace(pair, node, foot)) minima_.push_back(foot);
    }
  }
  const Foot* best = nullptr;
  for (const Foot& foot : minima_) {
    if (foot.distance < 0.0 && foot.distance >= -pair.depth() && faces(pair.own, node, foot.normal) &&
        (best == nullptr || foot.distance > best->distance)) {
      best = &foot;
    }
  }
  return best;
}

void VertexFace::findFeet(const SurfacePair& pair, int node, double reach) {
  const Vector3 p = pair.own.x(node);
  const Vector3 around = Vector3::Constant(reach);
  pair.other.overlapping({Vector3(p - around), Vector3(p + around)}, candidates_);
  feet_.clear();
  for (const int t : candidates_) {
    const Triangle& nodes = pair.other.triangles()[t];
    if (pair.folds() && (nodes[0] == node || nodes[1] == node || nodes[2] == node)) continue;
    const Vector3 weights =
        snapped(projectOnTriangle({pair.other.x(nodes[0]), pair.other.x(nodes[1]), pair.other.x(nodes[2])}, p));
    const Vector3 q = SurfacePoint{nodes, weights}.in(pair.other.positions());
    const double distance = (q - p).norm();
    if (distance <= reach) feet_.push_back({t, pair.other.featureOf(t, weights), weights, q, distance});
  }
}

void VertexFace::findMinima(const SurfacePair& pair, int node) {
  const auto order = [](const Foot& foot) {
    return std::make_tuple(foot.feature[2] >= 0, foot.feature[1] >= 0, foot.feature, foot.triangle);
  };
  minima_.clear();
  for (const Foot& foot : feet_) {
    const auto same =
        std::find_if(minima_.begin(), minima_.end(), [&](const Foot& one) { return coincide(pair, one, foot); });
    if (same != minima_.end() && order(*same) < order(foot)) continue;
    if (!isMinimum(pair, foot)) continue;
    if (same == minima_.end()) {
      minima_.push_back(foot);
    } else {
      *same = foot;
    }
  }
  const auto measured = [&](Foot& foot) { return measure(pair, node, foot); };
  minima_.erase(std::partition(minima_.begin(), minima_.end(), measured), minima_.end());
  std::sort(minima_.begin(), minima_.end(), [](const Foot& a, const Foot& b) {
    return std::make_tuple(std::abs(a.distance), a.feature) < std::make_tuple(std::abs(b.distance), b.feature);
  });
}

/// Whether the foot is the nearest point of every triangle around its feature.
bool VertexFace::isMinimum(const SurfacePair& pair, const Foot& foot) const {
  return !pair.other.anyTriangleOf(foot.feature, [&](int t) {
    const auto near = std::lower_bound(feet_.begin(), feet_.end(), t,
                                       [](const Foot& one, int triangle) { return one.triangle < triangle; });
    return near == feet_.end() || near->triangle != t || !coincide(pair, *near, foot);
  });
}

/// Not features but points are compared: round-off may put one point on an edge for one triangle, and just beside it
/// for the next.
bool VertexFace::coincide(const SurfacePair& pair, const Foot& a, const Foot& b) {
  const double reach = kSamePoint * pair.size();
  return (a.q - b.q).squaredNorm() <= reach * reach;
}

/// Measures a foot from the face it was found on. False: the vertex is not straight above or below that face.
bool VertexFace::measureBehindFace(const SurfacePair& pair, int node, Foot& foot) {
  const SurfacePoint point{pair.other.triangles()[foot.triangle], foot.weights};
  if (pair.nearAtRest(vertexPoint(node), point)) return false;
  const Vector3 offset = pair.own.x(node) - foot.q;
  foot.normal = pair.other.normal(foot.triangle);
  foot.distance = foot.normal.dot(offset);
  return (offset - foot.distance * foot.normal).norm() <= kTouching * pair.size();
}

/// Sets the contact normal and gives the distance its sign, < 0: behind the surface. False: no contact can be here.
bool VertexFace::measure(const SurfacePair& pair, int node, Foot& foot) {
  const SurfacePoint point{pair.other.triangles()[foot.triangle], foot.weights};
  if (pair.nearAtRest(vertexPoint(node), point)) return false;
  const Vector3 outward = pair.other.featureNormal(foot.feature);
  if (outward.isZero(0.0)) return false;
  const Vector3 offset = pair.own.x(node) - foot.q;
  const bool on_face = foot.feature[2] >= 0;
  const bool touching = foot.distance <= kTouching * pair.size();
  foot.normal = outward;
  if (!on_face && !touching) {
    foot.normal = (offset.dot(outward) < 0.0 ? -1.0 : 1.0) / foot.distance * offset;
  } else if (!on_face && pair.own.isVolume() && pair.other.isVolume()) {
    const Vector3 normal = touchingNormal(pair.own, node, pair.other, foot.feature, foot.q);
    if (!normal.isZero(0.0)) foot.normal = normal;
  }
  foot.distance = foot.normal.dot(offset);
  if (pair.other.isVolume()) return true;
  bool turn = foot.distance < 0.0;
  if (pair.own.isVolume() && std::abs(foot.distance) <= pair.apart()) {
    turn = foot.normal.dot(pair.own.featureNormal(vertexFeature(node))) > 0.0;
  }
  if (turn) {
    foot.normal = -foot.normal;
    foot.distance = -foot.distance;
  }
  return true;
}

void VertexFace::add(const SurfacePair& pair, int node, const Foot& foot, bool swapped,
                     std::vector<Contact>& contacts) {
  const bool at_vertex = foot.feature[1] < 0;
  if (!at_vertex) {
    const SurfacePoint point{pair.other.triangles()[foot.triangle], foot.weights};
    pair.add(vertexFeature(node), vertexPoint(node), foot.feature, point, foot.normal, foot.distance, contacts);
    return;
  }
  // Two vertices find each other from both sides; the same words from both make it one contact.
  const int theirs = foot.feature[0];
  if (pair.folds() ? node < theirs : !swapped) {
    pair.add(vertexFeature(node), vertexPoint(node), foot.feature, vertexPoint(theirs), foot.normal, foot.distance,
             contacts);
  } else {
    const SurfacePair mirrored{pair.other, pair.own, pair.margin};
    mirrored.add(foot.feature, vertexPoint(theirs), vertexFeature(node), vertexPoint(node), -foot.normal, foot.distance,
                 contacts);
  }
}

}  // namespace tissue_contact
