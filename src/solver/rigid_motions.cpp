#include "solver/rigid_motions.h"

#include <algorithm>
#include <cmath>

namespace tissue_contact {
namespace {

Matrix3 crossMatrix(const Vector3& a) {
  Matrix3 matrix;
  matrix << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return matrix;
}

}  // namespace

RigidMotions::Rows RigidMotions::motionsOf(const Vector3& arm) {
  Rows motions;
  motions << Matrix3::Identity(), -crossMatrix(arm);
  return motions;
}

RigidMotions::Vector6 RigidMotions::along(const Vector3& arm, const Vector3& vector) {
  Vector6 result;
  result << vector, arm.cross(vector);
  return result;
}

void RigidMotions::begin(const BodySystem& body, const std::vector<int>& excluded) {
  body_ = &body;
  used_ = 0;
  const auto nodes = static_cast<std::size_t>(body.K->rows());
  place_of_.assign(nodes, Place{});
  row_of_.assign(nodes, -1);
  for (const std::vector<int>& part : *body.stiff_parts) {
    if (parts_.size() == used_) parts_.emplace_back();
    if (measure(part, excluded, parts_[used_])) use();
  }
}

/// @return false where it has no motions of its own.
bool RigidMotions::measure(const std::vector<int>& nodes, const std::vector<int>& excluded, Part& part) {
  part.members.clear();
  Vector3 middle = Vector3::Zero();
  for (const int node : nodes) {
    if ((*body_->fixed)[static_cast<std::size_t>(node)]) continue;
    if (std::binary_search(excluded.begin(), excluded.end(), node)) continue;
    part.members.push_back({node, body_->x->col(node)});
    middle += body_->x->col(node);
  }
  constexpr std::size_t kLeastNodes = 3;  // two turn about their line for nothing
  if (part.members.size() < kLeastNodes) return false;
  middle /= static_cast<double>(part.members.size());
  double radius = 0.0;
  for (Member& member : part.members) {
    member.arm -= middle;
    radius = std::max(radius, member.arm.norm());
  }
  if (!(radius > 0.0)) return false;
  for (Member& member : part.members) member.arm /= radius;
  part.rows.clear();
  for (const Member& member : part.members) addBelow(member, part);
  for (const Row& row : part.rows) row_of_[static_cast<std::size_t>(row.node)] = -1;
  part.followed.setZero();
  return factor(part);
}

/// The part measured last takes part.
void RigidMotions::use() {
  const std::vector<Member>& members = parts_[used_].members;
  for (std::size_t m = 0; m < members.size(); ++m) {
    place_of_[static_cast<std::size_t>(members[m].node)] = {static_cast<int>(used_), static_cast<int>(m)};
  }
  ++used_;
}

/// What the motions of a member do to the rows after it.
void RigidMotions::addBelow(const Member& member, Part& part) {
  const Rows motions = motionsOf(member.arm);
  const auto add = [&](const BlockMatrix& matrix, double scale) {
    const Rows scaled = scale * motions;
    matrix.pattern->forRow(member.node, [&](int j, int place) {
      if (j <= member.node) return;
      int& row = row_of_[static_cast<std::size_t>(j)];
      if (row < 0) {
        row = static_cast<int>(part.rows.size());
        part.rows.push_back({j, Rows::Zero()});
      }
      part.rows[static_cast<std::size_t>(row)].lower += matrix.block(place).transpose() * scaled;  // A is symmetric
    });
  };
  add(*body_->K, body_->stiffness_scale);
  if (body_->D != nullptr) add(*body_->D, body_->damping_scale);
}

/// @return false where K, which may be indefinite, takes energy away, so that its least is nowhere to go to, and of nodes in a line.
bool RigidMotions::factor(Part& part) const {
  Matrix6 below = Matrix6::Zero();  // Z'L Z
  Matrix6 own = Matrix6::Zero();
  Matrix6 inertia = Matrix6::Zero();
  for (const Row& row : part.rows) {
    const auto at = std::lower_bound(part.members.begin(), part.members.end(), row.node,
                                     [](const Member& member, int node) { return member.node < node; });
    if (at == part.members.end() || at->node != row.node) continue;
    below += motionsOf(at->arm).transpose() * row.lower;
  }
  for (const Member& member : part.members) {
    const Rows motions = motionsOf(member.arm);
    own += motions.transpose() * ownBlock(member.node) * motions;
    inertia += body_->mass[member.node] * (motions.transpose() * motions);
  }
  const Matrix6 energy = own + below + below.transpose();
  part.energy.compute(energy - kLeastEnergy * inertia);
  if (part.energy.info() != Eigen::Success) return false;
  part.energy.compute(energy);
  return part.energy.info() == Eigen::Success && part.energy.rcond() > kLeastCondition;
}

Matrix3 RigidMotions::ownBlock(int node) const {
  const auto i = static_cast<std::size_t>(node);
  Matrix3 block = body_->mass[node] * Matrix3::Identity() + body_->stiffness_scale * body_->K->diagonal[i];
  if (body_->D != nullptr) block += body_->damping_scale * body_->D->diagonal[i];
  return block;
}

void RigidMotions::beginForth() {
  for (std::size_t p = 0; p < used_; ++p) parts_[p].followed.setZero();
}

void RigidMotions::followInParts(int j, const Vector3& added) {
  const Place& place = place_of_[static_cast<std::size_t>(j)];
  if (place.part < 0) return;
  Part& part = parts_[static_cast<std::size_t>(place.part)];
  part.followed += along(part.members[static_cast<std::size_t>(place.member)].arm, added);
}

RigidMotions::Vector6 RigidMotions::wanted(const Part& part, const PaddedVectors& begun, const PaddedVectors& v) const {
  Vector6 work = -part.followed;
  for (const Row& row : part.rows) {
    const auto i = static_cast<std::size_t>(row.node);
    work -= row.lower.transpose() * (vectorOf(v[i]) - vectorOf(begun[i]));
  }
  return part.energy.solve(work);
}

}  // namespace tissue_contact
