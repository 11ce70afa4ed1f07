/// @file
/// Room `simulation`, private: what a Simulator consists of, and the pipeline of one step.
#pragma once

#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "simulation/compliant_joints.h"
#include "simulation/detection_margins.h"
#include "simulation/fold_watch.h"
#include "simulation/friction_table.h"
#include "simulation/instrument_motion.h"
#include "simulation/load_watch.h"
#include "simulation/mesh_follower.h"
#include "simulation/moving_tissue.h"
#include "simulation/step_contacts.h"
#include "simulation/tissue_refinement.h"
#include "simulation/touched_places.h"
#include "tissue_contact/contact/contact_detector.h"
#include "tissue_contact/contact/tissue_pair_detector.h"
#include "tissue_contact/simulation/force_error.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

struct Simulator::Implementation {
  Implementation(const Scene& description, const SceneEnvironment& environment);
  Implementation(const Implementation&) = delete;  // members refer to each other
  Implementation& operator=(const Implementation&) = delete;
  void reset();
  void carry(StateArchive& archive);
  void carryMeshes(StateArchive& archive);
  void step(double dt);
  void restTissues();
  void retune();
  void refineTissues(double dt);
  bool refineTissue(int tissue, const TouchedPlaces::Approaching& approaching);
  void changeMesh(int tissue, ComingMesh& coming);
  void takeMesh(int tissue, ComingMesh& coming, const std::vector<int>& to_new);
  void restartMesh(int tissue);
  MeshUsers usersOf(int tissue) const;
  void detectContacts(double dt);
  void wakeTouched();
  void assemble(double dt);
  void solve(double dt);
  bool wakeHeld(double dt, int repeats);
  void moveTissues(double dt);
  void findContactWork();
  void recordContacts();
  void sumWrenches();
  CoarseCells coarsestCells() const;

  Scene scene;                   ///< never but for what retune() takes
  std::optional<Scene> retuned;  ///< whose numbers the next step takes
  SecondsClock clock;
  const std::vector<Instrument> instruments;
  std::vector<std::unique_ptr<TissueRefinement>> refinements;  ///< per tissue; null: its mesh never changes
  std::vector<Tissue> tissues;
  FrictionTable friction;
  SurfaceEdges edges;

  InstrumentMotion motion;
  CompliantJoints compliant_joints;
  std::vector<NodalVectors> x;  ///< per tissue, m
  ContactProblem problem;
  ContactSolution solution;         ///< v is the tissues' velocity
  std::deque<MovingTissue> moving;  ///< per tissue, each with its own of the three above; they never change their place
  DetectionMargins margins;
  ContactDetector detector;
  std::optional<TissuePairDetector> pair_detector;  ///< only where tissues touch each other
  FoldWatch folds;
  std::vector<ContactKey> known;  ///< scratch: contacts between tissues of the step before
  std::vector<Contact> found;     ///< scratch: by the detectors
  StepContacts contacts;
  std::unique_ptr<ContactSolver> solver;
  double deadline_s = std::numeric_limits<double>::infinity();  ///< of the solver, see setSolverDeadline()
  double prompt_s = std::numeric_limits<double>::infinity();
  std::vector<int> touched_nodes;      ///< scratch
  std::vector<double> contact_work_j;  ///< per tissue, by the contacts of a step
  std::vector<bool> is_pressed;        ///< per tissue, by any of them
  TouchedPlaces touched_places;
  std::vector<double>
      approach_m;  ///< per tissue: how near a resting shape must be for the mesh to be refined; < 0: it never is
  std::vector<double> near_m;    ///< scratch: the same in this step
  std::vector<NearPlace> near;   ///< scratch
  std::vector<Wrench> wrenches;  ///< per instrument
  LoadWatch load_watch;
  StepReport report;
  std::optional<Residuals> residuals = Residuals();  ///< none: nobody has asked since the step
  std::vector<NodalVectors> residual_scratch;
  std::optional<std::vector<ForceErrorEstimate>> force_errors;  ///< none: nobody has asked since the last advance
  long step_count = 0;
  double last_dt = 0.0;  ///< of the step before, s
  std::function<void()> observer;
  std::vector<std::unique_ptr<MeshFollower>> followers;  ///< per tissue; null as in refinements
  std::unique_ptr<BackgroundWorker>
      worker;  ///< of the followers, null without any; last, so that it ends before what it works on
};

}  // namespace tissue_contact
