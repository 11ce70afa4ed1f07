/// @file
/// Room `simulation`: a whole scene and its time step. Scene in; positions, contacts and wrenches out. No clock, no
/// ROS.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "tissue_contact/contact/contact_detector.h"
#include "tissue_contact/core/state_archive.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/mesh/triangle_mesh.h"
#include "tissue_contact/simulation/force_error.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/scene_environment.h"
#include "tissue_contact/simulation/solved_contact.h"
#include "tissue_contact/solver/contact_solver.h"
#include "tissue_contact/solver/residuals.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// What an instrument does to a tissue that no tissue bears (src/simulation/load_watch.h), at the end of an interval. The
/// forces are then not to be trusted.
struct ImplausibleLoad {
  bool found = false;
  int tissue = -1;
  int instrument = -1;            ///< -1: another tissue
  Vector3 p_W = Vector3::Zero();  ///< where it is worst, m
  int inverted_elements = 0;      ///< at nodes that carry contact forces
  double pressure_pa = 0.0;       ///< largest mean contact pressure of an instrument on a tissue
  double modulus_pa = 0.0;        ///< Young's modulus it is compared with: the largest of that tissue
};

/// What the choice of the elastic law does to the contact forces (law_error.h), at the end of an interval: of the instrument and
/// tissue for which it is largest. Zeros where no linear or corotational tissue is touched.
struct LawError {
  int tissue = -1;
  int instrument = -1;  ///< -1: another tissue
  double strain = 0.0;  ///< equivalent strain under the tool, see equivalentStrain()
  /// Likely error of the contact force against neo-Hookean tissue with `dilatation: patch`; negative: too small.
  double relative = 0.0;
};

/// What is left of the cells that a tissue's refinement asks for when its mesh may have no more nodes
/// (`tissues[].refinement.nodes_at_most`), at the end of an interval: of the tissue whose are longest. -1 and 1 where all are as asked for.
struct CoarseCells {
  int tissue = -1;
  double factor = 1.0;  ///< the newest refined cells are longer by it than asked for
};

/// How the mesh of a tissue has moved since it was built.
struct MeshMoves {
  int prepared = 0;  ///< beside the steps
  int at_once = 0;   ///< within a step, which took the longer: something touched where nobody could know of it in time
  /// How often steps waited for a mesh that was not ready: for figures, since it depends on the machine.
  int waited = 0;
};

/// How the last step went.
struct StepReport {
  int substeps = 0;          ///< implicit steps taken for the last advance
  double advanced_s = 0.0;   ///< by the last advance; its duration unless interrupted
  bool interrupted = false;  ///< the last advance ended early, see AdvanceLimits
  bool jumped = false;     ///< an instrument moved too far for sub-stepping: it was put at its new place without a path
  bool discarded = false;  ///< a step gave no finite answer: tissues were stopped where they were
  int iterations = 0;      ///< solver iterations of its last step
  StopReason stop = StopReason::kTolerance;
  int sleeping_nodes = 0;     ///< left out of the last step, since they are at rest (see tissue_sleep.h)
  double held_force_n = 0.0;  ///< sum of the forces that holding them still takes, N: bounds the error it makes
  int open_contacts = 0;
  int static_contacts = 0;
  int kinetic_contacts = 0;
  int pinched_contacts = 0;          ///< left out of the last step: shapes that touch each other leave them no room
  ImplausibleLoad implausible_load;  ///< of its last step
  LawError law_error;                ///< likewise
  CoarseCells coarse_cells;          ///< likewise
};

/// Bounds on the work of one advance, for a caller that has to keep up with time.
struct AdvanceLimits {
  /// At most so many implicit steps, which are then longer than scene.step.max_step_s and may carry an instrument
  /// through something thin; <= 0: as many as the interval and the motion ask for.
  int most_steps = 0;
  /// Asked between two steps; true ends the advance there, with the instruments as far as they have come. Null: never.
  std::function<bool()> interrupted;
  /// In place of scene.step.max_step_s; <= 0: that.
  double longest_step_s = 0.0;
};

/// Of all joints at both ends of an interval, rad/s or m/s, a vector per instrument; NaN: not known.
struct JointVelocities {
  std::vector<VectorX> start, end;
};

/// What was chosen for a scene, or is to be expected of it, and why: a line for a log.
struct Advice {
  std::string text;
  bool is_warning = false;  ///< forces are likely far off: to be logged as a warning
};

class Simulator {
 public:
  /// Builds every tissue and instrument.
  /// @throws std::invalid_argument "<file>:<line>: <key path>: <what is wrong>".
  Simulator(const Scene& scene, const SceneEnvironment& environment);
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;

  const Scene& scene() const;
  const std::vector<Instrument>& instruments() const;
  /// With the meshes they have now, see meshRevision(); names and order never change. Meshes change within advance() and reset()
  /// only; the first nodes of each are those of the mesh at the start, in its order.
  const std::vector<Tissue>& tissues() const;

  /// How often the mesh of a tissue has changed since the start: nodes, tetrahedra and surface of tissues()[tissue] are those of
  /// this revision. Never decreases, not by reset() either. The nodes of the unrefined mesh are the first of every other.
  int meshRevision(int tissue) const;
  MeshMoves meshMoves(int tissue) const;

  /// Which models were chosen for the scene and why, a line for each choice; for a log.
  std::vector<Advice> advice() const;

  /// Everything back to the start: tissues undeformed and at rest, instruments at their initial joint positions, no
  /// contact history, step count 0.
  void reset();

  /// All that the next advance depends on, as bytes for restoreState(): a simulation restored from them goes on to the same bits. What
  /// methods carry from step to step (factors of `cholesky`) is not in it: both go on without.
  std::string saveState();

  /// Goes on from a state that was saved of the same scene: tissues, instruments, materials. Friction, solver and step may differ.
  /// @throws std::invalid_argument telling what does not fit; nothing has changed then, unless positions had run away: then all is
  ///   as after reset().
  void restoreState(const std::string& state);

  /// For those whose state has this one's in it.
  void carry(StateArchive& archive);

  /// From the next step on takes the numbers of `changed` that may change while a scene is simulated: Young's moduli, Poisson's ratios and
  /// damping of tissues and their regions, friction coefficients, and the solver's iterations, contact passes and tolerance. Positions,
  /// velocities, contacts and what bodies remember go on; reset() keeps the numbers. Until that step scene() and all results
  /// are as they were; of two calls before it the later one counts.
  /// @param changed scene() but for such numbers, as tuned() (scene/tuning.h) makes it.
  /// @throws std::invalid_argument naming what else differs (places of regions, of `fixed` and of shapes are not looked at); nothing changes
  ///   then.
  void retune(const Scene& changed);

  /// Puts an instrument somewhere without motion in between (no speed, no contact until the next advance).
  void placeInstrument(int instrument, const VectorX& joint_positions);

  /// Advances by `duration_s` (> 0) while the joints move to `joint_positions` (one vector per instrument): linearly, or as a cubic those that
  /// have velocities which fit this way.
  /// Cuts the interval into equal implicit steps no longer than scene.step.max_step_s, and shorter where an instrument
  /// moves so far that it could pass through tissue. Without limits the result depends on the arguments alone.
  /// @param joint_velocities null: none are known.
  /// @throws std::invalid_argument when duration or positions are not finite, anything is of the wrong size, a position is beyond 1e9 rad or m, or
  ///   the duration is more than a billion of the longest steps; nothing has moved then.
  void advance(double duration_s, const std::vector<VectorX>& joint_positions, const AdvanceLimits& limits = {},
               const JointVelocities* joint_velocities = nullptr);

  /// From now on solvers stop iterating once the environment's clock shows `clock_s` and report
  /// StopReason::kTimeBudget, after one iteration at least; infinity, as at the start: never. The answer depends on the
  /// machine then. Methods without a time budget take no notice.
  /// @param prompt_s the same once ten iterations are done: an answer that is good enough then rather than a better one
  ///   late.
  /// @throws std::invalid_argument when there is no clock, or for NaN.
  void setSolverDeadline(double clock_s, double prompt_s = std::numeric_limits<double>::infinity());

  /// What the tissues exert on the instrument: mean over the last implicit step, at the origin of the tip link and in
  /// its axes (N, N m). Zero before the first advance.
  Wrench wrench(int instrument) const;

  const VectorX& jointPositions(int instrument) const;
  /// Of each joint, how much farther than that it is, rad or m, having given way to the tissue; empty for instruments without compliant joints.
  const VectorX& jointDeflections(int instrument) const;
  const std::vector<Pose>& linkPoses(int instrument) const;  ///< X_WL of every link
  /// See ContactDetector::actingSurface.
  const TriangleMesh* actingSurface(int instrument, int contact_link, int shape) const;
  const NodalVectors& positions(int tissue) const;   ///< m, world frame
  const NodalVectors& velocities(int tissue) const;  ///< m/s, world frame
  /// Hands over the memory that positions() or velocities() of a tissue lie in and goes on in a copy, so that whoever looks at that memory
  /// can keep what it saw. References that these have returned now tell of the copy.
  NodalVectors handOverPositions(int tissue);
  NodalVectors handOverVelocities(int tissue);
  const std::vector<SolvedContact>& contacts() const;  ///< of the last step, sorted by key; those of lastProblem()
  const StepReport& report() const;
  /// Of the last step: how far its answer is from its contact problem. Computed when first asked for, at the price of about half a
  /// sweep forth and back; zeros before the first step, and where the step had no finite answer. Two threads may not ask at once.
  const Residuals& residuals() const;
  /// How wrong wrench() is likely to be, per instrument: an estimate for the end of the last advance, computed when first asked for, at the
  /// price of passes over the elements for every shape that touches (605 nodes: two thirds of a step; 1600 refined ones: a fifth). Torques have
  /// not been compared. Two threads may not ask at once.
  const std::vector<ForceErrorEstimate>& forceErrors() const;
  long stepCount() const;  ///< implicit steps since the last reset

  /// Lowers `closest` to where an instrument is nearest to a tissue's surface now, if that is nearer than what it
  /// holds; for a run in which nothing touches. Costs nothing unless called; see
  /// ContactDetector::lowerClosestApproach().
  void lowerClosestApproach(Approach& closest);

  /// The contact problem of the last step and its answer, e.g. for writeContactProblem().
  const ContactProblem& lastProblem() const;
  const ContactSolution& lastSolution() const;

  /// Called after every implicit step (null: nobody), when the accessors tell of that step.
  void setStepObserver(std::function<void()> observer);

 private:
  void requireJointPositions(int instrument, const VectorX& joint_positions) const;

  struct Implementation;
  static std::unique_ptr<Implementation> build(const Scene& scene, const SceneEnvironment& environment);
  std::unique_ptr<Implementation> implementation_;
};

/// A sentence for a log about the implausible load of the last advance: what, where and what to do.
std::string implausibleLoadText(const Simulator& simulator);

/// The same about the law error of the last advance, where there is one.
std::string lawErrorText(const Simulator& simulator);

/// The same about the coarse cells of the last advance, where there are any.
std::string coarseCellsText(const Simulator& simulator);

}  // namespace tissue_contact
