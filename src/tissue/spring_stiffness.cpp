#include "tissue/spring_stiffness.h"

#include <Eigen/QR>
#include <algorithm>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

using Vector15 = Eigen::Matrix<double, 15, 1>;

/// An edge as one of its tetrahedra sees it.
struct EdgeShare {
  std::array<int, 2> nodes;
  double volume;     ///< of the tetrahedron, m^3
  double stiffness;  ///< its E V / L^2, N/m
  double damping;
};

std::vector<EdgeShare> edgeShares(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                                  const ElementMaterials& materials) {
  std::vector<EdgeShare> shares;
  shares.reserve(6 * tetrahedra.size());
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    const Tetrahedron& tet = tetrahedra[e];
    const double volume = signedVolume(rest, tet);
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double k =
            materials.of(e).youngs_modulus_pa * volume / (rest.col(tet[i]) - rest.col(tet[j])).squaredNorm();
        shares.push_back({{std::min(tet[i], tet[j]), std::max(tet[i], tet[j])}, volume, k, materials.dampingOf(e) * k});
      }
    }
  }
  // Stable: the sums below must not depend on how equal edges were left.
  std::stable_sort(shares.begin(), shares.end(),
                   [](const EdgeShare& a, const EdgeShare& b) { return a.nodes < b.nodes; });
  return shares;
}

/// The independent components of n n n n.
Vector15 quartics(const Vector3& n) {
  Vector15 q;
  int next = 0;
  for (int a = 0; a <= 4; ++a) {
    for (int b = 0; a + b <= 4; ++b) {
      double product = 1.0;
      for (int i = 0; i < a; ++i) product *= n.x();
      for (int i = 0; i < b; ++i) product *= n.y();
      for (int i = a + b; i < 4; ++i) product *= n.z();
      q[next++] = product;
    }
  }
  return q;
}

/// Their mean over all directions: x^4 -> 1/5, x^2 y^2 -> 1/15, odd powers -> 0.
Vector15 isotropicQuartics() {
  Vector15 q;
  int next = 0;
  for (int a = 0; a <= 4; ++a) {
    for (int b = 0; a + b <= 4; ++b) {
      const int c = 4 - a - b;
      const bool odd = a % 2 != 0 || b % 2 != 0 || c % 2 != 0;
      q[next++] = odd ? 0.0 : (a == 4 || b == 4 || c == 4 ? 1.0 / 5.0 : 1.0 / 15.0);
    }
  }
  return q;
}

Vector3 direction(const NodalVectors& rest, const std::array<int, 2>& nodes) {
  return (rest.col(nodes[1]) - rest.col(nodes[0])).normalized();
}

/// Factors w per share: the least deviation from 1, linear in the quartics, that makes sum V w nnnn isotropic. Of
/// geometry alone, so that regions of different modulus keep their ratio. As solved: springs cannot have all of them.
std::vector<double> wantedFactors(const NodalVectors& rest, const std::vector<EdgeShare>& shares) {
  Eigen::Matrix<double, 15, 15> gram = Eigen::Matrix<double, 15, 15>::Zero();
  Vector15 missing = Vector15::Zero();
  double total = 0.0;
  for (const EdgeShare& share : shares) total += share.volume;
  for (const EdgeShare& share : shares) {
    const Vector15 q = quartics(direction(rest, share.nodes));
    const double part = share.volume / total;
    gram += part * q * q.transpose();
    missing += part * (isotropicQuartics() - q);
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix<double, 15, 15>> decomposition;
  decomposition.setThreshold(1e-9);  // a mesh with few edge directions leaves components of s undetermined: 0 then
  const Vector15 s = decomposition.compute(gram).solve(missing);
  std::vector<double> factors;
  factors.reserve(shares.size());
  for (const EdgeShare& share : shares) factors.push_back(1.0 + s.dot(quartics(direction(rest, share.nodes))));
  return factors;
}

/// Those that springs have.
std::vector<double> boundedFactors(const NodalVectors& rest, const std::vector<EdgeShare>& shares) {
  constexpr double kMost = 10.0;
  std::vector<double> factors = wantedFactors(rest, shares);
  double total = 0.0;
  for (const EdgeShare& share : shares) total += share.volume;
  double dilation = 0.0;  // energy of a uniform dilation over the right one
  for (std::size_t i = 0; i < shares.size(); ++i) {
    factors[i] = std::clamp(factors[i], kLeastSpringFactor, kMost);
    dilation += factors[i] * shares[i].volume / total;
  }
  for (double& factor : factors) factor /= dilation;
  return factors;
}

}  // namespace

std::vector<Spring> makeSprings(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                                const ElementMaterials& materials) {
  const std::vector<EdgeShare> shares = edgeShares(rest, tetrahedra, materials);
  const std::vector<double> factors = boundedFactors(rest, shares);
  std::vector<Spring> springs;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const EdgeShare& share = shares[i];
    if (springs.empty() || springs.back().nodes != share.nodes) {
      springs.push_back({share.nodes, (rest.col(share.nodes[1]) - rest.col(share.nodes[0])).norm(), 0.0, 0.0, {}});
    }
    springs.back().stiffness += factors[i] * share.stiffness;
    springs.back().damping += factors[i] * share.damping;
  }
  return springs;
}

double leastWantedSpringFactor(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra) {
  const MaterialDescription any;  // factors are of geometry alone
  const std::vector<double> factors = wantedFactors(rest, edgeShares(rest, tetrahedra, any));
  return *std::min_element(factors.begin(), factors.end());
}

}  // namespace tissue_contact
