/// @file
/// Room `ros`, private: messages that a publisher numbered and that never came: lost in its own queue, or in ours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "tissue_contact/core/text.h"

namespace tissue_contact {

/// Counts the gaps in header.seq, per topic and publisher, and knows the publishers. Not thread-safe.
class SequenceGaps {
 public:
  /// @param publisher its first 100 characters count.
  void note(int topic, const std::string& publisher, std::uint32_t sequence) {
    if (last_.size() > kMostPublishers) last_.clear();  // names come from outside
    const auto [last, is_new] = last_.try_emplace({topic, publisher.substr(0, kLongestName)}, Last{sequence, false});
    const bool goes_on = sequence > last->second.sequence;
    // Backwards: started again, or a bag with numbers of its own; of two publishers, whose numbers rosbag keeps, it then goes ahead again, as it
    // may have before.
    const std::uint32_t ahead = sequence - last->second.sequence;
    if (!is_new && goes_on && !last->second.went_back && ahead <= kMostMissing) missing_ += ahead - 1;
    last->second = {sequence, !is_new && sequence < last->second.sequence};
  }

  std::int64_t missing() const { return missing_; }

  /// "/a, /b": some of those heard on the topic.
  std::string publishers(int topic) const {
    std::string text;
    int named = 0;
    for (auto at = last_.lower_bound({topic, ""}); at != last_.end() && at->first.first == topic && named < 4; ++at) {
      text += (named++ > 0 ? ", " : "") + printable(at->first.second, kLongestName);
    }
    return text;
  }

 private:
  static constexpr std::uint32_t kMostMissing = 100'000;  // at once: of a driver at 1 kHz 100 s
  struct Last {
    std::uint32_t sequence;
    bool went_back;
  };

  static constexpr std::size_t kMostPublishers = 1000;
  static constexpr std::size_t kLongestName = 100;
  std::map<std::pair<int, std::string>, Last> last_;
  std::int64_t missing_ = 0;
};

}  // namespace tissue_contact
