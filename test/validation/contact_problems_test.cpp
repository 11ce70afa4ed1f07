/// @file
/// The shared contact problems: files u = W r + q from several sources with reference answers of other solvers.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <filesystem>
#include <fstream>
#include <string>

#include "tissue_contact/solver/delassus.h"

namespace tissue_contact {
namespace {

const std::string kDirectory = std::string(TISSUE_CONTACT_SHARED_DATA) + "/contact_problems/";

struct SharedProblem {
  const char* name;
  bool full_rank;
};

constexpr SharedProblem kProblems[] = {{"one_open", true},
                                       {"one_slip", true},
                                       {"one_stick", true},
                                       {"one_threshold", true},
                                       {"three_solutions", true},
                                       {"bem_sphere_nu045_96", true},
                                       {"LMGC_GlobalFrictionContactProblem00046", true},
                                       {"Box_Stacks-i0122-82-5", false},
                                       {"Capsules-i125-1213", false}};

void PrintTo(const SharedProblem& problem, std::ostream* stream) { *stream << problem.name; }

/// The numbers after the word `name` in a solution file; empty if there is no such file.
VectorX storedVector(const std::string& problem, const std::string& name, Eigen::Index size) {
  std::ifstream file(kDirectory + problem + ".sol.txt");
  std::string line;
  while (std::getline(file, line) && line != name) continue;
  VectorX values(file ? size : 0);
  for (double& value : values) file >> value;
  EXPECT_TRUE(values.size() == 0 || file) << problem << ": " << name << " is cut short";
  return values;
}

class ContactProblems : public ::testing::TestWithParam<SharedProblem> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kDirectory)) GTEST_SKIP() << "no " << kDirectory;
    problem_ = readContactProblem(kDirectory + GetParam().name + ".txt");
  }

  DelassusReport solve(SolverMethod method, double tolerance, DelassusSolution& solution) const {
    SolverDescription description;
    description.method = method;
    description.tolerance = tolerance;
    description.iterations = 10000;
    return solveDelassus(problem_, description, solution);
  }

  /// |u - stored u| / max(|u|, |q|); 0 where no answer is stored.
  double velocityError(const DelassusSolution& solution) const {
    const VectorX stored = storedVector(GetParam().name, "u", problem_.q.size());
    if (stored.size() == 0) return 0.0;
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

INSTANTIATE_TEST_SUITE_P(Shared, ContactProblems, ::testing::ValuesIn(kProblems), [](const auto& tested) {
  std::string name = tested.param.name;
  for (char& c : name) {
    if (c == '-') c = '_';
  }
  return name;
});

TEST(StoredAnswers, AreAcceptedByTheResiduals) {
  if (!std::filesystem::exists(kDirectory)) GTEST_SKIP() << "no " << kDirectory;
  int stored = 0;
  for (const SharedProblem& shared : kProblems) {
    const DelassusProblem problem = readContactProblem(kDirectory + shared.name + ".txt");
    const VectorX r = storedVector(shared.name, "r", problem.q.size());
    if (r.size() == 0) continue;
    ++stored;
    EXPECT_LE(computeResiduals(problem, r).scaled_natural_map, 2e-14) << shared.name;  // files: 5e-18 to 1e-14
    EXPECT_GT(computeResiduals(problem, 1.001 * r).scaled_natural_map, 1e-7) << shared.name;
  }
  EXPECT_EQ(stored, 4);
}

/// mu = 1.5 and a strong coupling of normal and tangential directions: open, slip and stick are all exact.
TEST(ThreeSolutions, EachIsAcceptedAndOneIsFound) {
  if (!std::filesystem::exists(kDirectory)) GTEST_SKIP() << "no " << kDirectory;
  const DelassusProblem problem = readContactProblem(kDirectory + "three_solutions.txt");
  const Vector3 stick = -(Matrix3(problem.W).inverse() * problem.q);
  // Slip: u_n = 0 and r_t = -mu r_n along t1, so r_n = -q_n / (W_nn - mu W_nt).
  const double normal = -problem.q[0] / (problem.W(0, 0) - 1.5 * problem.W(0, 1));
  const Vector3 answers[] = {Vector3::Zero(), stick, Vector3(normal, -1.5 * normal, 0.0)};
  for (const Vector3& answer : answers) EXPECT_LE(computeResiduals(problem, answer).scaled_natural_map, 1e-14);
  for (const SolverMethod method : {SolverMethod::kPredictorCorrector, SolverMethod::kReference}) {
    SolverDescription description;
    description.method = method;
    description.tolerance = 1e-10;
    DelassusSolution solution;
    solveDelassus(problem, description, solution);
    double nearest = 1e300;
    for (const Vector3& answer : answers) nearest = std::min(nearest, (solution.r - answer).norm());
    EXPECT_LE(nearest, 1e-9);
  }
}

}  // namespace
}  // namespace tissue_contact
