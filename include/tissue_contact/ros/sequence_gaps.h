/// @file
/// Room `ros`: messages that a publisher numbered and that never came: lost in its own queue, or in ours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace tissue_contact {

/// Counts the gaps in header.seq, per topic and publisher. Not thread-safe.
class SequenceGaps {
 public:
  void note(int topic, const std::string& publisher, std::uint32_t sequence) {
    if (last_.size() > kMostPublishers) last_.clear();  // names come from outside
    const auto [last, is_new] = last_.try_emplace({topic, publisher}, sequence);
    // Backwards: started again, or a bag with numbers of its own.
    if (!is_new && sequence > last->second) missing_ += sequence - last->second - 1;
    last->second = sequence;
  }

  std::int64_t missing() const { return missing_; }

 private:
  static constexpr std::size_t kMostPublishers = 1000;
  std::map<std::pair<int, std::string>, std::uint32_t> last_;
  std::int64_t missing_ = 0;
};

}  // namespace tissue_contact
