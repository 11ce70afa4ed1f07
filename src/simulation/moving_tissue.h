/// @file
/// Room `simulation`, private: one tissue in motion: positions, velocities, elastic state, loads, its linear system,
/// and which of its nodes sleep. What contacts touch and how hard they press in; the system of each step and new
/// positions out.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "simulation/energy_debt.h"
#include "simulation/momentum_rate.h"
#include "simulation/tissue_sleep.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/solver/contact_problem.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

class MovingTissue {
 public:
  /// At rest, undeformed. All arguments must outlive this. The last three are this tissue's among those of all, which
  /// detectors and solvers take together; they are written here alone, but for v, which is also the solver's answer.
  /// @param x positions, 3 x nodes, m, world frame.
  /// @param v velocities, 3 x nodes, m/s.
  /// @param model the tissue's.
  /// @param system A and b of the step.
  MovingTissue(const Scene& scene, ElasticModel model, const Tissue& tissue, NodalVectors& x, NodalVectors& v,
               BodySystem& system);
  MovingTissue(const MovingTissue&) = delete;
  MovingTissue& operator=(const MovingTissue&) = delete;

  /// Undeformed, at rest, awake.
  void reset();
  /// Goes on with another mesh, awake, and a fresh elastic state of it, which is exchanged for that before. x and v are those of its nodes
  /// already; fixed ones are put to where they rest.
  /// @param edge_m mean edge of its surface.
  void changeMesh(std::unique_ptr<Elasticity::State>& elastic_state, double edge_m);
  /// Goes on with other materials, awake, where it is and as fast as it is. Bodies with memory keep theirs.
  void changeMaterials();
  /// At rest where it is, awake, with a fresh elastic state: what was not finite may have got into tangents. Bodies with memory
  /// keep theirs.
  void stop();

  /// Of positions and velocities, m, m/s: what is farther or faster has long stopped to be tissue.
  static constexpr double kMost = 1e9;

  /// @pre on reading: the mesh is that of what was written.
  void carry(StateArchive& archive);

  /// Ends a step of `dt`, s.
  /// @return whether it is time to call fallAsleep().
  bool isTimeToSleep(double dt) { return sleep_ && sleep_->isTimeToCheck(dt); }
  /// Lets nodes sleep that have come to rest.
  /// @param pressing_n as in wakeHeld().
  /// @param touched nodes with contacts.
  void fallAsleep(std::optional<double> pressing_n, const std::vector<int>& touched);
  /// Contacts act on these nodes: they wake before anything is computed with them.
  void wake(const std::vector<int>& touched);

  /// Writes the system of an implicit Euler step of `dt`, s: doc/method.md, "Equation solved each step".
  void assemble(double dt);

  /// After a solve: wakes sleepers that must move.
  /// @param pressing_n the weakest net force of what presses on the tissue, N; none: nothing does.
  /// @param repeats how often this step was solved before.
  /// @return whether any woke: the step is to be solved again.
  bool wakeHeld(std::optional<double> pressing_n, double dt, int repeats);

  /// Whether velocities, the answer of a step of `dt`, s, and positions after it are finite and at most kMost.
  bool isPossible(double dt) const;
  /// After a step that ended before the tolerance: slows v down, by half at most, to where it turns no element inside out.
  /// @pre isPossible()
  void keepElements(double dt);
  /// x += dt v.
  /// @param contact_work_j, was_cut, is_free_of_contact see EnergyDebt::finish().
  void move(double dt, double contact_work_j, bool was_cut, bool is_free_of_contact);

  const MomentumRate& momentumRate() const { return momentum_rate_; }  ///< of the last step

  bool canSleep() const { return sleep_.has_value(); }
  bool isFree() const { return is_free_; }  ///< nothing of the tissue is fixed or attached
  int sleepers() const { return sleep_ ? sleep_->sleepers() : 0; }
  double heldForce() const { return sleep_ ? sleep_->heldForce() : 0.0; }  ///< see TissueSleep::heldForce()

 private:
  void makeState();
  void watchSleep(double edge_m);
  double allowedHeldForce(std::optional<double> pressing_n) const;

  const Scene& scene_;
  ElasticModel model_;
  const Tissue& tissue_;
  NodalVectors& x_;
  NodalVectors& v_;
  BodySystem& system_;
  std::unique_ptr<Elasticity::State> elastic_state_;
  NodalVectors loads_;  ///< elastic forces and pressure, and weight if nodes can sleep, N
  EnergyDebt energy_debt_;
  MomentumRate momentum_rate_;
  bool is_free_ = false;              ///< see isFree()
  std::optional<TissueSleep> sleep_;  ///< none: no node ever sleeps
  bool still_changed_ = false;        ///< sleepers have changed since the elasticity was told
  std::vector<int> woken_;            ///< scratch
  std::vector<char> is_fast_;         ///< scratch
  NodalVectors rigid_;                ///< scratch, m/s
};

}  // namespace tissue_contact
