/// The pressure that point contacts stand for: exact where it is uniform, whatever points carry it.
#include "simulation/contact_pressure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "simulation/build_scene.h"
#include "support/text_scene.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {
namespace contact_pressure_test {

constexpr double kPressure = 1250.0;  // Pa

/// A block, a sheet beside it.
const char* const kTissues = R"(
tissues:
  - name: block
    block: {size_m: [0.04, 0.02, 0.02], cells: [4, 2, 2]}
    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}
  - name: sheet
    sheet: {size_m: [0.02, 0.02], cells: [2, 2], thickness_m: 0.001}
    material: {model: membrane, youngs_modulus_pa: 5000, poissons_ratio: 0.3, density_kg_per_m3: 1000}
instruments: []
)";

struct Pressed {
  Scene scene = parseScene(kTissues, "test scene", {});
  std::vector<std::unique_ptr<TissueRefinement>> refinements;
  std::vector<Tissue> tissues = buildTissues(scene, {}, refinements);
  ContactPressure pressure{tissues};
  std::vector<NodalVectors> x = {tissues[0].restPositions(), tissues[1].restPositions()};

  std::vector<Triangle> upperFaces(int tissue) const {
    const double top = x[tissue].row(2).maxCoeff() - 1e-9;
    std::vector<Triangle> faces;
    for (const Triangle& t : tissues[tissue].surface()) {
      if (x[tissue](2, t[0]) > top && x[tissue](2, t[1]) > top && x[tissue](2, t[2]) > top) faces.push_back(t);
    }
    return faces;
  }

  SolvedContact contactAt(int tissue, const Triangle& nodes, const Vector3& weights, const Vector3& n) const {
    SolvedContact solved;
    solved.contact.key.tissue = tissue;
    solved.contact.key.instrument = 0;
    solved.contact.nodes = nodes;
    solved.contact.weights = weights;
    solved.contact.R_WC = contactFrame(n);
    solved.state = ContactState::kKinetic;
    return solved;
  }

  /// A uniform pressure on the upper face by three contacts per triangle (exact for what is linear on it), with friction.
  std::vector<SolvedContact> uniform(int tissue, double pressure_pa, const Vector3& n) const {
    std::vector<SolvedContact> contacts;
    for (const Triangle& t : upperFaces(tissue)) {
      for (int i = 0; i < 3; ++i) {
        Vector3 weights = Vector3::Constant(1.0 / 6.0);
        weights[i] = 4.0 / 6.0;
        contacts.push_back(contactAt(tissue, t, weights, n));
        contacts.back().force_on_tissue_n =
            pressure_pa * triangleArea(x[tissue], t) / 3.0 * (n + Vector3(0.4, 0.0, 0.0));
      }
    }
    return contacts;
  }
};

TEST(ContactPressure, UniformPressureIsFoundEverywhereAndInAnyOrder) {
  Pressed block;
  const Vector3 down = -Vector3::UnitZ();
  std::vector<SolvedContact> contacts = block.uniform(0, kPressure, down);
  block.pressure.remember(contacts);
  for (const Triangle& t : block.upperFaces(0)) {
    for (const Vector3& weights : {Vector3(1, 0, 0), Vector3(0.5, 0.5, 0), Vector3(0.2, 0.3, 0.5)}) {
      // Nodes at the rim too, whose triangles are not all on this face.
      EXPECT_NEAR(block.pressure.at(block.contactAt(0, t, weights, down).contact, block.x), kPressure, 1e-9);
    }
  }
  const Contact one = contacts[5].contact;
  const double before = block.pressure.at(one, block.x);
  std::reverse(contacts.begin(), contacts.end());
  block.pressure.remember(contacts);
  EXPECT_NEAR(block.pressure.at(one, block.x), before, 1e-12 * before);
}

TEST(ContactPressure, IsThatOfTheDeformedArea) {
  Pressed block;
  block.pressure.remember(block.uniform(0, kPressure, -Vector3::UnitZ()));
  block.x[0].row(0) *= 2.0;
  const Contact contact =
      block.contactAt(0, block.upperFaces(0)[0], Vector3::Constant(1.0 / 3.0), -Vector3::UnitZ()).contact;
  EXPECT_NEAR(block.pressure.at(contact, block.x), 0.5 * kPressure, 1e-9);
}

TEST(ContactPressure, IsZeroWhereNothingPressedAndAfterClear) {
  Pressed block;
  const std::vector<SolvedContact> contacts = block.uniform(0, kPressure, -Vector3::UnitZ());
  EXPECT_EQ(block.pressure.at(contacts[0].contact, block.x), 0.0);
  block.pressure.remember(contacts);
  EXPECT_GT(block.pressure.at(contacts[0].contact, block.x), 0.0);
  block.pressure.clear();
  EXPECT_EQ(block.pressure.at(contacts[0].contact, block.x), 0.0);
  std::vector<SolvedContact> open = contacts;
  for (SolvedContact& one : open) one.state = ContactState::kOpen;
  block.pressure.remember(open);
  EXPECT_EQ(block.pressure.at(contacts[0].contact, block.x), 0.0);
}

TEST(ContactPressure, KeepsTheSidesOfASheetApart) {
  Pressed sheet;
  const Vector3 up = Vector3::UnitZ();
  std::vector<SolvedContact> contacts = sheet.uniform(1, kPressure, -up);
  const std::vector<SolvedContact> below = sheet.uniform(1, 3.0 * kPressure, up);
  contacts.insert(contacts.end(), below.begin(), below.end());
  sheet.pressure.remember(contacts);
  EXPECT_NEAR(sheet.pressure.at(contacts[0].contact, sheet.x), kPressure, 1e-9);
  EXPECT_NEAR(sheet.pressure.at(below[0].contact, sheet.x), 3.0 * kPressure, 1e-9);
}

/// The sheet lies on the block, whose face reaches beyond it.
TEST(ContactPressure, BetweenTissuesTheSmallerFaceCounts) {
  Pressed both;
  const Triangle under = both.upperFaces(0)[0];
  std::vector<SolvedContact> contacts = both.uniform(1, kPressure, Vector3::UnitZ());
  for (SolvedContact& solved : contacts) {
    solved.contact.key.instrument = -1;
    solved.contact.key.other_tissue = 0;
    solved.contact.other_nodes = under;
    solved.contact.other_weights = Vector3::Constant(1e-3 / 3.0);
  }
  both.pressure.remember(contacts);
  EXPECT_NEAR(both.pressure.at(contacts[0].contact, both.x), kPressure, 1e-9);
  for (SolvedContact& solved : contacts) {  // named the other way round
    Contact& contact = solved.contact;
    std::swap(contact.key.tissue, contact.key.other_tissue);
    std::swap(contact.nodes, contact.other_nodes);
    std::swap(contact.weights, contact.other_weights);
    contact.R_WC.leftCols<2>() *= -1.0;
    solved.force_on_tissue_n *= -1.0;
  }
  both.pressure.remember(contacts);
  EXPECT_NEAR(both.pressure.at(contacts[0].contact, both.x), kPressure, 1e-9);
}

}  // namespace contact_pressure_test
}  // namespace tissue_contact
