#include "ros/replay/replay.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <exception>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ros/approach_text.h"
#include "ros/bag/bag_frames.h"
#include "ros/bag/joint_state_bag.h"
#include "ros/bag/recorded_changes.h"
#include "ros/conversions.h"
#include "ros/frame_motion.h"
#include "ros/joint_watch.h"
#include "ros/replay/bag_recorder.h"
#include "ros/replay/interruption.h"
#include "ros/replay/manifest.h"
#include "ros/replay/replay_batch.h"
#include "ros/replay/replay_files.h"
#include "ros/replay/replay_findings.h"
#include "ros/replay/replay_progress.h"
#include "ros/replay/replay_table.h"
#include "ros/run_script.h"
#include "tissue_contact/baselines/delassus.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/core/whole_file.h"
#include "tissue_contact/mesh/gmsh_version.h"
#include "tissue_contact/ros/environment.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {
namespace {

using Clock = std::chrono::steady_clock;

using MomentObserver = std::function<void(const Simulator&, const PlayedSample&, long steps)>;

constexpr const char* kPrefix = "tissue_contact_replay: ";

class Replay {
 public:
  Replay(const ReplayOptions& options, std::ostream& log, MomentObserver observe)
      : options_(options),
        log_(log),
        observe_(std::move(observe)),
        scene_(loadReplayedScene(options, publish_)),
        simulator_(scene_, bagEnvironment(scene_, options.bag_file, options.urdf_file)),
        player_(simulator_),
        joint_watch_(simulator_, player_, scene_.step.max_gap_s),
        findings_(simulator_, log, kPrefix) {
    requireModelsKept(options, simulator_);
    for (const Advice& advice : simulator_.advice()) {
      log_ << kPrefix << (advice.is_warning ? "warning: " : "") << "advisor: " << advice.text << "\n";
    }
    simulator_.setStepObserver([this] { stepTaken(); });
  }

  void run() {
    const JointStateBag bag(options_.bag_file, player_.topics());
    if (!bag.missingTopics().empty()) {
      log_ << kPrefix << "warning: the bag has no message on " << joinedNames(bag.missingTopics())
           << "; its joints stay where the scene puts them\n";
    }
    if (options_.changes_topic != "none") {
      changes_.emplace(options_.bag_file, options_.changes_topic, scene_, bag.begin());
    }
    const BagWindow window = windowOf(bag);
    openResults();
    try {
      play(bag, window);
      commitResults();
    } catch (...) {
      progress_.reset();
      keepPartial();
      throw;
    }
    summarize();
    if (options_.plot_folder.empty()) return;
    std::vector<std::string> arguments = {"--bag", options_.out_file, "--output", options_.plot_folder};
    if (!setsFriction()) arguments.insert(arguments.end(), {"--scene", options_.scene_file});
    runScript("plot_forces.py", arguments);
  }

 private:
  /// The part of the recording that --from and --duration choose.
  BagWindow windowOf(const JointStateBag& bag) {
    constexpr double kNanoseconds = 1e9;
    const auto begin_ns = static_cast<std::int64_t>(bag.begin().toNSec());
    const auto end_ns = static_cast<std::int64_t>(bag.end().toNSec());
    const double length_s = static_cast<double>(end_ns - begin_ns) / kNanoseconds;
    if (options_.from_s > length_s) {
      std::ostringstream text;
      text << "--from " << options_.from_s << ": the joint states of bag '" << options_.bag_file << "' last only "
           << length_s << " s";
      throw std::invalid_argument(text.str());
    }
    const std::int64_t from_ns = begin_ns + std::llround(options_.from_s * kNanoseconds);
    length_s_ = std::min(length_s - options_.from_s, options_.duration_s);
    if (options_.from_s > 0.0) {
      log_ << kPrefix << "begins " << options_.from_s
           << " s into the recording with undeformed tissue, as if there were nothing before\n";
    }
    const bool to_the_end = !(options_.duration_s < length_s - options_.from_s);  // exactly, however long it is
    return {toTime(from_ns), toTime(to_the_end ? end_ns : from_ns + std::llround(options_.duration_s * kNanoseconds))};
  }

  void openResults() {
    if (!options_.csv_file.empty()) table_.emplace(options_.csv_file);
    if (!options_.timing_file.empty()) timing_.emplace(options_.timing_file);
    if (!options_.dump_file.empty()) dump_.emplace(options_.dump_file);
    if (!options_.manifest_file.empty()) manifest_.emplace(options_.manifest_file);
    if (options_.out_file.empty()) return;
    recorder_ = std::make_unique<BagRecorder>(options_.out_file, simulator_, player_, publish_);
    AdvanceLimits limits;
    limits.interrupted = [] { return SignalWatch::signal() != 0; };
    player_.setLimits(limits);
    watch_.emplace();
  }

  void play(const JointStateBag& bag, const BagWindow& window) {
    start_ = Clock::now();
    progress_.emplace(log_, &log_ == &std::cerr && isatty(STDERR_FILENO) == 1, kPrefix, length_s_);
    const auto take = [&](int topic, JointStateSample sample, ros::Time recorded) {
      played_s_ = recorded.toSec() - window.from.toSec();  // a ros::Duration ends after 68 years
      recorded_ = recorded;
      joint_watch_.note(topic, sample, 1e-9 * static_cast<double>(sample.stamp_ns));
      player_.push(topic, std::move(sample));
      playAll();
    };
    bag.forEach(take, window);
    player_.finish();
    playAll();
    progress_.reset();
  }

  void commitResults() {
    requireDumped();
    if (recorded_.isZero()) throw std::runtime_error("no joint state was recorded between --from and its --duration");
    if (player_.count(Verdict::kAccepted) == 0) {
      throw std::runtime_error(nothingPlayed(options_.bag_file, findings_.firstRefusal()));
    }
    if (table_) table_->finish();
    if (timing_) timing_->finish();
    if (recorder_) recorder_->finish();
    if (manifest_) describe();
    if (table_) table_->commit();
    if (timing_) timing_->commit();
    if (recorder_) recorder_->commit();
    if (manifest_) manifest_->commit();  // last: it is of results that are there
    watch_.reset();
  }

  /// Into the manifest, while the results wait for their names.
  void describe() {
    ManifestContent content;
    content.inputs = inputFiles(options_, simulator_);
    if (fillsMesh(simulator_.scene())) content.gmsh = gmshVersion();  // a kept mesh is of this version too
    if (table_) content.results.push_back({"--csv", options_.csv_file, table_->path()});
    if (recorder_) content.results.push_back({"--out", options_.out_file, recorder_->path()});
    for (int v = 0; v < kVerdictCount; ++v) {
      const auto verdict = static_cast<Verdict>(v);
      content.counts.emplace_back(std::string("joint states: ") + verdictText(verdict), player_.count(verdict));
    }
    const auto findings = findings_.counts();
    content.counts.insert(content.counts.end(), {{"steps since the last reset", simulator_.stepCount()},
                                                 {"resets", player_.resets()},
                                                 {"gaps", player_.gaps()}});
    content.counts.insert(content.counts.end(), findings.begin(), findings.end());
    writeManifest(manifest_->stream(), options_, content);
    manifest_->finish();
  }

  /// Of what was recorded before the replay ended early.
  void keepPartial() {
    if (!recorder_) return;
    try {
      if (!recorder_->commitPartial()) return;
      log_ << kPrefix << "ended after " << played_s_ << " s of " << length_s_ << " s; what was recorded is in '"
           << options_.out_file << WholeFile::kPartialEnding << "'\n";
    } catch (const std::exception& error) {
      log_ << kPrefix << error.what() << "\n";
    }
  }

  /// Then the coefficients in the scene's file are not those that were played with.
  bool setsFriction() const {
    return std::any_of(options_.settings.begin(), options_.settings.end(),
                       [](const std::string& setting) { return setting.rfind("friction", 0) == 0; });
  }

  double wallTime() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  /// After every implicit step, since one interval may take long.
  void stepTaken() {
    dumpIfWanted();
    if (!touched_) {
      touched_ = touchesTissue(simulator_);
      if (beganInContact(simulator_, approach_)) {
        log_ << kPrefix << "warning: an instrument touches tissue where "
             << (options_.from_s > 0.0 ? "--from" : "the recording") << " begins, and what it did to it before is "
             << "missing: it is taken as undeformed there; begin before it touches\n";
      }
    }
    if (progress_) progress_->at(played_s_, wallTime());
  }

  /// Writes the contact problem of the step asked for, the first time it is taken.
  void dumpIfWanted() {
    if (!dump_ || simulator_.stepCount() != options_.dump_step) return;
    if (simulator_.contacts().empty()) {
      log_ << kPrefix << "warning: --dump-step " << options_.dump_step
           << ": nothing touches in that step, so its problem has no contact to solve; ask for a later one\n";
    }
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

  void playAll() {
    while (true) {
      if (watch_ && SignalWatch::signal() != 0) throw Interrupted(SignalWatch::signal());
      retune();
      const long steps_before = simulator_.stepCount();
      const Clock::time_point start = Clock::now();
      const auto played = player_.playNext();
      if (!played) return;
      if (played->interrupted) continue;
      const std::chrono::duration<double> elapsed = Clock::now() - start;
      const long steps = simulator_.stepCount() - (played->was_reset ? 0 : steps_before);
      findings_.note(*played, steps);
      if (played->verdict != Verdict::kAccepted) continue;
      joint_watch_.notePlayed();
      played_ns_ = played->stamp_ns;
      if (!isFinite(simulator_) || !isFinite(simulator_.residuals())) {
        throw std::runtime_error("the step ending at " + stampText(played->stamp_ns) + " s gave no finite answer");
      }
      if (!touched_) noteApproach(played->stamp_ns);
      if (table_) table_->add(simulator_, *played, steps);
      if (observe_) observe_(simulator_, *played, steps);
      if (recorder_) recorder_->record(*played, static_cast<int>(steps), recorded_);
      findings_.noteForceErrors(*played);
      if (timing_ && steps > 0) timing_->add(played->stamp_ns, elapsed.count(), steps);
    }
  }

  /// At the moments at which the node was told to.
  void retune() {
    if (!changes_) return;
    const std::int64_t next_ns = player_.nextStamp().value_or(0);
    while (const std::optional<Scene> changed = changes_->takeDue(player_.resets(), played_ns_, next_ns)) {
      simulator_.retune(*changed);
    }
  }

  void summarizeChanges() const {
    if (!changes_ || changes_->count() == 0) return;
    log_ << kPrefix << (changes_->taken() < changes_->count() ? "warning: " : "") << changes_->taken() << " of "
         << changes_->count() << " changes of the scene's numbers played back"
         << (changes_->taken() < changes_->count() ? "; the others belong to moments that it does not have\n" : "\n");
  }

  void noteApproach(std::int64_t stamp_ns) {
    const double before = approach_.distance_m;
    simulator_.lowerClosestApproach(approach_);
    if (approach_.distance_m < before) approach_ns_ = stamp_ns;
  }

  void summarize() const {
    for (const std::string& line : joint_watch_.findings()) log_ << kPrefix << "warning: " << line << "\n";
    summarizeFrames();
    log_ << kPrefix << player_.count(Verdict::kAccepted) << " joint states accepted";
    for (int v = 1; v < kVerdictCount; ++v) {
      const auto verdict = static_cast<Verdict>(v);
      if (player_.count(verdict) > 0) log_ << ", " << player_.count(verdict) << " " << verdictText(verdict);
    }
    if (player_.waiting() > 0) log_ << ", " << player_.waiting() << " later than the last that gives a wrench";
    if (player_.merged() > 0) log_ << ", " << player_.merged() << " merged into the next of their topic";
    log_ << "; " << player_.resets() << " resets, " << player_.gaps() << " gaps, " << findings_.countsText() << " -> "
         << options_.csv_file << (table_ && recorder_ ? ", " : "") << options_.out_file << "\n"
         << kPrefix << length_s_ << " s of recording in " << wallTime() << " s\n";
    if (!findings_.firstRefusal().empty()) {
      log_ << kPrefix << "first refusal in bag '" << options_.bag_file << "': " << findings_.firstRefusal() << "\n";
    }
    summarizeChanges();
    findings_.summarize();
    if (!touched_) summarizeApproach();
  }

  /// Results are there by now: a bag whose tf ends in nonsense does not take them back.
  void summarizeFrames() const {
    for (const std::string& frame : framesOf(scene_)) {
      try {
        const FrameMotion motion = farthestInBag(frame, scene_.world_frame, options_.bag_file, recorded_);
        if (motion.counts()) log_ << kPrefix << "warning: " << frameMotionText(frame, motion) << "\n";
      } catch (const std::exception& error) {
        log_ << kPrefix << "warning: whether tf frame '" << frame << "' moves is not known: " << error.what() << "\n";
      }
    }
  }

  /// Most often a pose in the scene is wrong, so say how far and between what.
  void summarizeApproach() const {
    log_ << kPrefix << "no instrument touched tissue";
    if (approach_.instrument >= 0 && approach_.distance_m < 0.0) {
      const Instrument& tool = simulator_.instruments()[static_cast<std::size_t>(approach_.instrument)];
      log_ << "; '" << tool.name() << "' is up to " << -approach_.distance_m
           << " m inside it, from where nothing pushes it out: "
           << "a tool must begin outside; check base_pose and the tissue's pose";
    } else if (approach_.instrument >= 0) {
      log_ << "; " << approachText(simulator_, approach_, approach_ns_) << "; check base_pose and the tissue's pose";
    }
    log_ << "\n";
  }

  ReplayOptions options_;
  std::ostream& log_;
  MomentObserver observe_;  ///< null: nobody
  PublishOptions publish_;
  Scene scene_;
  Simulator simulator_;
  JointStatePlayer player_;
  std::optional<RecordedChanges> changes_;
  std::optional<std::int64_t> played_ns_;  ///< stamp of the moment played last
  std::optional<ReplayTable> table_;
  JointWatch joint_watch_;
  ReplayFindings findings_;
  std::optional<TimingTable> timing_;
  std::unique_ptr<BagRecorder> recorder_;
  std::optional<WholeFile> manifest_;
  std::optional<SignalWatch> watch_;  ///< while there is something to be kept
  std::optional<WholeFile> dump_;     ///< until it is written
  std::optional<ReplayProgress> progress_;
  Clock::time_point start_;
  double length_s_ = 0.0;  ///< of what is played of the recording
  double played_s_ = 0.0;  ///< how much of that
  ros::Time recorded_;     ///< the joint state pushed last; zero: none
  bool touched_ = false;   ///< an instrument has, since the start
  Approach approach_;      ///< until then
  std::int64_t approach_ns_ = 0;
};

}  // namespace

void replay(const ReplayOptions& options) { Replay(options, std::cerr, nullptr).run(); }

void replay(const ReplayOptions& options, std::ostream& log, const MomentObserver& observe) {
  Replay(options, log, observe).run();
}

int runReplay(int argc, char** argv) {
  try {
    const ReplayOptions options = parseReplayOptions({argv + 1, argv + argc});
    if (options.help) {
      std::cout << replayUsage();
      requireWritten(std::cout);
    } else if (!options.batch_file.empty()) {
      replayBatch(options.batch_file);
    } else {
      replay(options);
    }
    return 0;
  } catch (const Interrupted& end) {
    std::raise(end.signal());  // as it ends whoever does not wait for it
    return 1;
  } catch (const std::exception& error) {
    std::cerr << kPrefix << error.what() << "\n";
    return 1;
  }
}

}  // namespace tissue_contact
