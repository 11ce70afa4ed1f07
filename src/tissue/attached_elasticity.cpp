#include "tissue/attached_elasticity.h"

#include <utility>

namespace tissue_contact {

/// The matrices seen by the caller are those of the body with the springs in them.
struct AttachedElasticity::AttachedState : State {
  std::unique_ptr<State> body;      ///< has no matrices but while the body works on it
  std::vector<Matrix3> stiffness0;  ///< diagonal blocks of the attached nodes without springs: taking a spring out of a
                                    ///< sum again would leave its rounding, step after step
  std::vector<Matrix3> damping0;    ///< likewise; empty without a damping matrix

  void lendMatrices() {  ///< to the body, or takes them back
    std::swap(body->stiffness, stiffness);
    std::swap(body->damping, damping);
  }

  void carry(StateArchive& archive) override {
    archive.carry(elapsed_s);
    lendMatrices();
    try {
      body->carry(archive);
    } catch (...) {
      lendMatrices();
      throw;
    }
    lendMatrices();
    archive.carry(stiffness0);
    archive.carry(damping0);
  }
};

namespace {

void putBack(const std::vector<NodeSpring>& springs, const std::vector<Matrix3>& blocks, BlockMatrix& matrix) {
  for (std::size_t s = 0; s < blocks.size(); ++s) matrix.diagonal[springs[s].node] = blocks[s];
}

void addSprings(const std::vector<NodeSpring>& springs, double scale, std::vector<Matrix3>& blocks,
                BlockMatrix& matrix) {
  for (std::size_t s = 0; s < blocks.size(); ++s) {
    Matrix3& block = matrix.diagonal[springs[s].node];
    blocks[s] = block;
    block.diagonal().array() += scale * springs[s].stiffness;
  }
}

}  // namespace

AttachedElasticity::AttachedElasticity(std::unique_ptr<const Elasticity> body, const NodalVectors& rest,
                                       std::vector<NodeSpring> springs, double damping_s)
    : body_(std::move(body)),
      springs_(std::move(springs)),
      anchors_(3, static_cast<Eigen::Index>(springs_.size())),
      damping_s_(damping_s) {
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    anchors_.col(static_cast<Eigen::Index>(s)) = rest.col(springs_[s].node);
  }
}

/// Lets `work` have the body's state as the body left it.
template <typename Work>
void AttachedElasticity::withoutSprings(AttachedState& state, const Work& work) const {
  State& body = *state.body;
  body.adapt_rotations = state.adapt_rotations;
  body.step_s = state.step_s;
  body.elapsed_s += std::exchange(state.elapsed_s, 0.0);
  putBack(springs_, state.stiffness0, state.stiffness);
  putBack(springs_, state.damping0, state.damping);
  state.lendMatrices();
  work(body);
  state.lendMatrices();
  addSprings(springs_, 1.0, state.stiffness0, state.stiffness);
  addSprings(springs_, damping_s_, state.damping0, state.damping);
}

std::unique_ptr<Elasticity::State> AttachedElasticity::makeState() const { return attach(body_->makeState()); }

std::unique_ptr<Elasticity::State> AttachedElasticity::makeStateAt(const NodalVectors& x) const {
  return attach(body_->makeStateAt(x));
}

std::unique_ptr<Elasticity::State> AttachedElasticity::makeStateAfter(const State& before,
                                                                      const NodalVectors& x) const {
  auto state = attach(body_->makeStateAfter(*static_cast<const AttachedState&>(before).body, x));
  state->elapsed_s = before.elapsed_s;
  return state;
}

std::unique_ptr<Elasticity::State> AttachedElasticity::attach(std::unique_ptr<State> body) const {
  auto state = std::make_unique<AttachedState>();
  state->body = std::move(body);
  state->lendMatrices();
  state->stiffness0.resize(springs_.size());
  if (state->damping.rows() > 0) state->damping0.resize(springs_.size());
  addSprings(springs_, 1.0, state->stiffness0, state->stiffness);
  addSprings(springs_, damping_s_, state->damping0, state->damping);
  return state;
}

void AttachedElasticity::update(const NodalVectors& x, State& any_state, NodalVectors& forces) const {
  auto& state = static_cast<AttachedState&>(any_state);  // made by makeState()
  withoutSprings(state, [&](State& body) { body_->update(x, body, forces); });
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    const int node = springs_[s].node;
    forces.col(node) -= springs_[s].stiffness * (x.col(node) - anchors_.col(static_cast<Eigen::Index>(s)));
  }
}

void AttachedElasticity::holdStill(const std::vector<bool>& still, const NodalVectors& x, State& any_state) const {
  auto& state = static_cast<AttachedState&>(any_state);
  withoutSprings(state, [&](State& body) { body_->holdStill(still, x, body); });
}

double AttachedElasticity::energy(const NodalVectors& x) const {
  double energy = body_->energy(x);
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    const Vector3 pulled = x.col(springs_[s].node) - anchors_.col(static_cast<Eigen::Index>(s));
    energy += 0.5 * springs_[s].stiffness * pulled.squaredNorm();
  }
  return energy;
}

}  // namespace tissue_contact
