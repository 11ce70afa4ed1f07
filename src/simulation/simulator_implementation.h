/// @file
/// Room `simulation`, private: what a Simulator holds. simulator.cpp: the pipeline; contact_rows.cpp: contacts into rows of
/// the contact problem and answers back; tissue_step.cpp: tissues into systems, and their motion.
#pragma once

#include <optional>

#include "tissue_contact/contact/contact_detector.h"
#include "tissue_contact/contact/tissue_pair_detector.h"
#include "tissue_contact/simulation/contact_memory.h"
#include "tissue_contact/simulation/fold_watch.h"
#include "tissue_contact/simulation/friction_table.h"
#include "tissue_contact/simulation/instrument_motion.h"
#include "tissue_contact/simulation/simulator.h"
#include "tissue_contact/simulation/tissue_sleep.h"

namespace tissue_contact {

struct Simulator::Implementation {
  Implementation(const Scene& description, const SceneEnvironment& environment);
  void reset();
  void step(double dt);
  void detectContacts(double dt);
  void wakeTouched();
  void assembleTissues(double dt);
  void assembleContacts(double dt);
  void solveContacts(double dt);
  bool wakeHeld(double dt, int repeats);
  void landContacts(double dt);
  double& firstTouch(const ContactKey& key);
  void placeRow(const Contact& contact, double dt, ContactRow& row) const;
  void moveTissues(double dt);
  void restTissues(double dt);
  double allowedHeldForce(std::size_t tissue, double dt) const;
  void recordContacts(double dt);
  Vector3 slipOf(std::size_t contact, double dt) const;
  void makeElasticStates();
  void sumWrenches();

  const Scene scene;
  const std::vector<Instrument> instruments;
  const std::vector<Tissue> tissues;
  const FrictionTable friction;
  const double mean_edge;  ///< of all tissue surfaces, m

  InstrumentMotion motion;
  std::vector<NodalVectors> x;                                     ///< per tissue
  std::vector<std::unique_ptr<Elasticity::State>> elastic_states;  ///< per tissue
  std::vector<NodalVectors> loads;                                 ///< elastic forces and weight, per tissue, N
  std::vector<TissueSleep> sleep;                                  ///< per tissue; empty: none ever sleeps
  std::vector<bool> still_changed;                                 ///< per tissue: since its elasticity was told
  ContactDetector detector;
  std::optional<TissuePairDetector> pair_detector;  ///< only where tissues touch each other
  FoldWatch folds;
  std::vector<Contact> contacts;
  ContactMemory memory;
  std::vector<ContactMemory::Inherited> answers;  ///< per contact: inherited before the solve, found after it
  std::vector<Vector2> taken_back;  ///< per contact: part of the tool's velocity that undoes a slip, contact plane, m/s
  std::vector<Vector2> before_touch;  ///< per contact: part of u_tool that landContacts() has added, contact plane, m/s
  struct Patch {
    ContactKey key;  ///< of one of its contacts: those of a shape (or tissue) on a tissue
    double first_touch = 1.0;
  };
  std::vector<Patch> patches;        ///< scratch of landContacts()
  std::vector<double> touch_shares;  ///< per contact, the same
  ContactProblem problem;
  ContactSolution solution;  ///< v is the tissues' velocity
  std::unique_ptr<ContactSolver> solver;
  std::vector<int> touched_nodes;  ///< scratch
  std::vector<SolvedContact> solved;
  std::vector<Wrench> wrenches;  ///< per instrument
  LoadWatch load_watch;
  StepReport report;
  long step_count = 0;
  double last_dt = 0.0;  ///< of the step before, s
  std::function<void()> observer;
};

}  // namespace tissue_contact
