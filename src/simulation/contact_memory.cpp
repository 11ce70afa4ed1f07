#include "tissue_contact/simulation/contact_memory.h"

#include <algorithm>

namespace tissue_contact {
namespace {

bool sameShapes(const ContactKey& a, const ContactKey& b) {
  return a.tissue == b.tissue && a.instrument == b.instrument && a.link == b.link && a.shape == b.shape;
}

}  // namespace

void ContactMemory::remember(const std::vector<Contact>& contacts, const std::vector<Inherited>& answers) {
  remembered_.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (answers[c].state == ContactState::kOpen) continue;  // an open contact has nothing to hand on
    remembered_.push_back({contacts[c].key, contacts[c].p_WC, answers[c], false});
  }
}

void ContactMemory::recall(const std::vector<Contact>& contacts, double reach_m, std::vector<Inherited>& inherited) {
  inherited.assign(contacts.size(), Inherited());
  unmatched_.clear();
  for (Remembered& old : remembered_) old.taken = false;
  auto old = remembered_.begin();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    while (old != remembered_.end() && old->key < contacts[c].key) ++old;
    if (old != remembered_.end() && old->key == contacts[c].key) {
      inherited[c] = old->answer;
      old->taken = true;
    } else {
      unmatched_.push_back(c);
    }
  }
  for (const std::size_t c : unmatched_) recallNearest(contacts[c], reach_m, inherited[c]);
}

void ContactMemory::recallNearest(const Contact& contact, double reach_m, Inherited& inherited) {
  Remembered* nearest = nullptr;
  double best = reach_m * reach_m;
  for (Remembered& old : remembered_) {
    if (old.taken || !sameShapes(old.key, contact.key)) continue;
    const double squared = (old.p_W - contact.p_WC).squaredNorm();
    if (squared < best) {
      best = squared;
      nearest = &old;
    }
  }
  if (nearest == nullptr) return;
  nearest->taken = true;
  inherited = nearest->answer;
}

}  // namespace tissue_contact
