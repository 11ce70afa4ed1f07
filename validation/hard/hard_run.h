/// @file
/// Room `validation`: a scene run through its hard case. Every step's energy, work, residuals and penetration in, and
/// every so many steps the exact answer to the same step; what the worst of them was out.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/simulation/simulator.h"
#include "validation/report.h"

namespace tissue_contact {

/// What a run must keep to.
struct HardBands {
  /// Of the force of a step against the exact answer to the same step; RMS over RMS. The default settings leave some
  /// 0.1 % in a step of ordinary scenes; a hard case may have 0.5 %. Over the steps in which the same contacts stick: one that
  /// is within the tolerance of letting go may do so a step early or late, and that step is off by up to mu_s / mu_k - 1.
  double force = 0.005;

  /// Share of such steps: what sticks is decided otherwise than by the exact answer.
  double let_go_else = 0.05;

  /// How deep tissue may be inside a shape, over the mean edge of its surface. A ball of 10 mm on cells of 7.5 mm
  /// cannot be followed better than edge / (8 R) = 0.09 edges anyway: half of that.
  double penetration_edges = 0.05;

  /// Energy that appears without work over the work that was done: what a force with that error could do.
  double energy = 0.005;
};

/// Watches every implicit step of a simulator from its construction on.
class HardRun {
 public:
  /// @param simulator must outlive this object, and stay where it is.
  /// @param reference_every steps between two exact answers; 0: none.
  HardRun(Simulator& simulator, int reference_every);
  ~HardRun();
  HardRun(const HardRun&) = delete;
  HardRun& operator=(const HardRun&) = delete;

  /// Checks and notes under `name` (a few letters: quantities are short): steps, everything finite, no energy without
  /// work, friction that never drives, penetration, force against the exact answer; residuals as a note.
  void report(const std::string& name, const HardBands& bands, Report& report) const;

  long steps() const { return steps_; }
  bool finite() const { return finite_; }
  double meanEdge() const { return edge_; }  ///< of the tissues' surfaces at rest, m
  /// Force error as HardBands::force, over the steps that say they met the tolerance, whatever sticks; not a number: none did.
  double errorWhereMet() const;
  int mostContacts() const { return most_contacts_; }  ///< that carry force, at once

 private:
  void observe();
  double elasticEnergy() const;
  double totalEnergy() const;
  void addWork();
  void compareWithExact();

  Simulator& simulator_;
  int reference_every_;
  std::vector<std::vector<Pose>> X_WL_;  ///< of each instrument's links at the start of the step
  double edge_ = 0.0;                    ///< mean of all surfaces, m
  long steps_ = 0;
  bool finite_ = true;
  double energy_ = 0.0;
  double work_ = 0.0;          ///< J, of instruments in the step
  double pushed_out_ = 0.0;    ///< J, of taking penetration back in the step
  double total_work_ = 0.0;    ///< J, sum of magnitudes
  double total_pushed_ = 0.0;  ///< J
  double gained_ = 0.0;        ///< J, sum over the steps that ended with more than went in
  double driven_ = 0.0;        ///< J, sum over the contacts whose friction drove
  double deepest_ = 0.0;
  double largest_force_ = 0.0;
  int most_contacts_ = 0;
  long met_ = 0;  ///< steps that met the tolerance
  Residuals worst_;
  int references_ = 0;
  int references_met_ = 0;
  double natural_map_ = 0.0;
  int let_go_else_ = 0;  ///< of references_met_: steps in which a contact sticks here and slides there, or the reverse
  double squared_error_ = 0.0;  ///< of the others, N^2
  double squared_force_ = 0.0;
  double squared_error_else_ = 0.0;       ///< of those, N^2
  double squared_error_where_met_ = 0.0;  ///< of all that say so, N^2
  double squared_force_where_met_ = 0.0;
};

}  // namespace tissue_contact
