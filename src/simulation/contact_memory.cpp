#include "simulation/contact_memory.h"

#include <algorithm>
#include <cmath>
#include <tuple>

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

/// How far apart two points of the same feature are, as a share of its size.
double distanceOf(const Contact& a, const Contact& b) {
  double most = 0.0;
  for (const int node : a.key.feature) {
    if (node >= 0) most = std::max(most, std::abs(weightOf(a, node) - weightOf(b, node)));
  }
  return most;
}

bool areLevel(const Contact& a, const Contact& b) {
  return std::abs(a.gap_m - b.gap_m) < ContactMemory::kFlushSlope * (a.p_WC - b.p_WC).norm();
}

constexpr int kLeftOut = -1;  // a slot before all

bool isOpen(const SolvedContact& contact) { return contact.state == ContactState::kOpen; }

}  // namespace

void ContactMemory::remember(const std::vector<SolvedContact>& contacts) {
  remembered_.clear();
  for (const SolvedContact& contact : contacts) {
    if (!isOpen(contact)) remembered_.push_back(contact);  // an open one has nothing to hand on
  }
}

void ContactMemory::addKeptPoints(const ContactDetector& detector, const std::vector<NodalVectors>& positions,
                                  const std::vector<std::vector<Pose>>& X_WL, const std::vector<double>& margins_m,
                                  std::vector<Contact>& contacts) {
  kept_.clear();
  for (std::size_t first = 0, end = 0; first < remembered_.size(); first = end) {
    Contact probe;
    probe.key = withSlot(remembered_[first].contact.key, 0);
    while (end < remembered_.size() && withSlot(remembered_[end].contact.key, 0) == probe.key) ++end;
    // Tissue against tissue the pair's own feature is its point; without a feature, its mesh has changed there.
    if (probe.key.other_tissue >= 0 || probe.key.feature[0] < 0) continue;
    const auto fresh = std::lower_bound(contacts.begin(), contacts.end(), probe, keyBefore);
    const bool has_fresh = fresh != contacts.end() && fresh->key == probe.key;
    const bool is_new = !giveSlots(has_fresh ? &*fresh : nullptr, first, end) && has_fresh;
    for (std::size_t old = first; old < end; ++old) {
      if (isOpen(remembered_[old]) || remembered_[old].contact.key.slot == 0) continue;
      Contact contact = remembered_[old].contact;
      if (!detector.measure(positions, X_WL, margins_m[contact.key.tissue], contact)) continue;
      if (is_new && areLevel(contact, *fresh)) fresh->key.slot = kLeftOut;
      kept_.push_back(contact);
    }
  }
  const auto is_left_out = [](const Contact& contact) { return contact.key.slot == kLeftOut; };
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(), is_left_out), contacts.end());
  contacts.insert(contacts.end(), kept_.begin(), kept_.end());
  std::sort(contacts.begin(), contacts.end(), keyBefore);
  remembered_.erase(std::remove_if(remembered_.begin(), remembered_.end(), isOpen), remembered_.end());
  std::sort(remembered_.begin(), remembered_.end(),
            [](const SolvedContact& a, const SolvedContact& b) { return keyBefore(a.contact, b.contact); });
}

bool ContactMemory::giveSlots(const Contact* fresh, std::size_t first, std::size_t end) {
  std::array<bool, kKeptPoints + 1> used{};
  std::size_t continued = end;
  for (std::size_t old = first; old < end; ++old) {
    const Contact& point = remembered_[old].contact;
    if (fresh == nullptr || distanceOf(point, *fresh) > kSamePoint) {
      used[point.key.slot] = true;
      continue;
    }
    std::size_t farther = old;
    if (continued == end || distanceOf(point, *fresh) < distanceOf(remembered_[continued].contact, *fresh)) {
      std::swap(farther, continued);
    }
    if (farther < end) remembered_[farther].state = ContactState::kOpen;
  }
  for (std::size_t old = first; old < end; ++old) {
    int& slot = remembered_[old].contact.key.slot;
    if (old == continued) {
      slot = 0;
    } else if (slot == 0) {
      const auto free = std::find(used.begin() + 1, used.end(), false);
      if (free == used.end()) {  // in slot 0 the fresh contact would take its history for its own
        if (fresh != nullptr) remembered_[old].state = ContactState::kOpen;
      } else {
        slot = static_cast<int>(free - used.begin());
      }
    }
  }
  return continued < end;
}

void ContactMemory::recall(const std::vector<Contact>& contacts, const std::vector<double>& reach_m,
                           std::vector<SolvedContact>& inherited) {
  inherited.resize(contacts.size());
  frictions_W_.assign(contacts.size(), Vector3::Zero());
  continued_.assign(remembered_.size(), false);
  unmatched_.clear();
  std::size_t old = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    inherited[c] = SolvedContact();
    inherited[c].contact = contacts[c];
    while (old < remembered_.size() && keyBefore(remembered_[old].contact, contacts[c])) ++old;
    if (old < remembered_.size() && remembered_[old].contact.key == contacts[c].key) {
      inherit(old, c, inherited);
    } else {
      unmatched_.push_back(c);
    }
  }
  inheritNearest(reach_m, inherited);
}

void ContactMemory::inherit(std::size_t old, std::size_t index, std::vector<SolvedContact>& inherited) {
  SolvedContact& contact = inherited[index];
  const Vector3 n = remembered_[old].contact.R_WC.col(0);
  frictions_W_[index] = remembered_[old].force_on_tissue_n - n * n.dot(remembered_[old].force_on_tissue_n);
  continued_[old] = true;
  contact.state = remembered_[old].state;
  contact.force_on_tissue_n = remembered_[old].force_on_tissue_n;
  contact.slip_W = remembered_[old].slip_W;
}

void ContactMemory::inheritNearest(const std::vector<double>& reach_m, std::vector<SolvedContact>& inherited) {
  candidates_.clear();
  for (const std::size_t c : unmatched_) {
    const Contact& contact = inherited[c].contact;
    for (std::size_t old = 0; old < remembered_.size(); ++old) {
      const Contact& before = remembered_[old].contact;
      if (continued_[old] || !sameShapes(before.key, contact.key)) continue;
      const double squared = (before.p_WC - contact.p_WC).squaredNorm();
      if (squared < reach_m[c] * reach_m[c]) candidates_.push_back({squared, c, old});
    }
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.squared_m2, a.contact, a.old) < std::tie(b.squared_m2, b.contact, b.old);
  });
  for (const Candidate& pair : candidates_) {
    if (!continued_[pair.old] && inherited[pair.contact].state == ContactState::kOpen) {
      inherit(pair.old, pair.contact, inherited);
    }
  }
}

}  // namespace tissue_contact
