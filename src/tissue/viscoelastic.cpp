#include "tissue/viscoelastic.h"

#include <cmath>
#include <utility>

#include "tissue/element_kernel.h"
#include "tissue/rotation_state.h"
#include "tissue/tet_elements.h"

namespace tissue_contact {
namespace {

double sumOfRatios(const MaterialDescription& material) {
  double sum = 0.0;
  for (const PronyTerm& term : material.prony_series) sum += term.modulus_ratio;
  return sum;
}

LameParameters overstressParameters(const MaterialDescription& material) {
  const LameParameters relaxed = deviatoricParameters(material);
  const double ratios = sumOfRatios(material);
  return {ratios * relaxed.lambda, ratios * relaxed.mu};
}

PronyStep pronyStep(const PronyTerm& term, double ratios, double elapsed_s, double step_s) {
  const double past = elapsed_s / term.time_s;
  return {std::exp(-past), past > 0.0 ? -std::expm1(-past) / past : 1.0,
          term.modulus_ratio / ratios * std::exp(-step_s / term.time_s)};
}

}  // namespace

struct Overstress::MaxwellState : RotationState {
  std::vector<PronyStep> steps;      ///< scratch, per term
  std::vector<StrainBatch> strains;  ///< deviators at the last update, by batch
  std::vector<StrainBatch> held;     ///< h, term after term for each batch

  void carry(StateArchive& archive) override {
    RotationState::carry(archive);
    archive.carry(strains);
    archive.carry(held);
  }
};

Overstress::Overstress(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                       const std::vector<bool>& fixed, const ElementMaterials& materials,
                       std::shared_ptr<const BlockPattern> pattern)
    : TetElasticity(
          materials.materials.at(0).model != ElasticModel::kLinear,
          std::make_unique<TetElements>(rest, tetrahedra, fixed, materials, overstressParameters, std::move(pattern))),
      terms_(materials.materials.at(0).prony_series),
      ratios_(sumOfRatios(materials.materials.at(0))),
      turns_(materials.materials.at(0).model != ElasticModel::kLinear) {}

Overstress::~Overstress() = default;

std::unique_ptr<Elasticity::State> Overstress::makeState() const {
  auto state = std::make_unique<MaxwellState>();
  prepare(nullptr, *state);
  state->steps.resize(terms_.size());
  state->strains.assign(tets().batches.size(), StrainBatch{});
  state->held.assign(tets().batches.size() * terms_.size(), StrainBatch{});
  return state;
}

std::unique_ptr<Elasticity::State> Overstress::makeStateAfter(const State& before, const NodalVectors& /*x*/) const {
  const auto& memory = static_cast<const MaxwellState&>(before);
  auto state = makeState();
  auto& fresh = static_cast<MaxwellState&>(*state);
  fresh.rotations = memory.rotations;
  fresh.strains = memory.strains;
  fresh.held = memory.held;
  return state;
}

void Overstress::addForces(const NodalVectors& x, Elasticity::State& any_state, NodalVectors& forces) const {
  auto& state = static_cast<MaxwellState&>(any_state);  // made by makeState()
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    state.steps[k] = pronyStep(terms_[k], ratios_, state.elapsed_s, state.step_s);
  }
  state.elapsed_s = 0.0;
  state.nodes.begin(x, forces);
  const auto add = [&](const auto& material) {
    addOverstressForces(tets().batches, material, turns_, kTangentAngle, state.nodes.x.data(), state.tangent_rotations,
                        state.rotations, state.turned, state.steps, state.strains, state.held,
                        state.nodes.forces.data());
  };
  tets().batch_materials.empty() ? add(tets().material) : add(tets().batch_materials);
  unpad(state.nodes.forces, forces);
  for (std::size_t batch = 0; batch < state.turned.size(); ++batch) {
    if (state.turned[batch] != 0) refreshStiffness(batch, state);
  }
}

struct Viscoelastic::SumState : State {
  std::unique_ptr<State> relaxed;
  std::unique_ptr<State> overstress;

  void carry(StateArchive& archive) override {
    State::carry(archive);
    relaxed->carry(archive);
    overstress->carry(archive);
  }
  void sum() {
    stiffness.setSum(1.0, relaxed->stiffness, 1.0, overstress->stiffness);
    if (damping.rows() > 0) damping.setSum(1.0, relaxed->damping, 1.0, overstress->damping);
  }
};

Viscoelastic::Viscoelastic(std::unique_ptr<const Elasticity> relaxed, const NodalVectors& rest,
                           const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
                           const ElementMaterials& materials)
    : relaxed_(std::move(relaxed)),
      overstress_(rest, tetrahedra, fixed, materials, relaxed_->makeState()->stiffness.pattern) {}

std::unique_ptr<Elasticity::State> Viscoelastic::makeState() const {
  return sumOf(relaxed_->makeState(), overstress_.makeState());
}

std::unique_ptr<Elasticity::State> Viscoelastic::makeStateAfter(const State& before, const NodalVectors& x) const {
  const auto& sum = static_cast<const SumState&>(before);
  auto state = sumOf(relaxed_->makeStateAfter(*sum.relaxed, x), overstress_.makeStateAfter(*sum.overstress, x));
  state->elapsed_s = sum.elapsed_s;
  return state;
}

std::unique_ptr<Elasticity::State> Viscoelastic::sumOf(std::unique_ptr<State> relaxed,
                                                       std::unique_ptr<State> overstress) {
  auto state = std::make_unique<SumState>();
  state->relaxed = std::move(relaxed);
  state->overstress = std::move(overstress);
  state->stiffness = state->relaxed->stiffness;
  state->damping = state->relaxed->damping;
  state->sum();
  return state;
}

void Viscoelastic::update(const NodalVectors& x, State& any_state, NodalVectors& forces) const {
  auto& state = static_cast<SumState&>(any_state);  // made by makeState()
  state.overstress->step_s = state.step_s;
  state.overstress->elapsed_s = state.elapsed_s;
  state.elapsed_s = 0.0;
  relaxed_->update(x, *state.relaxed, forces);
  overstress_.addForces(x, *state.overstress, forces);
  state.sum();
}

}  // namespace tissue_contact
