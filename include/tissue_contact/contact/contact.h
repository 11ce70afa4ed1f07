/// @file
/// Room `contact`: what detection hands to the solver.
#pragma once

#include <array>
#include <tuple>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Names one contact across steps: which shape (or surface feature of another tissue) touches which surface feature.
/// Ordered, so contacts can be sorted.
struct ContactKey {
  int tissue = -1;
  int instrument = -1;  ///< -1: tissue against tissue
  int link = -1;        ///< index into Instrument::contactLinks()
  int shape = -1;       ///< index into ContactLink::shapes
  /// Surface feature as sorted node indices: vertex (a, -1, -1), edge (a, b, -1), face (a, b, c).
  std::array<int, 3> feature = {-1, -1, -1};
  int corner = -1;  ///< corner or vertex of the shape this contact belongs to, -1 for the closest point of the feature
  /// 0: found in this step; 1 to kKeptPoints: a point of the same feature kept from earlier steps (ContactMemory).
  int slot = 0;
  int other_tissue = -1;  ///< tissue against tissue: the one in the instrument's place, else -1
  std::array<int, 3> other_feature = {-1, -1, -1};

  auto tied() const {
    return std::tie(tissue, instrument, link, shape, feature, corner, slot, other_tissue, other_feature);
  }
  friend bool operator<(const ContactKey& a, const ContactKey& b) { return a.tied() < b.tied(); }
  friend bool operator==(const ContactKey& a, const ContactKey& b) { return a.tied() == b.tied(); }
};

/// Both contacts are of the same shape, or other tissue, on the same tissue.
inline bool sameShapes(const ContactKey& a, const ContactKey& b) {
  return a.tissue == b.tissue && a.instrument == b.instrument && a.link == b.link && a.shape == b.shape &&
         a.other_tissue == b.other_tissue;
}

/// A closest-point pair between a tissue surface point and an instrument shape, or a point of another tissue's surface
/// that takes the shape's place: n then points from `other_tissue` into `tissue`.
struct Contact {
  ContactKey key;
  std::array<int, 3> nodes = {0, 0, 0};  ///< tissue nodes of the surface triangle
  Vector3 weights = Vector3::Zero();     ///< barycentric, >= 0, sum 1: the tissue point is sum weights[i] * x[nodes[i]]
  Vector3 p_WC = Vector3::Zero();        ///< tissue point, m
  /// Columns (n, t1, t2); n is unit and points from the instrument INTO the tissue.
  Matrix3 R_WC = Matrix3::Identity();
  double gap_m = 0.0;  ///< signed distance from shape to tissue point; < 0: penetrating
  /// n less the gradient of the gap: 0, but for a vertex, which is pressed along the mean of the shape's normals around it.
  Vector3 lean_W = Vector3::Zero();
  std::array<int, 3> other_nodes = {0, 0, 0};  ///< tissue against tissue: nodes of the other surface point
  Vector3 other_weights = Vector3::Zero();     ///< and their barycentric weights
};

/// Any right-handed frame with the given unit normal as first column; a continuous function of n except at one point.
Matrix3 contactFrame(const Vector3& n);

}  // namespace tissue_contact
