#include "tissue_contact/contact/contact_detector.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "contact/conforming_gap.h"
#include "contact/narrow_phase.h"
#include "contact/triangle_tree.h"
#include "tissue_contact/core/check.h"

namespace tissue_contact {
namespace {

/// One shape of one instrument's touching link.
struct TouchingShape {
  int instrument;
  int contact_link;  // index into Instrument::contactLinks()
  int shape;         // index into ContactLink::shapes
  int link;          // index into RobotModel::links()
  Pose X_LS;
  std::unique_ptr<ShapeDistance> distance;
};

struct TouchableSurface {
  TriangleTree tree;
  NarrowPhase narrow_phase;
  int node_count;
  Eigen::AlignedBox3d box = Eigen::AlignedBox3d();  ///< around all nodes, this call
  bool refitted = false;                            ///< this call: only tissues that a shape comes near need their tree
};

std::vector<TouchingShape> touchingShapes(const std::vector<Instrument>& instruments,
                                          const MeshPreparation& preparation) {
  ShapeDistances distances(preparation);
  std::vector<TouchingShape> result;
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const std::vector<ContactLink>& links = instruments[i].contactLinks();
    for (std::size_t l = 0; l < links.size(); ++l) {
      for (std::size_t s = 0; s < links[l].shapes.size(); ++s) {
        const CollisionShape& shape = links[l].shapes[s];
        result.push_back({static_cast<int>(i), static_cast<int>(l), static_cast<int>(s), links[l].link, shape.X_LS,
                          distances.make(shape)});
      }
    }
  }
  return result;
}

/// @param index of the tissue or instrument meant, -1 for none. No allocation while all is well.
void requireSameSize(const char* what, int index, std::size_t size, std::size_t expected) {
  if (size == expected) return;
  throw std::invalid_argument(std::string("contact detection: ") + what +
                              (index < 0 ? "" : " " + std::to_string(index)) + ": " + std::to_string(size) +
                              " given; there must be " + std::to_string(expected));
}

Eigen::AlignedBox3d boxAround(const NodalVectors& positions) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index i = 0; i < positions.cols(); ++i) box.extend(Vector3(positions.col(i)));
  return box;
}

Eigen::AlignedBox3d boxAround(const ShapeDistance& shape, const Pose& X_WS, double margin) {
  const Vector3 centre = X_WS * shape.boxCentre();
  const Vector3 half = shape.halfExtents(X_WS.linear()) + Vector3::Constant(margin);
  return {Vector3(centre - half), Vector3(centre + half)};
}

}  // namespace

struct ContactDetector::Implementation {
  std::vector<TouchingShape> shapes;
  std::vector<TouchableSurface> surfaces;
  std::vector<std::size_t> link_counts;  ///< per instrument
  std::vector<int> candidates;
  std::vector<ShapeContact> found;

  void detectPair(int tissue, const NodalVectors& positions, const TouchingShape& shape, const Pose& X_WS,
                  double margin, std::vector<Contact>& contacts);
};

ContactDetector::ContactDetector(const std::vector<Instrument>& instruments, std::vector<TissueSurface> surfaces,
                                 const std::vector<NodalVectors>& positions, const MeshPreparation& preparation)
    : implementation_(std::make_unique<Implementation>()) {
  requireSameSize("positions of tissues", -1, positions.size(), surfaces.size());
  implementation_->shapes = touchingShapes(instruments, preparation);
  for (const Instrument& one : instruments) implementation_->link_counts.push_back(one.model().links().size());
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const int node_count = static_cast<int>(positions[i].cols());
    // The narrow phase checks the indices that the tree then relies on.
    NarrowPhase narrow_phase(surfaces[i].triangles, std::move(surfaces[i].fixed), node_count, surfaces[i].thickness_m);
    implementation_->surfaces.push_back(
        {TriangleTree(positions[i], std::move(surfaces[i].triangles)), std::move(narrow_phase), node_count});
  }
}

ContactDetector::ContactDetector(const std::vector<Instrument>& instruments, std::vector<TissueSurface> surfaces,
                                 const std::vector<NodalVectors>& positions)
    : ContactDetector(instruments, std::move(surfaces), positions, MeshPreparation()) {}

ContactDetector::~ContactDetector() = default;
ContactDetector::ContactDetector(ContactDetector&&) noexcept = default;
ContactDetector& ContactDetector::operator=(ContactDetector&&) noexcept = default;

void ContactDetector::detect(const std::vector<NodalVectors>& positions, const std::vector<std::vector<Pose>>& X_WL,
                             double margin_m, std::vector<Contact>& contacts) {
  Implementation& self = *implementation_;
  if (!(margin_m >= 0.0 && std::isfinite(margin_m)))
    requireNonNegative("contact detection: margin", margin_m, "m");  // no string else
  requireSameSize("positions of tissues", -1, positions.size(), self.surfaces.size());
  requireSameSize("link poses of instruments", -1, X_WL.size(), self.link_counts.size());
  for (std::size_t i = 0; i < X_WL.size(); ++i) {
    requireSameSize("link poses of instrument", static_cast<int>(i), X_WL[i].size(), self.link_counts[i]);
  }
  contacts.clear();
  for (std::size_t tissue = 0; tissue < positions.size(); ++tissue) {
    requireSameSize("nodes of tissue", static_cast<int>(tissue), positions[tissue].cols(),
                    self.surfaces[tissue].node_count);
    self.surfaces[tissue].refitted = false;
    self.surfaces[tissue].box = boxAround(positions[tissue]);
    for (const TouchingShape& shape : self.shapes) {
      self.detectPair(static_cast<int>(tissue), positions[tissue], shape,
                      X_WL[shape.instrument][shape.link] * shape.X_LS, margin_m, contacts);
    }
  }
}

void ContactDetector::Implementation::detectPair(int tissue, const NodalVectors& positions, const TouchingShape& shape,
                                                 const Pose& X_WS, double margin, std::vector<Contact>& contacts) {
  TouchableSurface& surface = surfaces[tissue];
  const Eigen::AlignedBox3d box = boxAround(*shape.distance, X_WS, margin + surface.narrow_phase.halfThickness());
  if (!surface.box.intersects(box)) return;
  if (!surface.refitted) surface.tree.refit(positions);
  surface.refitted = true;
  surface.tree.overlapping(box, candidates);
  if (candidates.empty()) return;
  surface.narrow_phase.findContacts(*shape.distance, X_WS, positions, candidates, margin, found);
  for (const ShapeContact& one : found) {
    Contact& contact = contacts.emplace_back();
    contact.key = {tissue, shape.instrument, shape.contact_link, shape.shape, one.feature, one.corner, 0,
                   -1,     {-1, -1, -1}};
    contact.nodes = one.nodes;
    contact.weights = one.weights;
    contact.p_WC.setZero();
    for (int i = 0; i < 3; ++i) contact.p_WC += one.weights[i] * positions.col(one.nodes[i]);
    contact.R_WC = contactFrame(one.normal_W);
    contact.gap_m = one.gap;
  }
}

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
    const Pose X_WS = X_WL.at(shape.instrument).at(shape.link) * shape.X_LS;
    Vector3 p_W = Vector3::Zero();
    std::array<Vector3, 3> corners_S;
    std::array<double, 3> distances;
    for (int i = 0; i < 3; ++i) {
      p_W += contact.weights[i] * x.col(contact.nodes[i]);
      corners_S[i] = X_WS.linear().transpose() * (x.col(contact.nodes[i]) - X_WS.translation());
      distances[i] = shape.distance->at(corners_S[i]).distance;
    }
    const SignedDistance here = shape.distance->at(X_WS.linear().transpose() * (p_W - X_WS.translation()));
    const Vector3 normal_W = (X_WS.linear() * here.normal).normalized();
    const NarrowPhase& surface = implementation_->surfaces[key.tissue].narrow_phase;
    const double gap =
        conformingGap(corners_S, distances, contact.weights, here.distance).gap - surface.halfThickness();
    if (!(gap <= margin_m) || !surface.faces(key.feature, normal_W, x)) return false;
    contact.p_WC = p_W;
    contact.R_WC = contactFrame(normal_W);
    contact.gap_m = gap;
    return true;
  }
  return false;
}

}  // namespace tissue_contact
