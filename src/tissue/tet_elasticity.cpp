#include "tissue_contact/tissue/tet_elasticity.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/rotation_by_svd.h"
#include "tissue/element_kernel.h"
#include "tissue/rotation_state.h"
#include "tissue/tet_elements.h"
#include "tissue/turned_block.h"

namespace tissue_contact {
namespace {

/// Of small turns: sin(angle/2) = |vec q| / |q|.
double largestTurnSquared(const std::vector<RotationBatch>& rotations) {
  double largest = 0.0;
  for (const RotationBatch& q : rotations) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double axial = q[1][lane] * q[1][lane] + q[2][lane] * q[2][lane] + q[3][lane] * q[3][lane];
      largest = std::max(largest, 4.0 * axial / (q[0][lane] * q[0][lane] + axial));
    }
  }
  return largest;
}

}  // namespace

Quaternion nearestRotation(const Matrix3& F, const Quaternion& guess) {
  // At the nearest rotation S = R'F is symmetric. With R <- R exp([w]), symmetry to first order asks for
  // (tr(S) I - sym(S)) w = axial(S - S'). The step is quadratic: after one of 1e-7 rad the error is round-off.
  constexpr int kMaxSteps = 8;
  constexpr double kLastStepSquared = 1e-14;
  constexpr double kRoundOffSquared = 1e-31;
  Quaternion q = guess;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Matrix3 S = q.toRotationMatrix().transpose() * F;
    const Vector3 axial(S(2, 1) - S(1, 2), S(0, 2) - S(2, 0), S(1, 0) - S(0, 1));
    const double trace = S(0, 0) + S(1, 1) + S(2, 2);
    const Vector3 diagonal(trace - S(0, 0), trace - S(1, 1), trace - S(2, 2));
    const Vector3 off(-0.5 * (S(1, 2) + S(2, 1)), -0.5 * (S(0, 2) + S(2, 0)), -0.5 * (S(0, 1) + S(1, 0)));
    // Cofactors of the symmetric matrix tr(S) I - sym(S). It is positive definite exactly at a maximum of tr(R'F):
    // elsewhere (inverted element, far guess) Newton must not be trusted.
    const Vector3 minors(diagonal.y() * diagonal.z() - off.x() * off.x(),
                         diagonal.x() * diagonal.z() - off.y() * off.y(),
                         diagonal.x() * diagonal.y() - off.z() * off.z());
    const Vector3 mixed(off.y() * off.z() - off.x() * diagonal.x(), off.x() * off.z() - off.y() * diagonal.y(),
                        off.x() * off.y() - off.z() * diagonal.z());
    const double determinant = diagonal.x() * minors.x() + off.z() * mixed.z() + off.y() * mixed.y();
    if (!(diagonal.x() > 0.0 && minors.z() > 0.0 && determinant > 0.0)) break;
    if (axial.squaredNorm() < kRoundOffSquared * trace * trace) return q;
    const double scale = 0.5 / determinant;
    const Vector3 half(scale * (minors.x() * axial.x() + mixed.z() * axial.y() + mixed.y() * axial.z()),
                       scale * (mixed.z() * axial.x() + minors.y() * axial.y() + mixed.x() * axial.z()),
                       scale * (mixed.y() * axial.x() + mixed.x() * axial.y() + minors.z() * axial.z()));
    const double squared = half.squaredNorm();
    if (!(squared < 0.25)) break;
    q = q * Quaternion(1.0, half.x(), half.y(), half.z());
    q.normalize();
    if (squared < 0.25 * kLastStepSquared) return q;
  }
  return Quaternion(rotationBySvd(F));
}

TetElasticity::TetElasticity(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                             const std::vector<bool>& fixed, const ElementMaterials& materials)
    : corotational_(materials.materials.at(0).model == ElasticModel::kCorotational),
      adapts_(corotational_),
      tets_(std::make_unique<TetElements>(rest, tetrahedra, fixed, materials, lameParameters)) {}

TetElasticity::TetElasticity(bool corotational, std::unique_ptr<const TetElements> tets)
    : corotational_(corotational), adapts_(false), tets_(std::move(tets)) {}

TetElasticity::~TetElasticity() = default;

std::unique_ptr<Elasticity::State> TetElasticity::makeState() const {
  auto state = std::make_unique<RotationState>();
  prepare(nullptr, *state);
  return state;
}

std::unique_ptr<Elasticity::State> TetElasticity::makeStateAt(const NodalVectors& x) const {
  auto state = std::make_unique<RotationState>();
  prepare(&x, *state);
  return state;
}

void TetElasticity::prepare(const NodalVectors* x, RotationState& state) const {
  RotationBatch identity{};
  identity[0].fill(1.0);
  state.rotations.assign(tets_->batches.size(), identity);
  state.tangent_rotations = state.rotations;
  state.turned.assign(tets_->batches.size(), 0);
  state.held = tets_->nothingHeld();
  tets_->prepare(state);
  state.nodes.x.resize(static_cast<std::size_t>(state.stiffness.rows()));
  state.nodes.forces.resize(state.nodes.x.size());
  if (x != nullptr && corotational_) findRotations(*x, state);
  for (std::size_t e = 0; e < tets_->size(); ++e) {
    addStiffness(e, rotationInLane(state.tangent_rotations[e / kLanes], e % kLanes), state);
  }
}

/// Those of update(), from none; nothing has been assembled with others yet.
void TetElasticity::findRotations(const NodalVectors& x, RotationState& state) const {
  state.nodes.begin(x, {});
  const auto find = [&](const auto& material) {
    addCorotationalForces(tets_->batches, {0, tets_->batches.size()}, material, kTangentAngle, 1.0,
                          state.nodes.x.data(), state.tangent_rotations, state.rotations, state.turned,
                          state.nodes.forces.data());
  };
  tets_->batch_materials.empty() ? find(tets_->material) : find(tets_->batch_materials);
  state.tangent_rotations = state.rotations;
}

void TetElasticity::addStiffness(std::size_t e, const Quaternion& rotation, State& state) const {
  const TetElement element = tets_->element(e);
  const Eigen::Matrix<double, 3, 4> c = rotation.toRotationMatrix() * tets_->shapeGradients(e);
  const double lambda = element.volume * element.lame.lambda;
  const double mu = element.volume * element.lame.mu;
  for (int i = 0; i < 4; ++i) {
    for (int j = i; j < 4; ++j) {
      if (element.slots(i, j) < 0) continue;
      Matrix3 block = (lambda * c.col(i)) * c.col(j).transpose() + (mu * c.col(j)) * c.col(i).transpose();
      block.diagonal().array() += mu * c.col(i).dot(c.col(j));
      addBlock(i == j, element.slots(i, j), block, element.damping_s, state.stiffness, state.damping);
    }
  }
}

/// Puts that of `rotation` in the place of that of `old`.
void TetElasticity::turnStiffness(std::size_t e, const Quaternion& old, const Quaternion& rotation,
                                  State& state) const {
  const TetElement element = tets_->element(e);
  const Eigen::Matrix<double, 3, 4> gradients = tets_->shapeGradients(e);
  const Matrix3 R = rotation.toRotationMatrix();
  const Matrix3 R_old = old.toRotationMatrix();
  std::array<PaddedGradient, 4> a, b;
  for (std::size_t i = 0; i < 4; ++i) {
    a[i] = turnedGradient(R, gradients.col(static_cast<int>(i)));
    b[i] = turnedGradient(R_old, gradients.col(static_cast<int>(i)));
  }
  const double lambda = element.volume * element.lame.lambda;
  const double mu = element.volume * element.lame.mu;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i; j < 4; ++j) {
      if (element.slots(i, j) < 0) continue;
      addBlock(i == j, element.slots(i, j), turnedBlock(lambda, mu, a[i], a[j], b[i], b[j]), element.damping_s,
               state.stiffness, state.damping);
    }
  }
}

void TetElasticity::refreshStiffness(std::size_t batch, RotationState& state) const {
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::size_t e = batch * kLanes + lane;
    if ((state.turned[batch] >> lane & 1) == 0 || e >= tets_->size()) continue;
    turnStiffness(e, rotationInLane(state.tangent_rotations[batch], lane), rotationInLane(state.rotations[batch], lane),
                  state);
    for (std::size_t i = 0; i < 4; ++i) state.tangent_rotations[batch][i][lane] = state.rotations[batch][i][lane];
  }
}

void TetElasticity::update(const NodalVectors& x, State& any_state, NodalVectors& forces) const {
  auto& state = static_cast<RotationState&>(any_state);  // made by makeState()
  updateElements(x, state);
  unpad(state.nodes.forces, forces);
}

/// Leaves x and the forces in state.nodes.
void TetElasticity::updateElements(const NodalVectors& x, RotationState& state) const {
  if (adapts_ && state.adapt_rotations) adaptRotations(x, state);
  state.turn_squared = 0.0;
  state.nodes.begin(x, state.held.forces);
  evaluate(state.held.moving, state);
}

/// One update nearer to what the turns of the last one ask for.
void TetElasticity::adaptRotations(const NodalVectors& x, RotationState& state) const {
  if (state.blend_to == 0) {
    const double turn_squared = state.blend == 0 ? state.turn_squared : largestTurnSquared(state.rotations);
    if (turn_squared > kTurnOn * kTurnOn) state.blend_to = kBlendUpdates;
  } else if (++state.updates == kBlendUpdates) {
    state.updates = 0;
    state.calm = largestTurnSquared(state.rotations) < kTurnOff * kTurnOff ? state.calm + kBlendUpdates : 0;
    if (state.calm >= kCalmUpdates) {
      state.blend_to = 0;
      state.calm = 0;
    }
  }
  if (state.blend == state.blend_to) return;
  state.blend += state.blend < state.blend_to ? 1 : -1;
  if (state.held.still.empty()) return;
  evaluateStill(x, state);
}

void TetElasticity::holdStill(const std::vector<bool>& still, const NodalVectors& x, State& any_state) const {
  auto& state = static_cast<RotationState&>(any_state);
  tets_->split(still, state.held);
  evaluateStill(x, state);
}

/// Leaves x and the forces in state.nodes, too.
void TetElasticity::evaluateStill(const NodalVectors& x, RotationState& state) const {
  state.nodes.begin(x, {});
  evaluate(state.held.still, state);
  unpad(state.nodes.forces, state.held.forces);
}

/// Adds the forces of these batches to state.nodes, and brings their share of the stiffness up to date.
void TetElasticity::evaluate(const std::vector<BatchRange>& ranges, RotationState& state) const {
  const PaddedVector* const x = state.nodes.x.data();
  PaddedVector* const forces = state.nodes.forces.data();
  const auto add = [&](BatchRange range, const auto& material) {
    if (!corotational_ || state.blend == 0) {
      addLinearForces(tets_->batches, range, material, x, forces, corotational_ ? &state.turn_squared : nullptr);
      return;
    }
    addCorotationalForces(tets_->batches, range, material, kTangentAngle, state.blend / double{kBlendUpdates}, x,
                          state.tangent_rotations, state.rotations, state.turned, forces);
    for (std::size_t batch = range.begin; batch < range.end; ++batch) {
      if (state.turned[batch] != 0) refreshStiffness(batch, state);
    }
  };
  for (const BatchRange range : ranges) {
    tets_->batch_materials.empty() ? add(range, tets_->material) : add(range, tets_->batch_materials);
  }
}

double TetElasticity::energy(const NodalVectors& x) const {
  double energy = 0.0;
  for (std::size_t e = 0; e < tets_->size(); ++e) {
    const TetElement element = tets_->element(e);
    const Matrix3 F = tets_->deformationGradient(e, x);
    const Matrix3 R =
        corotational_ ? nearestRotation(F, Quaternion::Identity()).toRotationMatrix() : Matrix3(Matrix3::Identity());
    const Matrix3 S = R.transpose() * F;
    Matrix3 strain = 0.5 * (S + S.transpose());
    strain.diagonal().array() -= 1.0;
    const double trace = strain.trace();
    energy += element.volume * (element.lame.mu * strain.squaredNorm() + 0.5 * element.lame.lambda * trace * trace);
  }
  return energy;
}

}  // namespace tissue_contact
