/// @file
/// Room `ros`, private: what markers need to be read: a colour bar with numbers and unit, the colours of static and kinetic friction,
/// an arrow of a known force; and the place for it, beside the tissues, in sizes that suit the scene.
#pragma once

#include <visualization_msgs/Marker.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "ros/publish/marker_style.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Where the tissues of a scene are at rest, and which way is up in a picture of it.
struct PictureFrame {
  Vector3 low = Vector3::Constant(-0.05);  ///< m, world frame; of a scene without tissue
  Vector3 high = Vector3::Constant(0.05);
  /// Along z: 1 or -1. Against gravity where that is along z; else to where the tips of the instruments are at the start.
  double up = 1.0;
  /// Where it is looked at from: the angle about z in the world frame, rad. Where tips are beside the tissues rather than above them,
  /// from their side, and so that they are on the left.
  double azimuth = 5.3;

  double size() const { return (high - low).norm(); }
  double letter() const { return size() / 24.0; }            ///< scale of texts, m; a capital has three quarters of it
  double longestArrow() const { return 0.3 * size(); }       ///< m
  Vector3 upwards() const { return Vector3(0.0, 0.0, up); }  ///< unit
  Vector3 rightwards() const { return up * Vector3(-std::sin(azimuth), std::cos(azimuth), 0.0); }  ///< unit
  /// From the middle of a text to its left end.
  Vector3 halfWidth(const std::string& text) const;
};

PictureFrame pictureFrame(const Simulator& simulator);

visualization_msgs::Marker newMarker(const Simulator& simulator, const std::string& ns, int id, int type);

/// "0.84 N".
std::string forceText(double force_n);

/// Namespace `legend`. Its markers lie one behind the other in the array of whoever owns it.
class MarkerLegend {
 public:
  /// Appends the markers.
  MarkerLegend(const Simulator& simulator, const PictureFrame& frame, SurfaceColor color,
               std::vector<visualization_msgs::Marker>& markers);

  /// Writes the numbers. @param color_full_scale SI unit.
  void update(double color_full_scale, double force_arrow_m_per_n,
              std::vector<visualization_msgs::Marker>& markers) const;

 private:
  visualization_msgs::Marker& add(int type, std::vector<visualization_msgs::Marker>& markers);
  void addText(const std::string& text, const Vector3& left, const std_msgs::ColorRGBA& color,
               std::vector<visualization_msgs::Marker>& markers);
  /// Of four sides, to be seen from everywhere.
  void addBar(std::vector<visualization_msgs::Marker>& markers);
  Vector3 tickPlace(int tick) const;

  const Simulator& simulator_;
  const PictureFrame frame_;
  const ColorQuantity& quantity_;
  Vector3 foot_;       ///< of the colour bar's left edge
  std::size_t first_;  ///< of the markers
  std::size_t ticks_;  ///< first of the numbers beside the bar, from 0 to full scale
  std::size_t arrow_;  ///< its text follows
};

}  // namespace tissue_contact
