/// @file
/// Room `ros`, private: joint-state topics on which nothing comes: not yet, or no longer. No ROS and no clock inside.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tissue_contact {

/// How long a driver may be silent, s: slower ones than 2 s are rare, and a busy machine holds none up for as long.
double longestSilence(double max_gap_s);

/// A tool whose driver has died stays where it was, and its forces go on. Not thread-safe.
class TopicSilence {
 public:
  /// @param topics as people know them. @param triggers whether each gives wrenches: others may stay silent from the start.
  /// @param longest_s that a driver may be silent, > 0; one that is slower may be for three times its longest usual interval so far.
  TopicSilence(std::vector<std::string> topics, std::vector<bool> triggers, double longest_s);

  /// A look at when the last joint state of each topic came; for one look a second or so.
  /// @param heard_s per topic, on a clock that never goes back; nothing: never.
  /// @return lines for the log: nothing yet on any topic, or on one while others come; silent now while others come. Each once, the last once
  ///   per silence.
  std::vector<std::string> look(const std::vector<std::optional<double>>& heard_s, double now_s);

  /// Of the topics that have been heard and are silent now, one line; empty if there are none.
  const std::string& summary() const { return summary_; }

 private:
  struct Topic {
    std::string name;
    bool triggers = false;
    std::optional<double> heard_s;  ///< at the look before
    double longest_s = 0.0;         ///< that it may be silent; 0: not known, since it was heard once at most
    bool is_silent = false;  ///< for longer than that, or this process was held up: what ends it is no usual interval
    bool told_of_silence = false;  ///< the present one
    bool told_of_absence = false;  ///< that it was never heard
  };

  void noteHeard(const std::vector<std::optional<double>>& heard_s);
  void noteSilent(double now_s, bool others_come, std::vector<std::string>& lines);
  void noteMissing(double now_s, bool others_come, std::vector<std::string>& lines);

  std::vector<Topic> topics_;
  double longest_s_;
  std::optional<double> began_s_;  ///< first look
  std::optional<double> first_s_;  ///< first look at which some topic had been heard
  std::optional<double> last_s_;   ///< look before
  double apart_s_ = 0.0;           ///< that, and the one before it
  bool told_of_all_ = false;
  std::string summary_;
};

}  // namespace tissue_contact
