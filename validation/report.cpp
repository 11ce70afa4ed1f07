#include "validation/report.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tissue_contact {

bool Check::passed() const {
  if (!std::isfinite(got) || !std::isfinite(expected)) return false;
  switch (kind) {
    case Kind::kNear:
      return std::abs(got - expected) <= tolerance;
    case Kind::kAtMost:
      return got <= expected;
    case Kind::kAtLeast:
      return got >= expected;
  }
  return false;
}

double ConvergenceStudy::error(const Level& level) const { return std::abs(level.value - limit); }

double ConvergenceStudy::observedOrder() const {
  const auto count = static_cast<double>(levels.size());
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (const Level& level : levels) {
    mean_x += std::log(level.size) / count;
    mean_y += std::log(error(level)) / count;
  }
  double covariance = 0.0;
  double variance = 0.0;
  for (const Level& level : levels) {
    const double x = std::log(level.size) - mean_x;
    covariance += x * (std::log(error(level)) - mean_y);
    variance += x * x;
  }
  const double order = covariance / variance;
  return std::isfinite(order) ? order : std::numeric_limits<double>::quiet_NaN();
}

void Report::near(const std::string& quantity, const std::string& unit, double expected, double got, double tolerance,
                  const std::string& source) {
  checks_.push_back({quantity, unit, Check::Kind::kNear, expected, got, tolerance, source});
}

void Report::atMost(const std::string& quantity, const std::string& unit, double bound, double got,
                    const std::string& source) {
  checks_.push_back({quantity, unit, Check::Kind::kAtMost, bound, got, 0.0, source});
}

void Report::atLeast(const std::string& quantity, const std::string& unit, double bound, double got,
                     const std::string& source) {
  checks_.push_back({quantity, unit, Check::Kind::kAtLeast, bound, got, 0.0, source});
}

void Report::require(const std::string& statement, bool holds, const std::string& source) {
  checks_.push_back({statement, "", Check::Kind::kNear, 1.0, holds ? 1.0 : 0.0, 0.0, source});
}

void Report::convergence(ConvergenceStudy study) { studies_.push_back(std::move(study)); }

void Report::note(const std::string& text) { notes_.push_back(text); }

void Report::progress(double share) const {
  if (progress_) progress_(share);
}

bool Report::passed() const {
  return !checks_.empty() && std::all_of(checks_.begin(), checks_.end(), [](const Check& c) { return c.passed(); });
}

}  // namespace tissue_contact
