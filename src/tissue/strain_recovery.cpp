#include "tissue/strain_recovery.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

struct StrainedElement {
  int element;
  int region;   ///< index into shear_moduli of the first that is the same
  bool counts;  ///< else only its nodes' means need it
  double volume;
  Vector6 strain;  ///< xx, yy, zz and sqrt(2) times yz, zx, xy: its norm is the tensor's
};

/// @param D edges at rest.
Vector6 deviatoricGreenStrain(const Matrix3& D, const NodalVectors& x, const Tetrahedron& element) {
  const Matrix3 F = edgeMatrix(x, element) * D.inverse();
  const Matrix3 C = F.transpose() * F;
  const double mean = C.trace() / 3.0;
  Vector6 twice;
  twice << C(0, 0) - mean, C(1, 1) - mean, C(2, 2) - mean, M_SQRT2 * C(2, 1), M_SQRT2 * C(0, 2), M_SQRT2 * C(1, 0);
  return 0.5 * twice;
}

/// Those that count and all that share a node with them.
std::vector<StrainedElement> strainedElements(const Tissue& tissue, const std::vector<double>& shear_moduli,
                                              const NodalVectors& x, const Vector3& center_W, double radius_m) {
  const NodalVectors& rest = tissue.restPositions();
  const std::vector<Tetrahedron>& elements = tissue.tetrahedra();
  const std::vector<int>& regions = tissue.elementRegions();
  std::vector<bool> counts(elements.size(), false);
  std::vector<bool> is_of_them(static_cast<std::size_t>(tissue.nodeCount()), false);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    Vector3 centroid = Vector3::Zero();
    for (const int node : elements[e]) centroid += 0.25 * rest.col(node);
    counts[e] = (centroid - center_W).squaredNorm() <= radius_m * radius_m;
    if (!counts[e]) continue;
    for (const int node : elements[e]) is_of_them[static_cast<std::size_t>(node)] = true;
  }
  const auto materialOf = [&](std::size_t element) {
    const double modulus = shear_moduli[regions.empty() ? 0 : static_cast<std::size_t>(regions[element] + 1)];
    return static_cast<int>(std::find(shear_moduli.begin(), shear_moduli.end(), modulus) - shear_moduli.begin());
  };
  std::vector<StrainedElement> strained;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const auto is_needed = [&](int node) { return is_of_them[static_cast<std::size_t>(node)]; };
    if (std::none_of(elements[e].begin(), elements[e].end(), is_needed)) continue;
    const Matrix3 D = edgeMatrix(rest, elements[e]);
    strained.push_back({static_cast<int>(e), materialOf(e), counts[e], D.determinant() / 6.0,
                        deviatoricGreenStrain(D, x, elements[e])});
  }
  return strained;
}

}  // namespace

double recoveredStrainError(const Tissue& tissue, const std::vector<double>& shear_moduli, const NodalVectors& x,
                            const Vector3& center_W, double radius_m) {
  const std::vector<StrainedElement> strained = strainedElements(tissue, shear_moduli, x, center_W, radius_m);
  std::vector<Vector6> mean(static_cast<std::size_t>(tissue.nodeCount()));
  std::vector<double> volume(mean.size());
  double error = 0.0;
  double energy = 0.0;
  for (std::size_t region = 0; region < shear_moduli.size(); ++region) {
    std::fill(mean.begin(), mean.end(), Vector6(Vector6::Zero()));
    std::fill(volume.begin(), volume.end(), 0.0);
    const auto is_of_region = [&](const StrainedElement& one) { return one.region == static_cast<int>(region); };
    if (std::none_of(strained.begin(), strained.end(), is_of_region)) continue;
    for (const StrainedElement& one : strained) {
      if (!is_of_region(one)) continue;
      for (const int node : tissue.tetrahedra()[static_cast<std::size_t>(one.element)]) {
        mean[static_cast<std::size_t>(node)] += one.volume * one.strain;
        volume[static_cast<std::size_t>(node)] += one.volume;
      }
    }
    for (std::size_t node = 0; node < mean.size(); ++node) {
      if (volume[node] > 0.0) mean[node] /= volume[node];
    }
    for (const StrainedElement& one : strained) {
      if (!one.counts || !is_of_region(one)) continue;
      // Of a field d that is linear in a tetrahedron: int |d|^2 = V / 20 (sum_i |d_i|^2 + |sum_i d_i|^2).
      Vector6 sum = Vector6::Zero();
      double squares = 0.0;
      for (const int node : tissue.tetrahedra()[static_cast<std::size_t>(one.element)]) {
        const Vector6 d = mean[static_cast<std::size_t>(node)] - one.strain;
        sum += d;
        squares += d.squaredNorm();
      }
      error += shear_moduli[region] * one.volume / 20.0 * (squares + sum.squaredNorm());
      energy += shear_moduli[region] * one.volume * one.strain.squaredNorm();
    }
  }
  return energy > 0.0 ? error / energy : 0.0;
}

}  // namespace tissue_contact
