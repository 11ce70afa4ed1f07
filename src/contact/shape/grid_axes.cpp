#include "contact/shape/grid_axes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "contact/shape/sample_distance.h"
#include "mesh/surface/triangle_geometry.h"

namespace tissue_contact {
namespace {

/// Volume of the grid around points along axes R, m^3.
double volumeAround(const NodalVectors& points, const Matrix3& R) {
  const NodalVectors turned = R.transpose() * points;
  return paddedExtent(turned).prod();
}

/// The farthest points in directions all around: the box around these is about that around all.
NodalVectors outermost(const NodalVectors& x) {
  constexpr int kDirections = 128;
  constexpr double kGoldenAngle = 2.399963229728653;
  NodalVectors points(3, Eigen::Index{2} * kDirections);
  for (int i = 0; i < kDirections; ++i) {
    const double z = (i + 0.5) / kDirections;  // of half a sphere, evenly
    const double r = std::sqrt(1.0 - z * z);
    const Vector3 direction(r * std::cos(kGoldenAngle * i), r * std::sin(kGoldenAngle * i), z);
    const Eigen::RowVectorXd along = direction.transpose() * x;
    Eigen::Index at = 0;
    along.maxCoeff(&at);
    points.col(2 * i) = x.col(at);
    along.minCoeff(&at);
    points.col(2 * i + 1) = x.col(at);
  }
  return points;
}

/// From the most extended to the least.
Matrix3 principalAxes(const TriangleMesh& mesh) {
  double area = 0.0;
  Vector3 first = Vector3::Zero();
  Matrix3 second = Matrix3::Zero();
  const Vector3 about = mesh.vertices.rowwise().mean();
  for (const Triangle& t : mesh.triangles) {
    const double share = triangleArea(mesh.vertices, t);
    Vector3 sum = Vector3::Zero();
    for (const int v : t) {
      const Vector3 p = mesh.vertices.col(v) - about;
      sum += p;
      second += share / 12.0 * p * p.transpose();
    }
    second += share / 12.0 * sum * sum.transpose();
    first += share / 3.0 * sum;
    area += share;
  }
  const Matrix3 spread = second / area - (first / area) * (first / area).transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(spread);
  Matrix3 R = solver.eigenvectors();
  if (R.determinant() < 0.0) R.col(0) = -R.col(0);
  return R;
}

/// Turned about one axis after the other to where the volume is least.
Matrix3 leastBox(const NodalVectors& points, Matrix3 R) {
  constexpr int kRounds = 4;
  double least = volumeAround(points, R);
  for (int turn = 0; turn < 3 * kRounds; ++turn) {
    double step = M_PI / 180.0;
    int steps = 45;
    for (int level = 0; level < 5; ++level) {  // a quarter of a turn, then ever finer
      const Matrix3 from = R;
      for (int i = -steps; i <= steps; ++i) {
        const Matrix3 tried = from * Eigen::AngleAxisd(i * step, Vector3::Unit(turn % 3)).toRotationMatrix();
        const double volume = volumeAround(points, tried);
        if (!(volume < least)) continue;
        least = volume;
        R = tried;
      }
      step *= 0.2;
      steps = 5;
    }
  }
  return R;
}

}  // namespace

Matrix3 gridAxes(const TriangleMesh& mesh) {
  constexpr double kMuch = 0.75;  // of the volume: samples a tenth nearer to each other
  const NodalVectors points = outermost(mesh.vertices);
  Matrix3 best = Matrix3::Identity();
  double least = kMuch * volumeAround(mesh.vertices, best);
  for (const Matrix3& start : {Matrix3(Matrix3::Identity()), principalAxes(mesh)}) {
    if (!start.allFinite()) continue;
    const Matrix3 R = leastBox(points, start);
    const double volume = volumeAround(mesh.vertices, R);
    if (!(volume < least)) continue;
    least = volume;
    best = R;
  }
  return best;
}

}  // namespace tissue_contact
