/// @file
/// Measures the Delassus solvers against each other; benchmark/drivers/solvers.py runs it and writes doc/solvers.md.
///   random_problems table [--most N]   random problems, at most N (1000) of each size; a Markdown table on stdout
///   random_problems cone               friction of one contact over the angle of sliding or load; CSV on stdout
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>
#include <vector>

#include "baselines/rival_contact.h"
#include "support/random_contact_problem.h"
#include "tissue_contact/core/command_line.h"

namespace tissue_contact {
namespace {

constexpr double kTolerance = 1e-8;
constexpr int kSizes[] = {1, 3, 10, 30, 100, 200};

struct Competitor {
  SolverMethod method;
  int iterations;
  int most_problems[std::size(kSizes)];  ///< per size: a second or more per problem is not tried a thousand times
};

constexpr Competitor kCompetitors[] = {{SolverMethod::kPredictorCorrector, 1000, {1000, 1000, 1000, 1000, 1000, 1000}},
                                       {SolverMethod::kReference, 30, {1000, 1000, 1000, 1000, 1000, 1000}},
                                       {SolverMethod::kCone4, 1000, {1000, 1000, 1000, 1000, 1000, 1000}},
                                       {SolverMethod::kPolyhedral, 1000, {1000, 1000, 1000, 1000, 1000, 1000}},
                                       {SolverMethod::kCondensedLcp, 30, {1000, 1000, 1000, 1000, 100, 10}}};

struct Tally {
  int problems = 0;
  int exact = 0;  ///< answers of the true cone
  int own = 0;    ///< answers of the solver's own cone: no penetration, no work of the normal impulses, settled
  std::vector<double> iterations, milliseconds, errors;
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// @param answer the exact impulses, or empty where nobody found them.
void addTo(Tally& tally, const Competitor& competitor, const DelassusProblem& problem, VectorX& answer) {
  SolverDescription description;
  description.method = competitor.method;
  description.iterations = competitor.iterations;
  description.tolerance = kTolerance;
  DelassusSolution solution;
  const auto start = std::chrono::steady_clock::now();
  const DelassusReport report = solveDelassus(problem, description, solution);
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
  const double scale = problem.q.norm();
  const bool sweeps = competitor.iterations == 1000;
  const bool settled = !sweeps || report.converged || report.iterations < competitor.iterations;
  ++tally.problems;
  tally.exact += report.converged ? 1 : 0;
  tally.own += settled && report.residuals.penetration_m_per_s <= 1e-6 * scale &&
                       report.residuals.complementarity_j <= 1e-6 * scale * solution.r.norm()
                   ? 1
                   : 0;
  tally.iterations.push_back(report.iterations);
  tally.milliseconds.push_back(spent.count());
  if (report.converged && answer.size() == 0) answer = solution.r;
  if (answer.norm() > 0.0) tally.errors.push_back((solution.r - answer).norm() / answer.norm());
}

void printRow(int contacts, const Competitor& competitor, const Tally& tally) {
  const auto percent = [&tally](int count) { return 100.0 * count / tally.problems; };
  std::printf("| %d | %s | %d | %.1f | %.1f | %.0f / %.0f | %.3g | %.2g |\n", contacts,
              solverMethodName(competitor.method), tally.problems, percent(tally.exact), percent(tally.own),
              quantile(tally.iterations, 0.5), quantile(tally.iterations, 0.99), quantile(tally.milliseconds, 0.5),
              100.0 * quantile(tally.errors, 0.5));
  std::fflush(stdout);
}

void printTable(int most) {
  std::printf(
      "| contacts | solver | problems | exact, %% | own cone, %% | iterations, median / 99 %% | median time, ms "
      "| median error of r, %% |\n|---|---|---|---|---|---|---|---|\n");
  for (std::size_t size = 0; size < std::size(kSizes); ++size) {
    Tally tallies[std::size(kCompetitors)];
    for (int k = 0; k < most; ++k) {
      const unsigned seed = static_cast<unsigned>(k);
      std::mt19937 random(seed + 77777);
      const double mu = std::uniform_real_distribution<double>(0.0, 1.5)(random);
      const DelassusProblem problem = randomContactProblem(kSizes[size], mu, seed);
      VectorX answer;  // of the first that is exact: the predictor-corrector, or else the reference
      for (std::size_t i = 0; i < std::size(kCompetitors); ++i) {
        if (k < kCompetitors[i].most_problems[size]) addTo(tallies[i], kCompetitors[i], problem, answer);
      }
    }
    for (std::size_t i = 0; i < std::size(kCompetitors); ++i) printRow(kSizes[size], kCompetitors[i], tallies[i]);
  }
}

/// A way to solve one contact; the axes of the compacted cone follow the last sliding velocity it is told.
using Solve = ContactAnswer (*)(const Vector3& q, const CoulombLaw& law, const Vector2& previous);

struct Cone {
  const char* name;
  Solve solve;
  bool follows;  ///< aligned with the sliding velocity of the step before, 5 degrees earlier
};

const Cone kCones[] = {{"fixed4",
                        [](const Vector3& q, const CoulombLaw& law, const Vector2&) {
                          return solveCone4Contact(Matrix3::Identity(), q, law, false, Vector2::Zero());
                        },
                        false},
                       {"fixed8",
                        [](const Vector3& q, const CoulombLaw& law, const Vector2&) {
                          return solvePolyhedralContact(Matrix3::Identity(), q, law, false, 8);
                        },
                        false},
                       {"compacted4",
                        [](const Vector3& q, const CoulombLaw& law, const Vector2& previous) {
                          return solveCone4Contact(Matrix3::Identity(), q, law, false, previous);
                        },
                        true},
                       {"predictor_corrector",
                        [](const Vector3& q, const CoulombLaw& law, const Vector2&) {
                          return solveCoulombContact(Matrix3::Identity(), q, law, false);
                        },
                        false}};

Vector2 direction(double degrees) { return {std::cos(degrees * M_PI / 180.0), std::sin(degrees * M_PI / 180.0)}; }

/// The largest load along `degrees` that sticks, over mu times the normal load, by bisection.
double heldShare(const Cone& cone, const CoulombLaw& law, double degrees) {
  double held = 0.0;
  double slides = 2.0;
  for (int step = 0; step < 50; ++step) {
    const double load = 0.5 * (held + slides);
    Vector3 q(-1.0, 0.0, 0.0);
    q.tail<2>() = load * law.mu_static * direction(degrees);
    const bool sticks = cone.solve(q, law, Vector2::Zero()).state == ContactState::kStatic;
    (sticks ? held : slides) = load;  // a contact at rest has not slid before: no axes to follow
  }
  return held;
}

/// Sliding fast (friction hardly turns it) along each angle: how far friction points away from -u_t, and its part along
/// -u_t over mu r_n; and the largest load held.
void printCones() {
  CoulombLaw law;
  law.mu_static = law.mu_kinetic = 0.5;
  std::printf("cone,angle_deg,direction_error_deg,drag_error_percent,held_error_percent\n");
  for (const Cone& cone : kCones) {
    for (int half_degrees = 0; half_degrees <= 180; ++half_degrees) {
      const double degrees = 0.5 * half_degrees;
      Vector3 q(-1.0, 0.0, 0.0);
      q.tail<2>() = 1e6 * direction(degrees);
      const Vector2 previous = cone.follows ? direction(degrees - 5.0) : Vector2(Vector2::Zero());
      const Vector3 r = cone.solve(q, law, previous).impulse;
      const Vector2 opposite = -(r + q).tail<2>().normalized();
      const Vector2 friction = r.tail<2>();
      const double cross = opposite.x() * friction.y() - opposite.y() * friction.x();
      const double error = std::atan2(cross, opposite.dot(friction)) * 180.0 / M_PI;
      const double drag = opposite.dot(friction) / (law.mu_kinetic * r[0]);
      std::printf("%s,%g,%.9g,%.9g,%.9g\n", cone.name, degrees, error, 100.0 * (drag - 1.0),
                  100.0 * (heldShare(cone, law, degrees) - 1.0));
    }
  }
}

}  // namespace
}  // namespace tissue_contact

int main(int argc, char** argv) {
  const tissue_contact::CommandLine line({argv + 1, argv + argc}, {{"--most"}, {}, {}, true});
  const std::string what = line.words().empty() ? "" : line.words().front();
  if (what == "table") {
    tissue_contact::printTable(static_cast<int>(line.integer("--most", 1000, 1, 1000)));
  } else if (what == "cone") {
    tissue_contact::printCones();
  } else {
    std::cerr << "usage: random_problems table [--most N] | cone\n";
    return 2;
  }
  return 0;
}
