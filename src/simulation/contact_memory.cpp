#include "tissue_contact/simulation/contact_memory.h"

#include <algorithm>

namespace tissue_contact {
namespace {

bool keyBefore(const Contact& a, const Contact& b) { return a.key < b.key; }

ContactKey withSlot(ContactKey key, int slot) {
  key.slot = slot;
  return key;
}

/// Barycentric weight of a node, whatever triangle the contact was reported with.
double weightOf(const Contact& contact, int node) {
  for (int i = 0; i < 3; ++i) {
    if (contact.nodes[i] == node) return contact.weights[i];
  }
  return 0.0;
}

/// Both contacts are on the same feature.
bool samePoint(const Contact& a, const Contact& b) {
  for (const int node : a.key.feature) {
    if (node >= 0 && std::abs(weightOf(a, node) - weightOf(b, node)) > ContactMemory::kSamePoint) return false;
  }
  return true;
}

}  // namespace

void ContactMemory::remember(const std::vector<Contact>& contacts, const std::vector<Inherited>& answers) {
  remembered_.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (answers[c].state == ContactState::kOpen) continue;  // an open contact has nothing to hand on
    remembered_.push_back({contacts[c], answers[c], false});
  }
}

void ContactMemory::addKeptPoints(const ContactDetector& detector, const std::vector<NodalVectors>& positions,
                                  const std::vector<std::vector<Pose>>& X_WL, double margin_m,
                                  std::vector<Contact>& contacts) {
  kept_.clear();
  for (std::size_t first = 0; first < remembered_.size();) {
    const ContactKey feature = withSlot(remembered_[first].contact.key, 0);
    std::size_t end = first;
    std::array<bool, kKeptPoints + 1> used{};
    for (; end < remembered_.size() && withSlot(remembered_[end].contact.key, 0) == feature; ++end) {
      used[remembered_[end].contact.key.slot] = true;
    }
    if (feature.other_tissue >= 0) {  // tissue against tissue: the pair's own feature is its point
      first = end;
      continue;
    }
    Contact probe;
    probe.key = feature;
    const auto fresh = std::lower_bound(contacts.begin(), contacts.end(), probe, keyBefore);
    const bool has_fresh = fresh != contacts.end() && fresh->key == feature;
    for (; first < end; ++first) {
      Contact& old = remembered_[first].contact;
      if (has_fresh && samePoint(old, *fresh)) {
        old.key.slot = 0;  // the fresh contact continues it
        continue;
      }
      if (old.key.slot == 0) {
        const auto free = std::find(used.begin() + 1, used.end(), false);
        if (free == used.end()) continue;
        old.key.slot = static_cast<int>(free - used.begin());
        *free = true;
      }
      Contact contact = old;
      if (detector.measure(positions, X_WL, margin_m, contact)) kept_.push_back(contact);
    }
  }
  contacts.insert(contacts.end(), kept_.begin(), kept_.end());
  std::sort(contacts.begin(), contacts.end(), keyBefore);
  std::sort(remembered_.begin(), remembered_.end(),
            [](const Remembered& a, const Remembered& b) { return a.contact.key < b.contact.key; });
}

void ContactMemory::recall(const std::vector<Contact>& contacts, double reach_m, std::vector<Inherited>& inherited) {
  inherited.assign(contacts.size(), Inherited());
  unmatched_.clear();
  for (Remembered& old : remembered_) old.taken = false;
  auto old = remembered_.begin();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    while (old != remembered_.end() && old->contact.key < contacts[c].key) ++old;
    if (old != remembered_.end() && old->contact.key == contacts[c].key) {
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
    if (old.taken || !sameShapes(old.contact.key, contact.key)) continue;
    const double squared = (old.contact.p_WC - contact.p_WC).squaredNorm();
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
