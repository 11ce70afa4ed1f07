#include <algorithm>
#include <cctype>
#include <set>

#include "scene/scene_sections.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

constexpr Range kJointPositionRange{-1000.0, 1000.0, "rad or m", "give radians (revolute) or metres (prismatic)"};
constexpr const char* kDefaultParameter = "robot_description";

void parseUrdfSource(const YamlMap& map, const PathContext& paths, InstrumentDescription& instrument) {
  map.atMostOne({"urdf", "robot_description"});
  if (const YamlCursor* value = map.find("urdf")) {
    instrument.urdf_file = parseFile(*value, paths, {".urdf", ".xml"});
  } else if (const YamlCursor* parameter = map.find("robot_description")) {
    instrument.robot_description_parameter = parseRosName(*parameter);
  } else {
    instrument.robot_description_parameter = kDefaultParameter;
  }
}

/// Whether a part of the name, between '/' and '_', is one that drivers give to what opens and closes: CRTK
/// /PSM1/jaw/measured_js, older dVRK /dvrk/PSM2/state_jaw_current.
bool isJawByName(const std::string& topic) {
  std::string word;
  for (const char c : topic + "/") {
    if (c != '/' && c != '_') {
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      continue;
    }
    if (word == "jaw" || word == "jaws" || word == "gripper") return true;
    word.clear();
  }
  return false;
}

/// A jaw that the scene says nothing about only updates, if that leaves a topic that triggers.
void defaultTriggers(const std::vector<bool>& is_given, std::vector<JointStateTopic>& topics) {
  bool any_triggers = false;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    any_triggers |= topics[i].triggers && (is_given[i] || !isJawByName(topics[i].name));
  }
  for (std::size_t i = 0; i < topics.size() && any_triggers; ++i) {
    if (!is_given[i]) topics[i].triggers = !isJawByName(topics[i].name);
  }
}

std::vector<JointStateTopic> parseTopics(const YamlCursor& cursor) {
  std::vector<JointStateTopic> topics;
  std::vector<bool> is_given;
  std::set<std::string> seen;
  for (const YamlCursor& element : cursor.list(0, kMostTopics)) {
    topics.emplace_back();
    is_given.push_back(false);
    if (element.isScalar()) {
      topics.back().name = parseRosName(element);
    } else {
      const YamlMap map = element.map();
      topics.back().name = parseRosName(map.get("topic"));
      const YamlCursor* triggers = map.find("triggers");
      is_given.back() = triggers != nullptr;
      if (triggers != nullptr) topics.back().triggers = triggers->boolean();
    }
    if (!seen.insert(topics.back().name).second) {
      element.fail("topic " + inQuotes(topics.back().name) + " is named twice");
    }
  }
  defaultTriggers(is_given, topics);
  const auto triggers = [](const JointStateTopic& topic) { return topic.triggers; };
  if (!topics.empty() && std::none_of(topics.begin(), topics.end(), triggers)) {
    cursor.fail(
        "no topic triggers, so this instrument would never give a wrench; leave triggers out, or make it true, "
        "for the topic of its arm");
  }
  return topics;
}

std::map<std::string, std::string> parseJointNames(const YamlCursor& cursor) {
  std::map<std::string, std::string> names;
  std::map<std::string, std::string> recorded_of_urdf;
  for (const auto& [recorded, value] : cursor.entries()) {
    const std::string urdf = value.text();
    const auto [other, is_new] = recorded_of_urdf.emplace(urdf, recorded);
    if (!is_new) {
      value.fail("URDF joint " + inQuotes(urdf) + " is already driven by recorded joint " + inQuotes(other->second) +
                 "; each URDF joint may be named once");
    }
    names.emplace(recorded, urdf);
  }
  return names;
}

// A mirroring (negative) scale would turn the surface inside out.
constexpr Range kMeshScaleRange{1e-9, 1e6, "m per file unit", "a mesh in millimetres has 0.001"};

MeshGeometry parseMeshGeometry(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map();
  MeshGeometry mesh;
  mesh.file = parseFile(map.get("file"), paths, {".stl", ".obj", ".dae"});
  if (const YamlCursor* value = map.find("scale")) {
    mesh.scale =
        value->isScalar() ? Vector3::Constant(value->number(kMeshScaleRange)).eval() : value->vector3(kMeshScaleRange);
  }
  return mesh;
}

ShapeGeometry parseShapeGeometry(const YamlMap& map, const PathContext& paths) {
  const std::string kind = map.exactlyOne({"sphere", "box", "cylinder", "mesh"});
  const YamlCursor& value = map.get(kind);
  if (kind == "sphere") {
    return SphereGeometry{value.map().get("radius_m").number(kShapeSizeRange)};
  }
  if (kind == "box") return BoxGeometry{value.map().get("size_m").vector3(kShapeSizeRange)};
  if (kind == "mesh") return parseMeshGeometry(value, paths);
  const YamlMap cylinder = value.map();
  return CylinderGeometry{cylinder.get("radius_m").number(kShapeSizeRange),
                          cylinder.get("length_m").number(kShapeSizeRange)};
}

ShapeDescription parseShape(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map();
  ShapeDescription shape;
  shape.geometry = parseShapeGeometry(map, paths);
  if (const YamlCursor* value = map.find("pose")) shape.X_LS = parsePose(*value).X;
  return shape;
}

ContactLinkDescription parseContactLink(const YamlCursor& cursor, const PathContext& paths) {
  if (cursor.isScalar()) return {cursor.text(), {}};
  const YamlMap map = cursor.map();
  ContactLinkDescription link;
  link.link = map.get("link").text();
  if (const YamlCursor* value = map.find("shapes")) {
    for (const YamlCursor& shape : value->list(1, kMostShapes)) link.shapes.push_back(parseShape(shape, paths));
  }
  return link;
}

std::vector<ContactLinkDescription> parseContactLinks(const YamlCursor& cursor, const PathContext& paths) {
  std::vector<ContactLinkDescription> links;
  std::set<std::string> seen;
  for (const YamlCursor& element : cursor.list(1, kMostShapes)) {
    links.push_back(parseContactLink(element, paths));
    if (!seen.insert(links.back().link).second) {
      element.fail("link " + inQuotes(links.back().link) + " is named twice; list all its shapes in one place");
    }
  }
  return links;
}

constexpr Range kTurningStiffnessRange{1e-6, 1e9, "N m/rad",
                                       "torque over the angle by which it makes the joint give way"};
constexpr Range kSlidingStiffnessRange{1e-3, 1e12, "N/m", "force over the way by which it makes the joint give way"};
constexpr Range kTorqueLimitRange{1e-9, 1e6, "N m",
                                  "force times distance from the joint's axis, of each jaw that it moves"};
constexpr Range kForceLimitRange{1e-9, 1e9, "N", "the force at the finger, of each that it moves"};

JointCompliance parseCompliance(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  JointCompliance compliance;
  compliance.joint = map.get("joint").text();
  const std::string stiffness = map.exactlyOne({"stiffness_n_m_per_rad", "stiffness_n_per_m"});
  compliance.slides = stiffness == "stiffness_n_per_m";
  compliance.stiffness = map.get(stiffness).number(compliance.slides ? kSlidingStiffnessRange : kTurningStiffnessRange);
  const YamlCursor* const torque = map.find("torque_limit_n_m");
  const YamlCursor* const force = map.find("force_limit_n");
  if (const YamlCursor* other = compliance.slides ? torque : force) {
    other->fail(
        "a joint that turns has stiffness_n_m_per_rad and torque_limit_n_m, "
        "one that slides stiffness_n_per_m and force_limit_n");
  }
  if (torque != nullptr) compliance.effort_limit = torque->number(kTorqueLimitRange);
  if (force != nullptr) compliance.effort_limit = force->number(kForceLimitRange);
  return compliance;
}

}  // namespace

InstrumentDescription parseInstrument(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map();
  InstrumentDescription instrument;
  instrument.name = parseName(map.get("name"));
  parseUrdfSource(map, paths, instrument);
  if (const YamlCursor* value = map.find("base_pose")) instrument.base_pose = parsePose(*value);
  if (const YamlCursor* value = map.find("joint_state_topics")) instrument.joint_state_topics = parseTopics(*value);
  if (const YamlCursor* value = map.find("joint_names")) instrument.joint_names = parseJointNames(*value);
  if (const YamlCursor* value = map.find("initial_joint_positions")) {
    for (const auto& [joint, position] : value->entries()) {
      instrument.initial_joint_positions.emplace(joint, position.number(kJointPositionRange));
    }
  }
  if (const YamlCursor* value = map.find("compliant_joints")) {
    for (const YamlCursor& joint : value->list(1, kMostShapes)) {
      instrument.compliant_joints.push_back(parseCompliance(joint));
    }
  }
  instrument.tip_link = map.get("tip_link").text();
  instrument.contact_links = parseContactLinks(map.get("contact_links"), paths);
  return instrument;
}

}  // namespace tissue_contact
