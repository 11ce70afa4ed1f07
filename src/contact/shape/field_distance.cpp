#include "contact/shape/field_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "contact/shape/field_surface.h"
#include "contact/shape/lowest_on_triangle.h"
#include "contact/tolerances.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kDrawnTriangles = 6000;  // 0.4 MB of a marker

/// Of the point of the grid's box nearest to p and of some on the faces of the box that p sees, the one by way of which the mesh is nearest.
Vector3 bestStart(const DistanceGrid& grid, const Vector3& p) {
  constexpr int kCuts = 20;  // of a face, each way
  const Eigen::AlignedBox3d box = grid.box();
  Vector3 best = p.cwiseMax(box.min()).cwiseMin(box.max());
  double least = (p - best).norm() + grid.valueAt(best);
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] >= box.min()[axis] && p[axis] <= box.max()[axis]) continue;
    const int other[2] = {(axis + 1) % 3, (axis + 2) % 3};
    Vector3 q;
    q[axis] = p[axis] < box.min()[axis] ? box.min()[axis] : box.max()[axis];
    for (int i = 0; i <= kCuts; ++i) {
      q[other[0]] = box.min()[other[0]] + i * box.sizes()[other[0]] / kCuts;
      for (int j = 0; j <= kCuts; ++j) {
        q[other[1]] = box.min()[other[1]] + j * box.sizes()[other[1]] / kCuts;
        const double there = (p - q).norm() + grid.valueAt(q);
        if (!(there < least)) continue;
        least = there;
        best = q;
      }
    }
  }
  return best;
}

}  // namespace

FieldDistance::FieldDistance(std::shared_ptr<const MeshField> field)
    : field_(std::move(field)),
      centre_(0.5 * (field_->low + field_->high)),
      half_(0.5 * (field_->high - field_->low)),
      size_(half_.maxCoeff()),
      is_turned_(!field_->R_SG.isIdentity(0.0)) {}

Vector3 FieldDistance::halfExtents(const Matrix3& R_WS) const {
  if (!is_turned_) return R_WS.cwiseAbs() * half_;
  const Matrix3 R_WG = R_WS * field_->R_SG;
  return R_WG.cwiseAbs() * half_;
}

Vector3 FieldDistance::boxCentre() const { return is_turned_ ? Vector3(field_->R_SG * centre_) : centre_; }

const TriangleMesh* FieldDistance::drawn() const {
  if (drawn_) return &*drawn_;
  drawn_ = fieldSurface(field_->grid, kDrawnTriangles);
  if (is_turned_) drawn_->vertices = NodalVectors(field_->R_SG * drawn_->vertices);
  return &*drawn_;
}

SignedDistance FieldDistance::at(const Vector3& p_S) const {
  if (!p_S.allFinite()) return {std::numeric_limits<double>::quiet_NaN(), Vector3::UnitX()};
  GridSample here = field_->grid.at(is_turned_ ? Vector3(field_->R_SG.transpose() * p_S) : p_S);
  if (is_turned_) here.gradient = Vector3(field_->R_SG * here.gradient);
  const double length = here.gradient.norm();
  constexpr double kNone = 1e-9;  // deepest inside: every direction is as good as another
  return {here.distance, length > kNone ? Vector3(here.gradient / length) : Vector3::UnitX()};
}

SignedDistance FieldDistance::atAnyDistance(const Vector3& p_S) const {
  const Eigen::AlignedBox3d box = field_->grid.box();
  const Vector3 p = is_turned_ ? Vector3(field_->R_SG.transpose() * p_S) : p_S;
  if (!p.allFinite() || box.contains(p)) return at(p_S);
  // To the mesh it is |p - q| and from there the grid's distance for the q on the grid's border that makes that least. From a point of the
  // mesh to the q on the way to it, and on to the mesh's point nearest to q: never farther.
  constexpr int kMostWays = 100;
  constexpr double kLeastGain = 1e-4;  // spacings
  double least = std::numeric_limits<double>::infinity();
  Vector3 normal_G = Vector3::UnitX();
  Vector3 q = bestStart(field_->grid, p);
  for (int way = 0; way < kMostWays; ++way) {
    const GridSample here = field_->grid.at(q);
    const Vector3 nearest = q - here.distance * here.gradient.normalized();
    const double distance = (p - nearest).norm();
    if (!(distance < least - kLeastGain * field_->grid.spacing)) break;
    least = distance;
    normal_G = (p - nearest) / distance;
    double share = 0.0;  // of the way from p on that lies before the box
    for (int axis = 0; axis < 3; ++axis) {
      const double border = p[axis] < box.min()[axis] ? box.min()[axis] : box.max()[axis];
      const bool is_beyond = p[axis] < box.min()[axis] || p[axis] > box.max()[axis];
      if (is_beyond) share = std::max(share, (border - p[axis]) / (nearest[axis] - p[axis]));
    }
    q = (p + share * (nearest - p)).cwiseMax(box.min()).cwiseMin(box.max());
  }
  return {least, is_turned_ ? Vector3(field_->R_SG * normal_G) : normal_G};
}

void FieldDistance::foremostCorners(const Vector3& forward, const Eigen::AlignedBox3d& box,
                                    std::vector<ShapeCorner>& corners) const {
  corners.clear();
  for (std::size_t i = 0; i < field_->tips.size(); ++i) {
    const MeshTip& tip = field_->tips[i];
    const auto rises = [&](const Vector3& edge) { return forward.dot(edge) > kCornerSlope; };
    if (!box.contains(tip.p_S) || std::any_of(tip.edges.begin(), tip.edges.end(), rises)) continue;
    corners.push_back({static_cast<int>(i), tip.p_S});
  }
}

bool FieldDistance::closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const {
  if (!is_turned_) return closestInGrid(triangle, margin, result);
  const Matrix3& R_SG = field_->R_SG;
  const TrianglePoints turned(R_SG.transpose() * triangle.corners[0], R_SG.transpose() * triangle.corners[1],
                              R_SG.transpose() * triangle.corners[2]);
  if (!closestInGrid(turned, margin, result)) return false;
  GradientSet gradients;
  for (int i = 0; i < result.gradients.count(); ++i) gradients.add(R_SG * result.gradients[i]);
  result.gradients = gradients;
  return true;
}

bool FieldDistance::closestInGrid(const TrianglePoints& triangle, double margin, ClosestPoint& result) const {
  Eigen::AlignedBox3d around;
  for (const Vector3& p : triangle.corners) around.extend(p);
  const Eigen::AlignedBox3d box(Vector3(centre_ - half_), Vector3(centre_ + half_));
  if (!(around.exteriorDistance(box) <= margin)) return false;
  const double reach = triangle.normal.cwiseAbs().dot(half_) + margin;
  if (std::abs(triangle.normal.dot(centre_ - triangle.corners[0])) > reach) return false;
  return lowestOnTriangle(field_->grid, triangle, margin, result);
}

}  // namespace tissue_contact
