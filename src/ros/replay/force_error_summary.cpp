#include "ros/replay/force_error_summary.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tissue_contact {

void ForceErrorSummary::add(double force_n, const ForceErrorEstimate& error) {
  force_ += force_n * force_n;
  total_ += error.total_n() * error.total_n();
  mesh_ += error.mesh_n * error.mesh_n;
  step_ += error.step_n * error.step_n;
  solver_ += error.solver_n * error.solver_n;
  knows_mesh_ = knows_mesh_ && error.knows_mesh;
}

std::string ForceErrorSummary::text() const {
  if (!(force_ > 0.0)) return {};
  const auto percent = [this](double squares) { return 100.0 * std::sqrt(squares / force_); };
  std::ostringstream text;
  text.precision(2);
  text << "likely wrong by " << percent(total_) << " % (RMS; ";
  if (knows_mesh_) {
    text << "mesh " << percent(mesh_) << " %, ";
  } else {
    text << "the mesh's part is not known, ";
  }
  text << "step " << percent(step_) << " %, solver " << percent(solver_) << " %)";
  constexpr double kWorthAWord = 10.0;  // per cent
  if (percent(total_) < kWorthAWord) return text.str();
  const double largest = std::max({mesh_, step_, solver_});
  if (largest == mesh_) {
    text << "; for less make cells smaller where it touches (tissues[].refinement: auto)";
  } else if (largest == step_) {
    text << "; for less take shorter steps (step.max_step_s)";
  } else {
    text << "; for less let the solver go on (solver.tolerance, solver.iterations)";
  }
  return text.str();
}

}  // namespace tissue_contact
