#include "tissue_contact/tissue/tet_elasticity.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "element_kernel.h"
#include "tissue_contact/core/check.h"

namespace tissue_contact {
namespace {

Quaternion rotationBySvd(const Matrix3& F) {
  const Eigen::JacobiSVD<Matrix3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3 U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0.0) U.col(2) = -U.col(2);
  return Quaternion(U * svd.matrixV().transpose());
}

/// Gradients of the four shape functions, columns, 1/m.
Eigen::Matrix<double, 3, 4> shapeGradients(const Matrix3& rest_inverse) {
  Eigen::Matrix<double, 3, 4> gradients;
  gradients.rightCols<3>() = rest_inverse.transpose();
  gradients.col(0) = -gradients.rightCols<3>().rowwise().sum();
  return gradients;
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
  return rotationBySvd(F);
}

TetElasticity::TetElasticity(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                             const std::vector<bool>& fixed, const MaterialDescription& material)
    : corotational_(material.model == ElasticModel::kCorotational) {
  const double E = requirePositive("youngs_modulus_pa", material.youngs_modulus_pa, "Pa");
  const double nu = requireInside("poissons_ratio", material.poissons_ratio, -1.0, 0.5);
  lame_lambda_ = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  lame_mu_ = E / (2.0 * (1.0 + nu));
  pattern_ = BlockMatrix::forTetrahedra(tetrahedra, fixed);
  elements_.reserve(tetrahedra.size());
  for (const Tetrahedron& tet : tetrahedra) addElement(rest, tet, fixed);
  fillBatches();
}

TetElasticity::~TetElasticity() = default;

void TetElasticity::addElement(const NodalVectors& rest, const Tetrahedron& tet, const std::vector<bool>& fixed) {
  Element element;
  element.nodes = tet;
  Matrix3 D;
  for (int i = 0; i < 3; ++i) D.col(i) = rest.col(tet[i + 1]) - rest.col(tet[0]);
  element.rest_inverse = D.inverse();
  element.volume = D.determinant() / 6.0;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      element.at[i][j] = i == j ? (fixed[tet[i]] ? -1 : tet[i]) : pattern_.find(tet[i], tet[j]);
    }
  }
  elements_.push_back(element);
}

void TetElasticity::fillBatches() {
  batches_.resize((elements_.size() + kLanes - 1) / kLanes);
  for (std::size_t slot = 0; slot < batches_.size() * kLanes; ++slot) {
    const bool used = slot < elements_.size();
    const Element& element = used ? elements_[slot] : elements_.back();
    ElementBatch& batch = batches_[slot / kLanes];
    const std::size_t lane = slot % kLanes;
    for (std::size_t i = 0; i < 9; ++i) batch.rest_inverse[i][lane] = element.rest_inverse.data()[i];
    batch.volume[lane] = used ? element.volume : 0.0;
    batch.nodes[lane] = element.nodes;
  }
}

std::unique_ptr<Elasticity::State> TetElasticity::makeState() const {
  RotationBatch identity{};
  identity[0].fill(1.0);
  auto result = std::make_unique<RotationState>();
  RotationState& state = *result;
  state.rotations.assign(batches_.size(), identity);
  state.tangent_rotations = state.rotations;
  state.turned.assign(batches_.size(), 0);
  state.stiffness = pattern_;
  for (const Element& element : elements_) addStiffness(element, Quaternion::Identity(), 1.0, state.stiffness);
  return result;
}

void TetElasticity::addStiffness(const Element& element, const Quaternion& rotation, double sign,
                                 BlockMatrix& K) const {
  const Eigen::Matrix<double, 3, 4> c = rotation.toRotationMatrix() * shapeGradients(element.rest_inverse);
  const double lambda = sign * element.volume * lame_lambda_;
  const double mu = sign * element.volume * lame_mu_;
  for (int i = 0; i < 4; ++i) {
    for (int j = i; j < 4; ++j) {
      if (element.at[i][j] < 0) continue;
      Matrix3 block = (lambda * c.col(i)) * c.col(j).transpose() + (mu * c.col(j)) * c.col(i).transpose();
      block.diagonal().array() += mu * c.col(i).dot(c.col(j));
      if (i == j) {
        K.diagonal[element.at[i][i]] += block;
      } else {
        K.values[element.at[i][j]] += block;
        K.values[element.at[j][i]] += block.transpose();
      }
    }
  }
}

void TetElasticity::refreshStiffness(std::size_t batch, RotationState& state) const {
  const auto rotation = [batch](const std::vector<RotationBatch>& rotations, std::size_t lane) {
    const RotationBatch& q = rotations[batch];
    return Quaternion(q[0][lane], q[1][lane], q[2][lane], q[3][lane]).normalized();
  };
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::size_t e = batch * kLanes + lane;
    if ((state.turned[batch] >> lane & 1) == 0 || e >= elements_.size()) continue;
    addStiffness(elements_[e], rotation(state.tangent_rotations, lane), -1.0, state.stiffness);
    addStiffness(elements_[e], rotation(state.rotations, lane), 1.0, state.stiffness);
    for (std::size_t i = 0; i < 4; ++i) state.tangent_rotations[batch][i][lane] = state.rotations[batch][i][lane];
  }
}

void TetElasticity::update(const NodalVectors& x, State& any_state, NodalVectors& forces) const {
  auto& state = static_cast<RotationState&>(any_state);  // made by makeState()
  forces.setZero();
  const KernelMaterial material{lame_lambda_, lame_mu_};
  if (!corotational_) {
    addLinearForces(batches_, material, x.data(), forces.data());
    return;
  }
  addCorotationalForces(batches_, material, kTangentAngle, x.data(), state.tangent_rotations, state.rotations,
                        state.turned, forces.data());
  for (std::size_t batch = 0; batch < batches_.size(); ++batch) {
    if (state.turned[batch] != 0) refreshStiffness(batch, state);
  }
}

double TetElasticity::energy(const NodalVectors& x) const {
  double energy = 0.0;
  for (const Element& element : elements_) {
    Matrix3 D;
    for (int i = 0; i < 3; ++i) D.col(i) = x.col(element.nodes[i + 1]) - x.col(element.nodes[0]);
    const Matrix3 F = D * element.rest_inverse;
    const Matrix3 R =
        corotational_ ? nearestRotation(F, Quaternion::Identity()).toRotationMatrix() : Matrix3(Matrix3::Identity());
    const Matrix3 S = R.transpose() * F;
    Matrix3 strain = 0.5 * (S + S.transpose());
    strain.diagonal().array() -= 1.0;
    const double trace = strain.trace();
    energy += element.volume * (lame_mu_ * strain.squaredNorm() + 0.5 * lame_lambda_ * trace * trace);
  }
  return energy;
}

}  // namespace tissue_contact
