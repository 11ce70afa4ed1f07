/// @file
/// Room `ros`: see replay.h.
#include "tissue_contact/ros/replay.h"

#include <chrono>
#include <exception>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "tissue_contact/ros/conversions.h"
#include "tissue_contact/ros/environment.h"
#include "tissue_contact/ros/joint_state_bag.h"
#include "tissue_contact/ros/replay_table.h"
#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/simulator.h"
#include "tissue_contact/solver/delassus.h"

namespace tissue_contact {
namespace {

using Clock = std::chrono::steady_clock;

/// Says every few seconds how far a long replay has come, in whole lines that also read well in a log file.
class Progress {
 public:
  Progress(ros::Time begin, ros::Time end) : begin_(begin), length_s_((end - begin).toSec()) {}

  void at(ros::Time time) {
    constexpr std::chrono::seconds kPeriod(3);
    if (Clock::now() - last_ < kPeriod || !(length_s_ > 0.0)) return;
    last_ = Clock::now();
    const auto percent = static_cast<int>(100.0 * (time - begin_).toSec() / length_s_);
    std::cerr << "tissue_contact_replay: " << percent << " % of " << length_s_ << " s\n";
  }

 private:
  ros::Time begin_;
  double length_s_;
  Clock::time_point last_ = Clock::now();
};

class Replay {
 public:
  explicit Replay(const ReplayOptions& options)
      : options_(options),
        scene_(loadScene(options.scene_file, packagePath)),
        simulator_(scene_, bagEnvironment(options.bag_file, options.urdf_file, scene_.world_frame)),
        player_(simulator_) {
    for (const std::string& line : simulator_.advice()) std::cerr << "tissue_contact_replay: advisor: " << line << "\n";
    if (options_.dump_step > 0) simulator_.setStepObserver([this] { dumpIfWanted(); });
  }

  void run() {
    const JointStateBag bag(options_.bag_file, player_.topics());
    if (!bag.missingTopics().empty()) {
      std::cerr << "tissue_contact_replay: warning: the bag has no message on " << joinedNames(bag.missingTopics())
                << "; its joints stay where the scene puts them\n";
    }
    ReplayTable table(options_.csv_file);
    if (!options_.timing_file.empty()) timing_.emplace(options_.timing_file);
    Progress progress(bag.begin(), bag.end());
    bag.forEach([&](int topic, JointStateSample sample, ros::Time recorded) {
      player_.push(topic, std::move(sample));
      playAll(table);
      progress.at(recorded);
    });
    player_.finish();
    playAll(table);
    requireDumped();
    if (player_.count(Verdict::kAccepted) == 0) {
      throw std::runtime_error("no joint state of bag '" + options_.bag_file +
                               "' was accepted; the first was refused: " + first_refusal_);
    }
    if (timing_) timing_->commit();
    table.commit();
    summarize();
  }

 private:
  /// Writes the contact problem of the step asked for, the first time it is taken.
  void dumpIfWanted() {
    if (dumped_ || simulator_.stepCount() != options_.dump_step) return;
    std::ofstream stream(options_.dump_file);
    writeContactProblem(stream, makeDelassusProblem(simulator_.lastProblem()), simulator_.lastSolution().states);
    stream.flush();
    if (!stream) throw std::runtime_error("cannot write '" + options_.dump_file + "'");
    dumped_ = true;
  }

  void requireDumped() const {
    if (options_.dump_step == 0 || dumped_) return;
    throw std::runtime_error("--dump-step " + std::to_string(options_.dump_step) + ": the replay took only " +
                             std::to_string(simulator_.stepCount()) + " steps; ask for one of those");
  }

  void playAll(ReplayTable& table) {
    while (true) {
      const long steps_before = simulator_.stepCount();
      const Clock::time_point start = Clock::now();
      const auto played = player_.playNext();
      if (!played) return;
      const std::chrono::duration<double> elapsed = Clock::now() - start;
      const long steps = simulator_.stepCount() - (played->was_reset ? 0 : steps_before);
      note(*played, steps);
      if (played->verdict != Verdict::kAccepted) continue;
      if (!isFinite(simulator_)) {
        throw std::runtime_error("the step ending at " + stampOf(*played) + " s gave no finite answer");
      }
      table.add(simulator_, *played);
      if (timing_ && steps > 0) timing_->add(played->stamp_ns, elapsed.count(), steps);
    }
  }

  void note(const PlayedSample& played, long steps) {
    if (played.verdict != Verdict::kAccepted && first_refusal_.empty()) {
      first_refusal_ = std::string(verdictText(played.verdict)) + ": " + played.detail;
    }
    if (steps == 0) return;
    const StepReport& report = simulator_.report();
    jumps_ += static_cast<long>(report.jumped);
    discarded_ += static_cast<long>(report.discarded);
    not_converged_ += static_cast<long>(report.stop != StopReason::kTolerance);
  }

  static std::string stampOf(const PlayedSample& played) {
    std::ostringstream text;
    text << toTime(played.stamp_ns);
    return text.str();
  }

  void summarize() const {
    std::cerr << "tissue_contact_replay: " << player_.count(Verdict::kAccepted) << " joint states accepted";
    for (int v = 1; v < kVerdictCount; ++v) {
      const auto verdict = static_cast<Verdict>(v);
      if (player_.count(verdict) > 0) std::cerr << ", " << player_.count(verdict) << " " << verdictText(verdict);
    }
    std::cerr << "; " << player_.resets() << " resets, " << player_.gaps() << " gaps, " << jumps_ << " jumps, "
              << not_converged_ << " intervals not converged, " << discarded_ << " without a finite answer -> "
              << options_.csv_file << "\n";
    if (!first_refusal_.empty()) std::cerr << "tissue_contact_replay: first refusal: " << first_refusal_ << "\n";
  }

  ReplayOptions options_;
  Scene scene_;
  Simulator simulator_;
  JointStatePlayer player_;
  std::optional<TimingTable> timing_;
  std::string first_refusal_;
  bool dumped_ = false;
  long jumps_ = 0;
  long discarded_ = 0;
  long not_converged_ = 0;
};

}  // namespace

void replay(const ReplayOptions& options) { Replay(options).run(); }

int runReplay(int argc, char** argv) {
  try {
    const ReplayOptions options = parseReplayOptions({argv + 1, argv + argc});
    if (options.help) {
      std::cout << replayUsage();
    } else {
      replay(options);
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "tissue_contact_replay: " << error.what() << "\n";
    return 1;
  }
}

}  // namespace tissue_contact
