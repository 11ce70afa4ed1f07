/// @file
/// Room `ros`, private: how markers are drawn: what colours show and which scales colours and arrows have.
#pragma once

#include <std_msgs/ColorRGBA.h>

#include <string>

namespace tissue_contact {

/// What the colours of a tissue's surface tell.
enum class SurfaceColor { kDisplacement, kPressure, kStrain };

struct ColorQuantity {
  const char* name;        ///< as in the parameter ~markers/color
  const char* full_scale;  ///< parameter below ~markers
  const char* unit;        ///< of that
  const char* title;       ///< of the colour bar, with the unit
  double shown_per_si;     ///< what the bar's unit is of the SI unit
};

const ColorQuantity& colorQuantity(SurfaceColor color);

/// @return the quantity of that name; @throws std::invalid_argument beginning with `what`.
SurfaceColor toSurfaceColor(const std::string& what, const std::string& name);

/// The node's parameters, which `Outputs` checks.
struct MarkerStyle {
  SurfaceColor color = SurfaceColor::kDisplacement;
  double color_full_scale = 0.0;     ///< drawn in the last colour, SI unit; 0: fits what has been drawn so far
  double force_arrow_m_per_n = 0.0;  ///< length of an arrow per newton; 0: likewise
};

/// Light skin (0) over red to dark violet (1), falling in lightness so that it also reads in grey.
/// @param fraction of full scale; values outside 0..1 are drawn as the nearer end.
std_msgs::ColorRGBA scaleColor(double fraction);

std_msgs::ColorRGBA rgba(float r, float g, float b, float a = 1.0F);

// Of forces, by what friction does; and of words. Strong enough for light and for dark backgrounds.
std_msgs::ColorRGBA staticColor();
std_msgs::ColorRGBA kineticColor();
std_msgs::ColorRGBA wordColor();

/// The smallest of 1, 1.5, 2, 3, 4, 6, 8, 10 times a power of ten that is not less than `value`, which is finite and > 0.
double roundUp(double value);

/// The full scale of something drawn again and again: one of roundUp()'s numbers, which grows with the largest value so far and
/// never shrinks, so that a picture does not flicker; or one that is given and stays.
class FullScale {
 public:
  /// @param given > 0: it; 0: grows. @param start, most > 0: from where and how far, so that one wild value does not pale all others.
  FullScale(double given, double start, double most)
      : value_(given > 0.0 ? given : roundUp(start)), most_(given > 0.0 ? given : most) {}

  /// NaN is overlooked.
  void take(double value);
  double value() const { return value_; }

 private:
  double value_;
  double most_;
};

}  // namespace tissue_contact
