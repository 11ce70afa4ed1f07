/// Sleeping nodes through the whole simulator: they save work, are woken in time, and what they add to the wrench stays
/// within the bound that is stated.
#include "simulation/tissue_sleep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "support/text_scene.h"

namespace tissue_contact {
namespace tissue_sleep_test {

constexpr double kSleepError = 0.001;

struct Variant {
  std::string name;
  std::string material = "model: corotational";
  std::string extra = {};   ///< lines of the scene
  std::string region = {};  ///< and of the tissue
};

/// A 5 mm ball over a block whose base is fixed, 0.1 mm above its middle at joints 0.
Simulator makeScene(const Variant& variant, const std::string& advisor) {
  std::ostringstream yaml;
  yaml << "tissues:\n  - name: block\n    block: {size_m: [0.08, 0.08, 0.03], cells: [8, 8, 3]}\n"
       << "    material: {" << variant.material
       << ", youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}\n"
       << "    damping: {stiffness_s: 0.005}\n"
       << "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
       << variant.region << onlyBall("[0.001, 0.002, 0.0351]")
       << "friction:\n  - {instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}\n"
       << "step: {max_step_s: 0.001}\n"
       << "advisor: {" << advisor << "}\n"
       << variant.extra;
  return makeSimulator(yaml.str(), {{"probe", probeUrdf(0.005)}});
}

const Variant kPlain{"corotational"};
const Variant kCholesky{"cholesky", "model: corotational", "solver: {relaxation: cholesky}\n"};

int freeNodes(const Simulator& simulator) {
  const std::vector<bool>& fixed = simulator.tissues()[0].fixed();
  return static_cast<int>(std::count(fixed.begin(), fixed.end(), false));
}

double pressing(const Simulator& simulator) {
  double sum = 0.0;
  for (const SolvedContact& contact : simulator.contacts()) sum += contact.force_on_tissue_n.norm();
  return sum;
}

/// 20 mm/s down to 3 mm, held to 0.8 s, dragged by 4 mm until 1 s, held to 1.4 s, lifted, away.
Vector3 probeAt(int step) {
  const double t = 0.001 * step;
  const double z = t < 1.4 ? -std::min(0.02 * t, 0.0031) : std::min(-0.0031 + 0.02 * (t - 1.4), 0.01);
  return {0.02 * std::min(std::max(t - 0.8, 0.0), 0.2), 0.0, z};
}
constexpr int kSteps = 3400;

class SleepOfModels : public testing::TestWithParam<Variant> {};

TEST_P(SleepOfModels, WrenchErrorStaysWithinItsBoundAndTheTissueComesToSleep) {
  Simulator sleeping = makeScene(GetParam(), "sleep: auto");
  Simulator awake = makeScene(GetParam(), "sleep: never");
  int most_in_contact = 0;
  double difference = 0.0;
  double size = 0.0;
  for (int k = 1; k <= kSteps; ++k) {
    sleeping.advance(0.001, {probeAt(k)});
    awake.advance(0.001, {probeAt(k)});
    ASSERT_EQ(awake.report().sleeping_nodes, 0);
    difference += (sleeping.wrench(0).force - awake.wrench(0).force).squaredNorm();
    size += awake.wrench(0).force.squaredNorm();
    if (pressing(sleeping) == 0.0) continue;
    most_in_contact = std::max(most_in_contact, sleeping.report().sleeping_nodes);
    ASSERT_LE(sleeping.report().held_force_n, kSleepError * pressing(sleeping) * (1.0 + 1e-12)) << k;
  }
  // The bound is on each step; what the solver leaves differs between the runs as well.
  EXPECT_LE(std::sqrt(difference / size), kSleepError);
  EXPECT_EQ(sleeping.report().sleeping_nodes, freeNodes(sleeping));
  EXPECT_TRUE(sleeping.velocities(0).isZero(0.0));
  EXPECT_LE(sleeping.report().iterations, 1);
  // Where it sleeps is where it rests: what is held moves one node by 1e-3 of an edge at most, were it alone.
  EXPECT_LE((sleeping.positions(0) - awake.positions(0)).colwise().norm().maxCoeff(), 1e-3 * 0.01);
  const bool by_parts = GetParam().extra.find("cholesky") == std::string::npos;
  const int expected = by_parts ? freeNodes(sleeping) / 4 : 0;
  EXPECT_TRUE(by_parts ? most_in_contact > expected : most_in_contact == expected) << most_in_contact;
}

INSTANTIATE_TEST_SUITE_P(
    Variants, SleepOfModels,
    testing::Values(
        kPlain, kCholesky, Variant{"linear", "model: linear"}, Variant{"neo_hookean", "model: neo_hookean"},
        Variant{"mass_spring", "model: mass_spring"},
        Variant{"damping_by_region", "model: corotational", "",
                "    regions:\n      - name: half\n        where: [{box: {min_m: [-1, -1, -1], max_m: [0, 1, 1]}}]\n"
                "        damping: {stiffness_s: 0.01}\n"}),
    [](const auto& variant) { return variant.param.name; });

TEST(TissueSleep, AReplayGivesTheSameBits) {
  Simulator simulator = makeScene(kPlain, "sleep: auto");
  std::vector<Vector3> first;
  std::vector<int> asleep;
  for (int k = 1; k <= kSteps; ++k) {
    simulator.advance(0.001, {probeAt(k)});
    first.push_back(simulator.wrench(0).force);
    asleep.push_back(simulator.report().sleeping_nodes);
  }
  const NodalVectors end = simulator.positions(0);
  simulator.reset();
  EXPECT_EQ(simulator.report().sleeping_nodes, 0);
  for (int k = 1; k <= kSteps; ++k) {
    simulator.advance(0.001, {probeAt(k)});
    ASSERT_EQ(simulator.wrench(0).force, first[k - 1]) << k;
    ASSERT_EQ(simulator.report().sleeping_nodes, asleep[k - 1]) << k;
  }
  EXPECT_EQ(simulator.positions(0), end);
}

// The first contact after a sleep must find the tissue awake: the same force as on tissue that never slept.
TEST(TissueSleep, WakesInTheStepThatTouches) {
  for (const Variant& variant : {kPlain, kCholesky}) {
    Simulator sleeping = makeScene(variant, "sleep: auto");
    Simulator awake = makeScene(variant, "sleep: never");
    for (Simulator* simulator : {&sleeping, &awake}) simulator->advance(1.0, {Vector3(0.0, 0.0, 0.001)});
    ASSERT_EQ(sleeping.report().sleeping_nodes, freeNodes(sleeping));
    for (int k = 1; k <= 70; ++k) {
      for (Simulator* simulator : {&sleeping, &awake}) simulator->advance(0.001, {Vector3(0.0, 0.0, 0.001 - 5e-5 * k)});
      // Nothing had moved yet but what round-off of the coordinates moves, about 1e-15 N.
      ASSERT_LE((sleeping.wrench(0).force - awake.wrench(0).force).norm(), 1e-9 * 0.02) << variant.name << k;
    }
    EXPECT_GT(awake.wrench(0).force.norm(), 0.02);
    EXPECT_EQ(sleeping.report().sleeping_nodes, 0);
  }
}

TEST(TissueSleep, OtherStepLengthsAndJumpsWakeWhatTheyMust) {
  Simulator sleeping = makeScene(kPlain, "sleep: auto");
  Simulator awake = makeScene(kPlain, "sleep: never");
  const auto both = [&](double duration, const Vector3& joints) {
    for (Simulator* simulator : {&sleeping, &awake}) simulator->advance(duration, {joints});
  };
  const Vector3 down(0.0, 0.0, -0.0031);
  both(0.15, down);
  both(1.0, down);
  ASSERT_GT(sleeping.report().sleeping_nodes, 0);
  for (const double dt : {0.0005, 0.0002, 0.001}) {
    for (int k = 0; k < 20; ++k) both(dt, down);
    EXPECT_LE((sleeping.wrench(0).force - awake.wrench(0).force).norm(), kSleepError * pressing(awake)) << dt;
  }
  // To another place at once: contacts are there that were not, on nodes that slept.
  for (Simulator* simulator : {&sleeping, &awake}) simulator->placeInstrument(0, Vector3(0.02, 0.01, -0.001));
  for (int k = 0; k < 300; ++k) {
    both(0.001, Vector3(0.02, 0.01, -0.001));
    ASSERT_LE(sleeping.report().held_force_n, kSleepError * std::max(pressing(sleeping), 1.0));
  }
  EXPECT_GT(awake.wrench(0).force.norm(), 0.01);
  EXPECT_LE((sleeping.wrench(0).force - awake.wrench(0).force).norm(),
            2.0 * kSleepError * awake.wrench(0).force.norm());
}

TEST(TissueSleep, SagsUnderGravityBeforeItSleeps) {
  Variant heavy = kPlain;
  heavy.extra = "gravity_m_per_s2: [-3, 0, -9]\n";
  Simulator sleeping = makeScene(heavy, "sleep: auto");
  Simulator awake = makeScene(heavy, "sleep: never");
  sleeping.advance(2.0, {Vector3(0.0, 0.0, 0.01)});
  awake.advance(4.0, {Vector3(0.0, 0.0, 0.01)});
  EXPECT_EQ(sleeping.report().sleeping_nodes, freeNodes(sleeping));
  const double sag = (awake.positions(0) - awake.tissues()[0].restPositions()).colwise().norm().maxCoeff();
  EXPECT_GT(sag, 5e-4);
  EXPECT_LE((sleeping.positions(0) - awake.positions(0)).colwise().norm().maxCoeff(), 1e-3 * 0.01);
}

TEST(TissueSleep, ZeroErrorLetsNothingSleepThatIsHeld) {
  Simulator simulator = makeScene(kPlain, "sleep_error: 0");
  simulator.advance(0.15, {Vector3(0.0, 0.0, -0.0031)});
  simulator.advance(1.0, {Vector3(0.0, 0.0, -0.0031)});
  EXPECT_EQ(simulator.report().held_force_n, 0.0);
  EXPECT_EQ(simulator.report().sleeping_nodes, 0);
}

}  // namespace tissue_sleep_test
}  // namespace tissue_contact
