/// Elements whose nodes are still need no evaluation: forces and stiffness are those of a full one.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "tissue/element_patches.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/tissue/make_elasticity.h"
#include "validation/elasticity_helpers.h"

namespace tissue_contact {
namespace hold_still_test {

struct Body {
  TetMesh mesh;
  std::vector<bool> fixed, still;
  ElementMaterials materials;
};

using Model = std::pair<ElasticModel, Dilatation>;

/// Two regions of different stiffness and damping along x; the lower half along z is still.
Body makeBody(const Model& model) {
  Body body{makeBlockMesh({Vector3(0.06, 0.03, 0.04), {6, 3, 4}, {}}), {}, {}, {}};
  for (Eigen::Index i = 0; i < body.mesh.positions.cols(); ++i) {
    body.fixed.push_back(body.mesh.positions(2, i) == 0.0);
    body.still.push_back(body.mesh.positions(2, i) < 0.025);
  }
  const MaterialDescription soft{model.first, 5e3, 0.4, 1000.0, -1.0, model.second};
  MaterialDescription stiff = soft;
  stiff.youngs_modulus_pa = 2e4;
  stiff.poissons_ratio = 0.3;
  body.materials.materials = {soft, stiff};
  body.materials.damping_s = {0.001, 0.004};
  for (const Tetrahedron& nodes : body.mesh.tetrahedra) {
    body.materials.of_element.push_back(body.mesh.positions(0, nodes[0]) > 0.0 ? 1 : 0);
  }
  return body;
}

/// Bends the block and shears what is not still by `more`.
NodalVectors deformed(const Body& body, double more) {
  NodalVectors x = body.mesh.positions;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const double z = x(2, i);
    x(0, i) += 6.0 * z * z;
    x(1, i) += 0.2 * z * x(0, i) / 0.06;
    if (!body.still[i]) x(0, i) += more * z;
  }
  return x;
}

class HoldStill : public testing::TestWithParam<Model> {};

TEST_P(HoldStill, ForcesAndMatricesAreThoseOfAFullEvaluation) {
  const Body body = makeBody(GetParam());
  const auto model = makeVolumeElasticity(body.mesh.positions, body.mesh.tetrahedra, body.fixed, body.materials,
                                          patchesByCells(body.mesh.tetrahedra.size(), kTetrahedraPerCell));
  const auto held = model->makeState();
  const auto full = model->makeState();
  NodalVectors f_held(3, body.mesh.positions.cols());
  NodalVectors f_full = f_held;
  model->update(deformed(body, 0.0), *held, f_held);
  model->update(deformed(body, 0.0), *full, f_full);
  model->holdStill(body.still, deformed(body, 0.0), *held);
  for (const double more : {0.0, 0.1, 0.3}) {
    model->update(deformed(body, more), *held, f_held);
    model->update(deformed(body, more), *full, f_full);
    // The same element forces, summed in another order.
    EXPECT_LE((f_held - f_full).cwiseAbs().maxCoeff(), 1e-13 * f_full.cwiseAbs().maxCoeff()) << more;
    EXPECT_LE((dense(held->stiffness) - dense(full->stiffness)).cwiseAbs().maxCoeff(),
              1e-12 * dense(full->stiffness).cwiseAbs().maxCoeff());
    EXPECT_LE((dense(held->damping) - dense(full->damping)).cwiseAbs().maxCoeff(),
              1e-12 * dense(full->damping).cwiseAbs().maxCoeff());
  }
  // All awake again, and moving where they were still.
  model->holdStill(body.fixed, deformed(body, 0.3), *held);
  const NodalVectors x = 1.01 * deformed(body, 0.3);
  model->update(x, *held, f_held);
  model->update(x, *full, f_full);
  EXPECT_LE((f_held - f_full).cwiseAbs().maxCoeff(), 1e-13 * f_full.cwiseAbs().maxCoeff());
}

// In a mesh file the elements of a patch are apart, so that batches of patches rest where no batch of elements does.
TEST_P(HoldStill, AlsoWhereElementsComeInAnyOrder) {
  Body body = makeBody(GetParam());
  std::shuffle(body.mesh.tetrahedra.begin(), body.mesh.tetrahedra.end(), std::mt19937(1));
  body.materials = ElementMaterials(body.materials.materials[0]);
  const std::vector<int> patch_of = patchesByFaces(body.mesh.positions, body.mesh.tetrahedra);
  const auto model =
      makeVolumeElasticity(body.mesh.positions, body.mesh.tetrahedra, body.fixed, body.materials, patch_of);
  const NodalVectors x = deformed(body, 0.0);
  NodalVectors f_held(3, x.cols());
  NodalVectors f_full(3, x.cols());
  const int patches = *std::max_element(patch_of.begin(), patch_of.end()) + 1;
  for (int few = 4; few < 12; ++few) {
    std::fill(body.still.begin(), body.still.end(), false);
    for (std::size_t e = 0; e < patch_of.size(); ++e) {
      if (patch_of[e] < patches - few) continue;
      for (const int node : body.mesh.tetrahedra[e]) body.still[static_cast<std::size_t>(node)] = true;
    }
    const auto held = model->makeState();
    const auto full = model->makeState();
    model->update(x, *held, f_held);
    model->update(x, *full, f_full);
    model->holdStill(body.still, x, *held);
    model->update(x, *held, f_held);
    model->update(x, *full, f_full);
    EXPECT_LE((f_held - f_full).cwiseAbs().maxCoeff(), 1e-12 * f_full.cwiseAbs().maxCoeff()) << few;
  }
}

/// Of the models that have something to gain.
class HoldStillSaves : public testing::TestWithParam<Model> {};

TEST_P(HoldStillSaves, ElementsOfStillNodesAreNotLookedAt) {
  const Body body = makeBody(GetParam());
  const auto model = makeVolumeElasticity(body.mesh.positions, body.mesh.tetrahedra, body.fixed, body.materials,
                                          patchesByCells(body.mesh.tetrahedra.size(), kTetrahedraPerCell));
  const auto state = model->makeState();
  NodalVectors before(3, body.mesh.positions.cols());
  NodalVectors after = before;
  model->holdStill(body.still, body.mesh.positions, *state);
  model->update(body.mesh.positions, *state, before);
  NodalVectors x = body.mesh.positions;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if (x(2, i) < 0.005) x(0, i) += 0.001;  // against the contract: in the bottom layer, whose elements are all still
  }
  model->update(x, *state, after);
  EXPECT_EQ(before, after);
}

constexpr Model kFiniteElements[] = {
    {ElasticModel::kLinear, Dilatation::kElement},       {ElasticModel::kLinear, Dilatation::kPatch},
    {ElasticModel::kCorotational, Dilatation::kElement}, {ElasticModel::kCorotational, Dilatation::kPatch},
    {ElasticModel::kNeoHookean, Dilatation::kElement},   {ElasticModel::kNeoHookean, Dilatation::kPatch},
    {ElasticModel::kNeoHookean, Dilatation::kAuto}};

std::string nameOf(const testing::TestParamInfo<Model>& model) {
  const bool patches = model.param.second == Dilatation::kPatch;
  const bool shares = model.param.first == ElasticModel::kNeoHookean && model.param.second == Dilatation::kAuto;
  return std::string(elasticModelName(model.param.first)) + (patches ? "_of_patches" : shares ? "_shared" : "");
}

INSTANTIATE_TEST_SUITE_P(FiniteElements, HoldStill, testing::ValuesIn(kFiniteElements), nameOf);
INSTANTIATE_TEST_SUITE_P(MassSpring, HoldStill, testing::Values(Model{ElasticModel::kMassSpring, Dilatation::kAuto}),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(FiniteElements, HoldStillSaves, testing::ValuesIn(kFiniteElements), nameOf);

}  // namespace hold_still_test
}  // namespace tissue_contact
