#include "contact/narrow_phase.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "contact/conforming_gap.h"
#include "contact/contact_direction.h"
#include "contact/tolerances.h"
#include "contact/vertex_contact.h"

namespace tissue_contact {

void NarrowPhase::makeRoom(const MovingSurface& surface) {
  nodes_.resize(std::max(nodes_.size(), static_cast<std::size_t>(surface.nodeCount())));
  normals_.resize(std::max(normals_.size(), surface.triangles().size()));
}

void NarrowPhase::findContacts(const ShapeDistance& shape, const Pose& X_WS, const MovingSurface& surface,
                               const std::vector<int>& candidates, double margin, std::vector<ShapeContact>& contacts,
                               const ShapesBeside* beside) {
  call_ = {&shape, &surface, X_WS.linear().transpose(), X_WS.translation(), margin + surface.halfThickness(),
           beside, &contacts};
  ++call_index_;
  makeRoom(surface);
  contacts.clear();
  for (const int triangle : candidates) {
    const TrianglePoints points = trianglePoints(triangle);
    if (certainlyFar(triangle, points)) continue;
    addClosest(triangle, points, shape.hasFlatParts() ? addCorners(triangle, points) : 0.0);
  }
  mergeAndSort();
}

const Vector3& NarrowPhase::nodePosition(int node) {
  NodeCache& cache = nodes_[node];
  if (cache.placed != call_index_) {
    cache.placed = call_index_;
    // Coordinates relative to the shape first: its origin may be far from the world's.
    cache.p_S.noalias() = call_.R_SW * (call_.surface->positions().col(node) - call_.p_WS);
  }
  return cache.p_S;
}

const Vector3& NarrowPhase::triangleNormalOf(int triangle) {
  NormalCache& cache = normals_[triangle];
  if (cache.computed != call_index_) {
    cache.computed = call_index_;
    const Triangle& nodes = call_.surface->triangles()[triangle];
    cache.normal_S = triangleNormal(nodePosition(nodes[0]), nodePosition(nodes[1]), nodePosition(nodes[2]));
  }
  return cache.normal_S;
}

TrianglePoints NarrowPhase::trianglePoints(int triangle) {
  const Triangle& nodes = call_.surface->triangles()[triangle];
  TrianglePoints points;
  points.corners = {nodePosition(nodes[0]), nodePosition(nodes[1]), nodePosition(nodes[2])};
  points.normal = triangleNormalOf(triangle);
  return points;
}

/// Of vertices that certainlyFar() has measured.
std::array<double, 3> NarrowPhase::vertexDistances(int triangle) const {
  const Triangle& nodes = call_.surface->triangles()[triangle];
  return {nodes_[nodes[0]].distance, nodes_[nodes[1]].distance, nodes_[nodes[2]].distance};
}

/// Distance of a tissue vertex, and its contact if it has one.
const NarrowPhase::NodeCache& NarrowPhase::measureVertex(int triangle, int corner) {
  NodeCache& cache = nodes_[call_.surface->triangles()[triangle][corner]];
  if (cache.measured == call_index_) return cache;
  cache.measured = call_index_;
  const SignedDistance here = call_.shape->at(cache.p_S);
  cache.distance = here.distance;
  const int node = call_.surface->triangles()[triangle][corner];
  const auto position = [this](int other) -> const Vector3& { return nodePosition(other); };
  const auto normal = [this](int other) -> const Vector3& { return triangleNormalOf(other); };
  const VertexContact vertex(*call_.shape, *call_.surface, node, position, normal);
  const bool is_near = here.distance <= call_.margin;
  const SignedDistance left = is_near ? vertex.leaves(here, call_.beside) : here;
  const bool touches = add(triangle, Vector3::Unit(corner), -1, left.normal, left.distance);
  if (touches && left.normal == here.normal) {
    ShapeContact& contact = call_.contacts->back();
    const Vector3 gradient_W = contact.normal_W;
    contact.normal_W = call_.R_SW.transpose() * vertex.meanNormal(here.normal);
    contact.lean_W = contact.normal_W - gradient_W;
  }
  cache.contact_gap = touches ? left.distance : std::numeric_limits<double>::infinity();
  return cache;
}

/// Distances change by no more than the way between the points, so far vertices may rule out the whole triangle.
bool NarrowPhase::certainlyFar(int triangle, const TrianglePoints& points) {
  bool far = false;
  for (int i = 0; i < 3; ++i) {
    const Vector3& p = points.corners[i];
    const double reach = std::sqrt(
        std::max((points.corners[(i + 1) % 3] - p).squaredNorm(), (points.corners[(i + 2) % 3] - p).squaredNorm()));
    far |= measureVertex(triangle, i).distance - reach > call_.margin;
  }
  return far;
}

/// Contacts of the shape's foremost corners that project on the triangle. Returns the smallest gap among them.
double NarrowPhase::addCorners(int triangle, const TrianglePoints& points) {
  double lowest = std::numeric_limits<double>::infinity();
  if (points.normal.isZero(0.0)) return lowest;
  // A sheet is met from the side on which the shape's middle is.
  const bool from_below =
      !call_.surface->isVolume() && points.normal.dot(call_.shape->boxCentre() - points.corners[0]) < 0.0;
  const Vector3 forward = from_below ? points.normal : -points.normal;
  Eigen::AlignedBox3d reach;
  for (const Vector3& p : points.corners) {
    reach.extend(p - call_.margin * forward);
    reach.extend(p + call_.shape->cornerReach() * forward);
  }
  call_.shape->foremostCorners(forward, reach, corners_);
  for (const ShapeCorner& corner : corners_) {
    const double gap = forward.dot(points.corners[0] - corner.p_S);
    if (!(gap <= call_.margin && gap >= -call_.shape->cornerReach())) continue;
    const Vector3 foot = corner.p_S + gap * forward;
    const Vector3 weights = snapped(projectOnTriangle(points.corners, foot));
    const double beside = (points.pointAt(weights) - foot).norm();
    if (beside > kTouch * call_.shape->size()) {
      if (beside < -gap) lowest = std::min(lowest, addCornerInFold(triangle, corner));
      continue;
    }
    if (add(triangle, weights, corner.index, forward, gap)) lowest = std::min(lowest, gap);
  }
  return lowest;
}

/// Under a valley of the surface projections on its triangles leave a hole: a corner below all triangles around an edge
/// or vertex that is their nearest point, each of them. It is pushed back along the mean of their normals. Returns its
/// gap.
double NarrowPhase::addCornerInFold(int triangle, const ShapeCorner& corner) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (!call_.surface->isVolume()) return kNone;
  const auto nearest = [&](int other) { return snapped(projectOnTriangle(trianglePoints(other).corners, corner.p_S)); };
  const Vector3 weights = nearest(triangle);
  const SurfaceFeature feature = call_.surface->featureOf(triangle, weights);
  const Vector3 p = trianglePoints(triangle).pointAt(weights);
  Vector3 outward = Vector3::Zero();
  const bool elsewhere = call_.surface->anyTriangleOf(feature, [&](int other) {
    outward += triangleNormalOf(other);
    return triangleNormalOf(other).dot(corner.p_S - p) >= 0.0 ||
           call_.surface->featureOf(other, nearest(other)) != feature;
  });
  if (elsewhere || outward.isZero(0.0)) return kNone;
  outward.normalize();
  const double gap = outward.dot(corner.p_S - p);
  if (!add(triangle, weights, corner.index, -outward, gap)) return kNone;
  return gap;
}

void NarrowPhase::addClosest(int triangle, const TrianglePoints& points, double flush_gap) {
  ClosestPoint closest;
  if (!call_.shape->closest(points, call_.margin, closest)) return;
  Vector3 weights = snapped(closest.weights);
  if (call_.surface->isHeld(call_.surface->triangles()[triangle], weights)) {
    if (!findClosestBesideHeld(triangle, points, closest)) return;
    weights = snapped(closest.weights);
  }
  const SurfaceFeature feature = call_.surface->featureOf(triangle, weights);
  if (feature[1] < 0) return;  // a vertex: measureVertex() has it
  SignedDistance direction = contactDirection(closest, tangentOf(points, weights));
  if (!closest.beyond_rim) {
    const ConformingGap conforming =
        conformingGap(points.corners, vertexDistances(triangle), weights, closest.distance);
    if (conforming.fully) return;
    direction.distance += conforming.gap - closest.distance;
  }
  if (call_.shape->hasFlatParts()) {
    const double lowest = std::min(flush_gap, lowestVertexGap(feature));
    if (direction.distance >= lowest - kFlush * call_.shape->size()) return;
  }
  add(triangle, weights, -1, direction.normal, direction.distance);
}

/// Where the nearest point is held, the nearest that is not lies on the line where points begin to be: distances to a convex shape grow
/// from there on.
bool NarrowPhase::findClosestBesideHeld(int triangle, const TrianglePoints& points, ClosestPoint& closest) {
  Matrix3 weights;
  if (!call_.surface->findHeldLine(triangle, weights)) return false;
  TrianglePoints part;
  for (int i = 0; i < 3; ++i) part.corners[i] = points.pointAt(weights.col(i));
  part.normal = points.normal;
  if (!call_.shape->closest(part, call_.margin, closest)) return false;
  closest.weights = weights * snapped(closest.weights);
  return true;
}

double NarrowPhase::lowestVertexGap(const SurfaceFeature& feature) const {
  double lowest = std::numeric_limits<double>::infinity();
  for (const int node : feature) {
    if (node >= 0) lowest = std::min(lowest, nodes_[node].contact_gap);
  }
  return lowest;
}

bool NarrowPhase::add(int triangle, const Vector3& weights, int corner, const Vector3& normal_S, double gap) {
  if (!(gap <= call_.margin)) return false;
  ShapeContact contact;
  contact.feature = call_.surface->featureOf(triangle, weights);
  if (call_.surface->isHeld(call_.surface->triangles()[triangle], weights)) return false;
  const auto faces = [&](int other) { return normal_S.dot(triangleNormalOf(other)) < -kFacing; };
  if (call_.surface->isVolume() && !call_.surface->anyTriangleOf(contact.feature, faces)) return false;

  const Triangle& own = call_.surface->triangles()[triangle];
  call_.surface->anyTriangleOf(contact.feature, [&](int first) {
    contact.nodes = call_.surface->triangles()[first];
    return true;
  });
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (contact.nodes[i] == own[k]) contact.weights[i] = weights[k];
    }
  }
  contact.corner = corner;
  contact.normal_W = (call_.R_SW.transpose() * normal_S).normalized();
  contact.gap = gap - call_.surface->halfThickness();
  call_.contacts->push_back(contact);
  return true;
}

/// One contact per feature and corner: the one of smallest gap, whatever order the triangles came in.
void NarrowPhase::mergeAndSort() {
  std::vector<ShapeContact>& contacts = *call_.contacts;
  const auto key = [](const ShapeContact& c) { return std::tie(c.feature, c.corner); };
  const auto order = [](const ShapeContact& c) {
    return std::tie(c.feature, c.corner, c.gap, c.weights[0], c.weights[1], c.weights[2]);
  };
  std::sort(contacts.begin(), contacts.end(),
            [&](const ShapeContact& a, const ShapeContact& b) { return order(a) < order(b); });
  const auto same = [&](const ShapeContact& a, const ShapeContact& b) { return key(a) == key(b); };
  contacts.erase(std::unique(contacts.begin(), contacts.end(), same), contacts.end());
}

}  // namespace tissue_contact
