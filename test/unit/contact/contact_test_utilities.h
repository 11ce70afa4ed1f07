/// @file
/// Surfaces, shapes and a slow but independent minimiser for the tests of room `contact`.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "contact/narrow_phase.h"
#include "contact/shape/field_distance.h"
#include "mesh/surface/moving_surface.h"
#include "tissue_contact/contact/contact_detector.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact::contact_test {

/// Uniform numbers from a fixed seed; std::uniform_real_distribution is not the same everywhere.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double number(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967295.0);
  }
  Vector3 vector(double half) { return {number(-half, half), number(-half, half), number(-half, half)}; }
  Vector3 direction() {
    Vector3 v = vector(1.0);
    while (v.norm() > 1.0 || v.norm() < 0.1) v = vector(1.0);
    return v.normalized();
  }
  Pose pose(double half) {
    Pose X = Pose::Identity();
    X.translate(vector(half));
    X.rotate(Eigen::AngleAxisd(number(-3.0, 3.0), direction()));
    return X;
  }

 private:
  std::mt19937 engine_;
};

struct EdgedTool {
  const char* name;
  std::unique_ptr<ShapeDistance> shape;
};

/// Each ends at x = +-.006 and z = +-.002, with edges along y there.
inline std::vector<EdgedTool> edgedTools() {
  std::vector<EdgedTool> all;
  all.push_back({"box", makeBoxDistance({0.006, 0.004, 0.002})});
  all.push_back({"cylinder", makeCylinderDistance(0.006, 0.002)});
  return all;
}

struct Surface {
  NodalVectors nodes;
  std::vector<Triangle> triangles;
  std::vector<bool> fixed() const { return std::vector<bool>(nodes.cols(), false); }
};

/// Closed surface of a box with corners at 0 and `size`, `cells` squares per axis, two triangles each, outward.
inline Surface boxSurface(const Vector3& size, const std::array<int, 3>& cells) {
  std::map<std::array<int, 3>, int> index;
  std::vector<Vector3> points;
  Surface surface;
  const auto node = [&](const std::array<int, 3>& ijk) {
    const auto added = index.emplace(ijk, static_cast<int>(points.size()));
    if (added.second) {
      Vector3 p;
      for (int d = 0; d < 3; ++d) p[d] = size[d] * ijk[d] / cells[d];
      points.push_back(p);
    }
    return added.first->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (const int end : {0, cells[axis]}) {
      for (int i = 0; i < cells[u]; ++i) {
        for (int j = 0; j < cells[v]; ++j) {
          std::array<int, 4> q{};
          for (int k = 0; k < 4; ++k) {
            std::array<int, 3> ijk{};
            ijk[axis] = end;
            ijk[u] = i + (k == 1 || k == 2 ? 1 : 0);
            ijk[v] = j + (k >= 2 ? 1 : 0);
            q[k] = node(ijk);
          }
          if (end == 0) std::swap(q[1], q[3]);
          surface.triangles.push_back({q[0], q[1], q[2]});
          surface.triangles.push_back({q[0], q[2], q[3]});
        }
      }
    }
  }
  surface.nodes.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) surface.nodes.col(static_cast<Eigen::Index>(i)) = points[i];
  return surface;
}

inline TriangleMesh boxMesh(const Vector3& half, int cells) {
  const Surface surface = boxSurface(2.0 * half, {cells, cells, cells});
  return {surface.nodes.colwise() - half, surface.triangles};
}

/// Icosahedron with every triangle cut in four `levels` times, vertices at distance `radius`: convex.
inline TriangleMesh sphereMesh(double radius, int levels) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  std::vector<Vector3> points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                 {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<Triangle> triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto added = middles.emplace(std::minmax(a, b), static_cast<int>(points.size()));
      if (added.second) points.push_back((points[a].normalized() + points[b].normalized()).eval());
      return added.first->second;
    };
    std::vector<Triangle> finer;
    for (const Triangle& t : triangles) {
      const int ab = middle(t[0], t[1]);
      const int bc = middle(t[1], t[2]);
      const int ca = middle(t[2], t[0]);
      for (const Triangle& part :
           {Triangle{t[0], ab, ca}, Triangle{ab, t[1], bc}, Triangle{ca, bc, t[2]}, Triangle{ab, bc, ca}}) {
        finer.push_back(part);
      }
    }
    triangles = finer;
  }
  TriangleMesh mesh;
  mesh.triangles = triangles;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = radius * points[i].normalized();
  }
  return mesh;
}

inline void append(TriangleMesh& mesh, const TriangleMesh& other, const Vector3& offset) {
  const int first = static_cast<int>(mesh.vertices.cols());
  NodalVectors vertices(3, first + other.vertices.cols());
  vertices << mesh.vertices, other.vertices.colwise() + offset;
  mesh.vertices = vertices;
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

inline std::unique_ptr<ShapeDistance> makeMeshDistance(const TriangleMesh& mesh) {
  MeshPreparation silent;
  return std::make_unique<FieldDistance>(prepareMeshField(mesh, "given", silent));
}

/// Smallest value of a convex function on [0, 1] by golden section.
inline double minimiseOnInterval(const std::function<double(double)>& f, double* where = nullptr) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  double low = 0.0;
  double high = 1.0;
  double left = high - ratio * (high - low);
  double right = low + ratio * (high - low);
  double f_left = f(left);
  double f_right = f(right);
  for (int i = 0; i < 60; ++i) {
    if (f_left <= f_right) {
      high = right;
      right = left;
      f_right = f_left;
      left = high - ratio * (high - low);
      f_left = f(left);
    } else {
      low = left;
      left = right;
      f_left = f_right;
      right = low + ratio * (high - low);
      f_right = f(right);
    }
  }
  const double ends = std::min(f(0.0), f(1.0));
  if (where) *where = 0.5 * (low + high);
  return std::min({f_left, f_right, ends});
}

/// Signed distance to a closed outward surface by looking at every triangle: the nearest point, and the sign by the solid
/// angle of the surface seen from p (van Oosterom and Strackee 1983), 4 pi inside and 0 outside.
inline SignedDistance bruteForceDistance(const Surface& surface, const Vector3& p) {
  double least = std::numeric_limits<double>::infinity();
  double solid_angle = 0.0;
  Vector3 way = Vector3::UnitX();
  Vector3 normal = Vector3::UnitX();
  for (const Triangle& t : surface.triangles) {
    const TrianglePoints points(surface.nodes.col(t[0]), surface.nodes.col(t[1]), surface.nodes.col(t[2]));
    const Vector3 to = p - points.pointAt(projectOnTriangle(points.corners, p));
    if (to.norm() < least) {
      least = to.norm();
      way = to;
      normal = points.normal;
    }
    const Vector3 a = points.corners[0] - p, b = points.corners[1] - p, c = points.corners[2] - p;
    const double across = a.dot(b.cross(c));
    const double along =
        a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() + b.dot(c) * a.norm() + c.dot(a) * b.norm();
    solid_angle += 2.0 * std::atan2(across, along);
  }
  const double sign = solid_angle > 2.0 * M_PI ? -1.0 : 1.0;
  return {sign * least, least > 0.0 ? Vector3(sign / least * way) : normal};
}

/// Smallest signed distance over a triangle, for a convex shape: two nested golden sections.
inline double bruteForceMinimum(const ShapeDistance& shape, const TrianglePoints& t) {
  return minimiseOnInterval([&](double u) {
    const Vector3 from = t.corners[0] + u * (t.corners[1] - t.corners[0]);
    const Vector3 to = t.corners[0] + u * (t.corners[2] - t.corners[0]);
    return minimiseOnInterval([&](double v) { return shape.at(from + v * (to - from)).distance; });
  });
}

/// @param fixed by node; none given: all move.
inline std::vector<ShapeContact> findContacts(const ShapeDistance& shape, const Pose& X_WS, const Surface& surface,
                                              double margin, const std::vector<bool>& fixed = {}) {
  const MovingSurface moving(0, {surface.triangles, fixed.empty() ? surface.fixed() : fixed}, surface.nodes);
  NarrowPhase narrow_phase;
  std::vector<int> all(surface.triangles.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  std::vector<ShapeContact> contacts;
  narrow_phase.findContacts(shape, X_WS, moving, all, margin, contacts);
  return contacts;
}

using tissue_contact::pointOf;
inline Vector3 pointOf(const ShapeContact& contact, const NodalVectors& nodes) {
  return pointOf(nodes, contact.nodes, contact.weights);
}

/// A rigid instrument: root, and a tip link with the given shapes.
inline Instrument makeInstrument(const std::string& name, const std::vector<ShapeDescription>& shapes) {
  RobotModel::Link root;
  root.name = "root";
  RobotModel::Link tip;
  tip.name = "tip";
  tip.parent = 0;
  InstrumentDescription description;
  description.name = name;
  description.tip_link = "tip";
  description.contact_links.push_back({"tip", shapes});
  return Instrument(description, RobotModel(name, {root, tip}, {}), Pose::Identity());
}

inline bool sameBits(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(a[i].key == b[i].key) || a[i].nodes != b[i].nodes || a[i].weights != b[i].weights) return false;
    if (a[i].other_nodes != b[i].other_nodes || a[i].other_weights != b[i].other_weights) return false;
    if (a[i].gap_m != b[i].gap_m || std::signbit(a[i].gap_m) != std::signbit(b[i].gap_m)) return false;
    if (a[i].p_WC != b[i].p_WC || a[i].R_WC != b[i].R_WC) return false;
  }
  return true;
}

inline Pose at(const Vector3& p) {
  Pose X = Pose::Identity();
  X.translate(p);
  return X;
}

}  // namespace tissue_contact::contact_test
