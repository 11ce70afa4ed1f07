/// @file
/// Room `ros`, private: how far an offline replay has come, for a person at a terminal or reading a log.
#pragma once

#include <ostream>
#include <string>

namespace tissue_contact {

/// Per cent of the recording, real-time factor, time left: on a terminal one line that is rewritten every second, in a
/// log whole lines every 10 s. Has no clock of its own: wall times are given, s since the start.
class ReplayProgress {
 public:
  /// @param length_s of the recording; 0: says nothing.
  /// @param prefix begins each line, e.g. the program's name.
  ReplayProgress(std::ostream& out, bool is_terminal, std::string prefix, double length_s);
  /// Takes the line off the terminal.
  ~ReplayProgress();
  ReplayProgress(const ReplayProgress&) = delete;
  ReplayProgress& operator=(const ReplayProgress&) = delete;

  /// @param played_s how much of the recording is played. Cheap when nothing is due; call as often as you like.
  void at(double played_s, double wall_s);

 private:
  std::ostream& out_;
  bool is_terminal_;
  std::string prefix_;
  double length_s_;
  double next_s_;
  bool line_shown_ = false;
};

}  // namespace tissue_contact
