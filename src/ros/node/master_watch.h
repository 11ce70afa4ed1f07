/// @file
/// Room `ros`, private: notices that the ROS master is gone, or is another one that does not know this node, and registers again.
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace tissue_contact {

/// roscpp registers topics once and never looks again, so after a restart of the master nobody would find this node. A
/// thread asks the master for this node every second; where it does not know it, all that roscpp advertises and
/// subscribes to is registered once more, by the same calls to the master that roscpp makes itself. Connections that
/// live are kept. What the parameter server held is not put back.
class MasterWatch {
 public:
  MasterWatch() = default;
  ~MasterWatch() { stop(); }
  MasterWatch(const MasterWatch&) = delete;
  MasterWatch& operator=(const MasterWatch&) = delete;

  /// @param services names, from / on, of those that this program offers beside the two of every node: roscpp does not tell.
  void start(const std::vector<std::string>& services);
  void stop();

  /// OK while the master knows this node, else WARN; how often it was lost. Any thread.
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status) const;

 private:
  using Clock = std::chrono::steady_clock;

  void run();
  void look();
  void noteKnown(bool known);
  void noteAnswer(bool came);
  bool registerAgain();  ///< @return false: not all of it, to be tried again

  std::set<std::string> services_;
  std::thread thread_;
  std::atomic<bool> stop_{false};

  mutable std::mutex mutex_;  ///< guards all below
  std::condition_variable changed_;
  std::optional<Clock::time_point> lost_;  ///< since when the master has not answered
  bool known_ = true;                      ///< to the master, with all topics; only the thread writes it
  std::int64_t losses_ = 0;
  std::int64_t registrations_ = 0;  ///< after the first
};

}  // namespace tissue_contact
