/// @file
/// Room `ros/replay`, private: Ctrl-C and SIGTERM, asked for where work can be put away. Signals in; a flag and an exception out.
#pragma once

#include <stdexcept>

namespace tissue_contact {

/// The run was ended by a signal, and what there is of its results is where it belongs.
class Interrupted : public std::runtime_error {
 public:
  explicit Interrupted(int signal) : std::runtime_error("interrupted"), signal_(signal) {}
  int signal() const { return signal_; }

 private:
  int signal_;
};

/// While it lives the first SIGINT or SIGTERM is noted; the second ends the process, as does one before or after. One at a time.
class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  /// Number of the signal that came; 0: none.
  static int signal();
};

}  // namespace tissue_contact
