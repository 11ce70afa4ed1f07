#include "simulation/sheet_turning.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tissue_contact {
namespace {

/// Rate of a triangle's unit normal, 1/s, of the one of its two that is nearer to `normal`. Area 0: 0.
/// @param x, v of the nodes.
Vector3 rateOfTriangle(const std::array<int, 3>& nodes, const Vector3& normal, const NodalVectors& x,
                       const NodalVectors& v) {
  const auto edge = [&](const NodalVectors& of, int to) -> Vector3 { return of.col(nodes[to]) - of.col(nodes[0]); };
  const Vector3 cross = edge(x, 1).cross(edge(x, 2));
  const double area = cross.norm();  // twice
  if (!(area > 0.0)) return Vector3::Zero();
  const Vector3 n = cross / area;
  const Vector3 rate = (edge(v, 1).cross(edge(x, 2)) + edge(x, 1).cross(edge(v, 2))) / area;
  return std::copysign(1.0, n.dot(normal)) * (rate - n * n.dot(rate));
}

}  // namespace

void SheetTurning::prepare(const std::vector<SolvedContact>& contacts, const std::vector<NodalVectors>& x,
                           const std::vector<NodalVectors>& v) {
  patches_.clear();
  for (const SolvedContact& solved : contacts) {
    const Contact& contact = solved.contact;
    if (thicknessAt(contact.key) == 0.0) continue;
    if (patches_.empty() || !sameShapes(patches_.back().key, contact.key)) patches_.push_back({contact.key});
    const Vector3 n = contact.R_WC.col(0);
    const double weight = std::max(n.dot(solved.force_on_tissue_n), 0.0);
    if (weight == 0.0) continue;
    patches_.back().weight += weight;
    patches_.back().rate += weight * n.cross(rateOfNormal(contact, x, v));
  }
  for (Patch& patch : patches_) {
    if (patch.weight > 0.0) patch.rate /= patch.weight;
  }
}

Vector3 SheetTurning::at(const Contact& contact) const {
  const double thickness = thicknessAt(contact.key);
  if (thickness == 0.0) return Vector3::Zero();
  const auto patch = std::find_if(patches_.begin(), patches_.end(),
                                  [&](const Patch& one) { return sameShapes(one.key, contact.key); });
  // Squeezed: what touches is nearer to the middle.
  const double beside = std::max(0.5 * thickness + std::min(contact.gap_m, 0.0), 0.0);
  return beside * patch->rate.cross(Vector3(contact.R_WC.col(0)));
}

/// Of the sheets on both sides, m; 0: volumes.
double SheetTurning::thicknessAt(const ContactKey& key) const {
  return tissues_[key.tissue].thickness() + (key.instrument < 0 ? tissues_[key.other_tissue].thickness() : 0.0);
}

/// Of the sheet, or the mean of the two, towards the contact's normal.
Vector3 SheetTurning::rateOfNormal(const Contact& contact, const std::vector<NodalVectors>& x,
                                   const std::vector<NodalVectors>& v) const {
  const ContactKey& key = contact.key;
  Vector3 sum = Vector3::Zero();
  int sheets = 0;
  const auto add = [&](int tissue, const std::array<int, 3>& nodes) {
    if (tissues_[tissue].thickness() == 0.0) return;
    sum += rateOfTriangle(nodes, contact.R_WC.col(0), x[tissue], v[tissue]);
    ++sheets;
  };
  add(key.tissue, contact.nodes);
  if (key.instrument < 0) add(key.other_tissue, contact.other_nodes);
  return sheets > 1 ? Vector3(0.5 * sum) : sum;
}

}  // namespace tissue_contact
