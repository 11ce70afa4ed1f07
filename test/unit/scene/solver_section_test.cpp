/// Solver methods and relaxations by name, and the solver section of a scene.
#include "scene_fixture.h"

namespace tissue_contact {
namespace solver_section_test {

constexpr std::pair<const char*, SolverMethod> kMethods[] = {{"predictor_corrector", SolverMethod::kPredictorCorrector},
                                                             {"reference", SolverMethod::kReference},
                                                             {"cone4", SolverMethod::kCone4},
                                                             {"polyhedral", SolverMethod::kPolyhedral},
                                                             {"condensed_lcp", SolverMethod::kCondensedLcp},
                                                             {"impulse", SolverMethod::kImpulse}};
constexpr std::pair<const char*, RelaxationKind> kRelaxations[] = {{"gauss_seidel", RelaxationKind::kGaussSeidel},
                                                                   {"cholesky", RelaxationKind::kCholesky}};

const std::string kScene = std::string(kSmallestScene) + R"(solver:
  method: reference
  relaxation: cholesky
  time_budget_s: 0.0005
  cone_sides: 16
)";

TEST(SolverNames, GoBothWays) {
  for (const auto& [name, method] : kMethods) {
    EXPECT_STREQ(solverMethodName(method), name);
    EXPECT_EQ(solverMethodByName(name), method);
  }
  for (const auto& [name, relaxation] : kRelaxations) {
    EXPECT_STREQ(relaxationName(relaxation), name);
  }
}

TEST(SolverNames, UnknownOnesAreRefusedWithTheKnown) {
  for (const char* name : {"", "Reference", "predictor-corrector", "cholesky"}) {
    const std::string message = refusal([&] { solverMethodByName(name); });
    expectContains(message, {"\"" + std::string(name) + "\""});
    for (const auto& known : kMethods) expectContains(message, {known.first});
  }
  EXPECT_THROW(solverMethodName(static_cast<SolverMethod>(99)), std::invalid_argument);
  EXPECT_THROW(relaxationName(static_cast<RelaxationKind>(-1)), std::invalid_argument);
}

TEST_F(SceneTest, FillsTheSolverSection) {
  const SolverDescription solver = parse(kScene).solver;
  EXPECT_EQ(solver.method, SolverMethod::kReference);
  EXPECT_EQ(solver.relaxation, RelaxationKind::kCholesky);
  EXPECT_EQ(solver.time_budget_s, 0.0005);
  EXPECT_EQ(solver.cone_sides, 16);
  for (const auto& [name, method] : kMethods) {
    EXPECT_EQ(parse(replaced(kScene, "method: reference", std::string("method: ") + name)).solver.method, method);
  }
}

TEST_F(SceneTest, SolvesByThePredictorCorrectorUnlessTold) {
  const SolverDescription solver = parse(kSmallestScene).solver;
  EXPECT_EQ(solver.method, SolverMethod::kPredictorCorrector);
  EXPECT_EQ(solver.relaxation, RelaxationKind::kGaussSeidel);
  EXPECT_EQ(solver.time_budget_s, 0.0);
}

const BadScene kBadSolvers[] = {
    {"method: reference", "method: referense", "10: solver.method", "did you mean \"reference\"? allowed here: pred"},
    {"method: reference", "method: newton", "10: solver.method",
     "allowed here: predictor_corrector, reference, cone4, polyhedral, condensed_lcp, impulse"},
    {"method: reference", "method: [reference]", "10: solver.method", "is a list; it must be text"},
    {"method: reference", "solver: reference", "10: solver.solver", "unknown key"},
    {"relaxation: cholesky", "relaxation: cholesk", "11: solver.relaxation",
     "did you mean \"cholesky\"? allowed here: gauss_seidel, cholesky"},
    {"relaxation: cholesky", "relaxation:", "11: solver.relaxation", "is empty; it must be text"},
    {"time_budget_s: 0.0005", "time_budget_s: -1", "12: solver.time_budget_s", ">= 0 and <= 10 s"},
    {"time_budget_s: 0.0005", "time_budget_s: 11", "12: solver.time_budget_s", "give seconds"},
    {"time_budget_s: 0.0005", "time_budget_s: .nan", "12: solver.time_budget_s", "is \".nan\""},
    {"time_budget_s: 0.0005", "time_budget: 0.1", "12: solver.time_budget", "did you mean \"time_budget_s\"?"},
    {"cone_sides: 16", "cone_sides: 7", "13: solver.cone_sides", "must be even"},
    {"cone_sides: 16", "cone_sides: 2", "13: solver.cone_sides", ">= 4 and <= 64"},
    {"cone_sides: 16", "cone_sides: 66", "13: solver.cone_sides", ">= 4 and <= 64"},
    {"cone_sides: 16", "cone_sides: 8.5", "13: solver.cone_sides", "whole number"},
    {"cone_sides: 16", "cone_sides: nan", "13: solver.cone_sides", "is \"nan\""},
};

TEST_F(SceneTest, RefusesBadSolversWithTheirPlace) { expectAllRefused(kScene, kBadSolvers); }

}  // namespace solver_section_test
}  // namespace tissue_contact
