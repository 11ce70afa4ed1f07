/// @file
/// Contact problem files ("FC3D 1"): read, solved if small, written and read again.
#include <sstream>
#include <stdexcept>

#include "fuzz/fuzz_support.h"
#include "tissue_contact/baselines/delassus.h"

using namespace tissue_contact;

namespace {

constexpr int kMostContactsSolved = 3;
constexpr int kIterations = 20;

void checkRead(const DelassusProblem& problem) {
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(problem.contacts());
  fuzz::require(problem.contacts() > 0, "a problem has contacts");
  fuzz::require(problem.W.rows() == size && problem.W.cols() == size && problem.q.size() == size, "sizes that match");
  fuzz::require(problem.W.allFinite() && problem.q.allFinite(), "finite numbers");
}

void solve(const DelassusProblem& problem, SolverMethod method) {
  SolverDescription description;
  description.method = method;
  description.tolerance = 1e-8;
  description.iterations = kIterations;
  DelassusSolution solution;
  try {
    solveDelassus(problem, description, solution);
  } catch (const std::invalid_argument&) {
    return;
  }
  const auto size = static_cast<std::size_t>(problem.contacts());
  fuzz::require(solution.states.size() == size && solution.r.size() == problem.q.size(), "an answer per contact");
  fuzz::require(solution.r.allFinite(), "finite impulses");
}

/// Seventeen digits give the same numbers back.
void writeAndReadAgain(const DelassusProblem& problem, fuzz::InputFile& file) {
  std::ostringstream text;
  const std::vector<ContactState> states(static_cast<std::size_t>(problem.contacts()), ContactState::kOpen);
  writeContactProblem(text, problem, states);
  const DelassusProblem again = readContactProblem(file.hold("again.txt", text.str()));
  fuzz::require(again.W == problem.W && again.q == problem.q, "a problem that was written reads as it was");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::InputFile file;
  try {
    const DelassusProblem problem = readContactProblem(file.hold("input.txt", fuzz::textOf(data, size)));
    checkRead(problem);
    if (problem.contacts() > kMostContactsSolved) return 0;
    for (const SolverMethod method : {SolverMethod::kPredictorCorrector, SolverMethod::kReference, SolverMethod::kCone4,
                                      SolverMethod::kPolyhedral, SolverMethod::kCondensedLcp}) {
      solve(problem, method);
    }
    writeAndReadAgain(problem, file);
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
