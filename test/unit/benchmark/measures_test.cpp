/// Errors, times and Pareto fronts of runs whose answers are known.
#include "benchmark/measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace tissue_contact {
namespace measures_test {

using RunRecord = Run;  // Run alone is a member of testing::Test

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Wrench wrench(const Vector3& force, const Vector3& torque = Vector3::Zero()) {
  Wrench result;
  result.force = force;
  result.torque = torque;
  return result;
}

Run runOf(const std::vector<std::vector<Wrench>>& wrenches) {
  Run run;
  run.wrenches = wrenches;
  for (std::size_t k = 0; k < wrenches.size(); ++k) run.times_s.push_back(0.01 * static_cast<double>(k));
  return run;
}

TEST(WrenchErrorTest, IsTheRmsOfTheDifferenceOverTheRmsOfTheReference) {
  const RunRecord reference = runOf({{wrench({3, 0, 0})}, {wrench({0, 4, 0})}});
  const RunRecord run = runOf({{wrench({3, 0, 1})}, {wrench({0, 4, 2})}});
  const WrenchError error = wrenchError(run, reference);
  EXPECT_DOUBLE_EQ(error.relative, std::sqrt(5.0 / 25.0));
  EXPECT_DOUBLE_EQ(error.newtons, std::sqrt(5.0 / 2.0));
  EXPECT_DOUBLE_EQ(error.reference_n, std::sqrt(25.0 / 2.0));
}

TEST(WrenchErrorTest, MomentsCountOverTheReferencesLever) {
  RunRecord reference = runOf({{wrench({1, 0, 0}, {0, 0.01, 0})}});
  const RunRecord run = runOf({{wrench({1, 0, 0}, {0, 0.02, 0})}});
  EXPECT_EQ(wrenchError(run, reference).relative, 0.0);  // no lever: forces alone
  reference.lever_m = 0.01;
  EXPECT_DOUBLE_EQ(wrenchError(run, reference).relative, std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(wrenchError(run, reference).newton_metres, 0.01);
}

TEST(WrenchErrorTest, TellsInstrumentsApart) {
  const RunRecord reference = runOf({{wrench({1, 0, 0}), wrench({2, 0, 0})}});
  const RunRecord run = runOf({{wrench({1, 0, 0}), wrench({2.2, 0, 0})}});
  EXPECT_EQ(wrenchError(run, reference, 0).relative, 0.0);
  EXPECT_NEAR(wrenchError(run, reference, 1).relative, 0.1, 1e-12);
}

TEST(WrenchErrorTest, ComparesTheSamplesBothRunsHave) {
  const RunRecord reference = runOf({{wrench({1, 0, 0})}});
  const RunRecord run = runOf({{wrench({1.5, 0, 0})}, {wrench({9, 0, 0})}});
  EXPECT_DOUBLE_EQ(wrenchError(run, reference).relative, 0.5);
}

TEST(WrenchErrorTest, WithoutContactThereIsNoRelativeError) {
  const RunRecord nothing = runOf({{wrench({0, 0, 0})}});
  EXPECT_TRUE(std::isnan(wrenchError(nothing, nothing).relative));
  EXPECT_EQ(wrenchError(nothing, nothing).reference_n, 0.0);
}

TEST(WrenchErrorTest, RefusesRunsSampledAtDifferentTimes) {
  const RunRecord reference = runOf({{wrench({1, 0, 0})}});
  RunRecord run = reference;
  run.times_s[0] += 1e-9;
  EXPECT_THROW(wrenchError(run, reference), std::invalid_argument);
  run.times_s[0] = kNan;
  EXPECT_THROW(wrenchError(run, reference), std::invalid_argument);
  EXPECT_THROW(wrenchError(runOf({{}}), reference), std::invalid_argument);
}

TEST(StepTimesTest, MedianP99AndMaximum) {
  std::vector<double> times;
  for (int k = 200; k >= 1; --k) times.push_back(k);
  const StepTimes of = stepTimes(times);
  EXPECT_EQ(of.median, 101.0);
  EXPECT_EQ(of.p99, 199.0);
  EXPECT_EQ(of.max, 200.0);
  EXPECT_EQ(stepTimes({}).max, 0.0);
}

TEST(ParetoFrontTest, KeepsWhatNothingBeats) {
  //                                  0    1    2    3    4     5
  const std::vector<double> times = {1.0, 2.0, 2.0, 3.0, 4.0, 0.5};
  const std::vector<double> errors = {0.5, 0.4, 0.3, 0.3, 0.1, kNan};
  EXPECT_EQ(paretoFront(times, errors), (std::vector<std::size_t>{0, 2, 4}));
  EXPECT_TRUE(paretoFront({}, {}).empty());
}

TEST(ParetoFrontTest, APointIsOffItWhenAnotherIsFasterBeyondNoiseWithNoMoreError) {
  const std::vector<double> times = {1.0, 2.0};
  const std::vector<double> errors = {0.2, 0.1};
  EXPECT_TRUE(onFront(2.0, 0.1, times, errors, 0.1));
  EXPECT_FALSE(onFront(2.0, 0.2, times, errors, 0.1));
  EXPECT_TRUE(onFront(1.05, 0.3, times, errors, 0.1));  // within noise
  EXPECT_FALSE(onFront(kNan, 0.3, times, errors, 0.1));
  EXPECT_FALSE(onFront(0.1, kNan, times, errors, 0.1));
}

TEST(RichardsonTest, FindsTheErrorOfThePowerLawItAssumes) {
  // Errors 3 h^2 at h = 2 and 1: difference 9, left 3.
  EXPECT_DOUBLE_EQ(richardsonError(9.0, 2.0, 2.0), 3.0);
  EXPECT_THROW(richardsonError(1.0, 1.0, 1.0), std::invalid_argument);
  EXPECT_THROW(richardsonError(1.0, 2.0, kNan), std::invalid_argument);
}

}  // namespace measures_test
}  // namespace tissue_contact
