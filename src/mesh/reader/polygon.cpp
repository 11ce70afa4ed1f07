#include "mesh/reader/polygon.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

namespace tissue_contact {
namespace {

/// The polygon, counter-clockwise, seen along an axis: coordinates stay as they are, so that what lies on a line does exactly.
std::vector<Vector2> seenAlongNormal(const std::vector<Vector3>& corners) {
  Vector3 normal = Vector3::Zero();
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    normal += (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]);
  }
  const Vector3 size = normal.cwiseAbs();
  const int axis = size.x() > std::max(size.y(), size.z()) ? 0 : size.y() > size.z() ? 1 : 2;
  const bool is_behind = normal[axis] < 0.0;
  std::vector<Vector2> seen;
  seen.reserve(corners.size());
  for (const Vector3& p : corners) {
    seen.emplace_back(p[(axis + (is_behind ? 2 : 1)) % 3], p[(axis + (is_behind ? 1 : 2)) % 3]);
  }
  return seen;
}

/// Its edges left over, as rings of corners before and behind.
class Polygon {
 public:
  explicit Polygon(const std::vector<Vector3>& corners)
      : p_(seenAlongNormal(corners)),
        before_(p_.size()),
        behind_(p_.size()),
        convex_(p_.size(), true),
        blocker_(p_.size()) {
    constexpr double kSinglePrecision = 0x1p-22;  // two units in the last place: of a point, and of the line beside it
    for (const Vector2& p : p_) resolved_ = std::max(resolved_, kSinglePrecision * p.cwiseAbs().maxCoeff());
    const int count = size();
    for (int i = 0; i < count; ++i) {
      before_[i] = (i + count - 1) % count;
      behind_[i] = (i + 1) % count;
    }
    for (int i = 0; i < count; ++i) lookAt(i);
  }

  int size() const { return static_cast<int>(p_.size()); }
  bool isConvex(int corner) const { return convex_[corner]; }
  int behind(int corner) const { return behind_[corner]; }
  Triangle ear(int corner) const { return {before_[corner], corner, behind_[corner]}; }

  /// @param clearly no corner in the ear or, to single precision, on its edges; else exactly so, and corners in the place of its tip do not
  ///   count.
  bool isEar(int corner, bool clearly) {
    count();
    const auto [a, b, c] = ear(corner);
    if (p_[a] == p_[b] || p_[b] == p_[c] || p_[c] == p_[a]) return true;  // nothing lies between
    if (clearly ? !convex_[b] || blocks(blocker_[b], b, true) : !(twiceArea(a, b, c) > 0.0)) return false;
    for (const int q : others_) {
      count();
      if (!blocks(q, b, clearly)) continue;
      blocker_[b] = q;
      return false;
    }
    return true;
  }

  void cut(int corner) {
    const auto [a, b, c] = ear(corner);
    behind_[a] = c;
    before_[c] = a;
    convex_[b] = true;  // in nobody's way
    lookAt(a);
    lookAt(c);
    if (--left_ % 64 != 0) return;
    others_.erase(std::remove_if(others_.begin(), others_.end(), [&](int q) { return convex_[q]; }), others_.end());
  }

 private:
  double twiceArea(int a, int b, int c) const {
    const Vector2 u = p_[b] - p_[a];
    const Vector2 v = p_[c] - p_[a];
    return u.x() * v.y() - u.y() * v.x();
  }

  bool isClearlyConvex(int a, int b, int c) const {
    const double longest = std::max({(p_[b] - p_[a]).norm(), (p_[c] - p_[b]).norm(), (p_[a] - p_[c]).norm()});
    return twiceArea(a, b, c) > resolved_ * longest;
  }

  void lookAt(int corner) {
    const auto [a, b, c] = ear(corner);
    const bool was_convex = convex_[b];
    convex_[b] = isClearlyConvex(a, b, c);
    if (was_convex && !convex_[b]) others_.push_back(b);
    blocker_[b] = b;
  }

  /// Whether a corner lies in an ear or on its edges. Convex ones need not be asked: where one does, one that is not does, too.
  bool blocks(int q, int tip, bool clearly) const {
    const auto [a, b, c] = ear(tip);
    if (convex_[q] || q == a || q == b || q == c) return false;
    if (p_[q] == p_[a] || p_[q] == p_[c] || (!clearly && p_[q] == p_[b])) return false;
    const auto isOutside = [&](int from, int to) {
      const double area = twiceArea(from, to, q);
      return area < 0.0 && (!clearly || area < -resolved_ * (p_[to] - p_[from]).norm());
    };
    return !isOutside(c, a) && !isOutside(a, b) && !isOutside(b, c);
  }

  void count() {
    if (++asked_ <= kMostAsked) return;
    throw std::invalid_argument(
        "a face has " + std::to_string(size()) +
        " corners, which take too long to be cut into triangles; do it in the program that made "
        "it (Blender: Triangulate Faces)");
  }

  static constexpr std::int64_t kMostAsked = 300'000'000;

  std::vector<Vector2> p_;
  std::vector<int> before_, behind_;
  std::vector<bool> convex_;  ///< by more than single precision resolves
  std::vector<int> others_;   ///< those that are not, and some that were not
  std::vector<int> blocker_;  ///< of the ear at each corner, found last; the corner itself if none was
  double resolved_ = 0.0;     ///< distance that single precision resolves there
  int left_ = size();
  std::int64_t asked_ = 0;
};

/// The next ear from a corner on: a clear one, or one at all, or the corner itself, of a polygon that has none.
int findEar(Polygon& polygon, int from, int left) {
  for (const bool clearly : {true, false}) {
    int corner = from;
    for (int i = 0; i < left; ++i, corner = polygon.behind(corner)) {
      if (polygon.isEar(corner, clearly)) return corner;
    }
  }
  return from;
}

}  // namespace

std::vector<Triangle> cutPolygon(const std::vector<Vector3>& corners) {
  if (corners.size() == 3) return {{0, 1, 2}};
  Polygon polygon(corners);
  if (polygon.size() == 4) {
    int from = 0;
    while (from < 4 && polygon.isConvex(from)) ++from;
    const auto corner = [from](int i) { return (from + i) % 4; };
    return {{corner(0), corner(1), corner(2)}, {corner(0), corner(2), corner(3)}};
  }
  std::vector<Triangle> triangles;
  int from = 0;
  for (int left = polygon.size(); left > 3; --left) {
    const int tip = findEar(polygon, from, left);
    triangles.push_back(polygon.ear(tip));
    polygon.cut(tip);
    from = polygon.behind(tip);
  }
  triangles.push_back(polygon.ear(from));
  std::sort(triangles.back().begin(), triangles.back().end());  // which runs round as the polygon does
  return triangles;
}

}  // namespace tissue_contact
