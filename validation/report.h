/// @file
/// Room `validation`: what a validation case finds. Expected and computed numbers in; checks, convergence studies and
/// their verdicts out.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace tissue_contact {

/// One number against what it should be.
struct Check {
  enum class Kind { kNear, kAtMost, kAtLeast };
  std::string quantity;  ///< what, in words that name the physics
  std::string unit;      ///< empty: dimensionless
  Kind kind = Kind::kNear;
  double expected = 0.0;  ///< kAtMost, kAtLeast: the bound
  double got = 0.0;
  double tolerance = 0.0;  ///< kNear: absolute, in `unit`; else 0
  std::string source;      ///< where the expected number or the bound comes from

  /// False for anything that is not finite.
  bool passed() const;
};

/// One quantity over mesh sizes, steps or iterations.
struct ConvergenceStudy {
  struct Level {
    double size = 0.0;   ///< mesh size (m), step (s) or 1 / iterations
    double value = 0.0;  ///< of the quantity
  };
  std::string quantity;
  std::string unit;
  std::string parameter;  ///< what `size` is, with unit
  std::vector<Level> levels;
  double limit = 0.0;  ///< what the values should approach

  double error(const Level& level) const;  ///< |value - limit|

  /// p of error ~ size^p: slope of the least-squares line through (log size, log error). NaN with fewer than two levels
  /// or an error of 0.
  double observedOrder() const;
};

/// Collects what one case finds, in order. Notes are facts without a verdict.
class Report {
 public:
  /// @param progress called with the done share of the case, 0 to 1; may be empty.
  explicit Report(std::function<void(double)> progress = {}) : progress_(std::move(progress)) {}

  void near(const std::string& quantity, const std::string& unit, double expected, double got, double tolerance,
            const std::string& source);
  void atMost(const std::string& quantity, const std::string& unit, double bound, double got,
              const std::string& source);
  void atLeast(const std::string& quantity, const std::string& unit, double bound, double got,
               const std::string& source);
  /// A yes or no: recorded as 1 expected, 1 or 0 got.
  void require(const std::string& statement, bool holds, const std::string& source);
  void convergence(ConvergenceStudy study);
  void note(const std::string& text);
  void progress(double share) const;

  const std::vector<Check>& checks() const { return checks_; }
  const std::vector<ConvergenceStudy>& studies() const { return studies_; }
  const std::vector<std::string>& notes() const { return notes_; }

  /// At least one check, and all of them passed.
  bool passed() const;

 private:
  std::function<void(double)> progress_;
  std::vector<Check> checks_;
  std::vector<ConvergenceStudy> studies_;
  std::vector<std::string> notes_;
};

}  // namespace tissue_contact
