#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "ros/place/place.h"
#include "ros/place/placed_scene.h"
#include "tissue_contact/simulation/simulator.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {
namespace {

struct SurfacePoint {
  std::size_t tissue = 0;
  Vector3 p_W = Vector3::Zero();
  Vector3 normal_W = Vector3::Zero();
};

/// Where a triangle is above or below x, y, if it is and does not stand upright.
bool meets(const Vector3& a, const Vector3& b, const Vector3& c, double x, double y, SurfacePoint& point) {
  const Vector3 normal = (b - a).cross(c - a);
  if (!(std::abs(normal.z()) > 1e-9 * normal.norm())) return false;
  constexpr double kOnTheEdge = 1e-9;
  const auto area = [&](const Vector3& p, const Vector3& q) {
    return (p.x() - x) * (q.y() - y) - (p.y() - y) * (q.x() - x);
  };
  const Vector3 weights = Vector3(area(b, c), area(c, a), area(a, b)) / normal.z();
  if (!(weights.minCoeff() >= -kOnTheEdge)) return false;
  point.p_W = Vector3(x, y, weights[0] * a.z() + weights[1] * b.z() + weights[2] * c.z());
  point.normal_W = normal.normalized();
  return true;
}

/// The uppermost first; one where triangles of a tissue meet.
std::vector<SurfacePoint> surfacePoints(const Simulator& simulator, double x, double y) {
  std::vector<SurfacePoint> points;
  for (std::size_t t = 0; t < simulator.tissues().size(); ++t) {
    const NodalVectors& nodes = simulator.positions(static_cast<int>(t));
    for (const Triangle& triangle : simulator.tissues()[t].surface()) {
      SurfacePoint point;
      point.tissue = t;
      if (!meets(nodes.col(triangle[0]), nodes.col(triangle[1]), nodes.col(triangle[2]), x, y, point)) continue;
      const auto same = [&](const SurfacePoint& other) {
        return other.tissue == t && (other.p_W - point.p_W).norm() < 1e-9;
      };
      if (std::none_of(points.begin(), points.end(), same)) points.push_back(point);
    }
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const SurfacePoint& a, const SurfacePoint& b) { return a.p_W.z() > b.p_W.z(); });
  return points;
}

std::string extents(const Simulator& simulator) {
  std::ostringstream text;
  for (std::size_t t = 0; t < simulator.tissues().size(); ++t) {
    const NodalVectors& nodes = simulator.positions(static_cast<int>(t));
    const Vector3 low = nodes.rowwise().minCoeff();
    const Vector3 high = nodes.rowwise().maxCoeff();
    text << (t == 0 ? "" : "; ") << "'" << simulator.tissues()[t].name() << "' lies between x " << low.x() << " and "
         << high.x() << ", y " << low.y() << " and " << high.y();
  }
  return text.str();
}

}  // namespace

void placeSurface(const PlaceOptions& options) {
  const PlacedScene placed(options);
  const Simulator simulator(placed.scene, placed.environment);
  const std::vector<SurfacePoint> points = surfacePoints(simulator, options.x_m, options.y_m);
  if (points.empty()) {
    std::ostringstream text;
    text << "no tissue above or below x " << options.x_m << ", y " << options.y_m << " m: " << extents(simulator);
    throw std::runtime_error(text.str());
  }
  std::cout.precision(6);
  for (const SurfacePoint& point : points) {
    const TissueDescription& tissue = placed.scene.tissues[point.tissue];
    const Vector3& p = point.p_W;
    const Vector3 n = point.normal_W.unaryExpr([](double x) { return std::round(x * 1e6) / 1e6 + 0.0; });
    std::cout << "- {tissue: " << tissue.name << ", point_m: [" << p.x() << ", " << p.y() << ", " << p.z()
              << "], normal: [" << n.x() << ", " << n.y() << ", " << n.z()
              << "], model: " << elasticModelName(tissue.material.model)
              << ", youngs_modulus_pa: " << tissue.material.youngs_modulus_pa
              << ", poissons_ratio: " << tissue.material.poissons_ratio << "}\n";
  }
}

}  // namespace tissue_contact
