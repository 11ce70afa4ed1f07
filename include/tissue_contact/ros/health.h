/// @file
/// Room `ros`: what goes wrong while running: counted, told to /diagnostics and, sparingly, to the console.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

class Health {
 public:
  /// @param simulator and @param player must outlive this.
  Health(const Simulator& simulator, const JointStatePlayer& player) : simulator_(simulator), player_(player) {}

  /// Notes one played sample. Warns about each kind of refusal, and about gaps and jumps, at most every 5 s of wall
  /// time; about every reset once; reports an error when a step gave no finite answer, once until the next reset.
  /// @param stepped whether this sample moved the simulator forward. @return whether the result is finite and so may
  ///   be published.
  bool note(const PlayedSample& played, bool stepped);

  /// Summary and counts. OK; WARN when a joint state was refused, or a gap or jump was cut short, since the last call;
  /// ERROR when a step gave no finite answer since the last reset. Steps that used up their iterations are counted but
  /// are no alarm: a fixed budget per step is how the solver keeps real time.
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  using Clock = std::chrono::steady_clock;
  /// Lets a warning through at most every 5 s of wall time.
  class Throttle {
   public:
    bool pass();

   private:
    std::optional<Clock::time_point> last_;
  };

  void warn(const PlayedSample& played);
  void noteStep(const PlayedSample& played, bool finite);
  std::int64_t troubles() const;

  const Simulator& simulator_;
  const JointStatePlayer& player_;
  std::array<Throttle, kVerdictCount> refusals_;
  Throttle gaps_;
  Throttle jumps_;
  std::int64_t jump_count_ = 0;           ///< intervals in which an instrument moved too far for sub-stepping
  std::int64_t not_finite_count_ = 0;     ///< intervals whose result was not finite
  std::int64_t not_converged_count_ = 0;  ///< intervals whose last step missed the tolerance
  std::string last_not_converged_ = "never";
  bool broken_ = false;  ///< not finite since the last reset
  std::int64_t troubles_told_ = 0;
};

}  // namespace tissue_contact
