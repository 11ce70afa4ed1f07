#include "benchmark/measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "tissue_contact/core/check.h"
#include "tissue_contact/core/range.h"

namespace tissue_contact {

WrenchError wrenchError(const Run& run, const Run& reference, int instrument) {
  const std::size_t samples = std::min(run.times_s.size(), reference.times_s.size());
  const double per_lever = reference.lever_m > 0.0 ? 1.0 / reference.lever_m : 0.0;
  double torque_difference2 = 0.0;
  double torque2 = 0.0;
  double force_difference2 = 0.0;
  double force2 = 0.0;
  for (std::size_t k = 0; k < samples; ++k) {
    // Stamps are nanoseconds: half of one tells them apart.
    if (!(std::abs(run.times_s[k] - reference.times_s[k]) < 5e-10) ||
        run.wrenches[k].size() != reference.wrenches[k].size()) {
      throw std::invalid_argument("the runs to compare were sampled at different times or of different instruments");
    }
    for (std::size_t i = 0; i < run.wrenches[k].size(); ++i) {
      if (instrument >= 0 && i != static_cast<std::size_t>(instrument)) continue;
      const Wrench& w = run.wrenches[k][i];
      const Wrench& w_ref = reference.wrenches[k][i];
      force_difference2 += (w.force - w_ref.force).squaredNorm();
      force2 += w_ref.force.squaredNorm();
      torque_difference2 += (w.torque - w_ref.torque).squaredNorm();
      torque2 += w_ref.torque.squaredNorm();
    }
  }
  const auto count = static_cast<double>(std::max<std::size_t>(samples, 1));
  const double difference = std::sqrt(force_difference2 + per_lever * per_lever * torque_difference2);
  const double size = std::sqrt(force2 + per_lever * per_lever * torque2);
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  return {size > 0.0 ? difference / size : nothing, std::sqrt(force_difference2 / count),
          std::sqrt(torque_difference2 / count), std::sqrt(force2 / count)};
}

StepTimes stepTimes(std::vector<double> step_s) {
  step_s.erase(std::remove_if(step_s.begin(), step_s.end(), [](double t) { return !std::isfinite(t); }), step_s.end());
  if (step_s.empty()) return {};
  std::sort(step_s.begin(), step_s.end());
  return {step_s[step_s.size() / 2], step_s[step_s.size() * 99 / 100], step_s.back()};
}

std::vector<std::size_t> paretoFront(const std::vector<double>& times, const std::vector<double>& errors) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (std::isfinite(times[i]) && std::isfinite(errors[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return times[a] != times[b] ? times[a] < times[b] : errors[a] < errors[b];
  });
  std::vector<std::size_t> front;
  for (const std::size_t i : order) {
    if (front.empty() || errors[i] < errors[front.back()]) front.push_back(i);
  }
  return front;
}

bool onFront(double time, double error, const std::vector<double>& times, const std::vector<double>& errors,
             double noise) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (times[i] < (1.0 - noise) * time && errors[i] <= error) return false;
  }
  return std::isfinite(time) && std::isfinite(error);
}

double richardsonError(double difference, double ratio, double order) {
  return difference / (std::pow(Range{1.0, 1e6, "", "", true, true}.require("ratio of sizes", ratio),
                                requirePositive("order", order)) -
                       1.0);
}

}  // namespace tissue_contact
