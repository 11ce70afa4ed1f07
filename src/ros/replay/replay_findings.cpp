#include "ros/replay/replay_findings.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>

#include "scene/scene_ranges.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

ReplayFindings::ReplayFindings(const Simulator& simulator, std::ostream& log, std::string prefix)
    : simulator_(simulator), log_(log), prefix_(std::move(prefix)), force_errors_(simulator.instruments().size()) {
  for (std::size_t i = 0; i < force_errors_.size(); ++i) {
    gave_way_.push_back(VectorX::Zero(simulator.jointDeflections(static_cast<int>(i)).size()));
  }
}

void ReplayFindings::note(const PlayedSample& played, long steps) {
  if (played.verdict != Verdict::kAccepted && first_refusal_.empty()) {
    first_refusal_ = std::string(verdictText(played.verdict)) + ": " + played.detail;
  }
  if (!played.placed.empty()) warn(played, played.placed);
  if (steps == 0) return;
  const StepReport& report = simulator_.report();
  jumps_ += static_cast<long>(report.jumped);
  discarded_ += static_cast<long>(report.discarded);
  const auto missed = static_cast<long>(report.stop != StopReason::kTolerance);
  not_converged_ += missed;
  if (report.static_contacts + report.kinetic_contacts > 0) touching_.add(report);
  if (report.static_contacts > 0) sticking_.add(report);
  pinched_ += static_cast<long>(report.pinched_contacts > 0);
  for (std::size_t i = 0; i < gave_way_.size(); ++i) {
    gave_way_[i] = gave_way_[i].cwiseMax(simulator_.jointDeflections(static_cast<int>(i)).cwiseAbs());
  }
  noteLaw(played);
  noteCells(played);
  if (report.implausible_load.found && ++implausible_ == 1) warn(played, implausibleLoadText(simulator_));
}

void ReplayFindings::noteLaw(const PlayedSample& played) {
  const LawError& error = simulator_.report().law_error;
  if (law_alarm_.leaves(error.relative) && ++law_alarms_ == 1) warn(played, lawErrorText(simulator_));
  if (std::abs(error.relative) > std::abs(law_error_.relative)) law_error_ = error;
}

void ReplayFindings::noteCells(const PlayedSample& played) {
  const CoarseCells& cells = simulator_.report().coarse_cells;
  if (cells.tissue < 0) return;
  if (++coarse_ == 1) warn(played, coarseCellsText(simulator_));
  if (cells.factor > coarsest_cells_.factor) coarsest_cells_ = cells;
}

void ReplayFindings::warn(const PlayedSample& played, const std::string& text) {
  log_ << prefix_ << "warning: " << stampText(played.stamp_ns) << " s: " << text << "\n";
}

void ReplayFindings::noteForceErrors(const PlayedSample& played) {
  for (const int instrument : played.instruments) {
    const auto index = static_cast<std::size_t>(instrument);
    force_errors_[index].add(simulator_.wrench(instrument).force.norm(), simulator_.forceErrors()[index]);
  }
}

std::vector<std::pair<std::string, long>> ReplayFindings::counts() const {
  return {{"jumps", jumps_},
          {"intervals not converged", not_converged_},
          {"intervals without a finite answer", discarded_},
          {"intervals with forces that no tissue bears", implausible_},
          {"intervals with pinched contacts", pinched_}};
}

std::string ReplayFindings::countsText() const {
  std::ostringstream text;
  text << jumps_ << " jumps, " << not_converged_ << " intervals not converged, " << discarded_
       << " without a finite answer, " << implausible_ << " with forces that no tissue bears, " << pinched_
       << " with pinched contacts";
  return text.str();
}

void ReplayFindings::summarize() const {
  summarizeJoints();
  summarizeForceErrors();
  summarizeLaw();
  summarizeCells();
  summarizeUnsolved();
}

void ReplayFindings::summarizeJoints() const {
  for (std::size_t i = 0; i < gave_way_.size(); ++i) {
    const Instrument& instrument = simulator_.instruments()[i];
    for (const CompliantJoint& compliant : instrument.compliantJoints()) {
      const IndependentJoint& joint = instrument.model().joints()[static_cast<std::size_t>(compliant.joint)];
      log_ << prefix_ << "joint '" << joint.name << "' of '" << instrument.name() << "' gave way by up to "
           << gave_way_[i][compliant.joint] << (compliant.slides ? " m\n" : " rad\n");
    }
  }
}

void ReplayFindings::summarizeForceErrors() const {
  for (std::size_t i = 0; i < force_errors_.size(); ++i) {
    const std::string text = force_errors_[i].text();
    if (!text.empty()) log_ << prefix_ << "force on '" << simulator_.instruments()[i].name() << "' " << text << "\n";
  }
}

void ReplayFindings::summarizeLaw() const {
  if (law_alarms_ == 0) return;
  const TissueDescription& tissue = simulator_.scene().tissues[static_cast<std::size_t>(law_error_.tissue)];
  log_ << prefix_ << "beyond the range of the " << elasticModelName(tissue.material.model) << " law of tissue '"
       << tissue.name << "' " << law_alarms_ << " times: forces likely wrong by up to " << 100.0 * law_error_.relative
       << " %, at a strain of " << law_error_.strain << "\n";
}

void ReplayFindings::summarizeCells() const {
  if (coarse_ == 0) return;
  const auto tissue = static_cast<std::size_t>(coarsest_cells_.tissue);
  log_ << prefix_ << "cells of tissue '" << simulator_.scene().tissues[tissue].name << "' up to "
       << coarsest_cells_.factor << " times as long as its refinement asks for, to keep to nodes_at_most; such "
       << "cells in " << coarse_ << " intervals\n";
}

/// Whether at least `share` of the intervals, and more than single ones, ended so: some are cut short wherever contact begins.
bool ReplayFindings::Solved::atLeast(double share) const {
  constexpr long kFew = 10;
  return not_converged >= kFew && static_cast<double>(not_converged) >= share * static_cast<double>(all);
}

// A step that is cut short leaves contacts static that would slip if it were solved to the end (config/two_psm.yaml held a flap so with a coefficient of
// friction with which it slips), and slender tissue behind (doc/notes/method.md, "A C-shape").
void ReplayFindings::summarizeUnsolved() const {
  constexpr double kSmallShare = 0.05;  // of grips: one that slips is lost
  constexpr double kLargeShare =
      0.2;  // of all: sweeps go on in the next step, so forces of compact tissue are met within a per cent
  const SolverOptions& solver = simulator_.scene().solver;
  const bool grips = sticking_.atLeast(kSmallShare);
  const bool may_iterate = solver.iterations < kMaxIterations;
  const bool may_factorize = solver.relaxation != RelaxationKind::kCholesky;
  if (!(may_iterate || may_factorize) || !(grips || touching_.atLeast(kLargeShare))) return;
  if (grips) {
    log_ << prefix_ << "static friction held in " << sticking_.all << " intervals, of which " << sticking_.not_converged
         << " ended before the solver's tolerance: what is held there may slip when solved to the end";
  } else {
    log_ << prefix_ << "something touched in " << touching_.all << " intervals, of which " << touching_.not_converged
         << " ended before the solver's tolerance: slender or nearly incompressible tissue may lag behind, most in "
            "long steps";
  }
  log_ << ". See whether it does with --set ";
  if (may_iterate) {
    log_ << "solver.iterations=" << std::min(10 * solver.iterations, kMaxIterations) << " (now " << solver.iterations
         << ")" << (may_factorize ? " or --set " : "");
  }
  log_ << (may_factorize ? "solver.relaxation=cholesky\n" : "\n");
}

}  // namespace tissue_contact
