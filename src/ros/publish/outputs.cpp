#include "ros/publish/outputs.h"

#include <ros/names.h>

#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "ros/parameter.h"
#include "ros/publish/crtk_wrench.h"

namespace tissue_contact {
namespace {

/// Wrenches must not be lost to a subscriber that stalls: 20 s of 500 Hz.
constexpr int kWrenchQueue = 10000;

// Far beyond what RViz can draw on either side.
constexpr Range kFullScaleRange{1e-9, 1e3, "m"};
constexpr Range kForceArrowRange{1e-9, 1e6, "m/N"};

MarkerStyle markerStyle(const ros::NodeHandle& node) {
  MarkerStyle style;
  style.displacement_full_scale_m =
      numberParameter(node, "markers/displacement_full_scale_m", style.displacement_full_scale_m, kFullScaleRange);
  style.force_arrow_m_per_n =
      numberParameter(node, "markers/force_arrow_m_per_n", style.force_arrow_m_per_n, kForceArrowRange);
  return style;
}

PublishedMesh publishedMesh(const ros::NodeHandle& node) {
  const std::string name = "publish_mesh";
  return toPublishedMesh("parameter '" + node.resolveName(name) + "'", textParameter(node, name, "refined"));
}

void checkTopicName(const std::string& kind, const std::string& name) {
  std::string why;
  if (name.find('/') == std::string::npos && ros::names::validate("/" + name, why) && !name.empty()) return;
  throw std::invalid_argument("the " + kind + " name '" + name +
                              "' becomes part of a topic name and must consist of letters, digits and underscores" +
                              (why.empty() ? "" : " (" + why + ")"));
}

/// A tf tree has one parent per frame, so links of different instruments need different names. A root link may be the
/// world frame itself when it lies there.
void checkFrameNames(const Simulator& simulator) {
  std::set<std::string> names = {simulator.scene().world_frame};
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) {
    const Instrument& instrument = simulator.instruments()[i];
    for (const RobotModel::Link& link : instrument.model().links()) {
      const bool is_world = link.parent < 0 && link.name == simulator.scene().world_frame &&
                            simulator.linkPoses(static_cast<int>(i)).front().isApprox(Pose::Identity());
      if (names.insert(link.name).second || is_world) continue;
      throw std::invalid_argument("publish.tf: link '" + link.name + "' of instrument '" + instrument.name() +
                                  "' has the name of the world frame or of another instrument's link; rename one or "
                                  "set publish.tf to false");
    }
  }
}

void checkNames(const Simulator& simulator, bool with_tf) {
  for (const Instrument& instrument : simulator.instruments()) checkTopicName("instrument", instrument.name());
  for (const Tissue& tissue : simulator.tissues()) checkTopicName("tissue", tissue.name());
  if (with_tf) checkFrameNames(simulator);
}

}  // namespace

Outputs::Outputs(const ros::NodeHandle& private_node, const Simulator& simulator, const JointStatePlayer& player,
                 const PublishOptions& options, std::function<void(Status&)> complete)
    : node_(private_node),
      simulator_(simulator),
      player_(player),
      options_(options),
      complete_(std::move(complete)),
      bulky_(simulator, options, markerStyle(node_)),
      meshes_(shownMeshes(simulator, publishedMesh(node_))),
      told_revisions_(meshes_.size(), -1),
      mesh_rate_(options.mesh_rate_hz),
      contacts_rate_(options.contacts_rate_hz),
      status_rate_(options.status_rate_hz),
      markers_rate_(options.markers_rate_hz) {
  checkNames(simulator, options.tf);
  for (const Instrument& instrument : simulator.instruments()) {
    wrenches_.emplace_back();
    wrenches_.back().header.frame_id = instrument.model().links()[static_cast<std::size_t>(instrument.tipLink())].name;
  }
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
    if (options_.crtk) publishCrtk(i, played.stamp_ns);
  }
}

void Outputs::publishCrtk(int instrument, std::int64_t stamp_ns) {
  const auto index = static_cast<std::size_t>(instrument);
  const Instrument& arm = simulator_.instruments()[index];
  const std::vector<Pose>& X_WL = simulator_.linkPoses(instrument);
  const auto tip = static_cast<std::size_t>(arm.tipLink());
  const Wrench felt = simulator_.wrench(instrument);
  crtk_.header.frame_id = arm.model().links()[tip].name;
  fillWrench(bodyMeasuredForce(felt), stamp_ns, crtk_);
  body_publishers_[index].publish(crtk_);
  crtk_.header.frame_id = arm.model().links().front().name;
  fillWrench(spatialMeasuredForce(felt, X_WL.front().inverse() * X_WL[tip]), stamp_ns, crtk_);
  spatial_publishers_[index].publish(crtk_);
}

void Outputs::publishState(const PlayedSample& played, int substeps, double step_time_s) {
  if (played.was_reset) {
    for (MessageTimeRate* rate : {&mesh_rate_, &contacts_rate_, &status_rate_, &markers_rate_}) rate->reset();
  }
  const bool is_new_stamp = played.stamp_ns != last_stamp_ns_;
  last_stamp_ns_ = played.stamp_ns;
  publishSnapshot(played.stamp_ns, substeps, step_time_s);
  if (broadcaster_ && is_new_stamp) publishTransforms(played.stamp_ns);  // tf2 warns about repeated stamps
}

void Outputs::publishSnapshot(std::int64_t stamp_ns, int substeps, double step_time_s) {
  const bool mesh_is_due = mesh_rate_.due(stamp_ns);
  // Of meshes that nobody is shown none needs a topology; where none is shown at all, the newest is told as soon as it is there.
  const bool topologies = (mesh_is_due || !(options_.mesh_rate_hz > 0.0)) && topologiesChange();
  const bool mesh = mesh_is_due && bulky_.meshIsWanted();
  const bool contacts = contacts_rate_.due(stamp_ns) && bulky_.contactsAreWanted();
  const bool status = status_rate_.due(stamp_ns) && bulky_.statusIsWanted() && isFinite(simulator_.residuals());
  const bool markers = markers_rate_.due(stamp_ns) && bulky_.markersAreWanted();
  if (!topologies && !mesh && !contacts && !status && !markers) return;
  std::unique_ptr<SceneSnapshot> snapshot = bulky_.queue().buffer();
  snapshot->topologies = topologies;
  snapshot->mesh = mesh;
  snapshot->contact_array = contacts;
  snapshot->with_status = status;
  snapshot->markers = markers;
  takeSnapshot(simulator_, meshes_, stamp_ns, *snapshot);
  if (status) {
    snapshot->status.header.frame_id = simulator_.scene().world_frame;
    fillStatus(simulator_, player_, stamp_ns, snapshot->status);
    if (substeps == 0) snapshot->status.discarded = snapshot->status.jumped = 0;  // told with the interval before
    complete_(snapshot->status);
    snapshot->status.substeps = static_cast<std::uint32_t>(substeps);
    snapshot->status.step_time = step_time_s;
  }
  bulky_.queue().put(std::move(snapshot));
}

/// RViz opened before or between recordings should not stay empty.
void Outputs::showToNewcomer() {
  if (!bulky_.takeNewcomer() || !isFinite(simulator_)) return;
  std::unique_ptr<SceneSnapshot> snapshot = bulky_.queue().buffer();
  snapshot->markers = true;
  takeSnapshot(simulator_, meshes_, last_stamp_ns_, *snapshot);
  bulky_.queue().put(std::move(snapshot));
}

/// Whether the mesh of a tissue is another than when last asked.
bool Outputs::topologiesChange() {
  bool change = false;
  for (std::size_t t = 0; t < meshes_.size(); ++t) {
    const int revision =
        meshes_[t].follow(simulator_.tissues()[t], simulator_.meshRevision(static_cast<int>(t)))->revision;
    change |= std::exchange(told_revisions_[t], revision) != revision;
  }
  return change;
}

void Outputs::publishTransforms(std::int64_t stamp_ns) {
  transforms_.clear();
  for (std::size_t i = 0; i < simulator_.instruments().size(); ++i) {
    const std::vector<RobotModel::Link>& links = simulator_.instruments()[i].model().links();
    const std::vector<Pose>& X_WL = simulator_.linkPoses(static_cast<int>(i));
    for (std::size_t l = 0; l < links.size(); ++l) {
      const bool is_root = links[l].parent < 0;
      if (is_root && links[l].name == simulator_.scene().world_frame) continue;
      const auto parent = static_cast<std::size_t>(is_root ? 0 : links[l].parent);
      geometry_msgs::TransformStamped& transform = transforms_.emplace_back();
      transform.header.stamp = toTime(stamp_ns);
      transform.header.frame_id = is_root ? simulator_.scene().world_frame : links[parent].name;
      transform.child_frame_id = links[l].name;
      transform.transform = toTransform(is_root ? X_WL[l] : Pose(X_WL[parent].inverse() * X_WL[l]));
    }
  }
  broadcaster_->sendTransform(transforms_);
}

}  // namespace tissue_contact
