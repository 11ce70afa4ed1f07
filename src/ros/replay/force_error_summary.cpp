#include "ros/replay/force_error_summary.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tissue_contact/core/text.h"

namespace tissue_contact {

void ForceErrorSummary::add(double force_n, const ForceErrorEstimate& error) {
  force_ += force_n * force_n;
  total_ += error.total_n() * error.total_n();
  mesh_ += error.mesh_n * error.mesh_n;
  step_ += error.step_n * error.step_n;
  solver_ += error.solver_n * error.solver_n;
  inertia_ += error.inertia_n * error.inertia_n;
  knows_mesh_ = knows_mesh_ && error.knows_mesh;
}

std::string ForceErrorSummary::text() const {
  if (!(force_ > 0.0)) return {};
  const auto share = [this](double squares) { return std::sqrt(squares / force_); };
  const auto percent = [&](double squares) { return twoDigits(100.0 * share(squares)) + " %"; };
  std::ostringstream text;
  text << "likely wrong by " << percent(total_) << " (RMS; ";
  if (knows_mesh_) {
    text << "mesh " << percent(mesh_) << ", ";
  } else {
    text << "the mesh's part is not known, ";
  }
  text << "step " << percent(step_) << ", solver " << percent(solver_) << ')';
  constexpr double kOfSwing = 0.4;  // held organs 2 to 30 %, a robot's sweep 24; organs on a stalk 49 and 54
  if (share(inertia_) > kOfSwing) {
    text << "; and by what went wrong in earlier steps, since the tissue swings: its inertia is " << percent(inertia_)
         << " of the force. Hold more of it (tissues[].fixed), or compare with shorter steps and smaller cells";
  }
  constexpr double kWorthAWord = 0.1;
  if (share(total_) < kWorthAWord) return text.str();
  if (knows_mesh_ && mesh_ >= std::max(step_, solver_)) {
    text << "; for less take smaller cells where it touches (tissues[].refinement)";
  } else if (step_ >= solver_) {
    text << "; for less take shorter steps (step.max_step_s)";
  } else {
    text << "; for less let the solver go on (solver.tolerance, solver.iterations, solver.relaxation)";
  }
  return text.str();
}

}  // namespace tissue_contact
