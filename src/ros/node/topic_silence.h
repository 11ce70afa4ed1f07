/// @file
/// Room `ros`, private: joint-state topics on which nothing comes: not yet, or no longer. No ROS and no clock inside.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace tissue_contact {

/// A tool whose driver has died stays where it was, and its forces go on. Not thread-safe.
class TopicSilence {
 public:
  /// @param topics as people know them. @param triggers whether each gives wrenches: others may stay silent from the start.
  /// @param longest_s that a driver may be silent, > 0.
  TopicSilence(std::vector<std::string> topics, std::vector<bool> triggers, double longest_s);

  /// A look at when the last joint state of each topic came; for one look a second or so.
  /// @param heard_s per topic, on a clock that never goes back; nothing: never.
  /// @return lines for the log: nothing yet on any topic, or on one while others come; silent now while others come. Each once, the last once
  ///   per silence.
  std::vector<std::string> look(const std::vector<std::optional<double>>& heard_s, double now_s);

  /// Of the topics that have been heard and are silent now, one line; empty if there are none.
  const std::string& summary() const { return summary_; }

 private:
  void noteMissing(const std::vector<std::optional<double>>& heard_s, double now_s, std::vector<std::string>& lines);

  std::vector<std::string> topics_;
  std::vector<bool> triggers_;
  double longest_s_;
  std::optional<double> began_s_;  ///< first look
  std::vector<bool> told_;         ///< per topic: of its present silence, or that it was never heard
  bool told_of_all_ = false;
  std::string summary_;
};

}  // namespace tissue_contact
