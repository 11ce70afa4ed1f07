/// Into how many steps a motion is cut, against a walk over all of them.
#include "simulation/instrument_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "unit/instrument/instrument_fixture.h"

namespace tissue_contact {
namespace instrument_motion_test {

constexpr double kRadius = 0.004;   // m, of the ball
constexpr double kMaxStep = 0.001;  // s

/// slide, prismatic; turn and bend, revolute; a finger that follows bend twice as far, with a ball beside its joint.
std::vector<Instrument> arm() {
  InstrumentDescription description;
  description.name = "arm";
  description.joint_state_topics = {{"/joint_states"}};
  description.tip_link = "finger";
  description.contact_links = {{"finger", {}}};
  RobotModel model = parse(
      "<link name='base'/><link name='carriage'/><link name='upper'/><link name='lower'/><link "
      "name='finger'><collision>"
      "<origin xyz='0.03 0 0.01'/><geometry><sphere radius='0.004'/></geometry></collision></link>" +
      joint("slide", "prismatic", "base", "carriage", "<origin xyz='0 0.1 0'/><axis xyz='0 0 1'/>") +
      joint("turn", "continuous", "carriage", "upper", "<origin xyz='0.1 0 0'/><axis xyz='0 0 1'/>") +
      joint("bend", "revolute", "upper", "lower", "<origin xyz='0.2 0 0.1' rpy='0.3 0 1'/><axis xyz='0 1 0'/>") +
      joint("follow", "revolute", "lower", "finger",
            "<origin xyz='0.05 0 0'/><axis xyz='1 0 0'/><mimic joint='bend' multiplier='2' offset='0.4'/>"));
  return {Instrument(description, std::move(model), rotation(0.7, Vector3(1, 2, 3)))};
}

struct Cut {
  double steps;
  bool jumped;
};

/// What begin() says of itself, every step looked at.
Cut walked(const Instrument& instrument, double duration_s, const VectorX& start, const VectorX& target) {
  const double by_time = std::ceil(duration_s / kMaxStep - 1e-9);
  double turn = 0.0;
  for (const RobotModel::Link& link : instrument.model().links()) {
    if (link.motion != RobotModel::Link::Motion::kRevolute) continue;
    turn = std::max(turn, std::abs(link.multiplier * (target[link.joint] - start[link.joint])));
  }
  const double steps = std::max({1.0, by_time, std::ceil(turn)});
  const auto ball = static_cast<std::size_t>(instrument.tipLink());
  const Vector3 center = instrument.contactLinks()[0].shapes[0].X_LS.translation();
  std::vector<Pose> before, after;
  instrument.linkPoses(start, before);
  double longest = 0.0;
  for (int k = 1; k <= static_cast<int>(steps); ++k) {
    instrument.linkPoses(start + k / steps * (target - start), after);
    const double angle = Eigen::AngleAxisd(before[ball].linear().transpose() * after[ball].linear()).angle();
    longest = std::max(longest, (after[ball] * center - before[ball] * center).norm() + angle * kRadius);
    before = after;
  }
  const double cut = steps * std::max(1.0, std::ceil(longest / (0.5 * kRadius)));
  const double most = std::max(
      by_time, std::min(InstrumentMotion::kMaxTravelSteps, InstrumentMotion::kMaxTravelStepsPerSecond * duration_s));
  return {cut <= most ? cut : std::max(1.0, by_time), cut > most};
}

TEST(InstrumentMotion, CutsAsIfItHadWalkedEveryStep) {
  const std::vector<Instrument> instruments = arm();
  std::mt19937_64 random(7);
  const auto size = [&](double low, double high) {  // log-uniform
    return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
  };
  int by_time = 0, by_travel = 0, jumps = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    InstrumentMotion motion(instruments);
    const double duration_s = size(5e-4, 4.0), scale = size(1e-3, 20.0);
    const VectorX start = Vector3::Random(), target = start + scale * Vector3::Random();
    motion.place(0, start);
    const Cut expected = walked(instruments[0], duration_s, start, target);
    EXPECT_EQ(motion.begin(duration_s, kMaxStep, {target}), expected.steps) << duration_s << " s, " << scale;
    EXPECT_EQ(motion.jumped(), expected.jumped) << duration_s << " s, " << scale;
    (expected.jumped ? jumps : expected.steps > std::ceil(duration_s / kMaxStep) ? by_travel : by_time) += 1;
  }
  EXPECT_GT(std::min({by_time, by_travel, jumps}), 100);
}

// An interruption is looked for between steps, so the cut into a billion of them must not take long: walked over, this takes hours.
TEST(InstrumentMotion, CutsIntoABillionStepsAtOnce) {
  const std::vector<Instrument> instruments = arm();
  InstrumentMotion motion(instruments);
  for (int k = 0; k < 100; ++k) {
    EXPECT_EQ(motion.begin(1e6, kMaxStep, {Vector3(0.1, 3.0 * (k % 2), 0.5)}), 1000000000);
    EXPECT_FALSE(motion.jumped());
    motion.moveTo(1.0);
    motion.finishStep();
  }
  EXPECT_EQ(motion.begin(1e6, kMaxStep, {Vector3(1e8, 0.0, 0.5)}), 1000000000);
  EXPECT_TRUE(motion.jumped());
}

/// What a joint does on average is not what it does at its fastest.
TEST(InstrumentMotion, CutsByTheFastestPartOfACubic) {
  const std::vector<Instrument> instruments = arm();
  InstrumentMotion motion(instruments);
  const double duration_s = 10.0 * kMaxStep, slide_m = 0.99 * 10.0 * 0.5 * kRadius;
  const Vector3 start(0.0, 0.2, 0.3), target = start + slide_m * Vector3::UnitX();
  motion.place(0, start);
  EXPECT_EQ(motion.begin(duration_s, kMaxStep, {target}), 10);
  const double mean = slide_m / duration_s;
  const JointVelocities velocities{{2.4 * mean * Vector3::UnitX()}, {-0.2 * mean * Vector3::UnitX()}};
  const int steps = motion.begin(duration_s, kMaxStep, {target}, 0, &velocities);
  ASSERT_GE(steps, 20);
  for (int k = 1; k <= steps; ++k) {
    motion.moveTo(static_cast<double>(k) / steps);
    EXPECT_LE(motion.longestTravel(), 0.5 * kRadius) << k;
    motion.finishStep();
  }
  EXPECT_EQ(motion.positions(0), VectorX(target));
}

/// Whoever jumps is there from the first step on, and so are those that have not far to go.
TEST(InstrumentMotion, AJumpLeavesNothingOfTheWay) {
  const std::vector<Instrument> instruments = arm();
  InstrumentMotion motion(instruments);
  const Vector3 start(0.0, 0.2, 0.3), target(1e3, 0.2, 0.3);
  motion.place(0, start);
  const JointVelocities velocities{{1e6 * Vector3::UnitX()}, {1e6 * Vector3::UnitX()}};
  for (const JointVelocities* known : {static_cast<const JointVelocities*>(nullptr), &velocities}) {
    motion.place(0, start);
    ASSERT_EQ(motion.begin(3.0 * kMaxStep, kMaxStep, {target}, 0, known), 3);
    EXPECT_TRUE(motion.jumped());
    for (int k = 1; k <= 3; ++k) {
      motion.moveTo(k / 3.0);
      EXPECT_EQ(motion.positions(0), VectorX(target)) << k;
      motion.finishStep();
    }
  }
}

// Velocities that carry it far beyond both ends.
TEST(InstrumentMotion, CutsACubicThatLeavesItsWay) {
  const std::vector<Instrument> instruments = arm();
  InstrumentMotion motion(instruments);
  const Vector3 start(0.0, 0.2, 0.3), target = start + 1.4 * kRadius * Vector3::UnitX();
  const double fast = 100.0 * 0.5 * kRadius / kMaxStep;
  const JointVelocities velocities{{fast * Vector3::UnitX()}, {-fast * Vector3::UnitX()}};
  motion.place(0, start);
  const int steps = motion.begin(kMaxStep, kMaxStep, {target}, 0, &velocities);
  ASSERT_FALSE(motion.jumped());
  ASSERT_GE(steps, 50);
  for (int k = 1; k <= steps; ++k) {
    motion.moveTo(static_cast<double>(k) / steps);
    EXPECT_LE(motion.longestTravel(), 0.5 * kRadius) << k;
    motion.finishStep();
  }
}

}  // namespace instrument_motion_test
}  // namespace tissue_contact
