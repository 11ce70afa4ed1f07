/// @file
/// The deadline a live caller sets for the solver: by the caller's clock, one iteration at least, no trace when unused.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include "support/text_scene.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {
namespace solver_deadline_test {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// A 5 mm ball 0.2 mm above a block; the clock shows a second more each time it is asked.
class SolverDeadline : public testing::Test {
 protected:
  Simulator makeScene(const std::string& solver, bool with_clock = true) {
    std::function<double()> clock;
    if (with_clock) clock = [this] { return now_s_ += 1.0; };
    return makeSimulator(blockScene() + "instruments:\n" + probeEntry("probe", "/probe", "[0, 0, 0.0252]") +
                             "friction: [{instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}]\n"
                             "step: {max_step_s: 0.01}\nadvisor: {sleep: never}\n"
                             "solver: {iterations: 100, tolerance: 1.0e-14, " +
                             solver + "}\n",
                         {}, clock);
  }

  /// 0.7 mm deep: in one step, since a step may be as long as half the radius of the probe's stem, 1 mm.
  static void press(Simulator& simulator) { simulator.advance(0.01, {Vector3(0, 0, -0.0009)}); }

  double now_s_ = 0.0;
};

TEST_F(SolverDeadline, StopsTheIterations) {
  for (const char* method : {"method: predictor_corrector", "method: impulse"}) {
    now_s_ = 0.0;
    Simulator simulator = makeScene(method);
    simulator.setSolverDeadline(5.0);
    press(simulator);
    EXPECT_EQ(simulator.report().iterations, 5) << method;  // the clock is asked after each
    EXPECT_EQ(simulator.report().stop, StopReason::kTimeBudget) << method;
    press(simulator);  // the deadline is over
    EXPECT_EQ(simulator.report().iterations, 1) << method;
    simulator.setSolverDeadline(kNever);
    press(simulator);
    EXPECT_GT(simulator.report().iterations, 5) << method;
    EXPECT_NE(simulator.report().stop, StopReason::kTimeBudget) << method;
  }
}

TEST_F(SolverDeadline, ThePromptOneLeavesTenIterations) {
  for (const char* method : {"method: predictor_corrector", "method: impulse"}) {
    now_s_ = 0.0;
    Simulator simulator = makeScene(method);
    simulator.setSolverDeadline(kNever, 1.0);
    press(simulator);
    EXPECT_EQ(simulator.report().iterations, 10) << method;
    EXPECT_EQ(simulator.report().stop, StopReason::kTimeBudget) << method;
    now_s_ = 0.0;
    simulator.setSolverDeadline(5.0, 1.0);  // the other does not wait for them
    press(simulator);
    EXPECT_EQ(simulator.report().iterations, 5) << method;
  }
}

TEST_F(SolverDeadline, TheEarlierOfItAndTheTimeBudgetCounts) {
  Simulator simulator = makeScene("time_budget_s: 3");
  simulator.setSolverDeadline(1000.0);
  press(simulator);
  EXPECT_EQ(simulator.report().iterations, 3);
  now_s_ = 0.0;
  simulator.setSolverDeadline(3.0);  // the clock is asked once more for the budget
  press(simulator);
  EXPECT_EQ(simulator.report().iterations, 2);
}

TEST_F(SolverDeadline, UnusedItAsksNoClockAndChangesNothing) {
  Simulator plain = makeScene("method: predictor_corrector", false);
  Simulator timed = makeScene("method: predictor_corrector");
  timed.setSolverDeadline(kNever);
  press(plain);
  press(timed);
  EXPECT_EQ(now_s_, 0.0);
  EXPECT_EQ(plain.wrench(0).force, timed.wrench(0).force);
  timed.setSolverDeadline(1e9);  // far away
  press(plain);
  press(timed);
  EXPECT_EQ(plain.wrench(0).force, timed.wrench(0).force);
}

TEST_F(SolverDeadline, MethodsWithoutABudgetTakeNoNotice) {
  Simulator simulator = makeScene("method: reference");
  simulator.setSolverDeadline(0.0);
  press(simulator);
  EXPECT_NE(simulator.report().stop, StopReason::kTimeBudget);
}

TEST_F(SolverDeadline, WantsAClockAndANumber) {
  Simulator without_clock = makeScene("method: predictor_corrector", false);
  EXPECT_THROW(without_clock.setSolverDeadline(1.0), std::invalid_argument);
  EXPECT_THROW(without_clock.setSolverDeadline(kNever, 1.0), std::invalid_argument);
  without_clock.setSolverDeadline(kNever);
  Simulator simulator = makeScene("method: predictor_corrector");
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(simulator.setSolverDeadline(kNan), std::invalid_argument);
  EXPECT_THROW(simulator.setSolverDeadline(kNever, kNan), std::invalid_argument);
}

}  // namespace solver_deadline_test
}  // namespace tissue_contact
