#include "tissue/plate_stencil.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mesh/edge_table.h"

namespace tissue_contact {
namespace {

using Matrix32 = Eigen::Matrix<double, 3, 2>;
using Points2 = Eigen::Matrix<double, 2, 3>;

// A patch whose nodes lie nearly on a conic hardly tells the curvature in one direction, and the fit through them would
// magnify noise into stiffness. Relative to the strongest direction (squared).
constexpr double kWeakestDirection = 1e-3;

/// A triangle in its own plane.
struct FlatTriangle {
  Points2 nodes;
  double area;
  std::array<double, 3> lengths;   ///< of the edges
  std::array<Vector2, 3> outward;  ///< unit normals of the edges
  std::array<int, 3> hinges;       ///< -1: border
  std::array<int, 3> neighbours;   ///< -1: border
  std::array<int, 3> their_edge;   ///< the edge as the neighbour numbers it
  Matrix3 slopes;                  ///< (k, h): slope across edge k relative to its own, by its fit, per fold of edge h
};

/// The three quadratics whose curvatures (xx, yy, 2 xy) are the unit vectors, at p.
Vector3 quadratics(const Vector2& p) { return {0.5 * p.x() * p.x(), 0.5 * p.y() * p.y(), 0.5 * p.x() * p.y()}; }

FlatTriangle flatten(const NodalVectors& rest, const Triangle& triangle) {
  const Vector3 e1 = rest.col(triangle[1]) - rest.col(triangle[0]);
  const Vector3 e2 = rest.col(triangle[2]) - rest.col(triangle[0]);
  const Vector3 x = e1.normalized();
  const double height = e1.cross(e2).norm() / e1.norm();
  FlatTriangle flat;
  flat.nodes << 0.0, e1.norm(), x.dot(e2), 0.0, 0.0, height;
  flat.area = 0.5 * e1.norm() * height;
  for (int k = 0; k < 3; ++k) {
    const Vector2 edge = flat.nodes.col((k + 1) % 3) - flat.nodes.col(k);
    flat.lengths[k] = edge.norm();
    flat.outward[k] = Vector2(edge.y(), -edge.x()) / edge.norm();
  }
  flat.hinges.fill(-1);
  flat.neighbours.fill(-1);
  flat.slopes.setZero();
  return flat;
}

/// Where the foot of the perpendicular from c onto the edge lies, as a fraction from a to b, and how long it is.
struct Foot {
  double at;
  double height;
};
Foot footOf(const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 edge = b - a;
  const double squared = edge.squaredNorm();
  return {edge.dot(c - a) / squared, edge.cross(c - a).norm() / std::sqrt(squared)};
}

Hinge makeHinge(const NodalVectors& rest, const std::vector<Triangle>& triangles, const EdgeUse& first,
                const EdgeUse& second) {
  const Triangle& t = triangles[first.triangle];
  Hinge hinge;
  hinge.nodes = {t[first.side], t[(first.side + 1) % 3], t[(first.side + 2) % 3],
                 triangles[second.triangle][(second.side + 2) % 3]};
  const auto x = [&](std::size_t i) { return Vector3(rest.col(hinge.nodes[i])); };
  const Foot c = footOf(x(0), x(1), x(2));
  const Foot d = footOf(x(0), x(1), x(3));
  hinge.jump = {-(1.0 - c.at) / c.height - (1.0 - d.at) / d.height, -c.at / c.height - d.at / d.height, 1.0 / c.height,
                1.0 / d.height};
  return hinge;
}

std::vector<Hinge> makeHinges(const NodalVectors& rest, const std::vector<Triangle>& triangles,
                              std::vector<FlatTriangle>& flats) {
  std::vector<Hinge> hinges;
  const EdgeTable table(triangles);
  for (const EdgeTable::Edge& edge : table) {
    const EdgeTable::Uses uses = table.usesOf(edge);
    if (uses.size() != 2) continue;
    for (const int i : {0, 1}) {
      FlatTriangle& flat = flats[uses[i].triangle];
      flat.hinges[uses[i].side] = static_cast<int>(hinges.size());
      flat.neighbours[uses[i].side] = uses[1 - i].triangle;
      flat.their_edge[uses[i].side] = uses[1 - i].side;
    }
    hinges.push_back(makeHinge(rest, triangles, uses[0], uses[1]));
  }
  return hinges;
}

/// Fold of edge k for each of the quadratics.
Vector3 foldsOfQuadratics(const FlatTriangle& flat, int k, const Hinge& hinge, const NodalVectors& rest,
                          const Triangle& triangle) {
  const Vector2 a = flat.nodes.col(k);
  const Vector2 b = flat.nodes.col((k + 1) % 3);
  const Vector2 c = flat.nodes.col((k + 2) % 3);
  const bool same_way = hinge.nodes[0] == triangle[k];  // else this is the hinge's second triangle
  const int opposite = same_way ? hinge.nodes[3] : hinge.nodes[2];
  const Foot foot = footOf(rest.col(triangle[k]), rest.col(triangle[(k + 1) % 3]), rest.col(opposite));
  const Vector2 d = a + foot.at * (b - a) + foot.height * flat.outward[k];
  const std::array<Vector2, 4> points =
      same_way ? std::array<Vector2, 4>{a, b, c, d} : std::array<Vector2, 4>{b, a, d, c};
  Vector3 folds = Vector3::Zero();
  for (std::size_t i = 0; i < 4; ++i) folds += hinge.jump[i] * quadratics(points[i]);
  return folds;
}

/// Slope of each quadratic across edge k at its middle, relative to that of its linear interpolant in the triangle.
Vector3 slopesOfQuadratics(const FlatTriangle& flat, int k) {
  const Vector2& m = flat.outward[k];
  const Vector2 middle = 0.5 * (flat.nodes.col(k) + flat.nodes.col((k + 1) % 3));
  Vector3 slopes(m.x() * middle.x(), m.y() * middle.y(), 0.5 * (m.x() * middle.y() + m.y() * middle.x()));
  for (int i = 0; i < 3; ++i) {
    const int opposite = (i + 1) % 3;  // edge i+1 is opposite to node i
    const Vector2 gradient = -flat.lengths[opposite] / (2.0 * flat.area) * flat.outward[opposite];
    slopes -= gradient.dot(m) * quadratics(flat.nodes.col(i));
  }
  return slopes;
}

/// Step 1: the fit, as slopes per fold.
void fitSlopes(FlatTriangle& flat, const Triangle& triangle, const std::vector<Hinge>& hinges, const NodalVectors& rest,
               const Matrix3& compliance) {
  Matrix3 folds = Matrix3::Zero();  // rows: edges; those of a border stay zero
  for (int k = 0; k < 3; ++k) {
    if (flat.hinges[k] < 0) continue;
    folds.row(k) = foldsOfQuadratics(flat, k, hinges[flat.hinges[k]], rest, triangle).transpose();
  }
  // Least energy among the curvatures with the given folds: kappa = C F' (F C F')^-1 folds.
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(folds * compliance * folds.transpose());
  const double strongest = eigen.eigenvalues()[2];
  if (!(strongest > 0.0)) return;  // no neighbours
  Matrix3 inverse = Matrix3::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vector3 direction = eigen.eigenvectors().col(i);
    inverse += direction * direction.transpose() / std::max(eigen.eigenvalues()[i], kWeakestDirection * strongest);
  }
  const Matrix3 curvature = compliance * folds.transpose() * inverse;
  for (int k = 0; k < 3; ++k) flat.slopes.row(k) = slopesOfQuadratics(flat, k).transpose() * curvature;
}

void accumulate(CurvatureStencil& stencil, int hinge, const Vector3& column) {
  for (int i = 0; i < stencil.count; ++i) {
    if (stencil.hinges[i] != hinge) continue;
    stencil.columns.col(i) += column;
    return;
  }
  stencil.hinges[stencil.count] = hinge;
  stencil.columns.col(stencil.count++) = column;
}

/// Steps 2 and 3.
CurvatureStencil curvatureOf(const FlatTriangle& flat, const std::vector<FlatTriangle>& flats) {
  CurvatureStencil stencil;
  const auto addSlopes = [&](const FlatTriangle& from, int edge, const Vector3& factor) {
    for (int h = 0; h < 3; ++h) {
      if (from.hinges[h] >= 0) accumulate(stencil, from.hinges[h], from.slopes(edge, h) * factor);
    }
  };
  for (int k = 0; k < 3; ++k) {
    const Vector2& m = flat.outward[k];
    const Vector3 factor = flat.lengths[k] / flat.area * Vector3(m.x() * m.x(), m.y() * m.y(), 2.0 * m.x() * m.y());
    if (flat.hinges[k] < 0) {
      addSlopes(flat, k, factor);
      continue;
    }
    // The neighbour measures outwards from itself: seen from here its slope is fold - slope.
    addSlopes(flat, k, 0.5 * factor);
    accumulate(stencil, flat.hinges[k], 0.5 * factor);
    addSlopes(flats[flat.neighbours[k]], flat.their_edge[k], -0.5 * factor);
  }
  return stencil;
}

}  // namespace

Matrix3 plateTensor(double nu) {
  Matrix3 tensor;
  tensor << 1.0, nu, 0.0, nu, 1.0, 0.0, 0.0, 0.0, 0.5 * (1.0 - nu);
  return tensor;
}

PlateStencils makePlateStencils(const NodalVectors& rest, const std::vector<Triangle>& triangles,
                                const std::vector<double>& poissons_ratio) {
  std::vector<FlatTriangle> flats;
  flats.reserve(triangles.size());
  for (const Triangle& triangle : triangles) flats.push_back(flatten(rest, triangle));
  PlateStencils stencils;
  stencils.hinges = makeHinges(rest, triangles, flats);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    fitSlopes(flats[t], triangles[t], stencils.hinges, rest, plateTensor(poissons_ratio[t]).inverse());
  }
  stencils.triangles.reserve(triangles.size());
  for (const FlatTriangle& flat : flats) stencils.triangles.push_back(curvatureOf(flat, flats));
  return stencils;
}

}  // namespace tissue_contact
