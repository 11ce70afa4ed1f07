#include "tissue_contact/instrument/parse_urdf.h"

#include <urdf_model/model.h>
#include <urdf_world/types.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "instrument/urdfdom_document.h"
#include "instrument/xml_tags.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

/// Position of a moving joint as a function of one independent joint: multiplier * position[joint] + offset.
struct Drive {
  int joint = -1;
  double multiplier = 1.0;
  double offset = 0.0;
};

/// To find a package may take a walk over all that are installed, and a robot may have hundreds of meshes of one.
PackagePath askedOnce(const PackagePath& package_path) {
  if (!package_path) return nullptr;
  return [&package_path, known = std::map<std::string, std::string>()](const std::string& package) mutable {
    const auto found = known.find(package);
    return found != known.end() ? found->second : known.emplace(package, package_path(package)).first->second;
  };
}

/// Turns urdfdom's model into links in tree order. One instance per parse.
class UrdfReader {
 public:
  UrdfReader(const urdf::ModelInterface& urdf, std::string source, std::string base_directory,
             const PackagePath& package_path)
      : urdf_(urdf),
        source_(std::move(source)),
        base_directory_(std::move(base_directory)),
        package_path_(askedOnce(package_path)) {}

  RobotModel read() {
    orderLinks();
    collectIndependentJoints();
    std::vector<RobotModel::Link> links;
    links.reserve(order_.size());
    for (const urdf::LinkConstSharedPtr& link : order_) links.push_back(readLink(*link));
    return RobotModel(urdf_.getName(), std::move(links), std::move(joints_));
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { throw std::invalid_argument(source_ + ": " + what); }

  /// Breadth-first from the root, so that parents come first. urdfdom does not notice a link with two parents nor links
  /// that form a ring apart from the root.
  void orderLinks() {
    std::map<std::string, std::string> joint_above;
    for (const auto& [name, joint] : urdf_.joints_) {
      if (name.empty()) refuse("the joint above link '" + joint->child_link_name + "' has an empty name");
      const auto [it, is_new] = joint_above.emplace(joint->child_link_name, name);
      if (!is_new) {
        refuse("link '" + joint->child_link_name + "' is the child of two joints, '" + it->second + "' and '" + name +
               "'; a URDF is a tree, each link has one parent");
      }
    }
    order_.push_back(urdf_.getRoot());
    for (std::size_t i = 0; i < order_.size(); ++i) {
      index_[order_[i]->name] = static_cast<int>(i);
      for (const urdf::JointSharedPtr& joint : order_[i]->child_joints) {
        order_.push_back(urdf_.getLink(joint->child_link_name));
      }
    }
    for (const auto& [name, link] : urdf_.links_) {
      if (name.empty()) refuse("a link has an empty name");
      if (index_.count(name) == 0) refuse("link '" + name + "' is not connected to the root '" + order_[0]->name + "'");
    }
  }

  void collectIndependentJoints() {
    for (const urdf::LinkConstSharedPtr& link : order_) {
      if (!link->parent_joint) continue;
      const urdf::Joint& joint = *link->parent_joint;
      checkType(joint);
      if (joint.type == urdf::Joint::FIXED || joint.mimic) continue;
      drives_[joint.name] = Drive{static_cast<int>(joints_.size()), 1.0, 0.0};
      IndependentJoint independent;
      independent.name = joint.name;
      // A continuous joint has no limits; urdfdom demands them of the others.
      const bool limited = joint.limits && joint.type != urdf::Joint::CONTINUOUS;
      independent.lower = limited ? joint.limits->lower : -std::numeric_limits<double>::infinity();
      independent.upper = limited ? joint.limits->upper : std::numeric_limits<double>::infinity();
      independent.turns_on = joint.type == urdf::Joint::CONTINUOUS;
      constexpr double kTurn = 6.2;  // rad; limits of 3.14 to either side are a turn
      const double range = independent.upper - independent.lower;
      independent.wraps = joint.type == urdf::Joint::REVOLUTE && !(range > 0.0 && range < kTurn);
      joints_.push_back(independent);
    }
  }

  void checkType(const urdf::Joint& joint) const {
    const char* type = joint.type == urdf::Joint::PLANAR     ? "planar"
                       : joint.type == urdf::Joint::FLOATING ? "floating"
                       : joint.type == urdf::Joint::UNKNOWN  ? "unknown"
                                                             : nullptr;
    if (type != nullptr) {
      refuse("joint '" + joint.name + "' has the unsupported type '" + type +
             "'; use fixed, revolute, continuous or prismatic (a base that moves: three prismatic and three revolute "
             "joints whose positions are published; one that stands elsewhere each time: fixed, and tf_frame in the "
             "scene's "
             "base_pose)");
    }
  }

  RobotModel::Link readLink(const urdf::Link& urdf_link) {
    RobotModel::Link link;
    link.name = urdf_link.name;
    for (const urdf::CollisionSharedPtr& shape : urdf_link.collision_array) {
      link.geometry.collision.push_back(readShape(*shape->geometry, shape->origin, "<collision> of link", link.name));
    }
    for (const urdf::VisualSharedPtr& shape : urdf_link.visual_array) {
      link.geometry.visual.push_back(readShape(*shape->geometry, shape->origin, "<visual> of link", link.name));
    }
    if (urdf_link.parent_joint) readJoint(*urdf_link.parent_joint, link);
    return link;
  }

  /// A link that follows at a tenth, or slides, is elsewhere after a whole turn of its joint.
  void checkTurns(const RobotModel::Link& link) {
    if (link.joint < 0) return;
    const bool is_same =
        link.motion == RobotModel::Link::Motion::kRevolute && link.multiplier == std::round(link.multiplier);
    if (is_same) return;
    IndependentJoint& driver = joints_[static_cast<std::size_t>(link.joint)];
    driver.turns_on = driver.wraps = false;
  }

  void readJoint(const urdf::Joint& joint, RobotModel::Link& link) {
    link.parent = index_.at(joint.parent_link_name);
    link.X_PJ = readPose(joint.parent_to_joint_origin_transform, "joint", joint.name);
    if (joint.type == urdf::Joint::FIXED) return;
    link.motion = joint.type == urdf::Joint::PRISMATIC ? RobotModel::Link::Motion::kPrismatic
                                                       : RobotModel::Link::Motion::kRevolute;
    const Vector3 axis(joint.axis.x, joint.axis.y, joint.axis.z);
    if (!axis.allFinite()) refuse("joint '" + joint.name + "' has an <axis> that is not finite");
    // stableNorm: a tiny or huge but usable axis must not vanish or overflow when squared.
    const double length = axis.stableNorm();
    if (!(length > 0.0))
      refuse("joint '" + joint.name + "' has a zero <axis>; give it a direction, e.g. xyz=\"0 0 1\"");
    link.axis = (axis / length).normalized();
    const Drive drive = driveOf(joint);
    link.joint = drive.joint;
    link.multiplier = drive.multiplier;
    link.offset = drive.offset;
    if (joint.mimic) link.mimic = joint.name;
    checkTurns(link);
  }

  /// The joint that `joint` mimics.
  /// @throws when it does not exist or never moves.
  const urdf::Joint& mimicked(const urdf::Joint& joint) const {
    const auto found = urdf_.joints_.find(joint.mimic->joint_name);
    if (found == urdf_.joints_.end()) {
      refuse("joint '" + joint.name + "' mimics the unknown joint '" + joint.mimic->joint_name + "'");
    }
    if (found->second->type == urdf::Joint::FIXED) {
      refuse("joint '" + joint.name + "' mimics '" + found->first + "', which is fixed; make '" + joint.name +
             "' fixed too or let it mimic a moving joint");
    }
    return *found->second;
  }

  /// Follows a chain of mimics to its independent joint and composes them: with q = M p + O for the mimicked joint,
  /// m q + o = (m M) p + (m O + o). Results are kept, so a chain is walked once.
  Drive driveOf(const urdf::Joint& joint) {
    std::vector<const urdf::Joint*> chain;
    std::set<std::string> seen;
    const urdf::Joint* at = &joint;
    for (; drives_.count(at->name) == 0; at = &mimicked(*at)) {
      if (!seen.insert(at->name).second) refuse("joint '" + at->name + "' mimics itself through a cycle of mimics");
      chain.push_back(at);
    }
    Drive drive = drives_.at(at->name);
    for (auto it = chain.rbegin(); it != chain.rend(); ++it) {
      const urdf::JointMimic& mimic = *(*it)->mimic;
      drive.offset = mimic.multiplier * drive.offset + mimic.offset;
      drive.multiplier *= mimic.multiplier;
      if (!std::isfinite(drive.offset) || !std::isfinite(drive.multiplier)) {
        refuse("joint '" + (*it)->name + "' has a <mimic> whose multiplier or offset is not finite");
      }
      drives_[(*it)->name] = drive;
    }
    return drive;
  }

  Pose readPose(const urdf::Pose& pose, const std::string& what, const std::string& name) const {
    const Vector3 p(pose.position.x, pose.position.y, pose.position.z);
    const Quaternion q(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
    if (!p.allFinite() || !q.coeffs().allFinite()) {
      refuse(what + " '" + name + "' has an <origin> that is not finite");
    }
    Pose X = Pose::Identity();
    X.linear() = q.normalized().toRotationMatrix();
    X.translation() = p;
    return X;
  }

  ShapeDescription readShape(const urdf::Geometry& geometry, const urdf::Pose& origin, const std::string& what,
                             const std::string& link) const {
    ShapeDescription shape;
    shape.X_LS = readPose(origin, what, link);
    if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry)) {
      shape.geometry = SphereGeometry{sphere->radius};
    } else if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) {
      shape.geometry = BoxGeometry{Vector3(box->dim.x, box->dim.y, box->dim.z)};
    } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry)) {
      shape.geometry = CylinderGeometry{cylinder->radius, cylinder->length};
    } else if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(&geometry)) {
      shape.geometry = MeshGeometry{meshPath(mesh->filename), Vector3(mesh->scale.x, mesh->scale.y, mesh->scale.z)};
    } else {
      refuse(what + " '" + link + "' has a geometry other than sphere, box, cylinder and mesh");
    }
    return shape;
  }

  /// A URDF may show meshes of packages that are not installed where the simulation runs; that matters only for links
  /// that touch tissue. So a path that cannot be resolved (a relative one in a URDF that is no file, too) is kept as
  /// written, and makeCollisionShape() refuses it.
  std::string meshPath(const std::string& uri) const {
    const bool relative = uri.find("://") == std::string::npos && uri.rfind('/', 0) != 0;
    if (relative && base_directory_.empty()) return uri;
    try {
      return resolvePath(uri, base_directory_, package_path_);
    } catch (const std::invalid_argument&) {
      return uri;
    }
  }

  const urdf::ModelInterface& urdf_;
  std::string source_;
  std::string base_directory_;
  PackagePath package_path_;
  std::vector<urdf::LinkConstSharedPtr> order_;
  std::map<std::string, int> index_;
  std::vector<IndependentJoint> joints_;
  std::map<std::string, Drive> drives_;
};

/// Whether xacro has yet to expand it: a command of xacro's, or a ${...} or $(...) in a tag, as the oldest files have without any such element. Not
/// in comments and in what is for others than urdfdom, which xacro copies to what it expands, nor where a macro is called that nothing defines,
/// which xacro of old left as it was.
bool needsXacro(const std::string& xml) {
  const std::set<std::string_view> commands = {
      "xacro:arg",   "xacro:attribute", "xacro:element",      "xacro:if",     "xacro:include",
      "xacro:macro", "xacro:property",  "xacro:insert_block", "xacro:unless", "xacro:call"};
  XmlTagScanner scanner(xml);
  const std::set<std::string_view> of_others = {"gazebo", "transmission", "ros2_control"};
  std::size_t within_others = 0;
  for (XmlTag tag; scanner.next(tag);) {
    if (commands.count(tag.name) > 0) return true;
    if (of_others.count(tag.name) > 0 && tag.kind == XmlTag::Kind::kOpen) ++within_others;
    if (of_others.count(tag.name) > 0 && tag.kind == XmlTag::Kind::kClose && within_others > 0) --within_others;
    if (within_others > 0) continue;
    const std::string_view text = std::string_view(xml).substr(tag.position);
    const std::string_view attributes = text.substr(0, text.find('>'));
    for (const char* open : {"${", "$("}) {
      if (attributes.find(open) != std::string_view::npos) return true;
    }
  }
  return false;
}

/// The value of an attribute in the text of a tag; empty where it has none.
std::string_view attributeOf(std::string_view tag, const std::string& name) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
    std::size_t end = at + name.size();
    if (at == 0 || !is_blank(tag[at - 1])) continue;
    while (end < tag.size() && is_blank(tag[end])) ++end;
    if (end >= tag.size() || tag[end] != '=') continue;
    const std::size_t open = tag.find_first_of("\"'", end);
    if (open == std::string_view::npos) return {};
    const std::size_t close = tag.find(tag[open], open + 1);
    return tag.substr(open + 1, close == std::string_view::npos ? close : close - open - 1);
  }
  return {};
}

/// Rotations that would be left out or be others without a word: quaternions, which urdfdom knows from version 4 on, and degrees.
void checkOrigins(const std::string& xml, const std::string& source) {
  constexpr double kMost = 12.57;  // rad, two turns: sums of quarters reach that, degrees are mostly beyond it
  bool counts = false;             // one of a joint or a shape; those of masses and sensors place nothing here
  XmlTagScanner scanner(xml);
  for (XmlTag tag; scanner.next(tag);) {
    if (tag.name == "joint" || tag.name == "visual" || tag.name == "collision")
      counts = tag.kind == XmlTag::Kind::kOpen;
    if (!counts || tag.name != "origin" || tag.kind == XmlTag::Kind::kClose) continue;
    const std::string_view rest = std::string_view(xml).substr(tag.position);
    const std::string_view text = rest.substr(0, rest.find('>'));
    const auto refuse = [&](const std::string& what) {
      std::string message = source + ":" + std::to_string(lineOf(xml, tag.position));
      throw std::invalid_argument(message.append(": <origin> ").append(what));
    };
    for (const char* name : {"quat_xyzw", "quat", "wxyz", "quaternion"}) {
      if (!attributeOf(text, name).empty()) {
        refuse("has a rotation as " + std::string(name) +
               ", which is not read here and would be left out; write it as rpy=\"roll pitch yaw\", in rad");
      }
    }
    const std::string rpy(attributeOf(text, "rpy"));
    std::istringstream angles(rpy);
    for (double angle = 0.0; angles >> angle;) {
      if (std::abs(angle) > kMost) {
        refuse("has rpy=\"" + printable(rpy) + "\", more than two turns; give radians, not degrees");
      }
    }
  }
}

}  // namespace

RobotModel parseUrdf(const std::string& xml, const std::string& source, const std::string& base_directory,
                     const PackagePath& package_path) {
  if (needsXacro(xml)) {
    throw std::invalid_argument(source + ": is a xacro file, not a URDF; expand it first: xacro FILE.urdf.xacro > " +
                                "FILE.urdf, or load robot_description with xacro's output and name no urdf");
  }
  const urdf::ModelInterfaceSharedPtr urdf = parseWithUrdfdom(xml, source);  // knows that tags are closed
  checkOrigins(xml, source);
  return UrdfReader(*urdf, source, base_directory, package_path).read();
}

RobotModel loadUrdf(const std::string& file, const PackagePath& package_path) {
  const std::string directory = std::filesystem::absolute(file).parent_path().string();
  return parseUrdf(readFile(file, "URDF file", kMaxUrdfBytes), file, directory, package_path);
}

}  // namespace tissue_contact
