/// @file
/// Sheets, folds and a brief way to call TissuePairDetector, for its tests.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "contact_test_utilities.h"
#include "tissue_contact/contact/tissue_pair_detector.h"

namespace tissue_contact::contact_test {

/// A tissue of a test: its surface now, and at rest (empty: as now).
struct TestTissue {
  Surface surface;
  double thickness = 0.0;
  NodalVectors rest = {};
  std::vector<bool> fixed = {};
};

inline std::vector<TissueSurface> surfacesOf(const std::vector<TestTissue>& tissues) {
  std::vector<TissueSurface> surfaces;
  for (const TestTissue& t : tissues) {
    surfaces.push_back({t.surface.triangles, t.fixed.empty() ? t.surface.fixed() : t.fixed, t.thickness});
  }
  return surfaces;
}

inline std::vector<NodalVectors> positionsOf(const std::vector<TestTissue>& tissues) {
  std::vector<NodalVectors> positions;
  for (const TestTissue& t : tissues) positions.push_back(t.surface.nodes);
  return positions;
}

inline std::vector<Contact> pairContacts(const std::vector<TestTissue>& tissues,
                                         const std::vector<TouchingTissues>& pairs, double margin) {
  std::vector<NodalVectors> rest;
  for (const TestTissue& t : tissues) rest.push_back(t.rest.cols() > 0 ? t.rest : t.surface.nodes);
  TissuePairDetector detector(pairs, shareSurfaces(surfacesOf(tissues), rest));
  std::vector<Contact> contacts;
  detector.detect(positionsOf(tissues), margin, contacts);
  return contacts;
}

/// Open sheet over [0, size.x] x [0, size.y] at z = 0, normals up, the diagonals of the cells alternating.
inline Surface sheetSurface(const Vector2& size, int nx, int ny) {
  Surface sheet;
  sheet.nodes.resize(3, static_cast<Eigen::Index>(nx + 1) * (ny + 1));
  const auto node = [&](int i, int j) { return j * (nx + 1) + i; };
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) sheet.nodes.col(node(i, j)) = Vector3(size.x() * i / nx, size.y() * j / ny, 0.0);
  }
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const int a = node(i, j), b = node(i + 1, j), c = node(i + 1, j + 1), d = node(i, j + 1);
      if ((i + j) % 2 == 0) {
        sheet.triangles.push_back({a, b, c});
        sheet.triangles.push_back({a, c, d});
      } else {
        sheet.triangles.push_back({a, b, d});
        sheet.triangles.push_back({b, c, d});
      }
    }
  }
  return sheet;
}

/// Bends a flat sheet or plate upwards about lines of constant x: straight up to `start`, then an arc of the given
/// radius up to `end`, then straight again. What is above the plane z = 0 stays square to it.
inline NodalVectors bent(const NodalVectors& flat, double start, double end, double radius) {
  NodalVectors result = flat;
  for (Eigen::Index i = 0; i < flat.cols(); ++i) {
    const double s = flat(0, i);
    const double angle = (std::min(std::max(s, start), end) - start) / radius;
    const double straight = s - std::min(std::max(s, start), end);
    const double along = start + radius * std::sin(angle) + straight * std::cos(angle);
    result(0, i) = along - flat(2, i) * std::sin(angle);
    result(2, i) = radius * (1.0 - std::cos(angle)) + straight * std::sin(angle) + flat(2, i) * std::cos(angle);
  }
  return result;
}

/// Half a turn of the given radius in the middle of [0, length], so that one half comes to lie above the other.
inline NodalVectors hairpin(const NodalVectors& flat, double length, double radius) {
  constexpr double kPi = 3.14159265358979323846;
  return bent(flat, 0.5 * (length - kPi * radius), 0.5 * (length + kPi * radius), radius);
}

inline Surface movedBy(Surface surface, const Vector3& by) {
  surface.nodes.colwise() += by;
  return surface;
}

inline Surface transformed(Surface surface, const Pose& X) {
  surface.nodes = ((X.linear() * surface.nodes).colwise() + X.translation()).eval();
  return surface;
}

inline Vector3 tissuePoint(const Contact& c, const NodalVectors& nodes) {
  return tissue_contact::pointOf(nodes, c.nodes, c.weights);
}

inline Vector3 otherPoint(const Contact& c, const NodalVectors& nodes) {
  return tissue_contact::pointOf(nodes, c.other_nodes, c.other_weights);
}

inline Vector3 normalOf(const Contact& c) { return c.R_WC.col(0); }
inline bool isEdgePair(const Contact& c) { return c.key.feature[1] >= 0; }

/// What must hold for the contacts of any scene.
inline void expectSound(const std::vector<TestTissue>& tissues, const std::vector<Contact>& contacts, double margin) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    if (i > 0) {
      EXPECT_TRUE(contacts[i - 1].key < c.key);
    }
    EXPECT_EQ(c.key.instrument, -1);
    EXPECT_NEAR(c.weights.sum(), 1.0, 1e-14);
    EXPECT_NEAR(c.other_weights.sum(), 1.0, 1e-14);
    EXPECT_GE(std::min(c.weights.minCoeff(), c.other_weights.minCoeff()), 0.0);
    EXPECT_LE((c.weights.array() > 0.0).count() + (c.other_weights.array() > 0.0).count(), 4);
    const Vector3 p = tissuePoint(c, tissues[c.key.tissue].surface.nodes);
    const Vector3 q = otherPoint(c, tissues[c.key.other_tissue].surface.nodes);
    const double apart = 0.5 * (tissues[c.key.tissue].thickness + tissues[c.key.other_tissue].thickness);
    EXPECT_EQ(p, c.p_WC);
    EXPECT_NEAR(c.gap_m, normalOf(c).dot(p - q) - apart, 1e-15);
    EXPECT_LE(c.gap_m, margin);
    EXPECT_NEAR(normalOf(c).norm(), 1.0, 1e-14);
    EXPECT_NEAR(c.R_WC.determinant(), 1.0, 1e-12);
  }
}

inline int edgePairs(const std::vector<Contact>& contacts) {
  return static_cast<int>(std::count_if(contacts.begin(), contacts.end(), isEdgePair));
}

}  // namespace tissue_contact::contact_test
