#include "baselines/solve.h"

#include <chrono>
#include <cmath>
#include <iomanip>
#include <limits>
#include <ostream>
#include <stdexcept>
#include <utility>

#include "tissue_contact/baselines/delassus.h"
#include "tissue_contact/core/command_line.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/core/whole_file.h"

namespace tissue_contact {
namespace {

constexpr const char* kUsage =
    R"(usage: tissue_contact_solve PROBLEM.txt [--solver NAME] [--tolerance T] [--iterations N] [--sides K] [--json]
Solves a frictional contact problem file ("FC3D 1": u = W r + q, Coulomb friction).
  --solver NAME    predictor_corrector (default), reference, cone4, polyhedral, condensed_lcp
  --tolerance T    of the scaled natural map, default 1e-8; the reference is never solved to less than 1e-10
  --iterations N   at most this many: two passes over the contacts (or a Newton step, where those stall), turns of the
                   reference, pivots of the condensed LCP per unknown; default 10000
  --sides K        of the cones of polyhedral and condensed_lcp: even, 4 to 64, default 8
  --json           one JSON object instead of text; impulses in N s, velocities in m/s
The text is a solution file: comments with residuals, then `r` and 3n impulses, `u` and 3n velocities, n states.
Exit code: 0 the tolerance is met, 1 it is not, 2 bad usage or input.
)";

struct Options {
  std::string file;
  SolverDescription solver;
  bool json = false;
  bool help = false;
};

/// @throws std::invalid_argument where the cone of the chosen solver has no sides.
void requireSides(SolverMethod method) {
  if (method == SolverMethod::kPolyhedral || method == SolverMethod::kCondensedLcp) return;
  throw std::invalid_argument("--sides does not go with --solver " + std::string(solverMethodName(method)) +
                              "; only polyhedral and condensed_lcp have cones with sides");
}

Options parseArguments(const std::vector<std::string>& arguments) {
  const CommandLine line(arguments, {{"--solver", "--tolerance", "--iterations", "--sides"}, {"--json"}, {}, true});
  Options options;
  options.help = line.help();
  options.json = line.has("--json");
  if (line.has("--solver")) options.solver.method = solverMethodByName(line.value("--solver"));
  constexpr double kMost = std::numeric_limits<double>::max();
  options.solver.tolerance = line.number("--tolerance", 1e-8, {0.0, kMost, "", "", true});
  options.solver.iterations = static_cast<int>(line.integer("--iterations", 10000, 1, std::numeric_limits<int>::max()));
  options.solver.cone_sides =
      static_cast<int>(line.integer("--sides", options.solver.cone_sides, kMinConeSides, kMaxConeSides));
  if (line.has("--sides")) requireSides(options.solver.method);
  if (line.words().size() > 1) {
    throw std::invalid_argument("more than one problem file: '" + line.words()[0] + "' and '" +
                                printable(line.words()[1]) + "'");
  }
  if (line.words().empty() && !options.help) throw std::invalid_argument("no problem file given");
  if (!options.help) options.file = line.words().front();
  return options;
}

const char* stateName(ContactState state) {
  if (state == ContactState::kOpen) return "open";
  return state == ContactState::kStatic ? "static" : "kinetic";
}

std::vector<std::pair<const char*, double>> named(const DelassusResiduals& residuals) {
  return {{"scaled_natural_map", residuals.scaled_natural_map},
          {"penetration_m_per_s", residuals.penetration_m_per_s},
          {"adhesion_n_s", residuals.adhesion_n_s},
          {"complementarity_j", residuals.complementarity_j},
          {"cone_violation_n_s", residuals.cone_violation_n_s},
          {"dissipation_defect_j", residuals.dissipation_defect_j},
          {"friction_power_j", residuals.friction_power_j},
          {"kinetic_angle_rad", residuals.kinetic_angle_rad},
          {"static_slip_m_per_s", residuals.static_slip_m_per_s}};
}

struct Outcome {
  DelassusSolution solution;
  DelassusReport report;
  double seconds = 0.0;
};

void printText(std::ostream& output, const Options& options, const Outcome& outcome) {
  output << "# solver                " << solverMethodName(options.solver.method) << '\n'
         << "# tolerance             " << options.solver.tolerance << (outcome.report.converged ? " met" : " NOT met")
         << '\n'
         << "# iterations            " << outcome.report.iterations << '\n'
         << "# time_s                " << outcome.seconds << '\n';
  for (const auto& [name, value] : named(outcome.report.residuals)) {
    output << "# " << std::left << std::setw(22) << name << value << '\n';
  }
  output << std::setprecision(std::numeric_limits<double>::max_digits10);
  const std::size_t contacts = outcome.solution.states.size();
  output << "n " << contacts << '\n';
  for (const auto& [name, values] : {std::pair('r', &outcome.solution.r), std::pair('u', &outcome.solution.u)}) {
    output << name << '\n';
    for (std::size_t c = 0; c < contacts; ++c) {
      const Vector3 value = values->segment<3>(3 * static_cast<Eigen::Index>(c));
      output << value[0] << ' ' << value[1] << ' ' << value[2] << '\n';
    }
  }
  output << "states\n";
  for (const ContactState state : outcome.solution.states) output << stateName(state) << '\n';
}

/// JSON has no NaN and no infinity.
void printNumber(std::ostream& output, double value) {
  if (std::isfinite(value)) {
    output << value;
  } else {
    output << "null";
  }
}

void printArray(std::ostream& output, const char* name, const VectorX& values) {
  output << ", \"" << name << "\": [";
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (i > 0) output << ", ";
    printNumber(output, values[i]);
  }
  output << ']';
}

void printJson(std::ostream& output, const Options& options, const Outcome& outcome) {
  output << std::setprecision(std::numeric_limits<double>::max_digits10);
  output << "{\"solver\": \"" << solverMethodName(options.solver.method)
         << "\", \"tolerance\": " << options.solver.tolerance
         << ", \"converged\": " << (outcome.report.converged ? "true" : "false")
         << ", \"iterations\": " << outcome.report.iterations << ", \"time_s\": " << outcome.seconds
         << ", \"residuals\": {";
  const char* separator = "\"";
  for (const auto& [name, value] : named(outcome.report.residuals)) {
    output << separator << name << "\": ";
    printNumber(output, value);
    separator = ", \"";
  }
  output << '}';
  printArray(output, "r", outcome.solution.r);
  printArray(output, "u", outcome.solution.u);
  output << ", \"states\": [";
  separator = "\"";
  for (const ContactState state : outcome.solution.states) {
    output << separator << stateName(state) << '"';
    separator = ", \"";
  }
  output << "]}\n";
}

int solve(const Options& options, std::ostream& output) {
  const DelassusProblem problem = readContactProblem(options.file);
  Outcome outcome;
  const auto start = std::chrono::steady_clock::now();
  outcome.report = solveDelassus(problem, options.solver, outcome.solution);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  options.json ? printJson(output, options, outcome) : printText(output, options, outcome);
  requireWritten(output);
  return outcome.report.converged ? 0 : 1;
}

}  // namespace

int runSolve(const std::vector<std::string>& arguments, std::ostream& output, std::ostream& errors) {
  try {
    const Options options = parseArguments(arguments);
    if (options.help) {
      output << kUsage;
      requireWritten(output);
      return 0;
    }
    return solve(options, output);
  } catch (const std::bad_alloc&) {
    errors << "tissue_contact_solve: not enough memory for this problem and solver\n";
  } catch (const std::exception& error) {
    errors << "tissue_contact_solve: " << error.what() << "\n(--help tells how to use it)\n";
  }
  return 2;
}

}  // namespace tissue_contact
