/// @file
/// JointStatePlayer where joint states have velocities: joints follow the cubic through them in between.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "joint_state_player_fixture.h"

namespace tissue_contact {
namespace joint_state_velocities_test {

constexpr double kTurnsPerSecond = 3.0;
constexpr double kAmplitude_m = 0.004;
const double kOmega = 2.0 * std::acos(-1.0) * kTurnsPerSecond;

double height(std::int64_t stamp_ns) {
  return kAmplitude_m * (std::sin(kOmega * 1e-9 * static_cast<double>(stamp_ns - kSecond)) + 1.0);
}
double climb(std::int64_t stamp_ns) {  // m/s
  return kAmplitude_m * kOmega * std::cos(kOmega * 1e-9 * static_cast<double>(stamp_ns - kSecond));
}

JointStateSample shaken(std::int64_t stamp_ns) {
  return {stamp_ns, {"x", "y", "z"}, {0.0, 0.0, height(stamp_ns)}, {0.0, 0.0, climb(stamp_ns)}};
}
JointStateSample withVelocity(JointStateSample sample, double z_velocity) {
  sample.velocities = {0.0, 0.0, z_velocity};
  return sample;
}

/// Where z of an instrument is after each step of 1 ms.
std::vector<double> heightsOf(Simulator& simulator, JointStatePlayer& player, const Order& order, int instrument = 0) {
  std::vector<double> heights;
  simulator.setStepObserver([&] { heights.push_back(simulator.jointPositions(instrument).z()); });
  runAll(simulator, player, order);
  simulator.setStepObserver(nullptr);
  return heights;
}
std::vector<double> heightsOf(const Order& order) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  return heightsOf(*simulator, player, order);
}

Order every(std::int64_t interval_ns, std::int64_t until_ns, JointStateSample (*make)(std::int64_t) = shaken) {
  Order order;
  for (std::int64_t stamp_ns = kSecond; stamp_ns <= until_ns; stamp_ns += interval_ns)
    order.emplace_back(0, make(stamp_ns));
  return order;
}
JointStateSample shakenWithoutVelocities(std::int64_t stamp_ns) {
  JointStateSample sample = shaken(stamp_ns);
  sample.velocities.clear();
  return sample;
}

/// Largest difference of the acceleration between steps from that of the motion, as a share of the latter's largest.
double accelerationError(const std::vector<double>& heights) {
  double largest = 0.0;
  for (std::size_t i = 1; i + 1 < heights.size(); ++i) {
    const double found = (heights[i + 1] - 2.0 * heights[i] + heights[i - 1]) / 1e-6;
    const std::int64_t stamp_ns = kSecond + static_cast<std::int64_t>(i + 1) * kMillisecond;
    const double right = -kOmega * kOmega * (height(stamp_ns) - kAmplitude_m);
    largest = std::max(largest, std::abs(found - right));
  }
  return largest / (kOmega * kOmega * kAmplitude_m);
}

TEST(JointStateVelocities, JointsFollowAMotionBetweenStatesRarerThanSteps) {
  const std::int64_t until_ns = kSecond + 400 * kMillisecond;
  for (const std::int64_t ms : {5, 10, 20}) {
    const std::vector<double> heights = heightsOf(every(ms * kMillisecond, until_ns));
    ASSERT_EQ(heights.size(), 400U);
    double farthest = 0.0;
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const std::int64_t stamp_ns = kSecond + static_cast<std::int64_t>(i + 1) * kMillisecond;
      farthest = std::max(farthest, std::abs(heights[i] - height(stamp_ns)));
    }
    const double angle = kOmega * 1e-3 * static_cast<double>(ms);
    // Cubic Hermite interpolation: h^4 / 384 times the largest fourth derivative; its second derivative is off by h^2 / 12 times that
    // at most. Differences over steps of 1 ms add what a sine's do.
    EXPECT_LE(farthest, kAmplitude_m * std::pow(angle, 4.0) / 384.0 + 1e-15);
    EXPECT_LE(accelerationError(heights), angle * angle / 12.0 + 1e-3);
    // Straight ways put all of an interval's change of speed into one step.
    const double straight = accelerationError(heightsOf(every(ms * kMillisecond, until_ns, shakenWithoutVelocities)));
    EXPECT_GT(straight, 0.9 * static_cast<double>(ms - 1));
  }
}

TEST(JointStateVelocities, WhatDoesNotTellOfTheWayChangesNothing) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const std::int64_t until_ns = kSecond + 200 * kMillisecond;
  const std::vector<double> straight = heightsOf(every(10 * kMillisecond, until_ns, shakenWithoutVelocities));
  const auto spoiled = [&](const std::array<double, 2>& factors) {
    Order order = every(10 * kMillisecond, until_ns);
    for (std::size_t i = 0; i < order.size(); ++i) {
      // A velocity of zero times a factor stays one: of no joint state here.
      std::vector<double>& velocities = order[i].second.velocities;
      for (double& velocity : velocities) velocity *= factors[i % 2];
    }
    return heightsOf(order);
  };
  EXPECT_EQ(spoiled({0.0, 0.0}), straight) << "filled with zeros";
  EXPECT_EQ(spoiled({kNan, kNan}), straight);
  EXPECT_EQ(spoiled({kNan, 1.0}), straight) << "only one end is known";
  EXPECT_EQ(spoiled({1e300, 1e300}), straight);
  EXPECT_EQ(spoiled({std::numeric_limits<double>::infinity(), 1.0}), straight);
  Order short_of_one = every(10 * kMillisecond, until_ns);
  for (auto& [topic, state] : short_of_one) state.velocities.pop_back();
  EXPECT_EQ(heightsOf(short_of_one), straight) << "not one for each name";
}

TEST(JointStateVelocities, AWildOneLeavesTheWayBetweenItsStates) {
  Order order = every(10 * kMillisecond, kSecond + 200 * kMillisecond);
  order[10].second = withVelocity(order[10].second, 5.0);  // m/s; .05 is the most
  const std::vector<double> heights = heightsOf(order);
  const std::vector<double> right = heightsOf(every(10 * kMillisecond, kSecond + 200 * kMillisecond));
  for (std::size_t i = 0; i < heights.size(); ++i) EXPECT_NEAR(heights[i], right[i], 0.1 * kAmplitude_m) << i;
}

/// Of one who is sampled between the stamps of another, both ways: its samples are there, or come before them.
TEST_F(TwoProbes, AMomentOfAnotherLiesOnTheSameCubic) {
  Order order;
  for (std::int64_t ms = 0; ms <= 200; ++ms) {
    const std::int64_t stamp_ns = kSecond + ms * kMillisecond;
    if (ms % 10 == 0) order.emplace_back(1, shaken(stamp_ns));
    if (ms % 4 == 1) order.emplace_back(0, sample(stamp_ns, 0.01));
  }
  const std::vector<double> heights = heightsOf(*simulator, player, order, 1);
  const std::vector<double> alone = heightsOf(every(10 * kMillisecond, kSecond + 200 * kMillisecond));
  ASSERT_EQ(heights.size(), alone.size());
  // Round-off of stamps' differences.
  for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_NEAR(heights[i], alone[i], 1e-12) << i;
}

TEST(JointStateVelocities, ASavedStateGoesOnAlongTheCubic) {
  const Order order = every(10 * kMillisecond, kSecond + 200 * kMillisecond);
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  const std::vector<double> unbroken = heightsOf(*simulator, player, order);
  const auto first = oneProbe();
  JointStatePlayer first_player(*first);
  heightsOf(*first, first_player, Order(order.begin(), order.begin() + 8));
  const auto second = oneProbe();
  JointStatePlayer second_player(*second);
  second_player.restoreState(first_player.saveState());
  const std::vector<double> rest = heightsOf(*second, second_player, Order(order.begin() + 8, order.end()));
  EXPECT_EQ(rest, std::vector<double>(unbroken.begin() + 70, unbroken.end()));
}

/// Another topic's moment may lie before where a restored state is, and its own next sample after that.
TEST_F(TwoProbes, AMomentBeforeARestoredStateIsNotOnTheWayToTheNext) {
  for (const int topic : {0, 1}) player.push(topic, shaken(kSecond));
  player.push(0, shaken(kSecond + 10 * kMillisecond));
  player.stopWaiting();
  drain(player);
  const VectorX at = simulator->jointPositions(1);
  const std::string state = player.saveState();
  for (const std::int64_t next_ms : {10, 11}) {
    player.restoreState(state);
    player.push(0, shaken(kSecond + 7 * kMillisecond));
    player.push(1, shaken(kSecond + next_ms * kMillisecond));
    player.finish();
    ASSERT_NO_THROW(drain(player));
    EXPECT_LT((simulator->jointPositions(1) - at).norm(), 1e-3) << next_ms;
  }
}

TEST_F(OneProbe, VelocitiesAreOfAllJointsAndMayBeAnything) {
  const double wild = std::numeric_limits<double>::max();
  JointVelocities velocities{{Vector3::Zero()}, {Vector3::Zero()}};
  for (const double value : {wild, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    velocities.start[0].setConstant(value);
    velocities.end[0].setConstant(-value);
    simulator->advance(0.01, {Vector3(0.0, 0.0, -0.002)}, {}, &velocities);
    EXPECT_TRUE(simulator->positions(0).allFinite());
    EXPECT_EQ(simulator->jointPositions(0), VectorX(Vector3(0.0, 0.0, -0.002)));
  }
  velocities.end[0] = Vector2::Zero();
  EXPECT_THROW(simulator->advance(0.01, {Vector3(0.0, 0.0, -0.002)}, {}, &velocities), std::invalid_argument);
  velocities.end.clear();
  EXPECT_THROW(simulator->advance(0.01, {Vector3(0.0, 0.0, -0.002)}, {}, &velocities), std::invalid_argument);
}

TEST_F(OneProbe, AfterAGapTheWayIsStraight) {
  player.push(0, withVelocity(sample(kSecond, 0.0), 0.1));
  player.push(0, withVelocity(sample(kSecond + 60 * kMillisecond, 0.006), 0.1));  // max_gap_s is 50 ms
  std::vector<double> heights;
  simulator->setStepObserver([&] { heights.push_back(simulator->jointPositions(0).z()); });
  drain(player);
  ASSERT_EQ(heights.size(), 50U);
  EXPECT_NEAR(heights[11], 0.006 * 12.0 / 50.0, 1e-15);  // a cubic would be .09 mm lower; half way both are the same
}

/// A block of 1 MPa lies on a plate that is shaken by .36 g at 3 Hz.
std::unique_ptr<Simulator> blockOnShakenPlate() {
  return std::make_unique<Simulator>(makeSimulator(
      "gravity_m_per_s2: [0, 0, -9.81]\ntissues:\n  - name: block\n    block: {size_m: [0.02, 0.02, 0.01], cells: [2, "
      "2, 1]}\n    material: "
      "{youngs_modulus_pa: 1.0e6, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n    damping: {stiffness_s: "
      "0.001}\ninstruments:\n  - {name: plate, "
      "robot_description: probe, base_pose: {position_m: [0, 0, -0.014]}, tip_link: tip, joint_state_topics: [/plate], "
      "initial_joint_positions: {z: 0.004}, contact_links: [{link: tip, shapes: [{box: {size_m: [0.2, 0.2, "
      "0.02]}}]}]}\nstep: {max_step_s: 0.001}\n",
      {{"probe", probeUrdf(0.005)}}));
}

/// Share of m a that the plate bears beside m g, in the wrenches of joint states at 100 Hz.
double inertiaShown(JointStateSample (*make)(std::int64_t)) {
  const auto simulator = blockOnShakenPlate();
  JointStatePlayer player(*simulator);
  double shown = 0.0, all = 0.0;
  for (const auto& [topic, state] : every(10 * kMillisecond, kSecond + 1000 * kMillisecond, make)) {
    player.push(topic, state);
    drain(player);
    if (state.stamp_ns < kSecond + 300 * kMillisecond) continue;  // until the fall of the start is over
    const double acceleration = -kOmega * kOmega * (height(state.stamp_ns) - kAmplitude_m);
    const double mass_kg = simulator->tissues()[0].nodeMasses().sum();
    shown += (-simulator->wrench(0).force.z() - mass_kg * 9.81) * acceleration;
    all += mass_kg * acceleration * acceleration;
  }
  return shown / all;
}

TEST(JointStateVelocities, WhatIsCarriedShowsItsInertia) {
  EXPECT_NEAR(inertiaShown(shaken), 1.0,
              0.05);  // the wrench is the mean of the step before the stamp, and cubics are off by angle^2 / 12
  EXPECT_LT(inertiaShown(shakenWithoutVelocities), 0.5);
}

}  // namespace joint_state_velocities_test
}  // namespace tissue_contact
