/// @file
/// Contact problems u = W r + q in files with answers made by others: ours, and published ones where they are at hand.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/random_contact_problem.h"

namespace tissue_contact {
namespace {

struct KnownProblem {
  const char* name;
  bool full_rank;
};

constexpr KnownProblem kOwn[] = {{"one_open", true},      {"one_slip", true},        {"one_stick", true},
                                 {"one_threshold", true}, {"pressed_sphere", false}, {"not_symmetric", true},
                                 {"three_blocks", false}};

constexpr KnownProblem kPublished[] = {{"bem_sphere_nu045_96", true},
                                       {"LMGC_GlobalFrictionContactProblem00046", true},
                                       {"Box_Stacks-i0122-82-5", false},
                                       {"Capsules-i125-1213", false}};

void PrintTo(const KnownProblem& problem, std::ostream* stream) { *stream << problem.name; }

/// Without ending: among ours, or else among the published ones.
std::string pathOf(const std::string& problem) {
  const std::string own = TISSUE_CONTACT_SOURCE_DIR "/test/data/contact_problems/" + problem;
  return std::filesystem::exists(own + ".txt") ? own : TISSUE_CONTACT_SHARED_DATA "/contact_problems/" + problem;
}

/// The numbers after the word `name` in a solution file.
VectorX storedVector(const std::string& problem, const std::string& name, Eigen::Index size) {
  std::ifstream file(pathOf(problem) + ".sol.txt");
  std::string line;
  while (std::getline(file, line) && line != name) continue;
  VectorX values(size);
  for (Eigen::Index i = 0; i < size; ++i) file >> values[i];
  EXPECT_TRUE(file) << problem << ": no answer, or " << name << " is cut short";
  return values;
}

class ContactProblems : public ::testing::TestWithParam<KnownProblem> {
 protected:
  void SetUp() override {
    const std::string file = pathOf(GetParam().name) + ".txt";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
    problem_ = readContactProblem(file);
  }

  DelassusReport solve(SolverMethod method, double tolerance, DelassusSolution& solution) const {
    return solveDelassus(problem_, solver(method, tolerance, 10000), solution);
  }

  /// |u - stored u| / max(|u|, |q|).
  double velocityError(const DelassusSolution& solution) const {
    const VectorX stored = storedVector(GetParam().name, "u", problem_.q.size());
    return (solution.u - stored).norm() / std::max(stored.norm(), problem_.q.norm());
  }

  DelassusProblem problem_;
};

TEST_P(ContactProblems, ReferenceReaches1em10) {
  DelassusSolution solution;
  const DelassusReport report = solve(SolverMethod::kReference, 1e-10, solution);
  EXPECT_TRUE(report.converged);
  EXPECT_LE(report.residuals.scaled_natural_map, 1e-10);
  EXPECT_LE(velocityError(solution), GetParam().full_rank ? 1e-9 : 1e-6);
}

TEST_P(ContactProblems, PredictorCorrectorReaches1em8) {
  DelassusSolution solution;
  const DelassusReport report = solve(SolverMethod::kPredictorCorrector, 1e-8, solution);
  RecordProperty("iterations", report.iterations);
  EXPECT_LE(report.residuals.scaled_natural_map, 1e-8);  // the rank-deficient ones too
  EXPECT_LE(velocityError(solution), 1e-6);
  EXPECT_LE(report.residuals.friction_power_j, 1e-15);
}

TEST_P(ContactProblems, StoredAnswerIsAcceptedByTheResiduals) {
  const VectorX r = storedVector(GetParam().name, "r", problem_.q.size());
  EXPECT_LE(computeResiduals(problem_, r).scaled_natural_map, 2e-14);  // files: 0 to 1e-14
  if (r.isZero()) return;
  EXPECT_GT(computeResiduals(problem_, 1.001 * r).scaled_natural_map, 1e-7);
}

std::string nameOf(const testing::TestParamInfo<KnownProblem>& tested) {
  std::string name = tested.param.name;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Own, ContactProblems, ::testing::ValuesIn(kOwn), nameOf);
INSTANTIATE_TEST_SUITE_P(Published, ContactProblems, ::testing::ValuesIn(kPublished), nameOf);

/// A large mu and a strong coupling of normal and tangential directions: open, slip and stick are all exact.
TEST(ThreeAnswers, EachIsAcceptedAndOneIsFound) {
  const DelassusProblem problem = readContactProblem(pathOf("three_answers") + ".txt");
  const double mu = problem.laws[0].mu_kinetic;
  const Vector3 stick = -(Matrix3(problem.W).inverse() * problem.q);
  // Slip: u_n = 0 and r_t = -mu r_n along t1, so r_n = -q_n / (W_nn - mu W_nt).
  const double normal = -problem.q[0] / (problem.W(0, 0) - mu * problem.W(0, 1));
  const Vector3 answers[] = {Vector3::Zero(), stick, Vector3(normal, -mu * normal, 0.0)};
  for (const Vector3& answer : answers) EXPECT_LE(computeResiduals(problem, answer).scaled_natural_map, 1e-14);
  for (const SolverMethod method : {SolverMethod::kPredictorCorrector, SolverMethod::kReference}) {
    DelassusSolution solution;
    solveDelassus(problem, solver(method), solution);
    double nearest = 1e300;
    for (const Vector3& answer : answers) nearest = std::min(nearest, (solution.r - answer).norm());
    EXPECT_LE(nearest, 1e-9);
  }
}

}  // namespace
}  // namespace tissue_contact
