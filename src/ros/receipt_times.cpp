/// @file
/// Room `ros`: see receipt_times.h.
#include "tissue_contact/ros/receipt_times.h"

#include <algorithm>

#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

void ReceiptTimes::note(int topic, std::int64_t stamp_ns, double received_s) {
  std::deque<Receipt>& receipts = topics_[static_cast<std::size_t>(topic)];
  receipts.push_back({stamp_ns, received_s});
  // The player lets no more wait; what it refused is forgotten here with the next that it plays, or so.
  if (receipts.size() > JointStatePlayer::kMaxWaiting) receipts.pop_front();
}

std::optional<double> ReceiptTimes::take(std::int64_t stamp_ns) {
  std::optional<double> last;
  for (std::deque<Receipt>& receipts : topics_) {
    // Refused ones and those of older moments, in the order they came unless time went backwards.
    while (!receipts.empty() && receipts.front().stamp_ns < stamp_ns) receipts.pop_front();
    const auto found = std::find_if(receipts.begin(), receipts.end(),
                                    [stamp_ns](const Receipt& receipt) { return receipt.stamp_ns == stamp_ns; });
    if (found == receipts.end()) continue;
    last = std::max(last.value_or(found->received_s), found->received_s);
    receipts.erase(receipts.begin(), found + 1);
  }
  return last;
}

}  // namespace tissue_contact
