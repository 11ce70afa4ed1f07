#include "ros/publish/outputs.h"

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "ros/parameter.h"
#include "ros/publish/instrument_messages.h"

namespace tissue_contact {
namespace {

/// Wrenches must not be lost to a subscriber that stalls: 20 s of 500 Hz.
constexpr int kWrenchQueue = 10000;

// Far beyond what RViz can draw on either side.
constexpr double kLeastScale = 1e-9;
constexpr double kMostScale = 1e12;
constexpr Range kForceArrowRange{1e-9, 1e6, "m/N", "leave it out and it fits the scene"};

MarkerStyle markerStyle(const ros::NodeHandle& node) {
  MarkerStyle style;
  const std::string color = "markers/color";
  style.color =
      toSurfaceColor("parameter '" + node.resolveName(color) + "'", textParameter(node, color, "displacement"));
  for (const SurfaceColor one : {SurfaceColor::kDisplacement, SurfaceColor::kPressure, SurfaceColor::kStrain}) {
    const std::string name = std::string("markers/") + colorQuantity(one).full_scale;
    const std::optional<double> given = numberParameter(
        node, name, {kLeastScale, kMostScale, colorQuantity(one).unit, "leave it out and it fits the scene"});
    if (one == style.color) style.color_full_scale = given.value_or(0.0);
  }
  style.force_arrow_m_per_n = numberParameter(node, "markers/force_arrow_m_per_n", kForceArrowRange).value_or(0.0);
  return style;
}

PublishedMesh publishedMesh(const ros::NodeHandle& node) {
  const std::string name = "publish_mesh";
  return toPublishedMesh("parameter '" + node.resolveName(name) + "'",
                         textParameter(node, name, kDefaultPublishedMesh));
}

/// Contacts are at nodes of the mesh computed with.
void checkColor(const Scene& scene, const MarkerStyle& style, PublishedMesh mesh) {
  if (style.color != SurfaceColor::kPressure || mesh == PublishedMesh::kRefined) return;
  for (const TissueDescription& tissue : scene.tissues) {
    if (tissue.refinement.mode == RefinementDescription::Mode::kNever) continue;
    throw std::invalid_argument(
        "parameter 'markers/color' is pressure, which is not known at the nodes of the unrefined mesh of tissue '" +
        tissue.name + "'; start with publish_mesh:=refined, or colour by displacement or strain");
  }
}

}  // namespace

Outputs::Outputs(const ros::NodeHandle& private_node, const Simulator& simulator, const JointStatePlayer& player,
                 const PublishOptions& options, std::function<void(Status&)> complete)
    : node_(private_node),
      simulator_(simulator),
      options_(options),
      complete_(std::move(complete)),
      bulky_(simulator, options, markerStyle(node_)),
      taker_(simulator, player, options, publishedMesh(node_)),
      frames_(frameNames(simulator)),
      wrenches_(wrenchMessages(simulator, frames_)) {
  checkNames(simulator);
  checkColor(simulator.scene(), markerStyle(node_), publishedMesh(node_));
}

void Outputs::start(std::function<void()> on_newcomer) {
  for (const Instrument& instrument : simulator_.instruments()) {
    wrench_publishers_.push_back(
        node_.advertise<geometry_msgs::WrenchStamped>(instrument.name() + "/wrench", kWrenchQueue));
    if (!options_.crtk) continue;
    for (const auto& [kind, publishers] :
         {std::pair("/body/", &body_publishers_), std::pair("/spatial/", &spatial_publishers_)}) {
      publishers->push_back(
          node_.advertise<geometry_msgs::WrenchStamped>(instrument.name() + kind + "measured_cf", kWrenchQueue));
    }
  }
  if (options_.tf) broadcaster_ = std::make_unique<tf2_ros::TransformBroadcaster>();
  bulky_.start(node_, std::move(on_newcomer));
}

void Outputs::publishWrenches(const PlayedSample& played) {
  for (const int i : played.instruments) {
    const auto index = static_cast<std::size_t>(i);
    fillWrench(simulator_.wrench(i), played.stamp_ns, wrenches_[index]);
    wrench_publishers_[index].publish(wrenches_[index]);
    if (!options_.crtk) continue;
    fillCrtk(simulator_, frames_, i, played.stamp_ns, crtk_);
    body_publishers_[index].publish(crtk_.body);
    spatial_publishers_[index].publish(crtk_.spatial);
  }
}

void Outputs::publishState(const PlayedSample& played, int substeps, double step_time_s) {
  const bool is_new_stamp = played.stamp_ns != last_stamp_ns_;
  last_stamp_ns_ = played.stamp_ns;
  publishSnapshot(played, substeps, step_time_s);
  if (!broadcaster_ || !is_new_stamp) return;  // tf2 warns about repeated stamps
  fillTransforms(simulator_, frames_, played.stamp_ns, transforms_);
  broadcaster_->sendTransform(transforms_.transforms);
}

void Outputs::publishSnapshot(const PlayedSample& played, int substeps, double step_time_s) {
  const BulkyTopics due = taker_.due(played, {true, bulky_.meshIsWanted(), bulky_.contactsAreWanted(),
                                              bulky_.statusIsWanted(), bulky_.markersAreWanted()});
  if (!due.any()) return;
  std::unique_ptr<SceneSnapshot> snapshot = bulky_.queue().buffer();
  const auto complete = [&](Status& status) {
    complete_(status);
    status.step_time = step_time_s;
  };
  taker_.take(played, due, substeps, complete, *snapshot);
  bulky_.queue().put(std::move(snapshot));
}

void Outputs::setRates(const PublishOptions& rates) { taker_.setRates(rates); }

/// RViz opened before or between recordings should not stay empty.
void Outputs::showToNewcomer() {
  if (bulky_.takeNewcomer()) showMarkers();
}

void Outputs::showReset() {
  taker_.beginAnew();
  if (bulky_.markersAreWanted()) showMarkers();
}

void Outputs::showMarkers() {
  if (!isFinite(simulator_)) return;
  std::unique_ptr<SceneSnapshot> snapshot = bulky_.queue().buffer();
  taker_.takeMarkers(last_stamp_ns_, *snapshot);
  bulky_.queue().put(std::move(snapshot));
}

}  // namespace tissue_contact
