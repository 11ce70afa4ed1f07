#include "contact/triangle_soup.h"

namespace tissue_contact {

TriangleMesh triangleSoup(const std::vector<Vector3>& points) {
  TriangleMesh result;
  result.vertices.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) result.vertices.col(static_cast<Eigen::Index>(i)) = points[i];
  for (int i = 0; i + 2 < static_cast<int>(points.size()); i += 3) result.triangles.push_back({i, i + 1, i + 2});
  return result;
}

}  // namespace tissue_contact
