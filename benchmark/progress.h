/// @file
/// Room `benchmark`: how far a long run is, for people: a bar with the time left on a terminal, nothing elsewhere.
#pragma once

#include <chrono>
#include <ostream>
#include <string>

namespace tissue_contact {

class Progress {
 public:
  /// @param bar where the bar goes; null: nowhere. @param work in all, in any unit.
  Progress(std::ostream* bar, double work) : bar_(bar), work_(work), start_(std::chrono::steady_clock::now()) {}
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// A part of that much work begins.
  void begin(const std::string& what, double work);
  void at(double share);  ///< of that part, 0 to 1
  void end();
  void clear();  ///< takes the bar away, so that a line can be printed

 private:
  std::ostream* bar_;
  double work_;
  double done_ = 0.0;
  double part_ = 0.0;
  std::string what_;
  std::chrono::steady_clock::time_point start_, shown_;
};

}  // namespace tissue_contact
