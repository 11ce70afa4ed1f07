#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "simulation/simulator_implementation.h"
#include "tissue_contact/baselines/make_contact_solver.h"

namespace tissue_contact {
namespace {

bool haveSameParts(const Scene& a, const Scene& b) {
  const auto same_tissue = [](const TissueDescription& s, const TissueDescription& t) {
    return s.name == t.name && s.regions.size() == t.regions.size();
  };
  const auto same_law = [](const FrictionDescription& s, const FrictionDescription& t) {
    return s.law.static_coefficients.size() == t.law.static_coefficients.size() &&
           s.law.kinetic_coefficients.size() == t.law.kinetic_coefficients.size();
  };
  return std::equal(a.tissues.begin(), a.tissues.end(), b.tissues.begin(), b.tissues.end(), same_tissue) &&
         std::equal(a.friction.begin(), a.friction.end(), b.friction.begin(), b.friction.end(), same_law);
}

/// @return whether it was another.
template <typename Value>
bool take(const Value& from, Value& to) {
  if (from == to) return false;
  to = from;
  return true;
}

bool takeMaterial(const MaterialDescription& from, MaterialDescription& to) {
  const bool modulus = take(from.youngs_modulus_pa, to.youngs_modulus_pa);
  return take(from.poissons_ratio, to.poissons_ratio) || modulus;
}

bool takeTissue(const TissueDescription& from, TissueDescription& to) {
  bool any = takeMaterial(from.material, to.material);
  any |= take(from.damping.mass_per_s, to.damping.mass_per_s);
  any |= take(from.damping.stiffness_s, to.damping.stiffness_s);
  for (std::size_t r = 0; r < to.regions.size(); ++r) {
    any |= takeMaterial(from.regions[r].material, to.regions[r].material);
    any |= take(from.regions[r].damping_stiffness_s, to.regions[r].damping_stiffness_s);
  }
  return any;
}

bool takeFriction(const Scene& from, Scene& to) {
  bool any = false;
  for (std::size_t i = 0; i < to.friction.size(); ++i) {
    any |= take(from.friction[i].law.static_coefficients, to.friction[i].law.static_coefficients);
    any |= take(from.friction[i].law.kinetic_coefficients, to.friction[i].law.kinetic_coefficients);
  }
  return any;
}

bool takeSolver(const SolverDescription& from, SolverDescription& to) {
  bool any = take(from.iterations, to.iterations);
  any |= take(from.contact_passes, to.contact_passes);
  any |= take(from.tolerance, to.tolerance);
  return any;
}

}  // namespace

void Simulator::retune(const Scene& changed) {
  if (!haveSameParts(changed, implementation_->scene)) {
    throw std::invalid_argument(
        "a running scene may change in numbers only, and this one has other tissues or friction");
  }
  implementation_->retuned = changed;
}

/// Within a step and not when asked to: till then residuals, contacts and force errors are those of the step before, and are computed
/// from its materials and laws. Refined meshes are made from a description of their own, which takes the numbers as well.
void Simulator::Implementation::retune() {
  const Scene changed = std::move(*retuned);
  retuned.reset();
  bool is_other_body = false;
  for (const auto& follower : followers) {
    if (follower) follower->pause();  // it may be making a tissue from those numbers
  }
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    if (!takeTissue(changed.tissues[t], scene.tissues[t])) continue;
    if (refinements[t]) takeTissue(changed.tissues[t], refinements[t]->description());
    tissues[t].changeMaterials(scene.tissues[t]);
    load_watch.setMaterials(static_cast<int>(t), scene.tissues[t]);
    moving[t].changeMaterials();
    if (followers[t]) followers[t]->goOn();
    is_other_body = true;
  }
  if (takeFriction(changed, scene)) friction = FrictionTable(scene, instruments, tissues);
  if (takeSolver(changed.solver, scene.solver)) {
    solver = makeContactSolver(scene.solver, clock);
    const bool never =
        std::isinf(deadline_s) && std::isinf(prompt_s);  // of which a solver without a clock need not hear
    if (!never) solver->setDeadline(deadline_s, prompt_s);
  } else if (is_other_body) {
    solver->reset();
  }
}

}  // namespace tissue_contact
