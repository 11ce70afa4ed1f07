#include "tissue_contact/instrument/instrument.h"

#include <cmath>
#include <cstddef>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "instrument/joint_bounds.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

template <typename Named>
std::string listNames(const std::vector<Named>& named) {
  std::vector<std::string> names;
  names.reserve(named.size());
  for (const Named& one : named) names.push_back(one.name);
  return names.empty() ? "none" : listOf(names, 20);
}

/// The checks of one description against one model; every message starts with the instrument's name.
class Builder {
 public:
  Builder(const InstrumentDescription& description, const RobotModel& model)
      : description_(description), model_(model) {}

  /// @param entry of the instrument in the scene
  [[noreturn]] void refuse(const std::string& entry, const std::string& what) const {
    throw EntryError(entry, "instrument '" + description_.name + "': " + what);
  }

  int findLink(const std::string& entry, const std::string& role, const std::string& name) const {
    const int link = model_.findLink(name);
    if (link < 0) {
      refuse(entry, role + " '" + name + "' is not a link of robot '" + model_.name() +
                        "'; its links are: " + listNames(model_.links()));
    }
    return link;
  }

  int findJoint(const std::string& entry, const std::string& role, const std::string& name) const {
    const int joint = model_.findJoint(name);
    if (joint < 0) {
      refuse(entry,
             role + " '" + name + "', which is not an independent joint of robot '" + model_.name() +
                 "' (fixed and mimic joints cannot be set); its independent joints are: " + listNames(model_.joints()));
    }
    return joint;
  }

  void checkTopics() const {
    const bool moves = !model_.joints().empty();
    if (moves && description_.joint_state_topics.empty()) {
      refuse("", "its URDF has moving joints (" + listNames(model_.joints()) +
                     ") but no joint-state topic is given; name one in joint_state_topics");
    }
    if (!moves && !description_.joint_state_topics.empty()) {
      refuse("joint_state_topics", "joint_state_topics names '" + description_.joint_state_topics.front().name +
                                       "' but its URDF has no moving joint; leave the key out for a fixed obstacle");
    }
  }

  ContactLink makeContactLink(const std::string& entry, const ContactLinkDescription& contact) {
    ContactLink result;
    result.name = contact.link;
    result.link = findLink(entry, "contact link", contact.link);
    const LinkGeometry& geometry = model_.links()[static_cast<std::size_t>(result.link)].geometry;
    const auto& [shapes, origin] = !contact.shapes.empty() ? std::make_pair(&contact.shapes, "shape of the scene")
                                   : !geometry.collision.empty()
                                       ? std::make_pair(&geometry.collision, "<collision> of the URDF")
                                       : std::make_pair(&geometry.visual, "<visual> of the URDF");
    if (shapes->empty()) {
      refuse(entry,
             "contact link '" + contact.link +
                 "' has neither <collision> nor <visual> in its URDF; name its shapes in the scene or drop it from "
                 "contact_links");
    }
    for (std::size_t i = 0; i < shapes->size(); ++i) {
      try {
        result.shapes.push_back(makeCollisionShape((*shapes)[i]));
        count(result.shapes.back());
      } catch (const std::invalid_argument& error) {
        const bool of_scene = shapes == &contact.shapes;
        refuse(of_scene ? elementOf(entry + ".shapes", i) : entry,
               "contact link '" + contact.link + "', " + origin + " number " + std::to_string(i + 1) + ": " +
                   error.what() +
                   (of_scene ? "" : "; or name shapes for this link in the scene (contact_links[].shapes)"));
      }
    }
    return result;
  }

  std::vector<ContactLink> makeContactLinks() {
    std::vector<ContactLink> links;
    std::set<std::string> seen;
    for (const ContactLinkDescription& contact : description_.contact_links) {
      const std::string entry = elementOf("contact_links", links.size());
      if (!seen.insert(contact.link).second) refuse(entry, "contact link '" + contact.link + "' is listed twice");
      links.push_back(makeContactLink(entry, contact));
    }
    return links;
  }

  VectorX makeInitialPositions() const {
    VectorX positions = VectorX::Zero(static_cast<Eigen::Index>(model_.joints().size()));
    for (const auto& [name, position] : description_.initial_joint_positions) {
      const std::string entry = "initial_joint_positions." + name;
      const int joint = findJoint(entry, "an initial position is given for joint", name);
      if (!isJointPosition(position)) {
        refuse(entry, "initial position of joint '" + name + "' is " + std::to_string(position) + "; it must be " +
                          kJointPositionRange);
      }
      positions[joint] = position;
    }
    return positions;
  }

  std::vector<CompliantJoint> makeCompliantJoints() const {
    std::vector<CompliantJoint> joints;
    for (const JointCompliance& compliance : description_.compliant_joints) {
      const std::string entry = elementOf("compliant_joints", joints.size());
      const int joint = findJoint(entry + ".joint", "compliance is given for joint", compliance.joint);
      if (slides(joint) != compliance.slides) {
        refuse(entry, "joint '" + compliance.joint +
                          (slides(joint) ? "' slides; give its stiffness_n_per_m and force_limit_n"
                                         : "' turns; give its stiffness_n_m_per_rad and torque_limit_n_m"));
      }
      if (!(compliance.stiffness > 0.0) || !std::isfinite(compliance.stiffness) || !(compliance.effort_limit > 0.0)) {
        refuse(entry, "stiffness and limit of joint '" + compliance.joint + "' must be above 0");
      }
      for (const CompliantJoint& other : joints) {
        if (other.joint == joint) refuse(entry + ".joint", "joint '" + compliance.joint + "' is named twice");
      }
      joints.push_back({joint, compliance.stiffness, compliance.effort_limit, compliance.slides});
    }
    return joints;
  }

  /// Own names, but for those of joints that the map gives another: two arms of one model may share a topic. The map may give an own name
  /// another meaning.
  std::map<std::string, int> makeJointMap() const {
    std::map<std::string, int> joint_of;
    for (std::size_t i = 0; i < model_.joints().size(); ++i) joint_of[model_.joints()[i].name] = static_cast<int>(i);
    std::map<int, std::string> recorded_as;
    for (const auto& [recorded, name] : description_.joint_names) {
      const int joint = findMappedJoint(recorded, name);
      const auto [it, is_new] = recorded_as.emplace(joint, recorded);
      if (!is_new) refuseSharedJoint(it->second, recorded, name);
    }
    for (const auto& [joint, recorded] : recorded_as)
      joint_of.erase(model_.joints()[static_cast<std::size_t>(joint)].name);
    for (const auto& [joint, recorded] : recorded_as) joint_of[recorded] = joint;
    return joint_of;
  }

 private:
  bool slides(int joint) const {
    for (const RobotModel::Link& link : model_.links()) {
      if (link.joint == joint && link.mimic.empty()) return link.motion == RobotModel::Link::Motion::kPrismatic;
    }
    return false;
  }

  /// Bounds what one instrument holds while its meshes are read; the scene's bounds come after it.
  void count(const CollisionShape& shape) {
    if (shape.mesh) triangles_ += shape.mesh->triangles.size();
    if (++shapes_ > kMostShapes || triangles_ > kMostShapeTriangles) {
      throw std::invalid_argument("the shapes up to here are " + std::to_string(shapes_) + " with " +
                                  std::to_string(triangles_) + " triangles; an instrument may have at most " +
                                  std::to_string(kMostShapes) + " with " + std::to_string(kMostShapeTriangles) +
                                  "; name fewer contact links, or simpler shapes in the scene");
    }
  }

  int findMappedJoint(const std::string& recorded, const std::string& name) const {
    const bool is_reversed = model_.findJoint(name) < 0 && model_.findJoint(recorded) >= 0;
    return findJoint(
        "joint_names." + recorded,
        (is_reversed ? "the recorded name stands first (" + name + ": " + recorded + "); " : std::string()) +
            "the joint map sends '" + recorded + "' to",
        name);
  }

  [[noreturn]] void refuseSharedJoint(const std::string& first, const std::string& second,
                                      const std::string& name) const {
    refuse("joint_names." + second, "the joint map sends both '" + first + "' and '" + second + "' to '" + name + "'");
  }

  const InstrumentDescription& description_;
  const RobotModel& model_;
  std::size_t shapes_ = 0;
  std::size_t triangles_ = 0;
};

}  // namespace

Instrument::Instrument(const InstrumentDescription& description, RobotModel model, const Pose& X_WB)
    : name_(description.name), model_(std::move(model)), X_WB_(X_WB) {
  Builder builder(description, model_);
  if (!X_WB.matrix().allFinite()) builder.refuse("base_pose", "its base pose is not finite");
  builder.checkTopics();
  tip_link_ = builder.findLink("tip_link", "tip link", description.tip_link);
  contact_links_ = builder.makeContactLinks();
  initial_positions_ = builder.makeInitialPositions();
  compliant_joints_ = builder.makeCompliantJoints();
  joint_of_recorded_name_ = builder.makeJointMap();
}

int Instrument::jointOfRecordedName(const std::string& recorded) const {
  const auto found = joint_of_recorded_name_.find(recorded);
  return found == joint_of_recorded_name_.end() ? -1 : found->second;
}

std::string Instrument::mappedText(const std::vector<std::string>& names) const {
  const std::set<std::string_view> given(names.begin(), names.end());  // a message may name a million
  std::vector<std::string> mapped;
  for (const auto& [recorded, joint] : joint_of_recorded_name_) {
    const std::string& own = model_.joints()[static_cast<std::size_t>(joint)].name;
    if (recorded != own && given.count(own) > 0 && jointOfRecordedName(own) < 0)
      mapped.push_back(std::string(own).append(" as ").append(recorded));
  }
  return mapped.empty() ? std::string()
                        : "joints that joint_names expects under another name: " + listOf(mapped) +
                              "; take those entries out if they come under their own";
}

void Instrument::linkPoses(const VectorX& positions, std::vector<Pose>& X_WL) const {
  model_.forwardKinematics(positions, X_WL);
  for (Pose& X : X_WL) X = X_WB_ * X;
}

}  // namespace tissue_contact
