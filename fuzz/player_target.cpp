/// @file
/// Sequences of joint states, as two drivers or a bag may deliver them, through the player into a small simulator. Every
/// answer must be finite and bounded, every sample counted, and a second run of the same sequence equal to the last bit.
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fuzz/fuzz_support.h"
#include "support/text_scene.h"
#include "tissue_contact/core/content_hash.h"
#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/scene.h"

using namespace tissue_contact;

namespace {

constexpr int kMostRecords = 32;
/// Nodes go no farther than tools and tissue reach, or little. What diverges doubles every few steps.
constexpr double kFartherThanTools = 10.0;
/// Not promised (doc/reliability.md): faster tools throw tissue.
constexpr double kFastestTool = 2.0;  // m/s; real ones move at up to 0.5
/// Twice Young's modulus (LoadWatch::kMostPressure) on the whole surface of the block, 20 x 20 x 10 mm: beyond it a load must
/// be flagged.
constexpr double kMostForce = 2.0 * 5000.0 * 1.6e-3;  // N

const std::string kScene = blockScene("[0.02, 0.02, 0.01]", "[1, 1, 1]") + R"(
instruments:
  - name: left
    robot_description: probe
    base_pose: {position_m: [0, 0, 0.014]}
    joint_state_topics: [/left, {topic: /left_z, triggers: false}]
    tip_link: tip
    contact_links: [tip]
  - {name: right, robot_description: probe, base_pose: {position_m: [0.006, 0, 0.014]}, joint_state_topics: [/right],
     tip_link: tip, contact_links: [tip]}
friction:
  - {instrument: left, tissue: block, static: 0.6, kinetic: 0.4}
step: {max_step_s: 0.005, max_gap_s: 0.02}
solver: {iterations: 10, contact_passes: 5}
)";

/// One record of an input: small changes of its bytes are small changes of the sequence.
struct Record {
  std::uint8_t action = 0;
  std::uint8_t topic = 0;
  std::uint8_t unit = 0;  ///< of the stamp's step; of the positions
  std::uint8_t content = 0;
  std::int16_t step = 0;
  std::int16_t x = 0, y = 0, z = 0;

  explicit Record(fuzz::Bytes& bytes)
      : action(bytes.take<std::uint8_t>()),
        topic(bytes.take<std::uint8_t>()),
        unit(bytes.take<std::uint8_t>()),
        content(bytes.take<std::uint8_t>()),
        step(bytes.take<std::int16_t>()),
        x(bytes.take<std::int16_t>()),
        y(bytes.take<std::int16_t>()),
        z(bytes.take<std::int16_t>()) {}
};

std::int64_t strangeStamp(unsigned which) {
  constexpr std::int64_t kNewest = std::numeric_limits<std::int64_t>::max();
  // The last: seconds and nanoseconds of 0xFFFFFFFF each, the largest that a message can hold.
  constexpr std::int64_t kStamps[] = {0,       -1,          1,       std::numeric_limits<std::int64_t>::min(),
                                      kNewest, kNewest - 1, 1 << 30, 4294967295LL * 1000000000LL + 4294967295LL};
  return kStamps[which % 8];
}

double strangePosition(unsigned which) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kPositions[] = {
      std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity, std::numeric_limits<double>::max(), 1e154,
      std::numeric_limits<double>::lowest(),    5e-324,    3.0};
  return kPositions[which % 8];
}

/// Plays an input once.
class Run {
 public:
  explicit Run(Simulator& simulator) : simulator_(simulator), player_(simulator) {
    limits_.most_steps = kMostSteps;
    player_.setLimits(limits_);
    for (int i = 0; i < static_cast<int>(simulator.instruments().size()); ++i) {
      joints_before_.push_back(simulator.jointPositions(i));
    }
  }

  std::uint64_t play(fuzz::Bytes bytes) {
    for (int k = 0; k < kMostRecords && bytes.left() > 0; ++k) act(Record(bytes));
    player_.finish();
    playAll();
    // Under kNewestState what came late waits for a next moment to be merged into.
    if (player_.policy() == StatePolicy::kEveryState) {
      fuzz::require(player_.waiting() <= updates_, "after the end only joints wait whose topic triggers nothing");
    }
    addCounts();
    return digest_.value();
  }

 private:
  static constexpr int kMostSteps = 8;

  void act(const Record& record) {
    switch (record.action % 16) {
      case 0:
        player_.restart();
        break;
      case 1:
        player_.setPolicy(record.topic % 2 == 0 ? StatePolicy::kEveryState : StatePolicy::kNewestState);
        break;
      case 2:
        setLimits(record);
        break;
      default:
        push(record);
    }
    if (record.action < 240) playAll();  // else several wait, as after a stall
    checkCounts();
  }

  void setLimits(const Record& record) {
    limits_.most_steps = 1 + record.topic % kMostSteps;
    limits_.longest_step_s = record.unit % 2 == 0 ? 0.0 : 0.001 * (1 + record.content % 20);
    limits_.interrupted = nullptr;
    if (record.step > 0) {
      limits_.interrupted = [left = record.step % 16]() mutable { return left-- <= 0; };
    }
    player_.setLimits(limits_);
  }

  void push(const Record& record) {
    constexpr std::int64_t kUnits[] = {1, 1000, 100000, 1000000};  // ns
    std::int64_t& stamp_ns = stamps_ns_[record.topic % 3];
    stamp_ns += record.step * kUnits[record.unit % 4];
    if (record.unit / 4 % 4 == 3) stamp_ns = *std::max_element(std::begin(stamps_ns_), std::end(stamps_ns_));
    const double scale = record.unit >= 192 ? 1e-3 : 1e-6;  // m: 33 m or 33 mm at most
    JointStateSample sample{stamp_ns, {"x", "y", "z"}, {scale * record.x, scale * record.y, scale * record.z}};
    spoil(record, sample);
    player_.push(record.topic % 3, std::move(sample));
    ++pushed_;
    if (!player_.triggers(record.topic % 3)) ++updates_;
  }

  /// Most contents are as they should be.
  void spoil(const Record& record, JointStateSample& sample) {
    const unsigned which = record.content / 16;
    switch (record.content % 16) {
      case 1:
        sample.stamp_ns = strangeStamp(which);
        break;
      case 2:
        sample.positions[which % 3] = strangePosition(which / 2);
        break;
      case 3:
        sample.names.resize(which);
        break;
      case 4:
        sample.names.assign(which % 4, "unknown");
        sample.positions.resize(which % 4);
        break;
      case 5:
        sample.names[which % 3] = sample.names[which / 3 % 3];
        break;
      case 6:
        sample.names.erase(sample.names.begin());
        sample.positions.erase(sample.positions.begin());
        break;
      case 7:
      case 8:
        sample.velocities = {strangePosition(which), 1e-3 * record.x, -1e-3 * record.z};
        was_fast_ = true;  // within an interval, as nobody sees
        break;
      case 9:
        sample.velocities.resize(which, 1e-4 * record.x);
        was_fast_ |= which == sample.names.size();
        break;
      default:
        break;
    }
  }

  template <typename Number>
  void note(Number number) {
    digest_.add(&number, sizeof number);
  }

  void playAll() {
    while (const std::optional<PlayedSample> played = player_.playNext()) {
      checkCounts();
      checkPlayed(*played);
      checkState();
    }
  }

  void checkCounts() const {
    std::int64_t counted = player_.merged() + player_.waiting();
    for (int verdict = 0; verdict < kVerdictCount; ++verdict) counted += player_.count(static_cast<Verdict>(verdict));
    fuzz::require(counted == pushed_, "pushed = accepted + merged + refused + waiting");
  }

  void checkPlayed(const PlayedSample& played) {
    note(static_cast<int>(played.verdict));
    note(played.stamp_ns);
    if (played.verdict != Verdict::kAccepted) {
      fuzz::require(!played.detail.empty() && played.topic >= 0, "a refusal names its topic and why");
      return;
    }
    fuzz::require(played.stamp_ns > 0, "moments have stamps");
    fuzz::require(played.was_reset || played.was_resumed || played.stamp_ns >= last_moment_ns_,
                  "time goes back by a reset only, or from a stamp far off");
    last_moment_ns_ = played.stamp_ns;
    if (played.was_reset) {  // tissue is as at the start, and tools were placed
      was_fast_ = false;
      moment_before_ns_ = last_moment_ns_;
    }
    fuzz::require(!played.interrupted || played.instruments.empty(), "what was interrupted owes no wrench");
    for (const int instrument : played.instruments) note(instrument);
  }

  void watchTools() {
    constexpr double kMaxGap = 0.02;  // s, of the scene: what is longer is simulated as that long
    const double passed_s = std::min(1e-9 * static_cast<double>(last_moment_ns_ - moment_before_ns_), kMaxGap);
    for (int i = 0; i < static_cast<int>(simulator_.instruments().size()); ++i) {
      const VectorX& now = simulator_.jointPositions(i);
      const VectorX before = std::exchange(joints_before_.at(static_cast<std::size_t>(i)), now);
      farthest_m_ = std::max(farthest_m_, now.cwiseAbs().maxCoeff());
      was_fast_ |= passed_s > 0.0 && (now - before).norm() > kFastestTool * passed_s;
    }
    moment_before_ns_ = last_moment_ns_;
  }

  void checkState() {
    watchTools();
    for (int t = 0; t < static_cast<int>(simulator_.tissues().size()); ++t) {
      const NodalVectors& x = simulator_.positions(t);
      const NodalVectors& v = simulator_.velocities(t);
      fuzz::require(x.allFinite() && v.allFinite(), "finite nodes");
      fuzz::require(was_fast_ || x.cwiseAbs().maxCoeff() < kFartherThanTools * farthest_m_, "nodes that stay near");
      for (Eigen::Index i = 0; i < x.size(); ++i) note(x.data()[i]);
      for (Eigen::Index i = 0; i < v.size(); ++i) note(v.data()[i]);
    }
    for (int i = 0; i < static_cast<int>(simulator_.instruments().size()); ++i) {
      const Wrench wrench = simulator_.wrench(i);
      fuzz::require(wrench.force.allFinite() && wrench.torque.allFinite(), "finite wrenches");
      fuzz::require(wrench.force.norm() < kMostForce || simulator_.report().implausible_load.found,
                    "a load that no tissue bears is flagged");
      for (int k = 0; k < 3; ++k) note(wrench.force[k]);
      for (int k = 0; k < 3; ++k) note(wrench.torque[k]);
    }
  }

  void addCounts() {
    for (int verdict = 0; verdict < kVerdictCount; ++verdict) note(player_.count(static_cast<Verdict>(verdict)));
    note(player_.merged());
    note(player_.resets());
    note(player_.gaps());
  }

  Simulator& simulator_;
  JointStatePlayer player_;
  AdvanceLimits limits_;
  ContentHash digest_;  ///< bits of all that came out, in order
  std::int64_t stamps_ns_[3] = {10000000000, 10000000000, 10000000000};
  std::int64_t pushed_ = 0;
  std::int64_t updates_ = 0;  ///< of these, to the topic that only updates
  std::int64_t last_moment_ns_ = 0;
  std::int64_t moment_before_ns_ = 0;
  std::vector<VectorX> joints_before_;
  bool was_fast_ = false;
  double farthest_m_ = 0.03;  ///< of tissue or tools from the origin, so far
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Scene scene = parseScene(kScene, "scene of the fuzz target", {});
  static const SceneEnvironment environment = [] {
    SceneEnvironment made;
    made.urdf_text = [](const std::string&) { return probeUrdf(0.004); };
    return made;
  }();
  Simulator simulator(scene, environment);
  const std::uint64_t first = Run(simulator).play({data, size});
  simulator.reset();
  const std::uint64_t second = Run(simulator).play({data, size});
  fuzz::require(first == second, "the same sequence gives the same bits after a reset");
  return 0;
}
