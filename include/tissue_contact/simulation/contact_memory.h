/// @file
/// Room `simulation`: remembers contact forces and states from one step to the next, so that the solver starts warm and
/// friction has a history. Contacts of a new step in; their inherited force and state out.
#pragma once

#include <vector>

#include "tissue_contact/contact/contact.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/friction/coulomb.h"

namespace tissue_contact {

class ContactMemory {
 public:
  struct Inherited {
    Vector3 force_W = Vector3::Zero();  ///< N on the tissue, world frame
    ContactState state = ContactState::kOpen;
  };

  void clear() { remembered_.clear(); }

  /// Stores the answer of a step; `contacts` sorted by key as the detector gives them.
  void remember(const std::vector<Contact>& contacts, const std::vector<Inherited>& answers);

  /// Finds for each contact the one it continues: the same key, else the nearest contact of the same shape and tissue
  /// that no other contact continues, if it is no farther than `reach_m` (a contact sliding onto the next triangle).
  /// Each old contact is continued at most once. `inherited` is overwritten; no match: force 0, state open.
  void recall(const std::vector<Contact>& contacts, double reach_m, std::vector<Inherited>& inherited);

 private:
  struct Remembered {
    ContactKey key;
    Vector3 p_W;
    Inherited answer;
    bool taken;
  };
  void recallNearest(const Contact& contact, double reach_m, Inherited& inherited);

  std::vector<Remembered> remembered_;  ///< sorted by key
  std::vector<std::size_t> unmatched_;
};

}  // namespace tissue_contact
