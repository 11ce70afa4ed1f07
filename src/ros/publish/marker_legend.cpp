#include "ros/publish/marker_legend.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "ros/conversions.h"

namespace tissue_contact {
namespace {

using visualization_msgs::Marker;

constexpr int kBarPieces = 5;  // scaleColor() is linear in each
constexpr int kTicks = 3;

// In PictureFrame::letter().
constexpr double kGap = 3.0;  // from the tissues to the left edge
constexpr double kLine = 1.9;
constexpr double kBarWidth = 1.5;
constexpr double kBarHeight = 10.0;
constexpr double kBarFoot = 2.0 * kLine;  // above two lines of words
constexpr double kArrowAside = 7.0;       // right of the numbers

/// "2.5", "0.01": as many digits as roundUp()'s numbers, or halves of them, have.
std::string numberText(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

/// Which way is up, and from where.
void lookAt(const Simulator& simulator, PictureFrame& frame) {
  Vector3 to_tips = Vector3::Zero();
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) {
    const auto tip = static_cast<std::size_t>(simulator.instruments()[i].tipLink());
    to_tips += simulator.linkPoses(static_cast<int>(i))[tip].translation() - 0.5 * (frame.low + frame.high);
  }
  const Vector3& gravity = simulator.scene().gravity_m_per_s2;
  const double above = std::abs(gravity.z()) > 0.5 * gravity.norm() ? -gravity.z() : to_tips.z();
  frame.up = above < 0.0 ? -1.0 : 1.0;
  frame.azimuth *= frame.up;
  if (to_tips.head<2>().norm() < 0.5 * std::abs(to_tips.z())) return;
  constexpr double kAside = 0.7;  // rad: so that tools are seen from the side, and what they touch is seen
  frame.azimuth = std::atan2(to_tips.y(), to_tips.x()) + frame.up * kAside;
}

}  // namespace

Vector3 PictureFrame::halfWidth(const std::string& text) const {
  return 0.27 * letter() * static_cast<double>(text.size()) * rightwards();
}

PictureFrame pictureFrame(const Simulator& simulator) {
  PictureFrame frame;
  bool is_first = true;
  for (const Tissue& tissue : simulator.tissues()) {
    const Vector3 low = tissue.restPositions().rowwise().minCoeff();
    const Vector3 high = tissue.restPositions().rowwise().maxCoeff();
    frame.low = is_first ? low : frame.low.cwiseMin(low).eval();
    frame.high = is_first ? high : frame.high.cwiseMax(high).eval();
    is_first = false;
  }
  lookAt(simulator, frame);
  return frame;
}

Marker newMarker(const Simulator& simulator, const std::string& ns, int id, int type) {
  Marker marker;
  marker.header.frame_id = simulator.scene().world_frame;
  marker.ns = ns;
  marker.id = id;
  marker.type = type;
  marker.pose.orientation.w = 1.0;
  return marker;
}

std::string forceText(double force_n) {
  std::array<char, 64> text{};
  const int decimals = force_n < 0.0995 ? 3 : force_n < 9.95 ? 2 : 1;
  std::snprintf(text.data(), text.size(), "%.*f N", decimals, force_n);
  return text.data();
}

MarkerLegend::MarkerLegend(const Simulator& simulator, const PictureFrame& frame, SurfaceColor color,
                           std::vector<Marker>& markers)
    : simulator_(simulator), frame_(frame), quantity_(colorQuantity(color)), first_(markers.size()) {
  const double a = frame.letter();
  const Vector3 right = frame.rightwards();
  const Vector3 up = frame.upwards();
  // The lower corner of the tissues' box that is farthest right.
  foot_ = Vector3(right.x() > 0.0 ? frame.high.x() : frame.low.x(), right.y() > 0.0 ? frame.high.y() : frame.low.y(),
                  up.z() > 0.0 ? frame.low.z() : frame.high.z()) +
          kGap * a * right;
  addText(quantity_.title, foot_ + (kBarFoot + kBarHeight + kLine) * a * up, wordColor(), markers);
  addBar(markers);
  addText("kinetic: slides", foot_ + 0.5 * a * up, kineticColor(), markers);
  addText("static: held", foot_ + (0.5 + kLine) * a * up, staticColor(), markers);
  ticks_ = markers.size();
  for (int i = 0; i < kTicks; ++i) addText("", tickPlace(i), wordColor(), markers);
  arrow_ = markers.size();
  Marker& arrow = add(Marker::ARROW, markers);
  arrow.color = wordColor();
  arrow.points.resize(2);
  arrow.points[0] = toPoint(foot_ + a * (kArrowAside * right + (kBarFoot + kLine) * up));
  const double length = frame.longestArrow();
  arrow.scale = toVector(Vector3(length / 30.0, length / 12.0, length / 8.0));
  addText("", foot_ + a * (kArrowAside * right + kBarFoot * up), wordColor(), markers);
}

Vector3 MarkerLegend::tickPlace(int tick) const {
  const double height = kBarFoot + tick * kBarHeight / (kTicks - 1);
  return foot_ + frame_.letter() * ((kBarWidth + 0.7) * frame_.rightwards() + height * frame_.upwards());
}

Marker& MarkerLegend::add(int type, std::vector<Marker>& markers) {
  markers.push_back(newMarker(simulator_, "legend", static_cast<int>(markers.size() - first_), type));
  return markers.back();
}

/// @param left where it begins as seen from the frame's azimuth; RViz puts the middle of a text at its place.
void MarkerLegend::addText(const std::string& text, const Vector3& left, const std_msgs::ColorRGBA& color,
                           std::vector<Marker>& markers) {
  Marker& marker = add(Marker::TEXT_VIEW_FACING, markers);
  marker.text = text;
  marker.color = color;
  marker.scale.z = frame_.letter();
  marker.pose.position = toPoint(left + frame_.halfWidth(text));
}

void MarkerLegend::addBar(std::vector<Marker>& markers) {
  Marker& bar =
      add(Marker::TRIANGLE_LIST, markers);  // which RViz does not light, so that colours are those of the tissue
  bar.scale = toVector(Vector3::Ones());
  const double width = kBarWidth * frame_.letter();
  const Vector3 right = width * frame_.rightwards();
  const Vector3 back = width * Vector3(-std::cos(frame_.azimuth), -std::sin(frame_.azimuth), 0.0);
  const std::array<Vector3, 5> around = {Vector3::Zero(), right, right + back, back, Vector3::Zero()};
  const Vector3 bottom = foot_ + kBarFoot * frame_.letter() * frame_.upwards();
  const Vector3 whole = kBarHeight * frame_.letter() * frame_.upwards();
  for (int i = 0; i < kBarPieces; ++i) {
    for (std::size_t side = 0; side + 1 < around.size(); ++side) {
      // Two triangles: columns `side` and `side` + 1, each at the lower and the upper end.
      for (const auto& [column, end] :
           {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 0), std::pair(1, 1), std::pair(0, 1)}) {
        const double fraction = static_cast<double>(i + end) / kBarPieces;
        bar.points.push_back(toPoint(bottom + around[side + static_cast<std::size_t>(column)] + fraction * whole));
        bar.colors.push_back(scaleColor(fraction));
      }
    }
  }
}

void MarkerLegend::update(double color_full_scale, double force_arrow_m_per_n, std::vector<Marker>& markers) const {
  for (int i = 0; i < kTicks; ++i) {
    Marker& tick = markers[ticks_ + static_cast<std::size_t>(i)];
    tick.text = numberText(quantity_.shown_per_si * color_full_scale * i / (kTicks - 1));
    tick.pose.position = toPoint(tickPlace(i) + frame_.halfWidth(tick.text));
  }
  // A round force whose arrow is between three fifths of the longest and nine tenths.
  const double force_n = roundUp(0.6 * frame_.longestArrow() / force_arrow_m_per_n);
  Marker& arrow = markers[arrow_];
  arrow.points[1] = arrow.points[0];
  arrow.points[1].z += frame_.up * force_n * force_arrow_m_per_n;
  markers[arrow_ + 1].text = numberText(force_n) + " N";
}

}  // namespace tissue_contact
