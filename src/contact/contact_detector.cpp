#include "tissue_contact/contact/contact_detector.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "contact/contact_direction.h"
#include "contact/least_width.h"
#include "contact/narrow_phase.h"
#include "contact/shape/shape_union.h"
#include "contact/tolerances.h"
#include "contact/touching_shapes.h"
#include "contact/vertex_contact.h"
#include "mesh/mesh_checks.h"
#include "mesh/surface/moving_surface.h"
#include "mesh/surface/triangle_geometry.h"
#include "tissue_contact/core/check.h"

namespace tissue_contact {

namespace {

Eigen::AlignedBox3d boxAround(const ShapeDistance& shape, const Pose& X_WS, double margin) {
  const Vector3 centre = X_WS * shape.boxCentre();
  const Vector3 half = shape.halfExtents(X_WS.linear()) + Vector3::Constant(margin);
  return {Vector3(centre - half), Vector3(centre + half)};
}

}  // namespace

struct ContactDetector::Implementation {
  std::vector<TouchingShape> shapes;
  SharedSurfaces surfaces;
  std::vector<std::size_t> link_counts;  ///< per instrument
  std::vector<double> thicknesses_m;     ///< per tissue: of a sheet, or of the layer that a volume is at most, at rest
  NarrowPhase narrow_phase;
  std::vector<int> candidates;
  std::vector<double> least;  ///< scratch: bounds of their distances, m
  std::vector<ShapeContact> found;
  int pinched = 0;  ///< contacts left out by the last detect(), because there is no room for them

  void detectPair(MovingSurface& surface, const TouchingShape& shape, const Pose& X_WS, double margin,
                  const ShapesBeside* beside, std::vector<Contact>& contacts);
  double deepestGroove(const TouchingShape& shape, const std::vector<Pose>& X_WL) const;
  bool fitBetweenShapes(const TouchingShape& shape, const std::vector<std::vector<Pose>>& X_WL, Contact& contact) const;
  double surfaceDistance(MovingSurface& surface, const TouchingShape& shape, const Pose& X_WS, double bound,
                         NearPlace* place = nullptr);
};

ContactDetector::ContactDetector(const std::vector<Instrument>& instruments, SharedSurfaces surfaces,
                                 const MeshPreparation& preparation)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->shapes = touchingShapes(instruments, preparation);
  implementation_->surfaces = std::move(surfaces);
  for (const MovingSurface& surface : *implementation_->surfaces) {
    implementation_->narrow_phase.makeRoom(surface);
    implementation_->thicknesses_m.push_back(surface.isVolume() ? leastWidth(surface) : 2.0 * surface.halfThickness());
  }
  for (const Instrument& one : instruments) implementation_->link_counts.push_back(one.model().links().size());
}

ContactDetector::~ContactDetector() = default;
ContactDetector::ContactDetector(ContactDetector&&) noexcept = default;
ContactDetector& ContactDetector::operator=(ContactDetector&&) noexcept = default;

void ContactDetector::detect(const std::vector<NodalVectors>& positions, const std::vector<std::vector<Pose>>& X_WL,
                             double margin_m, std::vector<Contact>& contacts) {
  detect(positions, X_WL, std::vector<double>(implementation_->surfaces->size(), margin_m), contacts);
}

void ContactDetector::detect(const std::vector<NodalVectors>& positions, const std::vector<std::vector<Pose>>& X_WL,
                             const std::vector<double>& margins_m, std::vector<Contact>& contacts) {
  Implementation& self = *implementation_;
  requireCount("margins of tissues", margins_m.size(), self.surfaces->size());
  for (const double margin_m : margins_m) {
    if (!(margin_m >= 0.0 && std::isfinite(margin_m)))
      requireNonNegative("contact detection: margin", margin_m, "m");  // no string else
  }
  requireCount("link poses of instruments", X_WL.size(), self.link_counts.size());
  for (std::size_t i = 0; i < X_WL.size(); ++i) {
    requireCount("link poses of an instrument", X_WL[i].size(), self.link_counts[i]);
  }
  placeAll(*self.surfaces, positions);
  contacts.clear();
  self.pinched = 0;
  for (MovingSurface& surface : *self.surfaces) {
    const double margin_m = margins_m[surface.tissue()];
    for (const TouchingShape& shape : self.shapes) {
      const auto first = static_cast<std::ptrdiff_t>(contacts.size());
      const double groove = self.deepestGroove(shape, X_WL[shape.instrument]);
      const OtherShapes others(self.shapes, shape, X_WL[shape.instrument]);
      self.detectPair(surface, shape, X_WL[shape.instrument][shape.link] * shape.X_LS, margin_m + groove,
                      groove > 0.0 ? &others : nullptr, contacts);
      if (self.shapes.size() == 1) continue;
      const auto is_none = [&](Contact& contact) {
        const bool has_room = self.fitBetweenShapes(shape, X_WL, contact);
        self.pinched += static_cast<int>(!has_room);
        return !has_room || contact.gap_m > margin_m;
      };
      contacts.erase(std::remove_if(contacts.begin() + first, contacts.end(), is_none), contacts.end());
    }
  }
}

/// @param beside of the instrument's other shapes; null: none is near this one.
void ContactDetector::Implementation::detectPair(MovingSurface& surface, const TouchingShape& shape, const Pose& X_WS,
                                                 double margin, const ShapesBeside* beside,
                                                 std::vector<Contact>& contacts) {
  const Eigen::AlignedBox3d box = boxAround(*shape.distance, X_WS, margin + surface.halfThickness());
  if (!surface.box().intersects(box)) return;
  surface.overlapping(box, candidates);
  if (candidates.empty()) return;
  narrow_phase.findContacts(*shape.distance, X_WS, surface, candidates, margin, found, beside);
  for (const ShapeContact& one : found) {
    Contact& contact = contacts.emplace_back();
    contact.key = {surface.tissue(), shape.instrument, shape.contact_link, shape.shape, one.feature, one.corner, 0, -1,
                   {-1, -1, -1}};
    contact.nodes = one.nodes;
    contact.weights = one.weights;
    contact.p_WC = pointOf(surface.positions(), one.nodes, one.weights);
    contact.R_WC = contactFrame(one.normal_W);
    contact.gap_m = one.gap;
    contact.lean_W = one.lean_W;
  }
}

/// How far from this shape the filling of a groove with another of the instrument may reach, m; 0: none is near.
double ContactDetector::Implementation::deepestGroove(const TouchingShape& shape, const std::vector<Pose>& X_WL) const {
  // Between walls at an angle 2 phi the filling stands rho (1 - sin phi) before them, and there is one where they close
  // within 2 rho of it, so where rho (1 - sin phi) / sin phi < 2 rho.
  constexpr double kStands = 2.0 / 3.0;
  double deepest = 0.0;
  for (const TouchingShape& other : shapes) {
    if (&other == &shape || other.instrument != shape.instrument) continue;
    const double radius = kGrooveRadius * std::min(shape.half_extent, other.half_extent);
    const Eigen::AlignedBox3d own = boxAround(*shape.distance, X_WL[shape.link] * shape.X_LS, radius);
    if (radius > deepest && own.intersects(boxAround(*other.distance, X_WL[other.link] * other.X_LS, radius))) {
      deepest = radius;
    }
  }
  return kStands * deepest;
}

/// Fits a contact to the other shapes near it: turns it to the filling of the groove between this shape and another of the
/// instrument.
/// @return false where it is pinched: shapes that touch each other press its point from opposed sides. There is no room
///   for tissue then and no force that would make any, so it is dropped.
bool ContactDetector::Implementation::fitBetweenShapes(const TouchingShape& shape,
                                                       const std::vector<std::vector<Pose>>& X_WL,
                                                       Contact& contact) const {
  constexpr double kRoom = 0.05;        // of that radius: shapes that near touch each other
  constexpr double kTissueRoom = 0.25;  // of the tissue's thickness, if that is less
  const double tissue_room = kTissueRoom * thicknesses_m[contact.key.tissue];
  const PlacedShape own{shape.distance.get(), X_WL[shape.instrument][shape.link] * shape.X_LS};
  std::optional<SignedDistance> before;
  SignedDistance united;
  for (const TouchingShape& other : shapes) {
    if (&other == &shape) continue;
    const double radius = kGrooveRadius * std::min(shape.half_extent, other.half_extent);
    const PlacedShape second{other.distance.get(), X_WL[other.instrument][other.link] * other.X_LS};
    if (!boxAround(*other.distance, second.X_WS, radius).contains(contact.p_WC)) continue;
    if (!before) united = *(before = distanceAt(own, contact.p_WC));
    const SignedDistance there = distanceAt(second, contact.p_WC);
    const double room = std::min(kRoom * radius, tissue_room);
    if (areOpposed(*before, there) && before->distance + there.distance < room) return false;
    SignedDistance filled;
    if (other.instrument == shape.instrument &&
        fillGroove(own, second, contact.p_WC, radius, room, *before, there, filled) &&
        filled.distance < united.distance) {
      united = filled;
    }
  }
  if (!before || !(united.distance < before->distance)) return true;
  contact.gap_m += united.distance - before->distance;
  const Vector3 normal_W = (united.normal + contact.lean_W).normalized();
  contact.R_WC = contactFrame(normal_W);
  contact.lean_W = normal_W - united.normal;
  return true;
}

const SharedSurfaces& ContactDetector::surfaces() const { return implementation_->surfaces; }

int ContactDetector::pinchedContacts() const { return implementation_->pinched; }

const TriangleMesh* ContactDetector::actingSurface(int instrument, int contact_link, int shape) const {
  for (const TouchingShape& one : implementation_->shapes) {
    if (one.instrument == instrument && one.contact_link == contact_link && one.shape == shape) {
      return one.distance->drawn();
    }
  }
  return nullptr;
}

bool ContactDetector::measure(const std::vector<NodalVectors>& positions, const std::vector<std::vector<Pose>>& X_WL,
                              double margin_m, Contact& contact) const {
  const ContactKey& key = contact.key;
  const NodalVectors& x = positions.at(key.tissue);
  for (const TouchingShape& shape : implementation_->shapes) {
    if (shape.instrument != key.instrument || shape.contact_link != key.link || shape.shape != key.shape) continue;
    const MovingSurface& surface = (*implementation_->surfaces)[key.tissue];
    const Pose X_WS = X_WL.at(shape.instrument).at(shape.link) * shape.X_LS;
    const Vector3 p_W = pointOf(x, contact.nodes, contact.weights);
    const auto inShape = [&](int node) -> Vector3 {
      return X_WS.linear().transpose() * (x.col(node) - X_WS.translation());
    };
    const auto normalOf = [&](int triangle) -> Vector3 {
      const Triangle& nodes = surface.triangles()[triangle];
      return triangleNormal(inShape(nodes[0]), inShape(nodes[1]), inShape(nodes[2]));
    };
    TrianglePoints points;
    for (int i = 0; i < 3; ++i) points.corners[i] = inShape(contact.nodes[i]);
    if (key.feature[1] >= 0) {
      surface.anyTriangleOf(key.feature, [&](int triangle) {
        points.normal += normalOf(triangle);
        return false;
      });
      points.normal.normalize();
    }
    SignedDistance here = keptContact(*shape.distance, points, contact.weights);
    const double groove = implementation_->deepestGroove(shape, X_WL[shape.instrument]);
    const VertexContact vertex(*shape.distance, surface, key.feature[0], inShape, normalOf);
    const bool is_vertex = key.feature[1] < 0 && key.corner < 0;
    const Vector3 own = here.normal;
    const OtherShapes others(implementation_->shapes, shape, X_WL[shape.instrument]);
    if (is_vertex) here = vertex.leaves(here, groove > 0.0 ? &others : nullptr);
    const double gap = here.distance - surface.halfThickness();
    const auto faces = [&](int triangle) { return here.normal.dot(normalOf(triangle)) < -kFacing; };
    if (!(gap <= margin_m + groove) || (surface.isVolume() && !surface.anyTriangleOf(key.feature, faces))) return false;
    contact.p_WC = p_W;
    const Vector3 normal = is_vertex && here.normal == own ? vertex.meanNormal(own) : here.normal;
    contact.R_WC = contactFrame((X_WS.linear() * normal).normalized());
    contact.lean_W = X_WS.linear() * (normal - here.normal);
    contact.gap_m = gap;
    if (implementation_->shapes.size() == 1) return true;
    return implementation_->fitBetweenShapes(shape, X_WL, contact) && contact.gap_m <= margin_m;
  }
  return false;
}

void ContactDetector::turnWithSlide(const std::vector<std::vector<Pose>>& start_X_WL,
                                    const std::vector<std::vector<Pose>>& end_X_WL, const Vector3& way_W,
                                    Contact& contact) const {
  constexpr double kOwn = 0.99;                        // cosine
  constexpr double kMostTurn = 0.1, kSharpTurn = 0.2;  // rad: what slides farther is not foretold by the step before
  constexpr double kMostCurved = 4.0, kSharpCurvature = 8.0;  // over the smallest half extent
  constexpr double kMostDepth = 0.1;  // of the smallest half extent: deeper ones are being freed, and do not slide
  constexpr double kRoundOff = 1e-12;
  constexpr double kLeastWay_m = 1e-9;
  const auto faded = [](double value, double all, double none) {
    return std::clamp((none - value) / (none - all), 0.0, 1.0);
  };
  const ContactKey& key = contact.key;
  if (key.corner >= 0) return;  // its normal is the tissue's
  for (const TouchingShape& shape : implementation_->shapes) {
    if (shape.instrument != key.instrument || shape.contact_link != key.link || shape.shape != key.shape) continue;
    const Pose start = start_X_WL.at(shape.instrument).at(shape.link) * shape.X_LS;
    const Pose end = end_X_WL.at(shape.instrument).at(shape.link) * shape.X_LS;
    const Vector3 p_S = start.linear().transpose() * (contact.p_WC - start.translation());
    const Vector3 way_S = end.linear().transpose() * (contact.p_WC + way_W - end.translation()) - p_S;
    const SignedDistance here = shape.distance->at(p_S);
    const Vector3 from_W = start.linear() * here.normal;
    const bool is_own = from_W.dot(contact.R_WC.col(0) - contact.lean_W) > kOwn;
    if (is_own && contact.gap_m >= -kMostDepth * shape.half_extent) {
      const Vector3 way = way_S - here.normal.dot(way_S) * here.normal;
      const SignedDistance there = shape.distance->at(p_S + way);
      const double turned = std::max((there.normal - here.normal).norm() - kRoundOff, 0.0);
      const double curvature = turned > 0.0 ? turned * shape.half_extent / way.norm() : 0.0;
      // On the rim of a cylinder, and where an edge of the tissue crosses one of a box, round-off tells which face it is.
      const double of_ridge = std::min(shape.distance->toRidge(p_S) / std::max(way.norm(), kLeastWay_m), 1.0);
      const double share =
          of_ridge * std::min(faded(turned, kMostTurn, kSharpTurn), faded(curvature, kMostCurved, kSharpCurvature));
      if (share > 0.0) {
        const Quaternion turn = Quaternion::FromTwoVectors(from_W, end.linear() * there.normal);
        const Matrix3 turn_W = Quaternion::Identity().slerp(share, turn).toRotationMatrix();
        contact.R_WC = turn_W * contact.R_WC;
        contact.lean_W = turn_W * contact.lean_W;
        contact.gap_m += share * (there.distance - here.distance - there.normal.dot(way));
      }
    }
    // The way along the normal is to change the gap by what leads to the shape alone.
    contact.gap_m -= contact.lean_W.dot(end.linear() * way_S);
    return;
  }
}

/// Least signed distance of the shape over the surface's triangles, or `bound` if that is less.
/// @param place unless null: gets where that is, if some triangle is as near.
double ContactDetector::Implementation::surfaceDistance(MovingSurface& surface, const TouchingShape& shape,
                                                        const Pose& X_WS, double bound, NearPlace* place) {
  const ShapeDistance& distance = *shape.distance;
  // The surface node nearest to the middle of the shape tells how far to look.
  const Vector3 middle = X_WS * distance.boxCentre();
  const auto squared = [&](int node) { return (surface.x(node) - middle).squaredNorm(); };
  const int node = *std::min_element(surface.nodes().begin(), surface.nodes().end(),
                                     [&](int a, int b) { return squared(a) < squared(b); });
  const Matrix3 R_SW = X_WS.linear().transpose();
  const auto inShape = [&](int one) -> Vector3 { return R_SW * (surface.x(one) - X_WS.translation()); };
  const double at_node = distance.at(inShape(node)).distance;
  double nearest = std::min(bound, at_node);
  if (place != nullptr &&
      at_node <= bound) {  // what its triangles offer may be larger by round-off, of a mesh by what its search leaves
    surface.anyTriangleOf({node, -1, -1}, [&](int triangle) {
      place->nodes = surface.triangles()[triangle];
      for (int i = 0; i < 3; ++i) place->weights[i] = place->nodes[i] == node ? 1.0 : 0.0;
      return true;
    });
  }
  surface.overlapping(boxAround(distance, X_WS, std::max(nearest, 0.0)), candidates);
  const auto offer = [&](double there, const Triangle& nodes, const Vector3& weights) {
    if (!(there <= nearest)) return;
    nearest = there;
    if (place == nullptr) return;
    place->nodes = nodes;
    place->weights = weights;
  };
  // One point of each first: distances change by no more than the way, so most triangles are then known to be farther.
  least.clear();
  for (const int triangle : candidates) {
    const Triangle& nodes = surface.triangles()[triangle];
    const TriangleBall ball({inShape(nodes[0]), inShape(nodes[1]), inShape(nodes[2])});
    const double there = distance.at(ball.centre).distance;
    offer(there, nodes, Vector3::Constant(1.0 / 3.0));
    least.push_back(there - ball.radius);
  }
  ClosestPoint closest;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (least[i] > nearest) continue;
    const Triangle& nodes = surface.triangles()[candidates[i]];
    const TrianglePoints points(inShape(nodes[0]), inShape(nodes[1]), inShape(nodes[2]));
    if (distance.closest(points, nearest, closest)) offer(closest.distance, nodes, closest.weights);
  }
  return nearest;
}

void ContactDetector::lowerClosestApproach(const std::vector<NodalVectors>& positions,
                                           const std::vector<std::vector<Pose>>& X_WL, Approach& closest) {
  Implementation& self = *implementation_;
  placeAll(*self.surfaces, positions);
  for (MovingSurface& surface : *self.surfaces) {
    if (surface.nodes().empty()) continue;
    for (const TouchingShape& shape : self.shapes) {
      const Pose X_WS = X_WL.at(shape.instrument).at(shape.link) * shape.X_LS;
      const double bound = closest.distance_m + surface.halfThickness();
      const double between_boxes = surface.box().exteriorDistance(boxAround(*shape.distance, X_WS, 0.0));
      if (between_boxes > 0.0 && !(between_boxes < bound)) continue;
      NearPlace place;
      const double nearest = self.surfaceDistance(surface, shape, X_WS, bound, &place);
      if (!(nearest < bound)) continue;
      Vector3 p_W = Vector3::Zero();
      for (std::size_t i = 0; i < 3; ++i) p_W += place.weights[static_cast<int>(i)] * surface.x(place.nodes[i]);
      const SignedDistance there = shape.distance->atAnyDistance(X_WS.inverse() * p_W);
      const double distance = std::max(nearest, there.distance);
      if (!(distance < bound)) continue;
      closest = {surface.tissue(),
                 shape.instrument,
                 shape.contact_link,
                 shape.shape,
                 distance - surface.halfThickness(),
                 p_W,
                 X_WS.linear() * there.normal};
    }
  }
}

void ContactDetector::findNear(const std::vector<NodalVectors>& positions, const std::vector<std::vector<Pose>>& X_WL,
                               const std::vector<double>& within_m, std::vector<NearPlace>& near) {
  Implementation& self = *implementation_;
  placeAll(*self.surfaces, positions);
  near.clear();
  for (MovingSurface& surface : *self.surfaces) {
    const double bound = within_m[surface.tissue()] + surface.halfThickness();
    if (within_m[surface.tissue()] < 0.0 || surface.nodes().empty()) continue;
    for (const TouchingShape& shape : self.shapes) {
      const Pose X_WS = X_WL.at(shape.instrument).at(shape.link) * shape.X_LS;
      if (!(surface.box().exteriorDistance(boxAround(*shape.distance, X_WS, 0.0)) < bound)) continue;
      NearPlace place{surface.tissue(), shape.instrument, shape.contact_link, shape.shape};
      const double nearest = self.surfaceDistance(surface, shape, X_WS, bound, &place);
      if (!(nearest < bound)) continue;
      place.distance_m = nearest - surface.halfThickness();
      near.push_back(place);
    }
  }
}

void ContactDetector::swapSurface(MovingSurface& surface) {
  MovingSurface& own = (*implementation_->surfaces)[surface.tissue()];
  std::swap(own, surface);
  implementation_->narrow_phase.makeRoom(own);
}

}  // namespace tissue_contact
