/// @file
/// Room `simulation`: remembers contacts from one step to the next, so that the solver starts warm, friction has a
/// history and points that carry force stay in the problem. Contacts of a new step in; their inherited force and state
/// out.
///
/// Why points are kept: the closest point of a face moves when the face tilts, by the tool's radius times the tilt.
/// With the closest point alone, the force acts now at one and now at another end of the face and a resting contact
/// never comes to rest (measured: form H at 10 ms steps cycled between 0.068 and 0.072 N for ever). A point that
/// carried force last step therefore stays in the problem beside the new closest point, and is dropped once it carries
/// none: the cutting planes of an active set.
#pragma once

#include <vector>

#include "tissue_contact/contact/contact.h"
#include "tissue_contact/contact/contact_detector.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/friction/coulomb.h"

namespace tissue_contact {

class ContactMemory {
 public:
  struct Inherited {
    Vector3 force_W = Vector3::Zero();  ///< N on the tissue, world frame
    ContactState state = ContactState::kOpen;
    /// How far the tissue slid against the tool in the step, m, world frame. For a static contact: what the solver has
    /// left over, which the next step takes back, so that a held contact does not creep.
    Vector3 slip_W = Vector3::Zero();
  };

  void clear() { remembered_.clear(); }

  /// Stores the answer of a step; `contacts` sorted by key.
  void remember(const std::vector<Contact>& contacts, const std::vector<Inherited>& answers);

  /// Adds to the freshly detected contacts (sorted by key, slot 0) the remembered points that carried force and that no
  /// fresh contact of the same feature is near to; keeps the order. At most kKeptPoints per feature.
  void addKeptPoints(const ContactDetector& detector, const std::vector<NodalVectors>& positions,
                     const std::vector<std::vector<Pose>>& X_WL, double margin_m, std::vector<Contact>& contacts);

  /// Finds for each contact the one it continues: the same key, else the nearest contact of the same shape and tissue
  /// that no other contact continues, if it is no farther than `reach_m` (a contact sliding onto the next triangle).
  /// Each old contact is continued at most once. `inherited` is overwritten; no match: force 0, state open.
  void recall(const std::vector<Contact>& contacts, double reach_m, std::vector<Inherited>& inherited);

  static constexpr int kKeptPoints =
      3;  ///< with the fresh one: as many as a face can need to be held flat, and one more

  /// A fresh point nearer to an old one than this share of the feature's size continues it.
  static constexpr double kSamePoint = 0.02;

 private:
  struct Remembered {
    Contact contact;
    Inherited answer;
    bool taken;
  };
  void recallNearest(const Contact& contact, double reach_m, Inherited& inherited);

  std::vector<Remembered> remembered_;  ///< sorted by key
  std::vector<Contact> kept_;
  std::vector<std::size_t> unmatched_;
};

}  // namespace tissue_contact
