/// @file
/// Room `simulation`, private: remembers contacts from one step to the next, so that the solver starts warm, friction
/// has a history and points that carry force stay in the problem. Contacts of a new step in; what they inherit out.
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
#include "tissue_contact/simulation/solved_contact.h"

namespace tissue_contact {

class ContactMemory {
 public:
  void clear() { remembered_.clear(); }

  /// Stores the contacts of a step, sorted by key.
  void remember(const std::vector<SolvedContact>& contacts);

  /// Adds to the freshly detected contacts (sorted by key, slot 0) the remembered points that carried force and that no
  /// fresh contact of the same feature is near to; keeps the order. At most kKeptPoints per feature. A fresh one as
  /// deep as one of them goes: it would wander along a line of contact and cast a new point off in every step.
  /// @param margins_m per tissue: points with a larger gap are let go.
  void addKeptPoints(const ContactDetector& detector, const std::vector<NodalVectors>& positions,
                     const std::vector<std::vector<Pose>>& X_WL, const std::vector<double>& margins_m,
                     std::vector<Contact>& contacts);

  /// Finds for each contact the one it continues: the same key, else the nearest contact of the same shape and tissue
  /// that no other contact continues, if it is no farther than its `reach_m` (a contact sliding onto the next triangle).
  /// Each old contact is continued at most once: of all pairs the nearest first, whatever their order.
  /// @param reach_m per contact.
  /// @param inherited overwritten: each contact with force, state and slip of the one it continues; no match: open, 0.
  void recall(const std::vector<Contact>& contacts, const std::vector<double>& reach_m,
              std::vector<SolvedContact>& inherited);

  /// Of a contact of the last recall(): the tangential force on the tissue of the one it continues, N, world frame; no match: 0.
  const Vector3& frictionBefore(std::size_t contact) const { return frictions_W_[contact]; }

  static constexpr int kKeptPoints =
      3;  ///< with the fresh one: as many as a face can need to be held flat, and one more

  /// A fresh point nearer to an old one than this share of the feature's size continues it.
  static constexpr double kSamePoint = 0.02;

  /// A fresh point is as deep as a kept one where their gaps differ by less than this share of the way between them.
  /// On a line of contact they do, by what the solver leaves; on a ball they come as near only where they are one.
  static constexpr double kFlushSlope = 1e-3;

 private:
  /// Slots of the remembered points [first, end) of one feature in the new step: 0 for the one that the fresh contact
  /// continues, others for those that stay beside it. Of several at the fresh point the nearest goes on; the rest
  /// become open: nobody inherits from them.
  /// @param fresh null: none was detected on the feature.
  /// @return whether one goes on at the fresh point.
  bool giveSlots(const Contact* fresh, std::size_t first, std::size_t end);
  void inherit(std::size_t old, std::size_t contact, std::vector<SolvedContact>& inherited);
  void inheritNearest(const std::vector<double>& reach_m, std::vector<SolvedContact>& inherited);

  struct Candidate {
    double squared_m2;  ///< distance
    std::size_t contact;
    std::size_t old;
  };
  std::vector<SolvedContact> remembered_;  ///< sorted by key
  std::vector<Vector3> frictions_W_;       ///< per contact of the last recall()
  std::vector<bool> continued_;            ///< per remembered contact: by one of this step
  std::vector<Contact> kept_;
  std::vector<std::size_t> unmatched_;
  std::vector<Candidate> candidates_;
};

}  // namespace tissue_contact
