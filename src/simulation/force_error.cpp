#include "tissue_contact/simulation/force_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "simulation/force_error_estimate.h"
#include "tissue/strain_recovery.h"
#include "tissue_contact/mesh/triangle_mesh.h"
#include "tissue_contact/tissue/element_materials.h"
#include "tissue_contact/tissue/make_elasticity.h"

namespace tissue_contact {
namespace {

/// Around a contact, in contact radii: most of its energy, and mostly not that of another.
constexpr double kRadiiLookedAt = 4.0;
/// Under a shape that so few nodes carry, strain is as smooth as the few elements around make it, however wrong: lengths tell more.
constexpr int kFewNodes = 5;
/// What a step leaves of the turn of normals in a slide, which frames follow (doc/method.md, "Contact frames and landing"): between the 0.13 to 0.30 of it that
/// drags of a ball and the recorded robot meet (doc/notes/accuracy.md).
constexpr double kOfTurn = 0.18;

/// What is left unbalanced acts on the tissue as a force that nobody exerts. Near the tool or on tissue that moves with it as a whole, all of
/// it is missing from the tool's; near fixed nodes, none. Found: .3 to 1.3 of it on a liver and a column, .6 to .8 in grasps, .2 to .6 in drags over slabs.
constexpr double kOfUnbalanced = 0.7;

/// What one shape does to one tissue.
struct Touch {
  double sum_n = 0.0;                  ///< of the magnitudes of its contact forces
  Vector3 center_W = Vector3::Zero();  ///< at rest, m, mean by force
  double slip_m = 0.0;                 ///< in the step, mean by force
  double radius_m = 0.0;
  long nodes = 0;           ///< that carry force
  double edge_m = 0.0;      ///< mean of the triangles around them
  double softened_n = 0.0;  ///< of the force, what vertices that carry it alone take away
};

/// A node that carries force.
struct Bearing {
  double force_n = 0.0;
  double at_vertex_n = 0.0;            ///< of it, by the node's own contact
  Vector3 normal_W = Vector3::Zero();  ///< times force_n, of the shape
};

/// 4 mu / (1 - nu): dF/dd of a round patch of radius a on a half-space, over a (Sneddon, Int. J. Eng. Sci. 3 (1965) 47-57, of any shape of revolution).
double contactModulus(const MaterialDescription& material) {
  return 4.0 * lameParameters(material).mu / (1.0 - material.poissons_ratio);
}

/// Between vertices that lie on the shape flat triangles cut into it, by (1/24) sum over edges of dx . dn in the mean for edges dx along which its normals turn by dn (on a
/// sphere: sum l^2 / (24 R)), as if the shape were that much less deep. N, by the triangles all of whose corners carry, each by
/// what its corners do.
/// @param at per node: index into `bearings`, or -1.
double softenedByChords(const Tissue& tissue, const TissueDescription& description, const NodalVectors& x,
                        const std::vector<int>& at, const std::vector<Bearing>& bearings) {
  double area = 0.0, cut_n = 0.0, force_n = 0.0;
  for (std::size_t k = 0; k < tissue.surface().size(); ++k) {
    const Triangle& triangle = tissue.surface()[k];
    std::array<const Bearing*, 3> corners{};
    for (int i = 0; i < 3; ++i) {
      const int index = at[static_cast<std::size_t>(triangle[i])];
      if (index >= 0) corners[i] = &bearings[static_cast<std::size_t>(index)];
    }
    const auto carrying = 3 - std::count(corners.begin(), corners.end(), nullptr);
    if (carrying == 0) continue;
    area += static_cast<double>(carrying) / 3.0 * triangleArea(x, triangle);
    if (carrying < 3) continue;
    double depth_m = 0.0, corners_n = 0.0, vertices_n = 0.0;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const Vector3 edge = x.col(triangle[i]) - x.col(triangle[j]);
      depth_m += edge.dot(corners[i]->normal_W.normalized() - corners[j]->normal_W.normalized()) / 24.0;
      corners_n += corners[i]->force_n;
      vertices_n += corners[i]->at_vertex_n;
    }
    const int region = tissue.surfaceRegions().empty() ? -1 : tissue.surfaceRegions()[k];
    const MaterialDescription& material =
        region < 0 ? description.material : description.regions[static_cast<std::size_t>(region)].material;
    cut_n += vertices_n * contactModulus(material) * depth_m;
    force_n += corners_n;
  }
  return force_n > 0.0 ? std::sqrt(area / M_PI) * cut_n / force_n : 0.0;
}

/// @param x positions, m.
/// @param first, end contacts of the shape with the tissue.
Touch touchOf(const Tissue& tissue, const TissueDescription& description, const NodalVectors& x,
              const SolvedContact* first, const SolvedContact* end) {
  Touch touch;
  std::vector<int> at(static_cast<std::size_t>(tissue.nodeCount()), -1);
  std::vector<Bearing> bearings;
  for (const SolvedContact* contact = first; contact != end; ++contact) {
    const double force_n = contact->force_on_tissue_n.norm();
    if (!(force_n > 0.0)) continue;
    for (int i = 0; i < 3; ++i) {
      const int node = contact->contact.nodes[i];
      const double weight = contact->contact.weights[i];
      if (weight == 0.0) continue;
      int& index = at[static_cast<std::size_t>(node)];
      if (index < 0) {
        index = static_cast<int>(bearings.size());
        bearings.emplace_back();
      }
      Bearing& bearing = bearings[static_cast<std::size_t>(index)];
      bearing.force_n += force_n * weight;
      bearing.normal_W += force_n * weight * contact->contact.R_WC.col(0);
      if (contact->contact.key.feature[1] < 0) bearing.at_vertex_n += force_n * weight;
      touch.center_W += force_n * weight * tissue.restPositions().col(node);
    }
    if (contact->state == ContactState::kKinetic) touch.slip_m += force_n * contact->slip_W.norm();
    touch.sum_n += force_n;
  }
  if (!(touch.sum_n > 0.0)) return touch;
  touch.center_W /= touch.sum_n;
  touch.slip_m /= touch.sum_n;
  touch.nodes = static_cast<long>(bearings.size());
  const NodalVectors& rest = tissue.restPositions();
  double area = 0.0;
  double edges_m = 0.0;
  int triangles = 0;
  for (const Triangle& triangle : tissue.surface()) {
    const auto carrying = std::count_if(triangle.begin(), triangle.end(),
                                        [&](int node) { return at[static_cast<std::size_t>(node)] >= 0; });
    if (carrying == 0) continue;
    area += static_cast<double>(carrying) / 3.0 * triangleArea(rest, triangle);
    ++triangles;
    for (int i = 0; i < 3; ++i) edges_m += (rest.col(triangle[i]) - rest.col(triangle[(i + 1) % 3])).norm() / 3.0;
  }
  touch.edge_m = edges_m / std::max(triangles, 1);
  touch.radius_m = std::sqrt(area / M_PI);
  touch.softened_n = softenedByChords(tissue, description, x, at, bearings);
  return touch;
}

std::vector<double> shearModuli(const TissueDescription& description) {
  std::vector<double> moduli = {lameParameters(description.material).mu};
  for (const TissueRegion& region : description.regions) moduli.push_back(lameParameters(region.material).mu);
  return moduli;
}

}  // namespace

double ForceErrorEstimate::total_n() const { return std::hypot(mesh_n, step_n, solver_n); }

MeshErrorFactors meshErrorFactors(const ElementMaterials& materials) {
  if (!averagesDistortion(materials)) return {2.2, 0.5};
  if (!averagesDilatation(materials)) return {2.2, 0.4};
  return {0.97, 0.3};
}

double likelyMeshError(double recovered, double softened, const MeshErrorFactors& factors) {
  constexpr double kUncertain = 0.6;
  const double stiffened = factors.of_strain * std::pow(recovered, 1.7);
  const double share = std::hypot(stiffened - softened, kUncertain * stiffened);
  return share < 1.0 ? share : 1.0;  // not finite as well: nothing is known then
}

double expectedMeshError(double surface_edge_m, double half_extent_m, const MeshErrorFactors& factors) {
  return factors.of_lengths * std::pow(surface_edge_m / half_extent_m, 1.8);
}

std::vector<ForceErrorEstimate> estimateForceErrors(const Scene& scene, const std::vector<Tissue>& tissues,
                                                    const std::vector<NodalVectors>& x,
                                                    const std::vector<SolvedContact>& contacts,
                                                    const TouchedPlaces& shapes, std::size_t instruments,
                                                    const std::vector<MomentumRate>& momentum_rates,
                                                    double unbalanced_n) {
  std::vector<ForceErrorEstimate> errors(instruments);
  std::vector<double> pressed_n(instruments, 0.0);
  std::vector<double> borne_n(tissues.size(), 0.0);
  for (const SolvedContact& solved : contacts) {
    if (solved.contact.key.instrument >= 0) borne_n[solved.contact.key.tissue] += solved.force_on_tissue_n.norm();
  }
  for (std::size_t first = 0, end = 0; first < contacts.size(); first = end) {
    const ContactKey& key = contacts[first].contact.key;
    const auto t = static_cast<std::size_t>(key.tissue);
    const bool judges_mesh = isContinuum(scene.tissues[t].material.model);
    const MeshErrorFactors factors = meshErrorFactors(materialsOf(scene.tissues[t]));
    Vector3 force_n = Vector3::Zero();  // jaws that grip press against each other: what is left is what the wrench has
    double sum_n = 0.0, mesh = 0.0, step = 0.0;  // shares times the forces of the shapes
    for (std::size_t shape = first; shape < contacts.size(); shape = end) {
      const ContactKey& of_shape = contacts[shape].contact.key;
      if (of_shape.tissue != key.tissue || of_shape.instrument != key.instrument) break;
      for (end = shape; end < contacts.size() && sameShapes(contacts[end].contact.key, of_shape); ++end) {
        force_n += contacts[end].force_on_tissue_n;
      }
      if (key.instrument < 0) continue;
      const Touch touch = touchOf(tissues[t], scene.tissues[t], x[t], contacts.data() + shape, contacts.data() + end);
      if (!(touch.radius_m > 0.0)) continue;
      sum_n += touch.sum_n;
      step += touch.sum_n * kOfTurn * touch.slip_m / touch.radius_m;
      if (!judges_mesh) continue;
      double share = likelyMeshError(recoveredStrainError(tissues[t], shearModuli(scene.tissues[t]), x[t],
                                                          touch.center_W, kRadiiLookedAt * touch.radius_m),
                                     touch.softened_n / touch.sum_n, factors);
      const double half_extent_m = shapes.halfExtent(of_shape.instrument, of_shape.link, of_shape.shape);
      if (touch.nodes <= kFewNodes && half_extent_m > 0.0) {  // of the force found, not of the right one
        share = std::max(share, 1.0 - 1.0 / (1.0 + expectedMeshError(touch.edge_m, half_extent_m, factors)));
      }
      mesh += touch.sum_n * share;
    }
    if (!(sum_n > 0.0)) continue;
    ForceErrorEstimate& error = errors[static_cast<std::size_t>(key.instrument)];
    pressed_n[static_cast<std::size_t>(key.instrument)] += sum_n;
    error.mesh_n += force_n.norm() * mesh / sum_n;
    // Not more than all it presses with: of a body that swings beside it, most is not its.
    const auto ofInstrument = [&](double of_tissue_n) { return std::min(of_tissue_n * (sum_n / borne_n[t]), sum_n); };
    error.step_n += std::hypot(force_n.norm() * step / sum_n, ofInstrument(momentum_rates[t].defect()));
    error.inertia_n += ofInstrument(momentum_rates[t].size());
    error.knows_mesh = error.knows_mesh && judges_mesh;
  }
  const double all_n = std::accumulate(pressed_n.begin(), pressed_n.end(), 0.0);
  for (std::size_t i = 0; i < instruments; ++i) {
    if (!errors[i].knows_mesh) errors[i].mesh_n = 0.0;
    if (!(pressed_n[i] > 0.0)) continue;
    // Not more than all it presses with: of a body that swings, most of what is left is elsewhere.
    errors[i].solver_n = std::min(kOfUnbalanced * unbalanced_n * (pressed_n[i] / all_n), pressed_n[i]);
  }
  return errors;
}

}  // namespace tissue_contact
