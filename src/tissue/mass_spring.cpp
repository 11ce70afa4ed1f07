#include "tissue/mass_spring.h"

#include <algorithm>

#include "tissue/spring_stiffness.h"

namespace tissue_contact {
namespace {

/// Adds `scale` times the spring's stiffness (of unit k) to the blocks of its nodes.
void addSpring(const Spring& spring, const Matrix3& unit_block, double scale, BlockMatrix& K) {
  const Matrix3 block = scale * unit_block;
  for (std::size_t i = 0; i < 2; ++i) {
    if (spring.slots(i, i) >= 0) K.diagonal[spring.slots(i, i)] += block;
  }
  if (spring.slots(0, 1) < 0) return;
  K.add(spring.slots(0, 1), -block);
}

}  // namespace

MassSpring::MassSpring(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                       const std::vector<bool>& fixed, const ElementMaterials& materials)
    : pattern_(BlockPattern::forElements(tetrahedra, fixed)), damps_(!materials.damping_s.empty()), rest_(rest) {
  for (const MaterialDescription& material : materials.materials) checkMaterial(material, "");
  springs_ = makeSprings(rest, tetrahedra, materials);
  for (Spring& spring : springs_) spring.slots = findSlots(*pattern_, spring.nodes, fixed);
}

MassSpring::~MassSpring() = default;

std::unique_ptr<Elasticity::State> MassSpring::makeState() const {
  auto state = std::make_unique<State>();
  state->stiffness = BlockMatrix(pattern_);
  if (damps_) state->damping = BlockMatrix(pattern_);
  NodalVectors forces(3, rest_.cols());
  update(rest_, *state, forces);
  return state;
}

void MassSpring::update(const NodalVectors& x, State& state, NodalVectors& forces) const {
  forces.setZero();
  state.stiffness.setZero();
  state.damping.setZero();
  for (const Spring& spring : springs_) {
    const Vector3 edge = x.col(spring.nodes[1]) - x.col(spring.nodes[0]);
    const double length = edge.norm();
    // Ends in one place: no direction to push in. The neighbours part them.
    const Vector3 n = length > 0.0 ? Vector3(edge / length) : Vector3(Vector3::Zero());
    const Vector3 pull = spring.stiffness * (length - spring.length) * n;
    forces.col(spring.nodes[0]) += pull;
    forces.col(spring.nodes[1]) -= pull;
    const double tension = length > spring.length ? 1.0 - spring.length / length : 0.0;
    Matrix3 block = (1.0 - tension) * n * n.transpose();
    block.diagonal().array() += tension;
    addSpring(spring, block, spring.stiffness, state.stiffness);
    if (damps_) addSpring(spring, block, spring.damping, state.damping);
  }
}

double MassSpring::energy(const NodalVectors& x) const {
  double energy = 0.0;
  for (const Spring& spring : springs_) {
    const double extension = (x.col(spring.nodes[1]) - x.col(spring.nodes[0])).norm() - spring.length;
    energy += 0.5 * spring.stiffness * extension * extension;
  }
  return energy;
}

}  // namespace tissue_contact
