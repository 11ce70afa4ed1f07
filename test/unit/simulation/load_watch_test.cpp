/// Loads that no tissue bears: found where they are, and not where they are not.
#include "simulation/load_watch.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <string>

#include "support/refusal.h"
#include "support/text_scene.h"
#include "tissue_contact/simulation/law_error.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {
namespace load_watch_test {

constexpr double kModulus = 5000.0;

/// A 5 mm sphere 1 mm above the middle of a block of 60 x 60 x 20 mm with cells of 10 mm, fixed below.
Simulator makeScene(const std::string& model = "neo_hookean", const std::string& regions = "",
                    const std::function<double()>& clock = nullptr) {
  return makeSimulator(blockScene("[0.06, 0.06, 0.02]", "[6, 6, 2]", "poissons_ratio: 0.4, model: " + model) + regions +
                           onlyBall("[0, 0, 0.026]"),
                       {{"probe", probeUrdf(0.005)}}, clock);
}

/// The node of the surface nearest to the middle of the upper face.
int middleNode(const Tissue& tissue) {
  int nearest = 0;
  const Vector3 middle(0.0, 0.0, 0.02);
  for (int i = 0; i < tissue.nodeCount(); ++i) {
    if ((tissue.restPositions().col(i) - middle).norm() < (tissue.restPositions().col(nearest) - middle).norm())
      nearest = i;
  }
  return nearest;
}

SolvedContact pushOn(int node, const Vector3& force) {
  SolvedContact contact;
  contact.contact.key.tissue = 0;
  contact.contact.key.instrument = 0;
  contact.contact.key.feature = {node, -1, -1};
  contact.contact.nodes = {node, node, node};
  contact.contact.weights = Vector3::UnitX();
  contact.contact.p_WC = Vector3(0.0, 0.0, 0.02);
  contact.state = ContactState::kStatic;
  contact.force_on_tissue_n = force;
  return contact;
}

struct Watched {
  explicit Watched(const std::string& model = "neo_hookean", const std::string& regions = "")
      : simulator(makeScene(model, regions)) {}

  Simulator simulator;
  LoadWatch watch{simulator.scene(), simulator.tissues()};
  std::vector<NodalVectors> x = {simulator.tissues()[0].restPositions()};
  int node = middleNode(simulator.tissues()[0]);

  ImplausibleLoad check(const std::vector<SolvedContact>& contacts) {
    ImplausibleLoad load;
    watch.check(contacts, x, load, law_error);
    return load;
  }
  LawError law_error;  ///< of the last check
};

constexpr double kNodeArea =
    1e-4;  // of an inner node of the upper face: a cell of 10 x 10 mm, +- a third by its splitting

TEST(LoadWatch, ComparesTheMeanPressureWithTheModulus) {
  Watched scene;
  const ImplausibleLoad light = scene.check({pushOn(scene.node, {0.0, 0.0, -0.5 * kModulus * kNodeArea})});
  EXPECT_FALSE(light.found);
  EXPECT_NEAR(light.pressure_pa, 0.5 * kModulus, 0.34 * 0.5 * kModulus);
  EXPECT_EQ(light.modulus_pa, kModulus);
  const ImplausibleLoad heavy = scene.check({pushOn(scene.node, {0.0, 0.0, -4.0 * kModulus * kNodeArea})});
  EXPECT_TRUE(heavy.found);
  EXPECT_EQ(heavy.tissue, 0);
  EXPECT_EQ(heavy.instrument, 0);
  EXPECT_EQ(heavy.inverted_elements, 0);
  EXPECT_EQ(heavy.p_W, Vector3(0.0, 0.0, 0.02));
  EXPECT_FALSE(scene.check({}).found);
}

TEST(LoadWatch, OpposedForcesDoNotCancel) {
  Watched scene;
  const double big = 4.0 * kModulus * kNodeArea;
  EXPECT_TRUE(scene.check({pushOn(scene.node, {big, 0, 0}), pushOn(scene.node, {-big, 0, 0})}).found);
}

TEST(LoadWatch, OpenContactsPressNothing) {
  Watched scene;
  SolvedContact contact = pushOn(scene.node, {0.0, 0.0, -1.0});
  contact.state = ContactState::kOpen;
  EXPECT_FALSE(scene.check({contact}).found);
}

TEST(LoadWatch, FindsElementsTurnedInsideOutUnderTheTool) {
  Watched scene;
  const std::vector<SolvedContact> contacts = {pushOn(scene.node, {0.0, 0.0, -0.01})};
  scene.x[0](2, scene.node) -= 0.006;  // of 10 mm: flatter
  EXPECT_FALSE(scene.check(contacts).found);
  scene.x[0](2, scene.node) -= 0.009;  // through the layer below
  const ImplausibleLoad load = scene.check(contacts);
  EXPECT_TRUE(load.found);
  EXPECT_GT(load.inverted_elements, 0);
  EXPECT_LT((load.p_W - scene.x[0].col(scene.node)).norm(), 0.02);
  scene.x[0](2, scene.node) += 0.015;
  scene.x[0](2, 0) += 0.05;  // somewhere else, where nothing presses
  EXPECT_FALSE(scene.check(contacts).found);
}

// The whole block strained alike: so is what is under the tool, by F = diag(a, a, b): Green's strain (a^2 - 1)/2, (b^2 - 1)/2, its
// deviator in the ratio 1 : 1 : -2, so the equivalent is |b^2 - a^2| / 3.
TEST(LawWatch, TakesTheStrainUnderTheTool) {
  Watched scene("corotational");
  const SolvedContact push = pushOn(scene.node, {0.0, 0.0, -0.01});
  scene.check({push});
  EXPECT_NEAR(scene.law_error.strain, 0.0, 1e-15);
  const double a = 1.2;
  const double b = 0.7;
  scene.x[0] = Vector3(a, a, b).asDiagonal() * scene.x[0];
  scene.check({push});
  EXPECT_NEAR(scene.law_error.strain, (a * a - b * b) / 3.0, 1e-12);
  EXPECT_EQ(scene.law_error.relative, likelyLawError(ElasticModel::kCorotational, 0.4, scene.law_error.strain));
  EXPECT_EQ(scene.law_error.tissue, 0);
  EXPECT_EQ(scene.law_error.instrument, 0);
  scene.x[0] = Eigen::AngleAxisd(2.0, Vector3(1.0, 2.0, -1.0).normalized()).toRotationMatrix() * scene.x[0];
  scene.check({push});
  EXPECT_NEAR(scene.law_error.strain, (a * a - b * b) / 3.0, 1e-12);
  scene.check({});
  EXPECT_EQ(scene.law_error.strain, 0.0);
  EXPECT_EQ(scene.law_error.relative, 0.0);
}

TEST(LawWatch, ContactsCountByForceAndOpenOnesNot) {
  Watched scene("linear");
  const int other = 0;  // a corner, far from the middle
  scene.x[0](2, scene.node) -= 0.003;
  scene.check({pushOn(scene.node, {0.0, 0.0, -0.01})});
  const double alone = scene.law_error.strain;
  EXPECT_GT(alone, 0.1);
  scene.check({pushOn(other, {0.0, 0.0, -0.03}), pushOn(scene.node, {0.0, 0.0, -0.01})});
  EXPECT_NEAR(scene.law_error.strain, 0.25 * alone, 1e-12);
  SolvedContact open = pushOn(other, {0.0, 0.0, -0.03});
  open.state = ContactState::kOpen;
  scene.check({open, pushOn(scene.node, {0.0, 0.0, -0.01})});
  EXPECT_NEAR(scene.law_error.strain, alone, 1e-15);
}

TEST(LawWatch, TakesPoissonsRatioOfTheRegionUnderTheTool) {
  const auto relative = [](const std::string& min_m) {
    Watched scene("corotational", "    regions: [{name: part, where: [{box: {min_m: " + min_m +
                                      ", max_m: [1, 1, 1]}}], material: {poissons_ratio: 0.49}}]\n");
    scene.x[0] = Vector3(1.1, 1.1, 0.8).asDiagonal() * scene.x[0];
    scene.check({pushOn(scene.node, {0.0, 0.0, -0.01})});
    return scene.law_error.relative;
  };
  const double strain = (1.1 * 1.1 - 0.8 * 0.8) / 3.0;
  const double of_tissue = likelyLawError(ElasticModel::kCorotational, 0.4, strain);
  const double of_region = likelyLawError(ElasticModel::kCorotational, 0.49, strain);
  ASSERT_LT(of_region, of_tissue - 0.01);
  EXPECT_NEAR(relative("[-1, -1, -1]"), of_region, 1e-12);
  EXPECT_NEAR(relative("[0.021, -1, -1]"), of_tissue, 1e-12);  // beside the tool
  const double half = relative("[0, -1, -1]");
  EXPECT_GT(half, of_region + 0.2 * (of_tissue - of_region));
  EXPECT_LT(half, of_tissue - 0.2 * (of_tissue - of_region));
}

TEST(LawWatch, NeoHookeanTissueIsNotWatched) {
  Watched scene;
  scene.x[0] = Vector3(1.2, 1.2, 0.7).asDiagonal() * scene.x[0];
  scene.check({pushOn(scene.node, {0.0, 0.0, -0.01})});
  EXPECT_EQ(scene.law_error.strain, 0.0);
  EXPECT_EQ(scene.law_error.tissue, -1);
}

// Against figures of press-laws (its fit is checked there); at the ends of what it was fitted to it stays what it is.
TEST(LawError, IsThatOfPressesAndBounded) {
  const ElasticModel linear = ElasticModel::kLinear;
  const ElasticModel corotational = ElasticModel::kCorotational;
  EXPECT_NEAR(likelyLawError(corotational, 0.45, 0.26), -0.15, 0.03);
  EXPECT_NEAR(likelyLawError(corotational, 0.3, 0.26), -0.10, 0.03);
  EXPECT_NEAR(likelyLawError(linear, 0.45, 0.47), -0.13, 0.03);
  for (const ElasticModel model : {linear, corotational}) {
    EXPECT_EQ(likelyLawError(model, 0.45, 0.0), 0.0);
    EXPECT_EQ(likelyLawError(model, 0.45, 1e300), likelyLawError(model, 0.45, 0.6));
    EXPECT_EQ(likelyLawError(model, -0.9, 0.3), likelyLawError(model, 0.3, 0.3));
    EXPECT_EQ(likelyLawError(model, 0.4999, 0.3), likelyLawError(model, 0.49, 0.3));
  }
  EXPECT_EQ(likelyLawError(ElasticModel::kNeoHookean, 0.45, 0.5), 0.0);
  EXPECT_EQ(likelyLawError(ElasticModel::kMassSpring, 0.25, 0.5), 0.0);
}

TEST(LawAlarm, TellsOnceUntilTheLawHasBeenBackInItsRange) {
  LawAlarm alarm;
  const auto leaves = [&](double relative) { return alarm.leaves(relative); };
  const double between = 0.5 * (LawAlarm::kLeft + LawAlarm::kBack);
  EXPECT_FALSE(leaves(-between));
  EXPECT_TRUE(leaves(-1.1 * LawAlarm::kLeft));
  EXPECT_FALSE(leaves(-2.0 * LawAlarm::kLeft));
  EXPECT_FALSE(leaves(-between));
  EXPECT_FALSE(leaves(-1.1 * LawAlarm::kLeft));
  EXPECT_FALSE(leaves(-0.9 * LawAlarm::kBack));
  EXPECT_TRUE(leaves(1.1 * LawAlarm::kLeft));
}

TEST(LawWatch, ADeepPressOnACorotationalTissueIsToldWithTheFix) {
  Simulator simulator = makeScene("corotational");
  simulator.advance(0.2, {Vector3(0.0, 0.0, -0.0013)});
  LawAlarm alarm;
  EXPECT_FALSE(alarm.leaves(simulator.report().law_error.relative)) << simulator.report().law_error.relative;
  simulator.advance(0.5, {Vector3(0.0, 0.0, -0.009)});
  EXPECT_TRUE(alarm.leaves(simulator.report().law_error.relative)) << simulator.report().law_error.relative;
  expectContains(lawErrorText(simulator),
                 {"'block'", "'probe'", "corotational", "too small", "model: neo_hookean, dilatation: patch"});
}

TEST(LoadWatch, APressIsPlausibleAndAToolThroughTheBaseIsNot) {
  for (const std::string model : {"neo_hookean", "corotational"}) {
    Simulator simulator = makeScene(model);
    simulator.advance(0.2, {Vector3(0.0, 0.0, -0.004)});
    EXPECT_GT(simulator.report().implausible_load.pressure_pa, 0.0);
    EXPECT_FALSE(simulator.report().implausible_load.found);
    bool flagged = false;
    for (int i = 1; i <= 30; ++i) {
      simulator.advance(0.02, {Vector3(0.0, 0.0, -0.004 - 0.001 * i)});
      if (!simulator.report().implausible_load.found) continue;
      flagged = true;
      const std::string text = implausibleLoadText(simulator);
      expectContains(text, {"'block'", "'probe'", "Pa", "smaller cells"});
      EXPECT_EQ(text.find("neo_hookean") == std::string::npos, model == "neo_hookean")
          << "advice that is taken already";
    }
    EXPECT_TRUE(flagged) << model;
  }
}

/// It told to check the place of the tool and to take smaller cells, which make a machine that does not keep up worse.
TEST(LoadWatch, AStepThatHadNoTimeIsToldToHaveNoneNotToBeMisplaced) {
  Simulator simulator = makeScene("corotational", "", [] { return 1.0; });
  simulator.advance(0.2, {Vector3(0.0, 0.0, -0.004)});
  simulator.setSolverDeadline(0.0);  // over
  for (int i = 1; i <= 60 && !simulator.report().implausible_load.found; ++i)
    simulator.advance(0.02, {Vector3(0.0, 0.0, -0.004 - 0.001 * i)});
  ASSERT_TRUE(simulator.report().implausible_load.found);
  ASSERT_EQ(simulator.report().stop, StopReason::kTimeBudget);
  const std::string text = implausibleLoadText(simulator);
  expectContains(text, {"'block'", "no time to finish this step", "step.max_lag_s", "fewer nodes"});
  EXPECT_EQ(text.find("smaller cells"), std::string::npos) << text;
}

}  // namespace load_watch_test
}  // namespace tissue_contact
