#include "ros/node/receipt_times.h"

#include <algorithm>

#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {
namespace {

auto firstOf(const std::deque<Receipt>& receipts, std::int64_t stamp_ns) {
  return std::find_if(receipts.begin(), receipts.end(),
                      [stamp_ns](const Receipt& receipt) { return receipt.stamp_ns == stamp_ns; });
}

}  // namespace

void ReceiptTimes::note(int topic, const Receipt& receipt) {
  std::deque<Receipt>& receipts = topics_[static_cast<std::size_t>(topic)];
  receipts.push_back(receipt);
  // The player lets no more wait; what it refused is forgotten here with the next that it plays, or so.
  if (receipts.size() > JointStatePlayer::kMaxWaiting) receipts.pop_front();
}

std::optional<Receipt> ReceiptTimes::find(std::int64_t stamp_ns) const {
  std::optional<Receipt> first;
  for (const std::deque<Receipt>& receipts : topics_) {
    const auto found = firstOf(receipts, stamp_ns);
    if (found != receipts.end() && (!first || found->received_s < first->received_s)) first = *found;
  }
  return first;
}

std::optional<Receipt> ReceiptTimes::take(std::int64_t stamp_ns) {
  const std::optional<Receipt> first = find(stamp_ns);
  for (std::deque<Receipt>& receipts : topics_) {
    // Refused ones and those of older moments, in the order they came unless time went backwards.
    while (!receipts.empty() && receipts.front().stamp_ns < stamp_ns) receipts.pop_front();
    const auto found = firstOf(receipts, stamp_ns);
    if (found != receipts.end()) receipts.erase(receipts.begin(), found + 1);
  }
  return first;
}

}  // namespace tissue_contact
