/// @file
/// Room `contact`: triangle-mesh shape.
#include "contact/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "contact/tolerances.h"

namespace tissue_contact {
namespace {

/// A vertex is a corner when some face around it leans away from the vertex's own normal by more than this cosine
/// (10 degrees); flatter ones belong to faces or to finely divided curved surfaces.
constexpr double kCornerCosine = 0.985;

/// Triangles that have a normal. @throws std::invalid_argument when there is none or an index is out of range.
std::vector<Triangle> usableTriangles(const TriangleMesh& mesh) {
  std::vector<Triangle> usable;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    for (const int v : t) {
      if (v < 0 || v >= mesh.vertices.cols()) {
        throw std::invalid_argument("collision mesh: triangle " + std::to_string(i) + " refers to vertex " +
                                    std::to_string(v) + "; it must be in [0, " +
                                    std::to_string(mesh.vertices.cols() - 1) + "]");
      }
    }
    if (!triangleNormal(mesh.vertices.col(t[0]), mesh.vertices.col(t[1]), mesh.vertices.col(t[2])).isZero(0.0)) {
      usable.push_back(t);
    }
  }
  if (usable.empty()) throw std::invalid_argument("collision mesh: it has no triangle with an area > 0");
  return usable;
}

}  // namespace

MeshDistance::MeshDistance(const TriangleMesh& mesh)
    : vertices_(mesh.vertices), triangles_(usableTriangles(mesh)), tree_(vertices_, triangles_) {
  const Vector3 low = vertices_.rowwise().minCoeff();
  const Vector3 high = vertices_.rowwise().maxCoeff();
  centre_ = 0.5 * (low + high);
  half_ = 0.5 * (high - low);
  size_ = half_.maxCoeff();
  computeNormals();
  findCorners();
}

void MeshDistance::computeNormals() {
  vertex_normals_.assign(vertices_.cols(), Vector3::Zero());
  std::map<std::pair<int, int>, Vector3> sum_of_edge;
  const auto edgeKey = [](int a, int b) { return std::make_pair(std::min(a, b), std::max(a, b)); };
  for (const Triangle& t : triangles_) {
    const Vector3 normal = triangleNormal(vertices_.col(t[0]), vertices_.col(t[1]), vertices_.col(t[2]));
    face_normals_.push_back(normal);
    for (int i = 0; i < 3; ++i) {
      const int v = t[i];
      const int next = t[(i + 1) % 3];
      const Vector3 to_next = vertices_.col(next) - vertices_.col(v);
      const Vector3 to_previous = vertices_.col(t[(i + 2) % 3]) - vertices_.col(v);
      const double angle = std::atan2(to_next.cross(to_previous).norm(), to_next.dot(to_previous));
      vertex_normals_[v] += angle * normal;
      sum_of_edge.emplace(edgeKey(v, next), Vector3::Zero()).first->second += normal;
    }
  }
  for (Vector3& normal : vertex_normals_) normal.normalize();  // leaves a zero vector alone
  for (const Triangle& t : triangles_) {
    edge_normals_.emplace_back();
    for (int i = 0; i < 3; ++i) edge_normals_.back()[i] = sum_of_edge[edgeKey(t[i], t[(i + 1) % 3])].normalized();
  }
}

void MeshDistance::findCorners() {
  std::vector<bool> is_corner(vertices_.cols(), false);
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    for (const int v : triangles_[i]) {
      if (vertex_normals_[v].dot(face_normals_[i]) < kCornerCosine) is_corner[v] = true;
    }
  }
  std::vector<int> corner_of_vertex(vertices_.cols(), -1);
  for (int v = 0; v < vertices_.cols(); ++v) {
    if (!is_corner[v]) continue;
    corner_of_vertex[v] = static_cast<int>(corners_.size());
    corners_.push_back({v, {}});
  }
  for (const Triangle& t : triangles_) {
    for (int i = 0; i < 3; ++i) {
      if (!is_corner[t[i]]) continue;
      std::vector<int>& neighbours = corners_[corner_of_vertex[t[i]]].neighbours;
      neighbours.push_back(t[(i + 1) % 3]);
      neighbours.push_back(t[(i + 2) % 3]);
    }
  }
}

Vector3 MeshDistance::featureNormal(const NearestOnTriangles& nearest) const {
  for (int i = 0; i < 3; ++i) {
    if (nearest.weights[i] == 1.0) return vertex_normals_[triangles_[nearest.triangle][i]];
  }
  for (int i = 0; i < 3; ++i) {
    if (nearest.weights[(i + 2) % 3] == 0.0) return edge_normals_[nearest.triangle][i];
  }
  return face_normals_[nearest.triangle];
}

SignedDistance MeshDistance::at(const Vector3& p_S) const {
  const NearestOnTriangles nearest = tree_.nearest(p_S);
  if (nearest.triangle < 0) return {std::numeric_limits<double>::quiet_NaN(), Vector3::UnitX()};  // p is not finite
  const Vector3 feature_normal = featureNormal(nearest);
  if (nearest.weights.minCoeff() > 0.0) {
    // Inside a face the distance to its plane is exact, also where the points coincide.
    const Vector3 corner = vertices_.col(triangles_[nearest.triangle][0]);
    return {feature_normal.dot(p_S - corner), feature_normal};
  }
  const Vector3 offset = p_S - nearest.point;
  const double distance = std::sqrt(nearest.distance_squared);
  const double sign = offset.dot(feature_normal) < 0.0 ? -1.0 : 1.0;
  if (distance > kTouch * size_) return {sign * distance, sign / distance * offset};
  return {sign * distance, feature_normal.isZero(0.0) ? face_normals_[nearest.triangle] : feature_normal};
}

bool MeshDistance::isForemost(const Corner& corner, const Vector3& forward) const {
  const auto rises = [&](int neighbour) {
    const Vector3 edge = vertices_.col(neighbour) - vertices_.col(corner.vertex);
    return forward.dot(edge) > kCornerSlope * edge.norm();
  };
  return std::none_of(corner.neighbours.begin(), corner.neighbours.end(), rises);
}

void MeshDistance::foremostCorners(const Vector3& forward, const Eigen::AlignedBox3d& box,
                                   std::vector<ShapeCorner>& corners) const {
  corners.clear();
  for (const Corner& corner : corners_) {
    const Vector3 p = vertices_.col(corner.vertex);
    if (box.contains(p) && isForemost(corner, forward)) corners.push_back({corner.vertex, p});
  }
}

std::unique_ptr<ShapeDistance> makeMeshDistance(const TriangleMesh& mesh) {
  return std::make_unique<MeshDistance>(mesh);
}

}  // namespace tissue_contact
