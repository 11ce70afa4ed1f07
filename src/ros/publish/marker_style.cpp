#include "ros/publish/marker_style.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

/// In the order of SurfaceColor.
constexpr std::array<ColorQuantity, 3> kQuantities = {
    {{"displacement", "displacement_full_scale_m", "m", "displacement, mm", 1e3},
     {"pressure", "pressure_full_scale_pa", "Pa", "contact pressure, kPa", 1e-3},
     {"strain", "strain_full_scale", "", "equivalent strain, %", 100.0}}};

}  // namespace

const ColorQuantity& colorQuantity(SurfaceColor color) { return kQuantities[static_cast<std::size_t>(color)]; }

SurfaceColor toSurfaceColor(const std::string& what, const std::string& name) {
  for (std::size_t i = 0; i < kQuantities.size(); ++i) {
    if (name == kQuantities[i].name) return static_cast<SurfaceColor>(i);
  }
  throw std::invalid_argument(what + " is " + inQuotes(name) +
                              "; it must be displacement, pressure or strain; default displacement");
}

std_msgs::ColorRGBA rgba(float r, float g, float b, float a) {
  std_msgs::ColorRGBA color;
  color.r = r;
  color.g = g;
  color.b = b;
  color.a = a;
  return color;
}

std_msgs::ColorRGBA staticColor() { return rgba(0.1F, 0.45F, 0.95F); }
std_msgs::ColorRGBA kineticColor() { return rgba(0.9F, 0.15F, 0.1F); }
std_msgs::ColorRGBA wordColor() { return rgba(0.45F, 0.45F, 0.48F); }

std_msgs::ColorRGBA scaleColor(double fraction) {
  static constexpr std::array<std::array<double, 3>, 6> kColors = {{{0.95, 0.84, 0.77},
                                                                    {0.95, 0.66, 0.48},
                                                                    {0.89, 0.38, 0.30},
                                                                    {0.72, 0.18, 0.38},
                                                                    {0.48, 0.12, 0.44},
                                                                    {0.25, 0.08, 0.38}}};
  const double position = (fraction > 0.0 ? std::min(fraction, 1.0) : 0.0) * (kColors.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(position), kColors.size() - 2);
  const double part = position - static_cast<double>(low);
  const auto mix = [&](std::size_t c) {
    return static_cast<float>(kColors[low][c] + part * (kColors[low + 1][c] - kColors[low][c]));
  };
  return rgba(mix(0), mix(1), mix(2));
}

double roundUp(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0}) {
    if (value <= step * power * (1.0 + 1e-9)) return step * power;
  }
  return 10.0 * power;
}

void FullScale::take(double value) {
  if (value > value_ && value_ < most_) value_ = roundUp(std::min(value, most_));
}

}  // namespace tissue_contact
