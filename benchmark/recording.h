/// @file
/// Room `benchmark`: a recording as a motion: joint states of a bag played into a simulator as node and replay do.
#pragma once

#include <string>
#include <vector>

#include "benchmark/run.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

/// Part of a bag, s from its first joint state; duration 0: to the end.
struct TimeWindow {
  double from_s = 0.0;
  double duration_s = 0.0;
};

/// Joint states held in memory, so that reading costs no step time.
struct Recording {
  struct Entry {
    int topic;
    JointStateSample sample;
  };
  std::vector<Entry> entries;
  double duration_s = 0.0;
  std::vector<std::string> missing_topics;
};

/// @throws std::runtime_error naming the bag when it cannot be read, has none of the topics, or nothing in the window.
Recording readRecording(const std::string& bag_file, const Scene& scene, const TimeWindow& window);

/// Samples once per accepted joint state; times are s since the first of the recording.
/// @throws std::runtime_error when none is accepted, saying why the first was refused.
Motion playRecording(Recording recording);

}  // namespace tissue_contact
