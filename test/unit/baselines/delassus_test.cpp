/// @file
/// Residuals and solvers of Delassus problems on cases small enough to know the answer.
#include "tissue_contact/baselines/delassus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "baselines/natural_map.h"
#include "support/random_contact_problem.h"
#include "tissue_contact/friction/friction_law.h"

namespace tissue_contact {
namespace delassus_test {

constexpr SolverMethod kAllMethods[] = {SolverMethod::kPredictorCorrector, SolverMethod::kReference,
                                        SolverMethod::kCone4, SolverMethod::kPolyhedral, SolverMethod::kCondensedLcp};

DelassusProblem oneContact(const Vector3& q, double mu_static, double mu_kinetic) {
  DelassusProblem problem;
  problem.W = 0.5 * Matrix3::Identity();
  problem.q = q;
  problem.laws = {{mu_static, mu_kinetic}};
  problem.was_sliding = {false};
  return problem;
}

TEST(ConeProjection, IsTheNearestPoint) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 500; ++trial) {
    const double mu = std::abs(normal(random));
    const Vector3 x(normal(random), normal(random), normal(random));
    const Vector3 p = projectOntoCone(x, mu);
    EXPECT_LE(p.tail<2>().norm(), mu * p[0] + 1e-15);
    EXPECT_LE((projectOntoCone(p, mu) - p).norm(), 1e-15);
    EXPECT_NEAR((x - p).dot(p), 0.0, 1e-14);  // Moreau: the rest is orthogonal ...
    for (int k = 0; k < 16; ++k) {            // ... and in the polar cone
      EXPECT_LE((x - p).dot(Vector3(1.0, mu * std::cos(k), mu * std::sin(k))), 1e-14);
    }
  }
}

TEST(ConeProjection, DerivativeIsThatOfTheProjection) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 300; ++trial) {
    const double mu = 0.1 + std::abs(normal(random));
    const Vector3 x(normal(random), normal(random), normal(random));
    const double size = x.tail<2>().norm();
    if (std::abs(mu * size + x[0]) < 1e-3 || std::abs(size - mu * x[0]) < 1e-3) continue;  // kinks
    const Matrix3 derivative = coneProjectionDerivative(x, mu);
    for (int k = 0; k < 3; ++k) {
      const Vector3 h = 1e-6 * Vector3::Unit(k);
      const Vector3 difference = (projectOntoCone(x + h, mu) - projectOntoCone(x - h, mu)) / 2e-6;
      EXPECT_LE((derivative.col(k) - difference).norm(), 1e-4);
    }
  }
}

TEST(DelassusResiduals, AreZeroAtTheClosedForms) {  // validation, A
  for (const auto& [q, r] : {std::pair(Vector3(-1.0, 0.2, 0.1), Vector3(2.0, -0.4, -0.2)),
                             std::pair(Vector3(-1.0, 1.2, 1.6), Vector3(2.0, -0.6, -0.8))}) {
    const DelassusResiduals residuals = computeResiduals(oneContact(q, 0.5, 0.5), r);
    EXPECT_LE(residuals.scaled_natural_map, 1e-15);
    EXPECT_LE(residuals.penetration_m_per_s, 1e-15);
    EXPECT_EQ(residuals.adhesion_n_s, 0.0);
    EXPECT_LE(residuals.cone_violation_n_s, 1e-15);
    EXPECT_LE(residuals.dissipation_defect_j, 1e-14);
    EXPECT_LE(residuals.kinetic_angle_rad, 1e-14);
    EXPECT_LE(residuals.friction_power_j, 1e-15);
  }
}

TEST(DelassusResiduals, EachNamesItsOwnError) {
  const DelassusProblem sliding = oneContact(Vector3(-1.0, 1.2, 1.6), 0.5, 0.5);
  const auto with = [&](const Vector3& r) { return computeResiduals(sliding, r); };
  EXPECT_NEAR(with({1.0, -0.3, -0.4}).penetration_m_per_s, 0.5, 1e-15);
  EXPECT_NEAR(with({-0.1, 0.0, 0.0}).adhesion_n_s, 0.1, 1e-15);
  EXPECT_NEAR(with({4.0, 0.0, 0.0}).complementarity_j, 4.0, 1e-15);
  EXPECT_NEAR(with({2.0, -0.9, -1.2}).cone_violation_n_s, 0.5, 1e-15);
  EXPECT_NEAR(with({2.0, 0.6, 0.8}).kinetic_angle_rad, M_PI, 1e-12);
  EXPECT_GT(with({2.0, 0.6, 0.8}).friction_power_j, 0.0);
  EXPECT_NEAR(with({2.0, 0.0, 0.0}).dissipation_defect_j, 2.0, 1e-12);  // mu r_n |u_t| is missing
  EXPECT_NEAR(with({2.0, -0.3, -0.4}).static_slip_m_per_s, 1.75, 1e-12);
  for (const Vector3& wrong : {Vector3(1.0, -0.3, -0.4), Vector3(2.0, 0.6, 0.8), Vector3(2.0, -0.9, -1.2)}) {
    EXPECT_GT(with(wrong).scaled_natural_map, 0.05);
  }
  EXPECT_TRUE(std::isnan(with({std::nan(""), 0.0, 0.0}).scaled_natural_map));
}

TEST(DelassusResiduals, DoNotDependOnUnits) {
  const DelassusProblem problem = randomContactProblem(5, 0.7, 3);
  VectorX r = VectorX::Random(15);
  const double map = computeResiduals(problem, r).scaled_natural_map;
  DelassusProblem other = problem;
  other.q *= 1e3;
  other.W *= 1e9;
  r *= 1e-6;
  EXPECT_NEAR(computeResiduals(other, r).scaled_natural_map, map, 1e-12 * map);
}

TEST(DelassusResiduals, TwoCoefficientsAllowBothBranchesAndNothingBetween) {
  const DelassusProblem problem = oneContact(Vector3(-1.0, 0.4, 0.0), 0.5, 0.3);
  const auto map = [&](const DelassusProblem& p, const Vector3& r) {
    return computeResiduals(p, r).scaled_natural_map;
  };
  EXPECT_LE(map(problem, {2.0, -0.8, 0.0}), 1e-15);  // held
  EXPECT_LE(map(problem, {2.0, -0.6, 0.0}), 1e-15);  // sliding
  EXPECT_GT(map(problem, {2.0, -0.7, 0.0}), 0.02);
  DelassusProblem slid = problem;
  slid.was_sliding = {true};
  EXPECT_GT(map(slid, {2.0, -0.8, 0.0}), 0.02);
  // Sliding at the static limit is no answer.
  EXPECT_GT(map(oneContact(Vector3(-1.0, 2.0, 0.0), 0.5, 0.3), {2.0, -1.0, 0.0}), 0.05);
}

TEST(SolveDelassus, FrictionlessProblemsAreTheSameForAll) {
  const DelassusProblem problem = randomContactProblem(12, 0.0, 4);
  DelassusSolution reference;
  ASSERT_TRUE(solveDelassus(problem, solver(SolverMethod::kReference), reference).converged);
  for (const SolverMethod method : kAllMethods) {
    DelassusSolution solution;
    EXPECT_TRUE(solveDelassus(problem, solver(method, 1e-9), solution).converged) << solverMethodName(method);
    EXPECT_LE((solution.r - reference.r).norm(), 1e-8 * reference.r.norm()) << solverMethodName(method);
  }
}

TEST(SolveDelassus, PolyhedralIterationAndCondensationAgree) {
  const DelassusProblem problem = randomContactProblem(10, 0.4, 5);
  SolverDescription description = solver(SolverMethod::kPolyhedral, 1e-11);
  description.cone_sides = 6;
  DelassusSolution iterated;
  solveDelassus(problem, description, iterated);
  description.method = SolverMethod::kCondensedLcp;
  DelassusSolution condensed;
  solveDelassus(problem, description, condensed);
  EXPECT_GT(iterated.r.norm(), 0.1);
  EXPECT_LE((iterated.r - condensed.r).norm(), 1e-8 * iterated.r.norm());
  EXPECT_EQ(iterated.states, condensed.states);
}

TEST(SolveDelassus, HysteresisIsConsistent) {
  int released = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    DelassusProblem problem = randomContactProblem(8, 0.5, seed);
    for (CoulombLaw& law : problem.laws) law.mu_kinetic = 0.3;
    for (int c = 0; c < 8; c += 2) problem.was_sliding[c] = true;
    for (const SolverMethod method : {SolverMethod::kPredictorCorrector, SolverMethod::kReference}) {
      DelassusSolution solution;
      const DelassusReport report = solveDelassus(problem, solver(method), solution);
      ASSERT_TRUE(report.converged) << seed << ' ' << solverMethodName(method);
      for (int c = 0; c < 8; ++c) {
        const Vector3 r = solution.r.segment<3>(3 * c);
        const double limit = problem.was_sliding[c] ? 0.3 : 0.5;
        const double speed = solution.u.segment<2>(3 * c + 1).norm();
        if (solution.states[c] == ContactState::kStatic) {
          EXPECT_LE(r.tail<2>().norm(), limit * r[0] + 1e-9);
          EXPECT_LE(speed, 1e-8);
        } else if (solution.states[c] == ContactState::kKinetic) {
          EXPECT_NEAR(r.tail<2>().norm(), 0.3 * r[0], 1e-8);
          released += problem.was_sliding[c] ? 0 : 1;
        }
      }
    }
  }
  EXPECT_GT(released, 20);
}

class DirectionalLaws : public ::testing::TestWithParam<FrictionLawDescription::Kind> {};

INSTANTIATE_TEST_SUITE_P(SolveDelassus, DirectionalLaws,
                         ::testing::Values(FrictionLawDescription::Kind::kOrthotropic,
                                           FrictionLawDescription::Kind::kAsymmetric));

TEST_P(DirectionalLaws, AreSolvedAndJudgedAlike) {
  FrictionLawDescription description;
  description.kind = GetParam();
  description.static_coefficients = description.kinetic_coefficients = {0.6, 0.2};
  if (GetParam() == FrictionLawDescription::Kind::kAsymmetric) {
    description.static_coefficients = description.kinetic_coefficients = {0.2, 0.6, 0.4};
  }
  const auto law = makeAnisotropicFriction(description);
  DelassusProblem problem = randomContactProblem(6, 0.0, 7);
  for (CoulombLaw& contact : problem.laws) {
    contact.anisotropic = law.get();
    contact.axis = Vector2(0.6, 0.8);
  }
  for (const SolverMethod method : {SolverMethod::kPredictorCorrector, SolverMethod::kReference}) {
    DelassusSolution solution;
    const DelassusReport report = solveDelassus(problem, solver(method), solution);
    EXPECT_TRUE(report.converged);
    EXPECT_LE(report.residuals.cone_violation_n_s, 1e-8);
    EXPECT_LE(report.residuals.kinetic_angle_rad, 1e-6);
    EXPECT_LE(report.residuals.friction_power_j, 0.0);
  }
}

TEST(SolveDelassus, WarmStartAtTheAnswerNeedsOneIteration) {
  const DelassusProblem problem = randomContactProblem(20, 0.5, 8);
  DelassusSolution solution;
  ASSERT_TRUE(solveDelassus(problem, solver(SolverMethod::kReference), solution).converged);
  EXPECT_EQ(solveDelassus(problem, solver(SolverMethod::kPredictorCorrector, 1e-9), solution).iterations, 1);
}

TEST(SolveDelassus, IterationLimitIsAStatus) {
  DelassusSolution solution;
  const DelassusReport report =
      solveDelassus(randomContactProblem(20, 0.5, 9), solver(SolverMethod::kPredictorCorrector, 1e-12, 2), solution);
  EXPECT_FALSE(report.converged);
  EXPECT_EQ(report.iterations, 2);
  EXPECT_GT(report.residuals.scaled_natural_map, 1e-12);
}

TEST(SolveDelassus, ContactsThatCannotMoveStayOpen) {
  DelassusProblem problem = randomContactProblem(3, 0.5, 10);
  problem.W.middleRows<3>(3).setZero();
  problem.W.middleCols<3>(3).setZero();
  problem.q.segment<3>(3).setZero();
  for (const SolverMethod method : {SolverMethod::kPredictorCorrector, SolverMethod::kReference}) {
    DelassusSolution solution;
    EXPECT_TRUE(solveDelassus(problem, solver(method), solution).converged);
    EXPECT_EQ(solution.r.segment<3>(3), Vector3::Zero());
    EXPECT_EQ(solution.states[1], ContactState::kOpen);
  }
}

TEST(SolveDelassus, NoContacts) {
  DelassusProblem problem;
  for (const SolverMethod method : kAllMethods) {
    DelassusSolution solution;
    EXPECT_TRUE(solveDelassus(problem, solver(method), solution).converged) << solverMethodName(method);
  }
}

TEST(SolveDelassus, NumbersThatOverflowGiveNoAnswerAndNoNan) {
  DelassusProblem problem = oneContact({-1e100, 1e99, 0.0}, 0.5, 0.5);
  problem.W *= 1e-300;
  for (const SolverMethod method : kAllMethods) {
    DelassusSolution solution;
    const DelassusReport report = solveDelassus(problem, solver(method), solution);
    EXPECT_FALSE(report.converged) << solverMethodName(method);
    EXPECT_EQ(solution.r, VectorX::Zero(3)) << solverMethodName(method);
    EXPECT_EQ(solution.u, problem.q) << solverMethodName(method);
  }
}

// A file that fuzzing made: q has an entry of 1e308, W is not symmetric.
TEST(SolveDelassus, OverflowOnTheWayIsToldAndIsNoNan) {
  const DelassusProblem problem =
      readContactProblem(TISSUE_CONTACT_SOURCE_DIR "/fuzz/corpus/contact_problem/b28615be0222");
  bool any = false;
  for (const SolverMethod method : kAllMethods) {
    DelassusSolution solution;
    const DelassusReport report = solveDelassus(problem, solver(method, 1e-8, 20), solution);
    EXPECT_FALSE(report.converged) << solverMethodName(method);
    EXPECT_TRUE(solution.r.allFinite() && solution.u.allFinite()) << solverMethodName(method);
    if (!report.overflowed) continue;
    any = true;
    EXPECT_EQ(solution.states, std::vector<ContactState>(3, ContactState::kOpen)) << solverMethodName(method);
  }
  EXPECT_TRUE(any);
}

TEST(SolveDelassus, VelocitiesWhoseSquaresOverflowMeetNoTolerance) {
  for (const SolverMethod method : kAllMethods) {
    DelassusSolution solution;
    EXPECT_FALSE(solveDelassus(oneContact({-1e155, 0.0, 1e308}, 0.5, 0.5), solver(method), solution).converged)
        << solverMethodName(method);
    EXPECT_TRUE(solution.r.allFinite()) << solverMethodName(method);
  }
}

TEST(SolveDelassus, RefusesBadInput) {
  const DelassusProblem good = oneContact({-1.0, 0.0, 0.0}, 0.5, 0.5);
  DelassusSolution solution;
  const auto refused = [&](const DelassusProblem& problem, const SolverDescription& description) {
    EXPECT_THROW(solveDelassus(problem, description, solution), std::invalid_argument);
  };
  refused(good, solver(SolverMethod::kImpulse));
  refused(good, solver(SolverMethod::kReference, std::nan("")));
  refused(good, solver(SolverMethod::kReference, 1e-8, 0));
  SolverDescription odd = solver(SolverMethod::kPolyhedral);
  odd.cone_sides = 5;
  refused(good, odd);
  const SolverDescription fine = solver(SolverMethod::kPredictorCorrector);
  DelassusProblem bad = good;
  bad.W(1, 1) = std::nan("");
  refused(bad, fine);
  bad = good;
  bad.q[2] = std::numeric_limits<double>::infinity();
  refused(bad, fine);
  bad = good;
  bad.q.resize(4);
  refused(bad, fine);
  bad = good;
  bad.was_sliding.clear();
  refused(bad, fine);
  bad = good;
  bad.W.resize(3, 2);
  refused(bad, fine);
  FrictionLawDescription orthotropic;
  orthotropic.kind = FrictionLawDescription::Kind::kOrthotropic;
  orthotropic.static_coefficients = orthotropic.kinetic_coefficients = {0.6, 0.2};
  const auto law = makeAnisotropicFriction(orthotropic);
  bad = good;
  bad.laws[0].anisotropic = law.get();
  refused(bad, solver(SolverMethod::kCone4));
  refused(bad, solver(SolverMethod::kCondensedLcp));
}

}  // namespace delassus_test
}  // namespace tissue_contact
