/// Which law holds where: by link and region, with the axis of a link or of the fibres in the contact plane.
#include "simulation/friction_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "simulation/build_scene.h"
#include "support/text_scene.h"

namespace tissue_contact {
namespace friction_table_test {

/// Two blocks side by side, `pad` with a hard half (region `scar`, x > 0) and fibres along y.
const char* const kTissues = R"(
tissues:
  - name: pad
    block: {size_m: [0.04, 0.02, 0.02], cells: [4, 2, 2]}
    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}
    fibre_direction: [0, 1, 0]
    regions:
      - name: scar
        where: [{box: {min_m: [0, -1, -1], max_m: [1, 1, 1]}}]
        material: {youngs_modulus_pa: 50000}
  - name: bed
    block: {size_m: [0.04, 0.02, 0.02], cells: [4, 2, 2]}
    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}
instruments:
  - {name: probe, robot_description: probe, tip_link: tip, joint_state_topics: [/js], contact_links: [y_link_shape, tip]}
tissue_pairs: [{tissue: pad, other: bed}]
friction:
)";

std::string twoLinkUrdf() {
  std::string urdf = probeUrdf(0.005);
  const std::string end = "</robot>";
  urdf.resize(urdf.size() - end.size());
  return urdf +
         "<link name='y_link_shape'><collision><geometry><sphere radius='0.001'/></geometry></collision></link>"
         "<joint name='mount' type='fixed'><parent link='y_link'/><child link='y_link_shape'/></joint></robot>";
}

struct Table {
  SceneEnvironment environment;
  Scene scene;
  std::vector<Instrument> instruments;
  std::vector<std::unique_ptr<TissueRefinement>> refinements;
  std::vector<Tissue> tissues;
  FrictionTable table;
  std::vector<NodalVectors> x;
  std::vector<std::vector<Pose>> X_WL;

  explicit Table(const std::string& friction)
      : environment(ownEnvironment({{"probe", twoLinkUrdf()}})),
        scene(parseScene(kTissues + friction, "test scene", environment.package_path)),
        instruments(buildInstruments(scene, environment)),
        tissues(buildTissues(scene, environment, refinements)),
        table(scene, instruments, tissues) {
    for (const Tissue& tissue : tissues) x.push_back(tissue.restPositions());
    X_WL.emplace_back(instruments[0].model().links().size(), Pose::Identity());
  }

  /// A contact on the first upper face of `pad` whose middle has this sign of x, normal downwards.
  Contact contactOn(double sign_of_x, int link) const {
    for (const Triangle& t : tissues[0].surface()) {
      const Vector3 middle = (x[0].col(t[0]) + x[0].col(t[1]) + x[0].col(t[2])) / 3.0;
      if (middle.z() < 0.0199 || middle.x() * sign_of_x <= 0.0) continue;
      Contact contact;
      contact.key.tissue = 0;
      contact.key.instrument = 0;
      contact.key.link = link;
      contact.nodes = t;
      contact.weights.setConstant(1.0 / 3.0);
      contact.R_WC << 0, 1, 0, 0, 0, -1, -1, 0, 0;  // n = -z, t1 = x, t2 = -y
      return contact;
    }
    throw std::logic_error("no such face");
  }
};

TEST(FrictionTable, MostSpecificEntryCountsInAnyOrder) {
  const Table with(
      "  - {instrument: probe, link: tip, tissue: pad, region: scar, static: 0.4}\n"
      "  - {instrument: probe, tissue: pad, static: 0.1}\n"
      "  - {instrument: probe, link: tip, tissue: pad, static: 0.3}\n"
      "  - {instrument: probe, tissue: pad, region: scar, static: 0.2}\n");
  const auto mu = [&](double side, int link) {
    return with.table.at(with.contactOn(side, link), with.x, with.X_WL, {}).mu_static;
  };
  EXPECT_EQ(mu(-1, 0), 0.1);
  EXPECT_EQ(mu(+1, 0), 0.2);
  EXPECT_EQ(mu(-1, 1), 0.3);
  EXPECT_EQ(mu(+1, 1), 0.4);
}

TEST(FrictionTable, PairsThatAreNotListedAreFrictionless) {
  const Table with("  - {instrument: probe, tissue: bed, static: 0.5}\n");
  const CoulombLaw law = with.table.at(with.contactOn(1, 0), with.x, with.X_WL, {});
  EXPECT_EQ(law.mu_static, 0.0);
  EXPECT_EQ(law.mu_kinetic, 0.0);
  EXPECT_EQ(law.anisotropic, nullptr);
}

TEST(FrictionTable, AxisTurnsWithTheLink) {
  Table with(
      "  - {instrument: probe, tissue: pad, law: orthotropic, static: [0.6, 0.2], axis: {link_direction: [1, 0, "
      "0]}}\n");
  const Contact contact = with.contactOn(1, 1);
  EXPECT_LE((with.table.at(contact, with.x, with.X_WL, {}).axis - Vector2(1, 0)).norm(), 1e-15);
  const int link = with.instruments[0].contactLinks()[1].link;
  with.X_WL[0][link].rotate(Eigen::AngleAxisd(0.5, Vector3::UnitZ()));
  // t2 = -y, so the turned axis (cos, sin, 0) is (cos, -sin) in the contact plane.
  const CoulombLaw law = with.table.at(contact, with.x, with.X_WL, {});
  EXPECT_LE((law.axis - Vector2(std::cos(0.5), -std::sin(0.5))).norm(), 1e-15);
  ASSERT_NE(law.anisotropic, nullptr);
}

TEST(FrictionTable, FibresAreCarriedByTheDeformation) {
  Table with("  - {instrument: probe, tissue: pad, law: orthotropic, static: [0.6, 0.2], axis: fibre}\n");
  const Contact contact = with.contactOn(1, 1);
  EXPECT_LE((with.table.at(contact, with.x, with.X_WL, {}).axis - Vector2(0, -1)).norm(), 1e-12);
  // Simple shear x += 0.75 y leans fibres along y over to (0.75, 1) / 1.25.
  with.x[0].row(0) += 0.75 * with.x[0].row(1);
  EXPECT_LE((with.table.at(contact, with.x, with.X_WL, {}).axis - Vector2(0.6, -0.8)).norm(), 1e-12);
}

/// A corner of the block is shared by three faces: the one the contact normal points into counts.
TEST(FrictionTable, VertexContactTakesTheFaceThatIsTouched) {
  const Table with("  - {instrument: probe, tissue: pad, law: orthotropic, static: [0.6, 0.2], axis: fibre}\n");
  const NodalVectors& x = with.tissues[0].restPositions();
  Eigen::Index corner = 0;
  (x.row(0) + x.row(1) + x.row(2)).maxCoeff(&corner);
  for (const Triangle& t : with.tissues[0].surface()) {
    const auto at = std::find(t.begin(), t.end(), static_cast<int>(corner));
    if (at == t.end()) continue;
    Contact contact = with.contactOn(1, 1);  // n = -z, whichever of the corner's triangles it is reported with
    contact.nodes = t;
    contact.weights = Vector3::Unit(at - t.begin());
    EXPECT_LE((with.table.at(contact, with.x, with.X_WL, {}).axis - Vector2(0, -1)).norm(), 1e-12);
  }
}

TEST(FrictionTable, StribeckFactorScalesKineticFrictionOnly) {
  const Table with(
      "  - {instrument: probe, tissue: pad, static: 0.5, kinetic: 0.4, speeds_m_per_s: [0, 0.1], speed_factors: [1, "
      "0.5]}\n");
  const CoulombLaw law = with.table.at(with.contactOn(1, 0), with.x, with.X_WL, {0.05, 0.0});
  EXPECT_EQ(law.mu_static, 0.5);
  EXPECT_NEAR(law.mu_kinetic, 0.3, 1e-15);
}

TEST(FrictionTable, TissuesFindTheirEntryFromBothSides) {
  const Table with("  - {tissue: pad, other_tissue: bed, region: scar, static: 0.7}\n");
  Contact named = with.contactOn(1, 0);
  named.key.instrument = -1;
  named.key.other_tissue = 1;
  EXPECT_EQ(with.table.at(named, with.x, with.X_WL, {}).mu_static, 0.7);
  Contact turned = named;
  std::swap(turned.key.tissue, turned.key.other_tissue);
  std::swap(turned.nodes, turned.other_nodes);
  std::swap(turned.weights, turned.other_weights);
  turned.R_WC.leftCols<2>() *= -1.0;
  EXPECT_EQ(with.table.at(turned, with.x, with.X_WL, {}).mu_static, 0.7);
  Contact outside = with.contactOn(-1, 0);
  outside.key = named.key;
  EXPECT_EQ(with.table.at(outside, with.x, with.X_WL, {}).mu_static, 0.0);
}

// Whichever of the two has the vertex, and whichever way round the entry without a region has them.
TEST(FrictionTable, BetweenTissuesTheEntryOfARegionCounts) {
  for (const char* const general :
       {"{tissue: pad, other_tissue: bed, static: 0.1}", "{tissue: bed, other_tissue: pad, static: 0.1}"}) {
    const Table with("  - " + std::string(general) +
                     "\n  - {tissue: pad, other_tissue: bed, region: scar, static: 0.7}\n");
    for (const double side : {1.0, -1.0}) {
      Contact named = with.contactOn(side, 0);
      named.key.instrument = -1;
      named.key.other_tissue = 1;
      named.other_nodes = with.tissues[1].surface()[0];
      named.other_weights.setConstant(1.0 / 3.0);
      Contact turned = named;
      std::swap(turned.key.tissue, turned.key.other_tissue);
      std::swap(turned.nodes, turned.other_nodes);
      std::swap(turned.weights, turned.other_weights);
      turned.R_WC.leftCols<2>() *= -1.0;
      for (const Contact& contact : {named, turned}) {
        EXPECT_EQ(with.table.at(contact, with.x, with.X_WL, {}).mu_static, side > 0.0 ? 0.7 : 0.1) << general;
      }
    }
  }
}

TEST(FrictionTable, RefusesALawThatWouldDriveSliding) {
  EXPECT_THROW(Table("  - {instrument: probe, tissue: pad, law: tensor, static: [[0.5, 0], [0, -0.1]], axis: fibre}\n"),
               std::invalid_argument);
}

}  // namespace friction_table_test
}  // namespace tissue_contact
