/// @file
/// Room `simulation`, private: the contacts of a step, from detection to their answers: what they inherit, their rows
/// in the contact problem, friction, landing, and what they hand on to the next step. Contacts and answers of the
/// solver in; rows, warm start and solved contacts out.
#pragma once

#include <optional>
#include <vector>

#include "simulation/contact_memory.h"
#include "simulation/contact_pressure.h"
#include "simulation/detection_margins.h"
#include "simulation/friction_table.h"
#include "simulation/instrument_motion.h"
#include "simulation/sheet_thickness.h"
#include "simulation/sheet_turning.h"
#include "simulation/surface_settling.h"
#include "tissue_contact/contact/contact_detector.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/simulation/solved_contact.h"
#include "tissue_contact/solver/contact_problem.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// What one instrument or one other tissue does to a tissue.
struct NetImpulse {
  int instrument = -1;    ///< -1: another tissue
  int other_tissue = -1;  ///< -1: an instrument
  Vector3 impulse_W = Vector3::Zero();
};

/// Sums up what acts on a tissue, by partner; its own folds do not count. Overwrites `net`, without those that do
/// nothing.
/// @param impulses per contact, contact frame, N s.
void sumImpulsesOn(int tissue, const std::vector<SolvedContact>& contacts, const std::vector<Vector3>& impulses,
                   std::vector<NetImpulse>& net);

/// No allocation once vectors have grown.
class StepContacts {
 public:
  /// The arguments must outlive this.
  StepContacts(const std::vector<Tissue>& tissues, const InstrumentMotion& motion, const FrictionTable& friction,
               const SurfaceEdges& edges);

  void clear();  ///< no contacts and no history
  /// To be called before the first step, and when materials change. @param descriptions of the tissues.
  void setMaterials(const std::vector<TissueDescription>& descriptions) { thickness_.setMaterials(descriptions); }

  /// Begins a step with the contacts that `detector` has found (sorted by key): adds the points that are kept and lets
  /// each contact inherit.
  /// @param x per tissue, m.
  /// @param margins of this step: contacts and kept points are let go beyond that of their place.
  void begin(const ContactDetector& detector, const std::vector<NodalVectors>& x, const DetectionMargins& margins,
             std::vector<Contact>& found);

  /// Turns the frames of contacts with instruments as these are expected to slide in this step.
  /// @param v per tissue, of the step before, m/s.
  void slideOn(const ContactDetector& detector, const std::vector<NodalVectors>& v, double dt);

  /// The nodes of a tissue that contacts act on, some more than once; overwrites `nodes`.
  void touchedNodes(int tissue, std::vector<int>& nodes) const;

  /// Writes the row of each contact and its warm start.
  /// @param last_dt of the step before, s; 0: there was none.
  /// @param solution its v: of the tissues at the start of the step; its impulses and states are overwritten.
  void assemble(const std::vector<NodalVectors>& x, double dt, double last_dt, std::vector<ContactRow>& rows,
                ContactSolution& solution);

  /// The weakest of the net forces of instruments and other tissues on a tissue, N; none: nothing presses.
  /// @param impulses per contact, contact frame, N s, of a step of `dt`, s.
  std::optional<double> weakestNetForce(int tissue, const std::vector<Vector3>& impulses, double dt);

  /// Ends the step with its answer.
  /// @param x at its end.
  void record(const std::vector<NodalVectors>& x, const ContactProblem& problem, const ContactSolution& solution);

  /// The mesh of a tissue has changed, the tissue is the new one: contacts go on at the same places.
  /// @param to_new per node before; -1: it is no more. A contact of such nodes is continued by the nearest one of its shape.
  /// @param triangles trianglesOfNodes() of it if friction depends on pressure; they are exchanged for those before.
  void renumber(int tissue, const std::vector<int>& to_new, TrianglesOfNodes& triangles);
  /// The mesh of a tissue is about to change: notes how fine it is under instruments, to see whether cells grow there.
  void noteCells(int tissue) { settling_.noteCells(tissue, contacts_); }
  /// To be called once all meshes that change have been renumbered.
  void finishRenumbering();

  /// On reading, refuses what does not belong to these tissues and instruments.
  void carry(StateArchive& archive, const std::vector<Instrument>& instruments);

  const std::vector<SolvedContact>& solved() const { return contacts_; }
  void keysBetweenTissues(std::vector<ContactKey>& keys) const;  ///< overwrites `keys`
  int count(ContactState state) const;

 private:
  /// Contacts of one shape (or tissue) on a tissue.
  struct Patch {
    ContactKey key;            ///< of one of them
    double first_touch = 1.0;  ///< share of the step that is over then
  };
  void placeRow(std::size_t contact, double dt, ContactRow& row) const;
  ContactBefore beforeOf(const SolvedContact& inherited, const std::vector<NodalVectors>& x, double last_dt,
                         double speed_over_tissue) const;
  void land(const std::vector<NodalVectors>& v, double dt, std::vector<ContactRow>& rows);
  double& firstTouch(const ContactKey& key);
  void requireContact(const StateArchive& archive, const SolvedContact& solved,
                      const std::vector<Instrument>& instruments) const;
  Vector3 slipOf(std::size_t contact, const ContactProblem& problem, const ContactSolution& solution) const;

  const std::vector<Tissue>& tissues_;
  const InstrumentMotion& motion_;
  const FrictionTable& friction_;
  const SurfaceEdges& edges_;
  ContactMemory memory_;
  SheetThickness thickness_;
  SheetTurning turning_;
  std::optional<ContactPressure> pressure_;  ///< only where friction depends on it
  std::vector<SolvedContact> contacts_;      ///< before the solve with what they inherit, after it with what was found
  /// Per contact, what is in its row's u_tool besides the instrument's motion, contact plane, m/s: the way back of a
  /// held contact, or what a contact without a history slid before it touched; each contact has one of them or none.
  std::vector<Vector2> u_besides_;
  double back_time_s_ = 0.0;  ///< over which slips are taken back
  SurfaceSettling settling_;
  std::vector<Patch> patches_;        ///< scratch of land()
  std::vector<double> touch_shares_;  ///< per contact, the same
  std::vector<NetImpulse> net_;       ///< scratch
  std::vector<double> reaches_m_;     ///< scratch of begin(), per contact
};

}  // namespace tissue_contact
