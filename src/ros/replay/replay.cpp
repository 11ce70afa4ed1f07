#include "ros/replay/replay.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "ros/bag/joint_state_bag.h"
#include "ros/conversions.h"
#include "ros/publish/publish_options.h"
#include "ros/replay/force_error_summary.h"
#include "ros/replay/joint_names.h"
#include "ros/replay/replay_progress.h"
#include "ros/replay/replay_table.h"
#include "scene/read_more.h"
#include "tissue_contact/baselines/delassus.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/core/whole_file.h"
#include "tissue_contact/ros/environment.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/law_error.h"
#include "tissue_contact/simulation/simulator.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kPrefix = "tissue_contact_replay: ";

std::vector<NamedFile> outputsOf(const ReplayOptions& options) {
  return {{"--csv", options.csv_file}, {"--timing", options.timing_file}, {"--dump-file", options.dump_file}};
}

void addMeshes(const std::vector<ShapeDescription>& shapes, const std::string& whose, std::vector<NamedFile>& files) {
  for (const ShapeDescription& shape : shapes) {
    if (const auto* mesh = std::get_if<MeshGeometry>(&shape.geometry)) files.push_back({whose, mesh->file});
  }
}

std::vector<NamedFile> filesOf(const Scene& scene) {
  std::vector<NamedFile> files = {{"--scene", scene.file}};
  for (const TissueDescription& tissue : scene.tissues) {
    const std::string whose = "the scene's tissue mesh";
    if (const auto* mesh = std::get_if<MeshDescription>(&tissue.geometry)) files.push_back({whose, mesh->file});
    if (const auto* shell = std::get_if<ShellDescription>(&tissue.geometry)) files.push_back({whose, shell->file});
  }
  for (const InstrumentDescription& instrument : scene.instruments) {
    files.push_back({"the scene's URDF", instrument.urdf_file});
    for (const ContactLinkDescription& link : instrument.contact_links) {
      addMeshes(link.shapes, "the scene's shape", files);
    }
  }
  return files;
}

/// Reads the scene; refuses a bag that is no regular file, and results that would replace the scene, the bag, a URDF or a
/// mesh the scene names, or each other.
Scene loadReplayedScene(const ReplayOptions& options) {
  requireRegularFile(options.bag_file, "bag");
  requireFreeOutputs(outputsOf(options),
                     {{"--scene", options.scene_file}, {"--bag", options.bag_file}, {"--urdf", options.urdf_file}});
  // Nothing is published here, but a mistake is one wherever the scene is used.
  Scene scene = loadScene(options.scene_file, packagePath, parsePublish);
  requireFreeOutputs(outputsOf(options), filesOf(scene));
  return scene;
}

/// The same for the meshes that the robot models name.
void requireModelsKept(const ReplayOptions& options, const Simulator& simulator) {
  std::vector<NamedFile> meshes;
  for (const Instrument& instrument : simulator.instruments()) {
    for (const RobotModel::Link& link : instrument.model().links()) {
      addMeshes(link.geometry.collision, "the URDF's mesh", meshes);
      addMeshes(link.geometry.visual, "the URDF's mesh", meshes);
    }
  }
  requireFreeOutputs(outputsOf(options), meshes);
}

class Replay {
 public:
  explicit Replay(const ReplayOptions& options)
      : options_(options),
        scene_(loadReplayedScene(options)),
        simulator_(scene_, bagEnvironment(scene_, options.bag_file, options.urdf_file)),
        player_(simulator_),
        joint_names_(simulator_, player_),
        force_errors_(simulator_.instruments().size()) {
    requireModelsKept(options, simulator_);
    for (const std::string& line : simulator_.advice()) std::cerr << kPrefix << "advisor: " << line << "\n";
    simulator_.setStepObserver([this] { stepTaken(); });
  }

  void run() {
    const JointStateBag bag(options_.bag_file, player_.topics());
    if (!bag.missingTopics().empty()) {
      std::cerr << kPrefix << "warning: the bag has no message on " << joinedNames(bag.missingTopics())
                << "; its joints stay where the scene puts them\n";
    }
    ReplayTable table(options_.csv_file);
    if (!options_.timing_file.empty()) timing_.emplace(options_.timing_file);
    if (!options_.dump_file.empty()) dump_.emplace(options_.dump_file);
    start_ = Clock::now();
    length_s_ = bag.end().toSec() - bag.begin().toSec();  // a ros::Duration ends after 68 years
    progress_.emplace(std::cerr, isatty(STDERR_FILENO) == 1, kPrefix, length_s_);
    bag.forEach([&](int topic, JointStateSample sample, ros::Time recorded) {
      played_s_ = recorded.toSec() - bag.begin().toSec();
      joint_names_.note(topic, sample.names);
      player_.push(topic, std::move(sample));
      playAll(table);
    });
    player_.finish();
    playAll(table);
    progress_.reset();
    requireDumped();
    if (player_.count(Verdict::kAccepted) == 0) {
      throw std::runtime_error("no joint state of bag '" + options_.bag_file +
                               "' was accepted; the first was refused: " + first_refusal_);
    }
    table.finish();
    if (timing_) timing_->finish();
    table.commit();
    if (timing_) timing_->commit();
    summarize();
  }

 private:
  double wallTime() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  /// After every implicit step, since one interval may take long.
  void stepTaken() {
    dumpIfWanted();
    if (!touched_) {
      for (const SolvedContact& contact : simulator_.contacts()) {
        touched_ |= contact.contact.key.instrument >= 0 && contact.state != ContactState::kOpen;
      }
    }
    if (progress_) progress_->at(played_s_, wallTime());
  }

  /// Writes the contact problem of the step asked for, the first time it is taken.
  void dumpIfWanted() {
    if (!dump_ || simulator_.stepCount() != options_.dump_step) return;
    writeContactProblem(dump_->stream(), makeDelassusProblem(simulator_.lastProblem()),
                        simulator_.lastSolution().states);
    dump_->commit();
    dump_.reset();
  }

  void requireDumped() const {
    if (!dump_) return;
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
      if (!isFinite(simulator_) || !isFinite(simulator_.residuals())) {
        throw std::runtime_error("the step ending at " + stampText(played->stamp_ns) + " s gave no finite answer");
      }
      if (!touched_) noteApproach(played->stamp_ns);
      table.add(simulator_, *played, steps);
      noteForceErrors(*played);
      if (timing_ && steps > 0) timing_->add(played->stamp_ns, elapsed.count(), steps);
    }
  }

  void noteApproach(std::int64_t stamp_ns) {
    const double before = approach_.distance_m;
    simulator_.lowerClosestApproach(approach_);
    if (approach_.distance_m < before) approach_ns_ = stamp_ns;
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
    pinched_ += static_cast<long>(report.pinched_contacts > 0);
    noteLaw(played);
    noteCells(played);
    if (!report.implausible_load.found) return;
    if (++implausible_ > 1) return;
    std::cerr << kPrefix << "warning: " << stampText(played.stamp_ns) << " s: " << implausibleLoadText(simulator_)
              << "\n";
  }

  void noteLaw(const PlayedSample& played) {
    const LawError& error = simulator_.report().law_error;
    if (law_alarm_.leaves(error.relative) && ++law_alarms_ == 1) {
      std::cerr << kPrefix << "warning: " << stampText(played.stamp_ns) << " s: " << lawErrorText(simulator_) << "\n";
    }
    if (std::abs(error.relative) > std::abs(law_error_.relative)) law_error_ = error;
  }

  /// Of a law that leaves its range in this recording.
  void summarizeLaw() const {
    if (law_alarms_ == 0) return;
    const TissueDescription& tissue = scene_.tissues[static_cast<std::size_t>(law_error_.tissue)];
    std::cerr << kPrefix << "beyond the range of the " << elasticModelName(tissue.material.model) << " law of tissue '"
              << tissue.name << "' " << law_alarms_ << " times: forces likely wrong by up to "
              << 100.0 * law_error_.relative << " %, at a strain of " << law_error_.strain << "\n";
  }

  void noteForceErrors(const PlayedSample& played) {
    for (const int instrument : played.instruments) {
      const auto index = static_cast<std::size_t>(instrument);
      force_errors_[index].add(simulator_.wrench(instrument).force.norm(), simulator_.forceErrors()[index]);
    }
  }

  void summarizeForceErrors() const {
    for (std::size_t i = 0; i < force_errors_.size(); ++i) {
      const std::string text = force_errors_[i].text();
      if (!text.empty())
        std::cerr << kPrefix << "force on '" << simulator_.instruments()[i].name() << "' " << text << "\n";
    }
  }

  void noteCells(const PlayedSample& played) {
    const CoarseCells& cells = simulator_.report().coarse_cells;
    if (cells.tissue < 0) return;
    if (++coarse_ == 1) {
      std::cerr << kPrefix << "warning: " << stampText(played.stamp_ns) << " s: " << coarseCellsText(simulator_)
                << "\n";
    }
    if (cells.factor > coarsest_cells_.factor) coarsest_cells_ = cells;
  }

  /// Of cells that are not as small as the scene asks for.
  void summarizeCells() const {
    if (coarse_ == 0) return;
    std::cerr << kPrefix << "cells of tissue '" << scene_.tissues[static_cast<std::size_t>(coarsest_cells_.tissue)].name
              << "' up to " << coarsest_cells_.factor
              << " times as long as its refinement asks for, to keep to nodes_at_most; such "
              << "cells in " << coarse_ << " intervals\n";
  }

  void summarize() const {
    for (const std::string& line : joint_names_.findings()) std::cerr << kPrefix << "warning: " << line << "\n";
    std::cerr << kPrefix << player_.count(Verdict::kAccepted) << " joint states accepted";
    for (int v = 1; v < kVerdictCount; ++v) {
      const auto verdict = static_cast<Verdict>(v);
      if (player_.count(verdict) > 0) std::cerr << ", " << player_.count(verdict) << " " << verdictText(verdict);
    }
    std::cerr << "; " << player_.resets() << " resets, " << player_.gaps() << " gaps, " << jumps_ << " jumps, "
              << not_converged_ << " intervals not converged, " << discarded_ << " without a finite answer, "
              << implausible_ << " with forces that no tissue bears, " << pinched_ << " with pinched contacts -> "
              << options_.csv_file << "\n"
              << kPrefix << length_s_ << " s of recording in " << wallTime() << " s\n";
    if (!first_refusal_.empty())
      std::cerr << kPrefix << "first refusal in bag '" << options_.bag_file << "': " << first_refusal_ << "\n";
    summarizeForceErrors();
    summarizeLaw();
    summarizeCells();
    if (!touched_) summarizeApproach();
  }

  /// Most often a pose in the scene is wrong, so say how far and between what.
  void summarizeApproach() const {
    std::cerr << kPrefix << "no instrument touched tissue";
    if (approach_.instrument >= 0) {
      const Instrument& instrument = simulator_.instruments()[static_cast<std::size_t>(approach_.instrument)];
      const ContactLink& link = instrument.contactLinks()[static_cast<std::size_t>(approach_.link)];
      std::cerr << "; closest approach " << approach_.distance_m << " m at " << stampText(approach_ns_) << " s: '"
                << instrument.name() << "', link '"
                << instrument.model().links()[static_cast<std::size_t>(link.link)].name << "', shape "
                << approach_.shape + 1 << " of " << link.shapes.size() << ", to tissue '"
                << scene_.tissues[static_cast<std::size_t>(approach_.tissue)].name
                << "'; check base_pose and the tissue's pose";
    }
    std::cerr << "\n";
  }

  ReplayOptions options_;
  Scene scene_;
  Simulator simulator_;
  JointStatePlayer player_;
  JointNames joint_names_;
  std::optional<TimingTable> timing_;
  std::optional<WholeFile> dump_;  ///< until it is written
  std::optional<ReplayProgress> progress_;
  Clock::time_point start_;
  double length_s_ = 0.0;  ///< of the recording
  double played_s_ = 0.0;  ///< how much of it is played
  bool touched_ = false;   ///< an instrument has, since the start
  Approach approach_;      ///< until then
  std::int64_t approach_ns_ = 0;
  std::string first_refusal_;
  long jumps_ = 0;
  long discarded_ = 0;
  long not_converged_ = 0;
  long implausible_ = 0;
  long pinched_ = 0;
  std::vector<ForceErrorSummary> force_errors_;  ///< per instrument
  LawAlarm law_alarm_;
  long law_alarms_ = 0;  ///< how often the law left its range
  LawError law_error_;   ///< largest
  long coarse_ = 0;      ///< intervals with cells longer than asked for
  CoarseCells coarsest_cells_;
};

}  // namespace

void replay(const ReplayOptions& options) { Replay(options).run(); }

int runReplay(int argc, char** argv) {
  try {
    const ReplayOptions options = parseReplayOptions({argv + 1, argv + argc});
    if (options.help) {
      std::cout << replayUsage();
      requireWritten(std::cout);
    } else {
      replay(options);
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << kPrefix << error.what() << "\n";
    return 1;
  }
}

}  // namespace tissue_contact
