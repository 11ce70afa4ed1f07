#include "tissue_contact/simulation/force_error.h"

#include <algorithm>
#include <cmath>

#include "simulation/force_error_estimate.h"
#include "tissue/strain_recovery.h"
#include "tissue_contact/mesh/triangle_mesh.h"
#include "tissue_contact/tissue/element_materials.h"
#include "tissue_contact/tissue/make_elasticity.h"

namespace tissue_contact {
namespace {

constexpr double kRadiiLookedAt =
    4.0;  // around a contact: most of its energy; another tool's contact mostly lies beyond

/// What one instrument does to one tissue.
struct Touch {
  Vector3 force_n = Vector3::Zero();
  Vector3 center_W = Vector3::Zero();  ///< at rest, m, mean by force
  double slip_m = 0.0;                 ///< in the step, mean by force
  double radius_m = 0.0;
};

/// @param first, end contacts of one instrument with the tissue.
Touch touchOf(const Tissue& tissue, const SolvedContact* first, const SolvedContact* end) {
  Touch touch;
  double sum_n = 0.0;
  std::vector<bool> carries(static_cast<std::size_t>(tissue.nodeCount()), false);
  for (const SolvedContact* contact = first; contact != end; ++contact) {
    const double force_n = contact->force_on_tissue_n.norm();
    if (!(force_n > 0.0)) continue;
    for (int i = 0; i < 3; ++i) {
      const int node = contact->contact.nodes[i];
      const double weight = contact->contact.weights[i];
      if (weight == 0.0) continue;
      carries[static_cast<std::size_t>(node)] = true;
      touch.center_W += force_n * weight * tissue.restPositions().col(node);
    }
    if (contact->state == ContactState::kKinetic) touch.slip_m += force_n * contact->slip_W.norm();
    touch.force_n += contact->force_on_tissue_n;
    sum_n += force_n;
  }
  if (!(sum_n > 0.0)) return touch;
  touch.center_W /= sum_n;
  touch.slip_m /= sum_n;
  double area = 0.0;
  for (const Triangle& triangle : tissue.surface()) {
    const auto carrying = std::count_if(triangle.begin(), triangle.end(),
                                        [&](int node) { return carries[static_cast<std::size_t>(node)]; });
    if (carrying > 0) area += static_cast<double>(carrying) / 3.0 * triangleArea(tissue.restPositions(), triangle);
  }
  touch.radius_m = std::sqrt(area / M_PI);
  return touch;
}

std::vector<double> shearModuli(const TissueDescription& description) {
  std::vector<double> moduli = {lameParameters(description.material).mu};
  for (const TissueRegion& region : description.regions) moduli.push_back(lameParameters(region.material).mu);
  return moduli;
}

}  // namespace

double ForceErrorEstimate::total_n() const { return std::hypot(mesh_n, step_n, solver_n); }

double likelyMeshError(double recovered) {
  const double share = 1.7 * recovered * std::sqrt(recovered);
  return share < 1.0 ? share : 1.0;  // not finite as well: nothing is known then
}

double expectedMeshError(double surface_edge_m, double half_extent_m) {
  return 0.5 * std::pow(surface_edge_m / half_extent_m, 1.8);
}

std::vector<ForceErrorEstimate> estimateForceErrors(const Scene& scene, const std::vector<Tissue>& tissues,
                                                    const std::vector<NodalVectors>& x,
                                                    const std::vector<SolvedContact>& contacts,
                                                    const std::vector<double>& changes_n, double momentum_residual) {
  std::vector<ForceErrorEstimate> errors(changes_n.size());
  std::vector<Vector3> forces_n(errors.size(), Vector3(Vector3::Zero()));
  for (std::size_t first = 0, end = 0; first < contacts.size(); first = end) {
    const ContactKey& key = contacts[first].contact.key;
    for (end = first; end < contacts.size(); ++end) {
      const ContactKey& other = contacts[end].contact.key;
      if (other.tissue != key.tissue || other.instrument != key.instrument) break;
    }
    if (key.instrument < 0) continue;
    const auto t = static_cast<std::size_t>(key.tissue);
    const Touch touch = touchOf(tissues[t], contacts.data() + first, contacts.data() + end);
    if (!(touch.radius_m > 0.0)) continue;
    ForceErrorEstimate& error = errors[static_cast<std::size_t>(key.instrument)];
    const double force_n = touch.force_n.norm();
    forces_n[static_cast<std::size_t>(key.instrument)] += touch.force_n;
    error.step_n += force_n * touch.slip_m / touch.radius_m;
    if (!isContinuum(scene.tissues[t].material.model)) {
      error.knows_mesh = false;
      continue;
    }
    error.mesh_n += force_n * likelyMeshError(recoveredStrainError(tissues[t], shearModuli(scene.tissues[t]), x[t],
                                                                   touch.center_W, kRadiiLookedAt * touch.radius_m));
  }
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!errors[i].knows_mesh) errors[i].mesh_n = 0.0;
    errors[i].step_n += 0.5 * changes_n[i];
    errors[i].solver_n = momentum_residual * forces_n[i].norm();
  }
  return errors;
}

}  // namespace tissue_contact
