/// @file
/// Room `ros`: when the joint states that the player holds were received. No ROS inside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace tissue_contact {

/// The player knows no clock, so its caller remembers when each state came. Not thread-safe.
class ReceiptTimes {
 public:
  explicit ReceiptTimes(std::size_t topics) : topics_(topics) {}

  /// A state was handed to the player.
  void note(int topic, std::int64_t stamp_ns, double received_s);

  /// The moment `stamp_ns` was played: when its last state was received; nothing if no state of that stamp is known.
  /// Forgets it and what came before it on the same topics.
  std::optional<double> take(std::int64_t stamp_ns);

 private:
  struct Receipt {
    std::int64_t stamp_ns;
    double received_s;
  };
  std::vector<std::deque<Receipt>> topics_;  ///< in order of arrival
};

}  // namespace tissue_contact
