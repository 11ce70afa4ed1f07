#include "ros/conversions.h"

#include <cmath>
#include <stdexcept>

namespace tissue_contact {
namespace {

std::uint8_t toState(ContactState state) {
  switch (state) {
    case ContactState::kOpen:
      return ContactPoint::OPEN;
    case ContactState::kStatic:
      return ContactPoint::STATIC;
    case ContactState::kKinetic:
      break;
  }
  return ContactPoint::KINETIC;
}

void fillPoints(const NodalVectors& x, std::vector<geometry_msgs::Point>& points) {
  points.resize(static_cast<std::size_t>(x.cols()));
  for (Eigen::Index i = 0; i < x.cols(); ++i) points[static_cast<std::size_t>(i)] = toPoint(x.col(i));
}

template <typename Polygon>
void fillIndices(const std::vector<Polygon>& polygons, std::vector<std::uint32_t>& indices) {
  indices.clear();
  for (const Polygon& polygon : polygons) {
    for (const int node : polygon) indices.push_back(static_cast<std::uint32_t>(node));
  }
}

}  // namespace

ros::Time toTime(std::int64_t stamp_ns) {
  ros::Time time;
  time.fromNSec(static_cast<std::uint64_t>(stamp_ns));
  return time;
}

geometry_msgs::Point toPoint(const Vector3& p) {
  geometry_msgs::Point point;
  point.x = p.x();
  point.y = p.y();
  point.z = p.z();
  return point;
}

geometry_msgs::Vector3 toVector(const Vector3& v) {
  geometry_msgs::Vector3 vector;
  vector.x = v.x();
  vector.y = v.y();
  vector.z = v.z();
  return vector;
}

geometry_msgs::Pose toPose(const Pose& X) {
  const Quaternion q(X.linear());
  geometry_msgs::Pose pose;
  pose.position = toPoint(X.translation());
  pose.orientation.x = q.x();
  pose.orientation.y = q.y();
  pose.orientation.z = q.z();
  pose.orientation.w = q.w();
  return pose;
}

geometry_msgs::Transform toTransform(const Pose& X) {
  geometry_msgs::Transform transform;
  transform.translation = toVector(X.translation());
  transform.rotation = toPose(X).orientation;
  return transform;
}

Pose toPose(const geometry_msgs::Transform& transform) {
  const Quaternion q(transform.rotation.w, transform.rotation.x, transform.rotation.y, transform.rotation.z);
  const Vector3 p(transform.translation.x, transform.translation.y, transform.translation.z);
  if (!(q.norm() > 0.0) || !std::isfinite(q.norm()) || !p.allFinite()) {
    throw std::invalid_argument(
        "a transform whose translation is not finite or whose quaternion is zero or not finite");
  }
  Pose X = Pose::Identity();
  X.linear() = q.normalized().toRotationMatrix();
  X.translation() = p;
  return X;
}

JointStateSample toSample(const sensor_msgs::JointState& message) {
  return {static_cast<std::int64_t>(message.header.stamp.toNSec()), message.name, message.position, message.velocity};
}

std::uint8_t toStop(StopReason stop) {
  switch (stop) {
    case StopReason::kTolerance:
      return Status::STOP_TOLERANCE;
    case StopReason::kIterations:
      return Status::STOP_ITERATIONS;
    default:
      return Status::STOP_TIME_BUDGET;
  }
}

void fillWrench(const Wrench& wrench, std::int64_t stamp_ns, geometry_msgs::WrenchStamped& message) {
  message.header.stamp = toTime(stamp_ns);
  message.wrench.force = toVector(wrench.force);
  message.wrench.torque = toVector(wrench.torque);
}

void fillTopology(const MeshRevision& mesh, TissueTopology& message) {
  message.revision = static_cast<std::uint32_t>(mesh.revision);
  fillPoints(mesh.rest_positions, message.rest_positions);
  fillIndices(mesh.tetrahedra, message.tetrahedra);
  fillIndices(mesh.surface, message.surface_triangles);
  message.fixed_nodes.clear();
  for (std::size_t node = 0; node < mesh.fixed.size(); ++node) {
    if (mesh.fixed[node]) message.fixed_nodes.push_back(static_cast<std::uint32_t>(node));
  }
}

void fillMesh(const SceneSnapshot& snapshot, int tissue, TissueMesh& message) {
  message.header.stamp = toTime(snapshot.stamp_ns);
  message.step = static_cast<std::uint64_t>(snapshot.step);
  message.revision = static_cast<std::uint32_t>(snapshot.revisions[static_cast<std::size_t>(tissue)]->revision);
  fillPoints(snapshot.positions[static_cast<std::size_t>(tissue)], message.positions);
}

void fillContacts(const Simulator& simulator, const SceneSnapshot& snapshot, ContactArray& message) {
  message.header.stamp = toTime(snapshot.stamp_ns);
  message.step = static_cast<std::uint64_t>(snapshot.step);
  message.contacts.resize(snapshot.contacts.size());
  const std::vector<TissueDescription>& tissues =
      simulator.scene().tissues;  // not those of the simulator, which change
  for (std::size_t i = 0; i < message.contacts.size(); ++i) {
    const SolvedContact& solved = snapshot.contacts[i];
    const ContactKey& key = solved.contact.key;
    auto& contact = message.contacts[i];
    contact.tissue = tissues[static_cast<std::size_t>(key.tissue)].name;
    if (key.instrument >= 0) {
      const Instrument& instrument = simulator.instruments()[static_cast<std::size_t>(key.instrument)];
      contact.instrument = instrument.name();
      contact.link = instrument.contactLinks()[static_cast<std::size_t>(key.link)].name;
      contact.other_tissue.clear();
    } else {
      contact.instrument.clear();
      contact.link.clear();
      contact.other_tissue = tissues[static_cast<std::size_t>(key.other_tissue)].name;
    }
    contact.point = toPoint(solved.contact.p_WC);
    contact.normal = toVector(solved.contact.R_WC.col(0));
    contact.force = toVector(solved.force_on_tissue_n);
    contact.gap = solved.contact.gap_m;
    contact.state = toState(solved.state);
  }
}

namespace {

void fillForceErrors(const Simulator& simulator, Status& message) {
  const std::vector<ForceErrorEstimate>& errors = simulator.forceErrors();
  message.force_errors.resize(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    auto& error = message.force_errors[i];
    error.instrument = simulator.instruments()[i].name();
    error.force = simulator.wrench(static_cast<int>(i)).force.norm();
    error.error = errors[i].total_n();
    error.knows_mesh = static_cast<std::uint8_t>(errors[i].knows_mesh);
    error.mesh = errors[i].mesh_n;
    error.step = errors[i].step_n;
    error.solver = errors[i].solver_n;
  }
}

}  // namespace

void fillStatus(const Simulator& simulator, const JointStatePlayer& player, std::int64_t stamp_ns, Status& message) {
  const StepReport& report = simulator.report();
  message.header.stamp = toTime(stamp_ns);
  message.step = static_cast<std::uint64_t>(simulator.stepCount());
  message.iterations = static_cast<std::uint32_t>(report.iterations);
  message.stop = toStop(report.stop);
  message.discarded = static_cast<std::uint8_t>(report.discarded);
  message.jumped = static_cast<std::uint8_t>(report.jumped);
  const ImplausibleLoad& load = report.implausible_load;
  message.implausible_load = static_cast<std::uint8_t>(load.found);
  message.implausible_at = toPoint(load.p_W);
  message.inverted_elements = static_cast<std::uint32_t>(load.inverted_elements);
  message.contact_pressure = load.pressure_pa;
  message.strain = report.law_error.strain;
  message.law_error = report.law_error.relative;
  fillForceErrors(simulator, message);
  message.pinched_contacts = static_cast<std::uint32_t>(report.pinched_contacts);
  message.open_contacts = static_cast<std::uint32_t>(report.open_contacts);
  message.static_contacts = static_cast<std::uint32_t>(report.static_contacts);
  message.kinetic_contacts = static_cast<std::uint32_t>(report.kinetic_contacts);
  message.sleeping_nodes = static_cast<std::uint32_t>(report.sleeping_nodes);
  message.held_force = report.held_force_n;
  const Residuals& residuals = simulator.residuals();
  message.momentum_residual = residuals.momentum;
  message.penetration = residuals.penetration_m;
  message.adhesion = residuals.adhesion_n;
  message.complementarity = residuals.complementarity_w;
  message.cone_violation = residuals.cone_violation_n;
  message.static_slip = residuals.static_slip_m_per_s;
  message.kinetic_angle = residuals.kinetic_angle_rad;
  message.joint_states_accepted = static_cast<std::uint64_t>(player.count(Verdict::kAccepted));
  message.joint_states_merged = static_cast<std::uint64_t>(player.merged());
  message.joint_states_refused = 0;
  for (int v = 1; v < kVerdictCount; ++v) {
    message.joint_states_refused += static_cast<std::uint64_t>(player.count(static_cast<Verdict>(v)));
  }
  const auto refused = [&](Verdict verdict) { return static_cast<std::uint64_t>(player.count(verdict)); };
  message.refused_duplicate_stamp = refused(Verdict::kDuplicateStamp);
  message.refused_bad_stamp = refused(Verdict::kBadStamp);
  message.refused_not_finite = refused(Verdict::kNotFinite);
  message.refused_bad_length = refused(Verdict::kBadLength);
  message.refused_no_known_joint = refused(Verdict::kNoKnownJoint);
  message.refused_late = refused(Verdict::kLate);
  message.refused_two_clocks = refused(Verdict::kTwoClocks);
  message.resets = static_cast<std::uint64_t>(player.resets());
  message.gaps = static_cast<std::uint64_t>(player.gaps());
}

bool isFinite(const Residuals& residuals) {
  return std::isfinite(residuals.momentum) && std::isfinite(residuals.momentum_defect_n_s) &&
         std::isfinite(residuals.net_defect_n_s) && std::isfinite(residuals.penetration_m) &&
         std::isfinite(residuals.adhesion_n) && std::isfinite(residuals.complementarity_w) &&
         std::isfinite(residuals.cone_violation_n) && std::isfinite(residuals.static_slip_m_per_s) &&
         std::isfinite(residuals.kinetic_angle_rad);
}

bool isFinite(const Simulator& simulator) {
  for (std::size_t i = 0; i < simulator.tissues().size(); ++i) {
    if (!simulator.positions(static_cast<int>(i)).allFinite()) return false;
  }
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) {
    const Wrench wrench = simulator.wrench(static_cast<int>(i));
    if (!wrench.force.allFinite() || !wrench.torque.allFinite()) return false;
  }
  for (const SolvedContact& solved : simulator.contacts()) {
    const Contact& contact = solved.contact;
    if (!contact.p_WC.allFinite() || !contact.R_WC.allFinite() || !std::isfinite(contact.gap_m)) return false;
    if (!solved.force_on_tissue_n.allFinite()) return false;
  }
  return true;
}

}  // namespace tissue_contact
