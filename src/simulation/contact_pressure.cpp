#include "simulation/contact_pressure.h"

#include <algorithm>
#include <cmath>

namespace tissue_contact {

ContactPressure::ContactPressure(const std::vector<Tissue>& tissues) : tissues_(tissues), surfaces_(tissues.size()) {
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    TrianglesOfNodes triangles = trianglesOfNodes(tissues[t]);
    swapSurface(static_cast<int>(t), triangles);
  }
}

void ContactPressure::swapSurface(int tissue, TrianglesOfNodes& triangles) {
  clear();
  surfaces_[tissue].triangles_of_node.swap(triangles);
  surfaces_[tissue].first_load.assign(surfaces_[tissue].triangles_of_node.size(), -1);
}

void ContactPressure::clear() {
  for (const Load& load : loads_) surfaces_[load.tissue].first_load[load.node] = -1;
  loads_.clear();
}

void ContactPressure::remember(const std::vector<SolvedContact>& contacts) {
  clear();
  for (const SolvedContact& solved : contacts) {
    if (solved.state == ContactState::kOpen) continue;
    const Contact& contact = solved.contact;
    const Vector3 n = contact.R_WC.col(0);
    const Vector3 force_W = n.dot(solved.force_on_tissue_n) * n;
    add(contact.key.tissue, contact.nodes, contact.weights, force_W);
    if (contact.key.other_tissue < 0) continue;
    add(contact.key.other_tissue, contact.other_nodes, contact.other_weights, -force_W);
  }
}

void ContactPressure::add(int tissue, const std::array<int, 3>& nodes, const Vector3& weights, const Vector3& force_W) {
  for (int i = 0; i < 3; ++i) {
    if (weights[i] == 0.0) continue;
    int& first = surfaces_[tissue].first_load[nodes[i]];
    loads_.push_back({tissue, nodes[i], weights[i] * force_W, first});
    first = static_cast<int>(loads_.size()) - 1;
  }
}

double ContactPressure::at(const Contact& contact, const std::vector<NodalVectors>& x) const {
  const ContactKey& key = contact.key;
  const Vector3 n = contact.R_WC.col(0);
  const double pressure = onSide(key.tissue, contact.nodes, contact.weights, n, x[key.tissue]);
  if (key.other_tissue < 0) return pressure;
  return std::max(pressure,
                  onSide(key.other_tissue, contact.other_nodes, contact.other_weights, -n, x[key.other_tissue]));
}

/// @param n unit, into the tissue: only what presses from that side counts (a sheet may be pinched).
double ContactPressure::onSide(int tissue, const std::array<int, 3>& nodes, const Vector3& weights, const Vector3& n,
                               const NodalVectors& x) const {
  double pressure = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (weights[i] == 0.0) continue;
    const double force = forceOn(tissue, nodes[i], n);
    if (!(force > 0.0)) continue;
    const double area = facingArea(tissue, nodes[i], n, x);
    if (area > 0.0) pressure += weights[i] * force / area;
  }
  return pressure;
}

/// What presses on a node along n, N.
double ContactPressure::forceOn(int tissue, int node, const Vector3& n) const {
  double force = 0.0;
  for (int load = surfaces_[tissue].first_load[node]; load >= 0; load = loads_[load].next) {
    force += std::max(0.0, loads_[load].force_W.dot(n));
  }
  return force;
}

/// Whether contacts that are not open act on a node. Of a sheet those on this side; around the edges of a tool normals point all ways.
bool ContactPressure::isTouchedFrom(int tissue, int node, const Vector3& n) const {
  const bool sheet = tissues_[tissue].thickness() > 0.0;
  for (int load = surfaces_[tissue].first_load[node]; load >= 0; load = loads_[load].next) {
    if (!sheet || loads_[load].force_W.dot(n) >= 0.0) return true;
  }
  return false;
}

/// A third of the triangles around a node, as seen along n, m^2; of a volume only of those that face what presses: at the
/// rim of a face the sides do not count. The edge of the patch runs through triangles with a node that nothing touches:
/// they count by the share of the node's two neighbours in them that are touched. A node whose neighbours are not has them
/// all in full.
double ContactPressure::facingArea(int tissue, int node, const Vector3& n, const NodalVectors& x) const {
  const bool sheet = tissues_[tissue].thickness() > 0.0;
  double whole = 0.0;
  double in_patch = 0.0;
  for (const int t : surfaces_[tissue].triangles_of_node[node]) {
    const Triangle& triangle = tissues_[tissue].surface()[t];
    const Vector3 first = x.col(triangle[1]) - x.col(triangle[0]);
    const Vector3 second = x.col(triangle[2]) - x.col(triangle[0]);
    const double facing = -0.5 * first.cross(second).dot(n);
    const double area = std::max(sheet ? std::abs(facing) : facing, 0.0) / 3.0;
    whole += area;
    for (const int other : triangle) {
      if (other != node && isTouchedFrom(tissue, other, n)) in_patch += 0.5 * area;
    }
  }
  return in_patch > 0.0 ? in_patch : whole;
}

}  // namespace tissue_contact
