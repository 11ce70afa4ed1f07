#include "simulation/nodal_fields.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/simulation/law_error.h"

namespace tissue_contact {
namespace {

/// Two edges of a triangle and its unit normal, so that the thickness counts as unchanged.
Matrix3 edgesAndNormal(const NodalVectors& x, const Triangle& triangle) {
  Matrix3 D;
  D.col(0) = x.col(triangle[1]) - x.col(triangle[0]);
  D.col(1) = x.col(triangle[2]) - x.col(triangle[0]);
  D.col(2) = D.col(0).cross(D.col(1)).normalized();
  return D;
}

Matrix3 edges(const NodalVectors& x, const Tetrahedron& element) { return edgeMatrix(x, element); }
Matrix3 edges(const NodalVectors& x, const Triangle& element) { return edgesAndNormal(x, element); }

template <typename Element>
void meanStrain(const std::vector<Element>& elements, const NodalVectors& rest, const NodalVectors& x,
                VectorX& strain) {
  VectorX sizes = VectorX::Zero(rest.cols());
  for (const Element& element : elements) {
    const Matrix3 D = edges(rest, element);
    const double size = std::abs(D.determinant());  // all that counts are ratios
    const double of_element = size * equivalentStrain(edges(x, element) * D.inverse());
    for (const int node : element) {
      strain[node] += of_element;
      sizes[node] += size;
    }
  }
  for (Eigen::Index node = 0; node < strain.size(); ++node) {
    if (sizes[node] > 0.0) strain[node] /= sizes[node];
  }
}

/// Adds to `loads` the forces along the normals of their contacts.
void addLoad(const Contact& contact, const std::array<int, 3>& nodes, const Vector3& weights, const Vector3& force,
             NodalVectors& loads) {
  const Vector3 n = contact.R_WC.col(0);
  for (int i = 0; i < 3; ++i) {
    if (nodes[i] < loads.cols()) loads.col(nodes[i]) += weights[i] * n.dot(force) * n;
  }
}

}  // namespace

void nodalAreas(const std::vector<Triangle>& surface, const NodalVectors& x, NodalVectors& areas) {
  areas.setZero(3, x.cols());
  for (const Triangle& t : surface) {
    const Vector3 third = (x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0])) / 6.0;
    for (const int node : t) areas.col(node) += third;
  }
}

void nodalPressure(const std::vector<SolvedContact>& contacts, int tissue, const NodalVectors& areas, bool is_membrane,
                   VectorX& pressure) {
  NodalVectors loads = NodalVectors::Zero(3, areas.cols());
  for (const SolvedContact& solved : contacts) {
    const Contact& contact = solved.contact;
    if (contact.key.tissue == tissue) {
      addLoad(contact, contact.nodes, contact.weights, solved.force_on_tissue_n, loads);
    }
    if (contact.key.other_tissue == tissue) {
      addLoad(contact, contact.other_nodes, contact.other_weights, -solved.force_on_tissue_n, loads);
    }
  }
  pressure.setZero(areas.cols());
  for (Eigen::Index node = 0; node < areas.cols(); ++node) {
    const double area_squared = areas.col(node).squaredNorm();
    if (!(area_squared > 0.0)) continue;
    const double inward = -loads.col(node).dot(areas.col(node)) / area_squared;
    pressure[node] = is_membrane ? std::abs(inward) : std::max(inward, 0.0);
  }
}

void nodalStrain(const std::vector<Tetrahedron>& tetrahedra, const std::vector<Triangle>& surface,
                 const NodalVectors& rest, const NodalVectors& x, VectorX& strain) {
  strain.setZero(rest.cols());
  if (tetrahedra.empty()) {
    meanStrain(surface, rest, x, strain);
  } else {
    meanStrain(tetrahedra, rest, x, strain);
  }
}

}  // namespace tissue_contact
