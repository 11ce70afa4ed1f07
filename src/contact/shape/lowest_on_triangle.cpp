#include "contact/shape/lowest_on_triangle.h"

#include <algorithm>
#include <array>
#include <limits>

#include "contact/shape/plane_minimum.h"

namespace tissue_contact {
namespace {

// Sampled. With 40 a needle of 1 x 1 x 40 mm on triangles of 50 mm came out up to .7 mm too high; far fewer are usual.
constexpr int kMostPieces = 400;
constexpr int kMostCuts = 12;
constexpr double kFinest = 3.0;              // spacings: smaller pieces are left to the cutting planes
constexpr double kDistanceTolerance = 0.01;  // of the spacing

/// One of the similar triangles a triangle is cut into.
struct Piece {
  Vector3 middle;  ///< barycentric
  double half;     ///< its corners are at middle + half * (2/3, -1/3, -1/3) and so on; < 0: upside down
  double value;    ///< at the middle, m
  double bound;    ///< no lower than this in it, m
};

/// Pieces to look at, those that may be lowest first.
class Queue {
 public:
  bool empty() const { return count_ == 0; }
  void push(const Piece& piece) {
    if (count_ == static_cast<int>(pieces_.size())) return;
    pieces_[count_++] = piece;
    std::push_heap(pieces_.begin(), pieces_.begin() + count_, Higher());
  }
  Piece pop() {
    std::pop_heap(pieces_.begin(), pieces_.begin() + count_, Higher());
    return pieces_[--count_];
  }

 private:
  struct Higher {
    bool operator()(const Piece& a, const Piece& b) const { return a.bound > b.bound; }
  };
  std::array<Piece, 4UL * kMostPieces> pieces_;
  int count_ = 0;
};

/// The last points met and the lowest of all; planes through them.
class Lowest {
 public:
  Lowest(const DistanceGrid& grid, const TrianglePoints& triangle)
      : grid_(grid), triangle_(triangle), tolerance_(kDistanceTolerance * grid.spacing) {}

  /// Distance at a point of the triangle. Most points are forgotten before a plane is laid through them.
  double sample(const Vector3& weights) {
    const Vector3 p = triangle_.pointAt(weights);
    const double value = grid_.valueAt(p);
    meet(weights, p, value);
    return value;
  }

  /// Cutting planes from the lowest point on. Steps stay within `reach` (m), which shrinks when they do not help. Gives up
  /// where the planes lead nowhere below `margin`.
  void descend(double reach, double margin) {
    for (int i = 0; i < count_; ++i) addPlane(i, grid_.at(triangle_.pointAt(points_[i])));
    for (int cut = 0; cut < kMostCuts; ++cut) {
      dropIdlePlanes(reach);
      const PlaneMinimum next = minimiseMaximum(planes_, tolerance_, std::min(value_, margin + tolerance_));
      if (!(next.value < value_ - tolerance_ && next.value <= margin)) return;
      const double way = (triangle_.pointAt(next.weights) - point_).norm();
      const double share = way > reach ? reach / way : 1.0;
      const double before = value_;
      const double expected = share * (before - next.value);
      const Vector3 weights = weights_ + share * (next.weights - weights_);
      const Vector3 p = triangle_.pointAt(weights);
      const GridSample here = grid_.at(p);
      meet(weights, p, here.distance);
      addPlane(count_ - 1, here);
      const double gained = before - here.distance;
      if (gained < 0.25 * expected) reach = 0.5 * std::min(way, reach);
      if (gained > 0.75 * expected) reach *= 2.0;
    }
  }

  void write(ClosestPoint& result) const {
    result.weights = weights_;
    result.distance = value_;
    result.beyond_rim = false;
    result.gradients = GradientSet();
    for (int i = 0; i < planes_.count(); ++i) {
      if (planes_.valueAt(i, weights_) >= value_ - 2.0 * tolerance_) result.gradients.add(gradients_[i]);
    }
  }

  double value() const { return value_; }

 private:
  void meet(const Vector3& weights, const Vector3& p, double value) {
    if (count_ == PlaneSet::kCapacity) drop(highest());
    points_[count_] = weights;
    values_[count_++] = value;
    if (!(value < value_)) return;
    value_ = value;
    weights_ = weights;
    point_ = p;
  }

  void addPlane(int i, const GridSample& here) {
    const Vector3 p = triangle_.pointAt(points_[i]);
    Vector3 corner_values;
    for (int k = 0; k < 3; ++k) corner_values[k] = here.distance + here.gradient.dot(triangle_.corners[k] - p);
    planes_.add(corner_values);
    gradients_[i] = here.gradient;
  }

  void drop(int i) {
    for (int k = i; k + 1 < count_; ++k) {
      points_[k] = points_[k + 1];
      values_[k] = values_[k + 1];
      gradients_[k] = gradients_[k + 1];
    }
    --count_;
    if (i < planes_.count()) planes_.remove(i);
  }

  int highest() const {
    return static_cast<int>(std::max_element(values_.begin(), values_.begin() + count_) - values_.begin());
  }

  /// Where the field is not convex a plane may lie above it; and with slopes of 1 one that lies 2 reach below the lowest
  /// point is not met within reach.
  void dropIdlePlanes(double reach) {
    for (int i = planes_.count() - 1; i >= 0; --i) {
      const double here = planes_.valueAt(i, weights_);
      if (here > value_ + tolerance_ || here < value_ - 2.0 * reach - tolerance_) drop(i);
    }
  }

  const DistanceGrid& grid_;
  const TrianglePoints& triangle_;
  double tolerance_;
  int count_ = 0;                                    ///< of points, none yet dropped to make room
  std::array<Vector3, PlaneSet::kCapacity> points_;  ///< barycentric
  std::array<double, PlaneSet::kCapacity> values_{};
  PlaneSet planes_;  ///< through the same points, once descend() has begun
  std::array<Vector3, PlaneSet::kCapacity> gradients_;
  double value_ = std::numeric_limits<double>::infinity();
  Vector3 weights_ = Vector3::UnitX();
  Vector3 point_ = Vector3::Zero();
};

}  // namespace

bool lowestOnTriangle(const DistanceGrid& grid, const TrianglePoints& triangle, double margin, ClosestPoint& result) {
  const Vector3 centre = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3.0;
  double radius = 0.0;
  for (const Vector3& corner : triangle.corners) radius = std::max(radius, (corner - centre).norm());
  Lowest lowest(grid, triangle);
  const Vector3 thirds = Vector3::Constant(1.0 / 3.0);
  Queue queue;
  lowest.sample(thirds);
  queue.push({thirds, 1.0, lowest.value(), lowest.value() - radius});
  double reach = radius;
  bool near = false;
  for (int sampled = 1; sampled < kMostPieces && !queue.empty();) {
    const Piece piece = queue.pop();
    if (piece.bound > std::min(margin, lowest.value())) {
      if (piece.bound > margin && lowest.value() > margin) return false;
      break;
    }
    const double piece_radius = 0.5 * std::abs(piece.half) * radius;
    reach = std::min(reach, 4.0 * piece_radius);
    if (piece_radius < kFinest * grid.spacing) {
      near = true;
      continue;
    }
    const double half = 0.5 * piece.half;
    queue.push({piece.middle, -half, piece.value, piece.value - piece_radius});
    for (int i = 0; i < 3; ++i) {
      Vector3 middle = piece.middle - Vector3::Constant(half / 3.0);
      middle[i] += half;
      const double value = lowest.sample(middle);
      queue.push({middle, half, value, value - piece_radius});
    }
    sampled += 3;
  }
  if (queue.empty() && !near && lowest.value() > margin) return false;
  lowest.descend(reach, margin);
  lowest.write(result);
  return result.distance <= margin;
}

}  // namespace tissue_contact
