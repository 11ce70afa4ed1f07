/// @file
/// Room `ros`, private: when the joint states that the player holds were received. No ROS inside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace tissue_contact {

/// When a joint state came.
struct Receipt {
  std::int64_t stamp_ns = 0;
  double received_s = 0.0;  ///< on a clock that never goes back
  double age_s = 0.0;       ///< wall clock minus stamp, then
};

/// The player knows no clock, so its caller remembers when each state came. Not thread-safe.
class ReceiptTimes {
 public:
  explicit ReceiptTimes(std::size_t topics) : topics_(topics) {}

  /// A state was handed to the player.
  void note(int topic, const Receipt& receipt);

  /// The first receipt of a state of that stamp; nothing if none is known.
  std::optional<Receipt> find(std::int64_t stamp_ns) const;

  /// The same, once the moment `stamp_ns` was played. Forgets it and what came before it on the same topics.
  std::optional<Receipt> take(std::int64_t stamp_ns);

 private:
  std::vector<std::deque<Receipt>> topics_;  ///< in order of arrival
};

}  // namespace tissue_contact
