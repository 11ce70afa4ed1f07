/// @file
/// Room `mesh`: which points lie in a region, which nodes are fixed.
#include "mesh/region.h"

#include <algorithm>
#include <sstream>
#include <variant>

#include "mesh/mesh_checks.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

bool holds(const BoxRegion& box, const Vector3& x, double rounding) {
  return ((x - box.min_m).array() >= -rounding).all() && ((box.max_m - x).array() >= -rounding).all();
}
bool holds(const PlaneRegion& plane, const Vector3& x, double rounding) {
  const double norm = plane.normal.norm();  // without a direction it holds nothing
  return norm > 0.0 && plane.normal.dot(x - plane.point_m) <= rounding * norm;
}
bool holds(const SphereRegion& sphere, const Vector3& x, double rounding) {
  return (x - sphere.center_m).norm() <= sphere.radius_m + rounding;
}

bool holds(const MemberRegion& members, const Vector3& x, double rounding) {
  const std::vector<Vector3>& places = *members.places;
  const double order = placeOrder(x);
  const double apart = rounding + 1e-15 * x.norm();  // placeOrder() rounds, too
  const auto first = std::lower_bound(places.begin(), places.end(), order - apart,
                                      [](const Vector3& place, double from) { return placeOrder(place) < from; });
  for (auto place = first; place != places.end() && placeOrder(*place) <= order + apart; ++place) {
    if ((*place - x).norm() <= rounding) return true;
  }
  return false;
}
bool holds(const GroupRegion&, const Vector3&, double) { return false; }     // they have no places
bool holds(const CellDataRegion&, const Vector3&, double) { return false; }  // before withPlaces()

/// Whether the nearest point of a region is farther from x than a distance; false where that is not known.
bool isFarther(const BoxRegion& box, const Vector3& x, double distance) {
  return (box.min_m - x).cwiseMax(x - box.max_m).maxCoeff() > distance;
}
bool isFarther(const PlaneRegion& plane, const Vector3& x, double distance) {
  return plane.normal.dot(x - plane.point_m) > distance * plane.normal.norm();
}
bool isFarther(const SphereRegion& sphere, const Vector3& x, double distance) {
  return (x - sphere.center_m).norm() > sphere.radius_m + distance;
}
template <typename Labelled>
bool isFarther(const Labelled&, const Vector3&, double) {
  return false;
}

}  // namespace

bool holds(const Region& region, const Vector3& x, double rounding) {
  return std::visit([&](const auto& shape) { return holds(shape, x, rounding); }, region);
}

namespace {

void describe(const BoxRegion& box, std::ostream& out) {
  out << "box from (" << box.min_m.transpose() << ") to (" << box.max_m.transpose() << ") m";
}
void describe(const PlaneRegion& plane, std::ostream& out) {
  out << "plane through (" << plane.point_m.transpose() << ") m, against its normal (" << plane.normal.transpose()
      << ")";
}
void describe(const SphereRegion& sphere, std::ostream& out) {
  out << "sphere around (" << sphere.center_m.transpose() << ") m of radius " << sphere.radius_m << " m";
}

void describe(const MemberRegion& members, std::ostream& out) { out << members.label; }
void describe(const GroupRegion& group, std::ostream& out) { out << "group '" << group.name << "'"; }
void describe(const CellDataRegion& data, std::ostream& out) { out << "cell data '" << data.name << "'"; }

[[noreturn]] void refuseRegion(const NodalVectors& x, const Region& region, std::size_t index, const std::string& entry,
                               const std::string& what, const std::string& source) {
  std::ostringstream message;
  message << entry << " region " << index << " (";
  std::visit([&](const auto& shape) { describe(shape, message); }, region);
  message << ") holds no " << what << "; ";
  if (x.cols() > 0) {
    message << "all lie within (" << x.rowwise().minCoeff().transpose() << ") to ("
            << x.rowwise().maxCoeff().transpose() << ") m of the tissue frame: move or enlarge the region";
  } else {
    message << "the mesh has no nodes";
  }
  throw EntryError(elementOf(entry, index), source + ": " + message.str());
}

constexpr int kParts = 8;  // of an edge: what holds no more of it than one holds the corner alone

bool leavesACorner(const std::vector<Region>& regions, const std::array<Vector3, 4>& corners, double rounding) {
  std::array<bool, 4> held{};
  for (std::size_t i = 0; i < 4; ++i) held[i] = anyHolds(regions, corners[i], rounding);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; held[i] && j < 4; ++j) {
      if (!held[j] && anyHolds(regions, corners[i] + (corners[j] - corners[i]) / kParts, rounding)) return true;
    }
  }
  return false;
}

bool holdsAPartInside(const std::vector<Region>& regions, const std::array<Vector3, 4>& corners, double rounding) {
  bool any_held = false, any_free = false;
  for (int a = 1; a < kParts; ++a) {
    for (int b = 1; a + b < kParts; ++b) {
      for (int c = 1; a + b + c < kParts; ++c) {
        const int d = kParts - a - b - c;
        const Vector3 place = (a * corners[0] + b * corners[1] + c * corners[2] + d * corners[3]) / kParts;
        (anyHolds(regions, place, rounding) ? any_held : any_free) = true;
        if (any_held && any_free) return true;
      }
    }
  }
  return false;
}

}  // namespace

double roundingDistance(const NodalVectors& x) {
  return x.cols() == 0 ? 0.0 : 1e-9 * (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
}

double placeOrder(const Vector3& place) {
  // Of length 1: square roots of 2, 3 and 5, which no small whole numbers relate.
  return Vector3(0.4472135954999579, 0.5477225575051661, 0.7071067811865476).dot(place);
}

bool anyHolds(const std::vector<Region>& regions, const Vector3& x, double rounding) {
  return std::any_of(regions.begin(), regions.end(), [&](const Region& region) { return holds(region, x, rounding); });
}

bool mayHoldWithin(const Region& region, const Vector3& x, double distance) {
  return std::visit([&](const auto& shape) { return !isFarther(shape, x, distance); }, region);
}

bool bordersIn(const std::vector<Region>& regions, const std::array<Vector3, 4>& corners, double rounding) {
  double longest = 0.0;
  for (const Vector3& corner : corners) longest = std::max(longest, (corner - corners[0]).norm());
  const bool is_near = std::any_of(regions.begin(), regions.end(), [&](const Region& region) {
    return mayHoldWithin(region, corners[0], longest + rounding);
  });
  return is_near && (leavesACorner(regions, corners, rounding) || holdsAPartInside(regions, corners, rounding));
}

std::vector<bool> heldPoints(const NodalVectors& points, const std::vector<Region>& regions, const std::string& entry,
                             const std::string& what, const std::string& source) {
  std::vector<bool> held(static_cast<std::size_t>(points.cols()), false);
  const double rounding = roundingDistance(points);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    bool any = false;
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const Vector3 x = points.col(i);
      if (!holds(regions[r], x, rounding)) continue;
      held[static_cast<std::size_t>(i)] = any = true;
    }
    if (!any) refuseRegion(points, regions[r], r, entry, what, source);
  }
  return held;
}

std::vector<bool> fixedNodes(const NodalVectors& positions, const std::vector<Region>& regions,
                             const std::string& source) {
  return heldPoints(positions, regions, "fixed", "node", source);
}

}  // namespace tissue_contact
