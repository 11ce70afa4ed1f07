/// What every elastic model must have: forces that are the gradient of an energy, a symmetric positive semidefinite
/// stiffness that is their gradient at rest, balance, and no force for rigid motions.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <new>
#include <random>
#include <stdexcept>

#include "tissue/attached_elasticity.h"
#include "tissue/element_patches.h"
#include "tissue/membrane.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/mesh/triangle_mesh.h"
#include "tissue_contact/tissue/make_elasticity.h"
#include "validation/elasticity_helpers.h"

namespace {
std::atomic<long> allocations{0};
}  // namespace

// noinline: gcc otherwise sees malloc() and free() where new and delete are and warns of a mismatch.
__attribute__((noinline)) void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
// What std::stable_sort() asks for, and gives back as the others.
__attribute__((noinline)) void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size);
}
__attribute__((noinline)) void operator delete(void* memory) noexcept { std::free(memory); }
__attribute__((noinline)) void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace tissue_contact {
namespace {

struct Body {
  NodalVectors rest;
  std::unique_ptr<const Elasticity> elasticity;
};

struct Model {
  std::string name;
  std::function<Body(const ElementMaterials&, int)> factory;  ///< second: how many nodes are fixed, the first ones
  ElementMaterials materials;
  bool rotation_free = true;  ///< rotations give no force
  int rigid_motions = 6;      ///< kernel of K at rest; 0: attached to the world

  /// @param given `of_element` may be longer than there are elements
  Body make(const ElementMaterials& given, int fixed_nodes = 0) const { return factory(given, fixed_nodes); }
};

void PrintTo(const Model& model, std::ostream* out) { *out << model.name; }

MaterialDescription material(ElasticModel model, double E, double nu, double bending = -1.0) {
  return {model, E, nu, 1000.0, bending, Dilatation::kElement};
}

std::vector<bool> firstFixed(int fixed_nodes, Eigen::Index nodes) {
  std::vector<bool> fixed(static_cast<std::size_t>(nodes), false);
  std::fill_n(fixed.begin(), fixed_nodes, true);
  return fixed;
}

Body makeBlock(const ElementMaterials& materials, int fixed_nodes) {
  TetMesh mesh = makeBlockMesh({Vector3(0.03, 0.02, 0.02), {2, 2, 2}, {}});
  auto elasticity =
      makeVolumeElasticity(mesh.positions, mesh.tetrahedra, firstFixed(fixed_nodes, mesh.positions.cols()), materials,
                           patchesByFaces(mesh.positions, mesh.tetrahedra));
  return {std::move(mesh.positions), std::move(elasticity)};
}

constexpr double kThickness = 2e-3;

/// @param curvature of the rest shape, a saddle, 1/m
Body makeSheet(const ElementMaterials& materials, int fixed_nodes, double curvature) {
  TriangleMesh mesh = makeSheetMesh({Vector2(0.04, 0.03), {4, 3}, kThickness});
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    mesh.vertices(2, i) = curvature * (std::pow(mesh.vertices(0, i), 2) - 0.5 * std::pow(mesh.vertices(1, i), 2));
  }
  auto elasticity = std::make_unique<Membrane>(mesh.vertices, mesh.triangles,
                                               firstFixed(fixed_nodes, mesh.vertices.cols()), kThickness, materials);
  return {std::move(mesh.vertices), std::move(elasticity)};
}
Body makeFlat(const ElementMaterials& materials, int fixed_nodes) { return makeSheet(materials, fixed_nodes, 0.0); }
Body makeCurved(const ElementMaterials& materials, int fixed_nodes) { return makeSheet(materials, fixed_nodes, 15.0); }

/// The body with springs at every third of its nodes but the first ones, each stiffer than the one before.
template <Body (*kMake)(const ElementMaterials&, int)>
Body makeAttached(const ElementMaterials& materials, int fixed_nodes) {
  Body body = kMake(materials, fixed_nodes);
  std::vector<NodeSpring> springs;
  for (int node = 6; node < static_cast<int>(body.rest.cols()); node += 3) springs.push_back({node, 10.0 + node});
  const double damping_s = materials.damping_s.empty() ? 0.0 : materials.damping_s[0];
  body.elasticity =
      std::make_unique<AttachedElasticity>(std::move(body.elasticity), body.rest, std::move(springs), damping_s);
  return body;
}

/// Three materials, 10 : 1 : 3, dealt out over the elements.
ElementMaterials layered(ElasticModel model, Dilatation dilatation = Dilatation::kElement) {
  ElementMaterials materials(material(model, 5e3, 0.4));
  materials.materials.push_back(material(model, 5e2, 0.1));
  materials.materials.push_back(material(model, 1.5e3, 0.3));
  for (MaterialDescription& one : materials.materials) one.dilatation = dilatation;
  for (int e = 0; e < 40; ++e) materials.of_element.push_back(e * e % 3);
  return materials;
}

/// Strain averaged over patches, nearly incompressible.
MaterialDescription averaged(ElasticModel model) {
  MaterialDescription description = material(model, 5e3, 0.49);
  description.dilatation = Dilatation::kPatch;
  return description;
}

/// Volume alone.
MaterialDescription volumeAveraged(ElasticModel model) {
  MaterialDescription description = averaged(model);
  description.distortion = Distortion::kElement;
  return description;
}

/// Forces from a fresh state are those of all terms at once.
ElementMaterials viscous(ElementMaterials materials) {
  for (MaterialDescription& one : materials.materials) one.prony_series = {{0.5, 0.1}, {2.0, 3.0}};
  return materials;
}

std::vector<Model> models() {
  using E = ElasticModel;
  return {{"Linear", makeBlock, material(E::kLinear, 5e3, 0.4), false},
          {"Corotational", makeBlock, material(E::kCorotational, 5e3, 0.4)},
          {"NeoHookean", makeBlock, material(E::kNeoHookean, 5e3, 0.4)},
          {"MassSpring", makeBlock, material(E::kMassSpring, 5e3, 0.25)},
          // Without bending every node is free to leave the plane: 20 of them, and 3 motions in it.
          {"Membrane", makeFlat, material(E::kMembrane, 5e4, 0.3, 0.0), true, 23},
          {"MembraneWithBending", makeFlat, material(E::kMembrane, 5e4, 0.3)},
          {"MembraneCurvedAtRest", makeCurved, material(E::kMembrane, 5e4, 0.3)},
          {"LayeredLinear", makeBlock, layered(E::kLinear), false},
          {"LayeredCorotational", makeBlock, layered(E::kCorotational)},
          {"MeanStrainLinear", makeBlock, averaged(E::kLinear), false},
          {"MeanStrainCorotational", makeBlock, averaged(E::kCorotational)},
          {"MeanStrainLayered", makeBlock, layered(E::kCorotational, Dilatation::kPatch)},
          {"AveragedNeoHookean", makeBlock, averaged(E::kNeoHookean)},
          {"VolumeAveragedNeoHookean", makeBlock, volumeAveraged(E::kNeoHookean)},
          {"SharedLayeredNeoHookean", makeBlock, layered(E::kNeoHookean, Dilatation::kAuto)},
          {"AveragedLayeredNeoHookean", makeBlock, layered(E::kNeoHookean, Dilatation::kPatch)},
          {"ViscoelasticLinear", makeBlock, viscous(material(E::kLinear, 5e3, 0.4)), false},
          {"ViscoelasticCorotational", makeBlock, viscous(averaged(E::kCorotational))},
          {"ViscoelasticNeoHookean", makeBlock, viscous(material(E::kNeoHookean, 5e3, 0.4))},
          {"ViscoelasticAveragedNeoHookean", makeBlock, viscous(averaged(E::kNeoHookean))},
          {"ViscoelasticLayered", makeBlock, viscous(layered(E::kCorotational, Dilatation::kPatch))},
          {"LayeredNeoHookean", makeBlock, layered(E::kNeoHookean)},
          {"LayeredMassSpring", makeBlock, layered(E::kMassSpring)},
          {"LayeredMembrane", makeFlat, layered(E::kMembrane)},
          {"LayeredMembraneCurvedAtRest", makeCurved, layered(E::kMembrane)},
          {"AttachedLinear", makeAttached<makeBlock>, material(E::kLinear, 5e3, 0.4), false, 0},
          {"AttachedCorotational", makeAttached<makeBlock>, material(E::kCorotational, 5e3, 0.4), false, 0},
          {"AttachedNeoHookean", makeAttached<makeBlock>, material(E::kNeoHookean, 5e3, 0.4), false, 0},
          {"AttachedMassSpring", makeAttached<makeBlock>, material(E::kMassSpring, 5e3, 0.25), false, 0},
          {"AttachedMeanStrain", makeAttached<makeBlock>, layered(E::kCorotational, Dilatation::kPatch), false, 0},
          {"AttachedMembrane", makeAttached<makeCurved>, material(E::kMembrane, 5e4, 0.3), false, 0}};
}

class ElasticityProperty : public ::testing::TestWithParam<Model> {
 protected:
  ElasticityProperty() : body(GetParam().make(GetParam().materials)) {}

  NodalVectors perturbed(double size, unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-size, size);
    NodalVectors x = body.rest;
    for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] += uniform(random);
    return x;
  }

  NodalVectors forces(const NodalVectors& x) const { return elasticForces(*body.elasticity, x); }

  /// Small shakes, squeezes, stretches, everything folded flat, inside out, and a heap (cells are 1 cm).
  std::vector<NodalVectors> shapes() const {
    std::vector<NodalVectors> shapes = {perturbed(1e-3, 1), perturbed(5e-3, 2), perturbed(2e-2, 3)};
    for (const Vector3& stretch : {Vector3(0.5, 1.2, 1.1), Vector3(3.0, 0.8, 1.0), Vector3(1.0, 0.0, 1.0),
                                   Vector3(1.0, -1.0, 1.0), Vector3(1e-3, 1e-3, 1e-3)}) {
      shapes.push_back(stretch.asDiagonal() * perturbed(5e-4, 4));
    }
    return shapes;
  }

  Body body;
};

TEST_P(ElasticityProperty, ForcesAreMinusTheEnergyGradient) {
  for (const double size : {2e-4, 2e-3}) {
    NodalVectors x = perturbed(size, 4);
    const NodalVectors f = forces(x);
    const double scale = f.cwiseAbs().maxCoeff();
    const double h = 1e-7;  // central difference: error h^2 f'' + round-off / h, both about 1e-7 of f here
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const double before = x.data()[i];
      x.data()[i] = before + h;
      const double above = body.elasticity->energy(x);
      x.data()[i] = before - h;
      const double below = body.elasticity->energy(x);
      x.data()[i] = before;
      ASSERT_NEAR(f.data()[i], -(above - below) / (2.0 * h), 1e-6 * scale) << "shaken by " << size;
    }
  }
}

TEST_P(ElasticityProperty, StiffnessIsTheGradientOfTheForcesAtRest) {
  const Eigen::MatrixXd K = dense(body.elasticity->makeState()->stiffness);
  const double h = 1e-7;
  for (Eigen::Index i = 0; i < body.rest.size(); ++i) {
    NodalVectors above = body.rest;
    NodalVectors below = body.rest;
    above.data()[i] += h;
    below.data()[i] -= h;
    const NodalVectors difference = (forces(above) - forces(below)) / (2.0 * h);
    const Eigen::Map<const VectorX> column(difference.data(), difference.size());
    ASSERT_LE((column + K.col(i)).cwiseAbs().maxCoeff(), 1e-7 * K.cwiseAbs().maxCoeff());
  }
}

TEST_P(ElasticityProperty, StiffnessAtRestLeavesRigidMotionsFreeAndNothingElse) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(dense(body.elasticity->makeState()->stiffness));
  const VectorX values = eigen.eigenvalues() / eigen.eigenvalues().maxCoeff();
  const int rigid = GetParam().rigid_motions;
  EXPECT_GE(values[0], -1e-12);
  if (rigid > 0) {
    EXPECT_LE(values[rigid - 1], 1e-12);
  }
  EXPECT_GE(values[rigid], 1e-5);
}

TEST_P(ElasticityProperty, StiffnessIsSymmetricPositiveSemidefiniteInEveryShape) {
  const auto state = body.elasticity->makeState();  // one state throughout: what a step takes back must leave no trace
  NodalVectors f(3, body.rest.cols());
  for (const NodalVectors& x : shapes()) {
    body.elasticity->update(x, *state, f);
    ASSERT_TRUE(f.allFinite());
    const Eigen::MatrixXd K = dense(state->stiffness);
    ASSERT_TRUE(K.allFinite());
    ASSERT_LE((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-12 * K.cwiseAbs().maxCoeff());
    const VectorX values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues();
    ASSERT_GE(values.minCoeff(), -1e-11 * values.maxCoeff());
  }
}

TEST_P(ElasticityProperty, RestsAtRestAndWhenMoved) {
  const double scale = dense(body.elasticity->makeState()->stiffness).cwiseAbs().maxCoeff() * body.rest.norm();
  EXPECT_LE(forces(body.rest).cwiseAbs().maxCoeff(), 1e-14 * scale);
  const double moved = forces(body.rest.colwise() + Vector3(0.1, -0.2, 0.3)).cwiseAbs().maxCoeff();
  if (GetParam().rigid_motions > 0) {
    EXPECT_LE(moved, 1e-13 * scale);
  } else {
    EXPECT_GT(moved, 1.0);  // 10 N/m and more, by 0.37 m
  }
  EXPECT_NEAR(body.elasticity->energy(body.rest), 0.0, 1e-14 * scale * body.rest.norm());
}

TEST_P(ElasticityProperty, InternalForcesAndMomentsBalance) {
  if (GetParam().rigid_motions == 0) GTEST_SKIP() << "springs to the world are no internal forces";
  const NodalVectors x = perturbed(3e-3, 5);
  const NodalVectors f = forces(x);
  EXPECT_LE(f.rowwise().sum().norm(), 1e-12 * f.norm());
  if (!GetParam().rotation_free) return;  // linear elasticity has a moment of second order in the displacement
  Vector3 moment = Vector3::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) moment += Vector3(x.col(i)).cross(Vector3(f.col(i)));
  EXPECT_LE(moment.norm(), 1e-10 * f.norm() * x.norm());
}

TEST_P(ElasticityProperty, RotationGivesNoForceAndTurnsTheForces) {
  if (GetParam().rigid_motions == 0) GTEST_SKIP() << "springs to the world do not turn with the body";
  const Matrix3 Q = Eigen::AngleAxisd(2.9, Vector3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  const NodalVectors x = perturbed(3e-3, 6);
  const NodalVectors f = forces(x);
  const double at_rest = forces(Q * body.rest).norm();
  const double difference = (forces(Q * x) - Q * f).norm();
  if (GetParam().rotation_free) {
    EXPECT_LE(at_rest, 1e-11 * f.norm());
    EXPECT_LE(difference, 1e-10 * f.norm());
  } else {
    EXPECT_GT(at_rest, f.norm());  // which is what the other models are for
  }
}

TEST_P(ElasticityProperty, SamePathSameBitsAndNothingAllocated) {
  const auto first = body.elasticity->makeState();
  const auto second = body.elasticity->makeState();
  NodalVectors f(3, body.rest.cols());
  NodalVectors g(3, body.rest.cols());
  for (const NodalVectors& x : shapes()) {
    const long before = allocations;
    body.elasticity->update(x, *first, f);
    EXPECT_EQ(allocations, before);
    body.elasticity->update(x, *second, g);
    ASSERT_EQ(f, g);
    ASSERT_EQ(dense(first->stiffness), dense(second->stiffness));
  }
}

TEST_P(ElasticityProperty, FixedNodesPullButHoldNoStiffness) {
  constexpr int kFixed = 5;
  const Body held = GetParam().make(GetParam().materials, kFixed);
  const auto held_state = held.elasticity->makeState();
  const auto free_state = body.elasticity->makeState();
  const NodalVectors x = perturbed(2e-3, 8);
  NodalVectors f(3, x.cols());
  NodalVectors g(3, x.cols());
  held.elasticity->update(x, *held_state, f);
  body.elasticity->update(x, *free_state, g);
  EXPECT_EQ(f, g);
  Eigen::MatrixXd expected = dense(free_state->stiffness);
  expected.leftCols(3 * kFixed).setZero();
  expected.topRows(3 * kFixed).setZero();
  EXPECT_LE((dense(held_state->stiffness) - expected).cwiseAbs().maxCoeff(), 1e-13 * expected.cwiseAbs().maxCoeff());
  for (int i = 0; i < kFixed; ++i) {
    held_state->stiffness.pattern->forRow(i, [](int j, int /*place*/) { ADD_FAILURE() << "a block with node " << j; });
  }
}

// D = sum over the elements of beta_e K_e: linear in beta, and K itself where every beta is 1 s.
TEST_P(ElasticityProperty, DampingIsTheStiffnessWeighedByElement) {
  const auto dampingFor = [&](const std::vector<double>& damping_s, const NodalVectors& x, Eigen::MatrixXd* K) {
    ElementMaterials materials = GetParam().materials;
    materials.damping_s = damping_s;
    if (materials.of_element.empty()) {
      materials.materials.resize(3, materials.materials[0]);
      for (int e = 0; e < 40; ++e) materials.of_element.push_back(e % 3);
    }
    const Body damped = GetParam().make(materials);
    const auto state = damped.elasticity->makeState();
    NodalVectors f(3, x.cols());
    damped.elasticity->update(x, *state, f);
    if (K != nullptr) *K = dense(state->stiffness);
    return dense(state->damping);
  };
  for (const NodalVectors& x : {perturbed(0.0, 0), perturbed(3e-3, 7)}) {
    Eigen::MatrixXd K;
    const Eigen::MatrixXd ones = dampingFor({1.0, 1.0, 1.0}, x, &K);
    const double scale = K.cwiseAbs().maxCoeff();
    EXPECT_LE((ones - K).cwiseAbs().maxCoeff(), 1e-13 * scale);
    const Eigen::MatrixXd D = dampingFor({2.0, 0.0, 5.0}, x, nullptr);
    const Eigen::MatrixXd parts =
        2.0 * dampingFor({1.0, 0.0, 0.0}, x, nullptr) + 5.0 * dampingFor({0.0, 0.0, 1.0}, x, nullptr);
    EXPECT_LE((D - parts).cwiseAbs().maxCoeff(), 1e-12 * scale);
    EXPECT_GT((D - 2.0 * K).cwiseAbs().maxCoeff(), 0.1 * scale);
    EXPECT_LE((D - D.transpose()).cwiseAbs().maxCoeff(), 1e-12 * scale);
    const VectorX values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(D, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_GE(values.minCoeff(), -1e-11 * values.maxCoeff());
  }
}

TEST_P(ElasticityProperty, RefusesMaterialsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto expectRefused = [&](double E, double nu, double bending) {
    ElementMaterials materials = GetParam().materials;
    MaterialDescription& last = materials.materials.back();
    last = material(last.model, E, nu, bending);
    EXPECT_THROW(GetParam().make(materials), std::invalid_argument) << E << " " << nu << " " << bending;
  };
  for (const double E : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) expectRefused(E, 0.3, -1.0);
  for (const double nu : {0.5, -1.0, nan}) expectRefused(1e3, nu, -1.0);
  expectRefused(1e3, 0.3, nan);
}

INSTANTIATE_TEST_SUITE_P(Models, ElasticityProperty, ::testing::ValuesIn(models()),
                         [](const auto& parameter) { return parameter.param.name; });

}  // namespace
}  // namespace tissue_contact
