#include <algorithm>
#include <cctype>
#include <filesystem>

#include "scene/scene_sections.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxNameLength = 64;
// A full turn: angles typed in degrees are mostly beyond it.
constexpr Range kAngleRange{-6.2832, 6.2832, "rad", "give radians, not degrees"};
constexpr double kQuaternionNormTolerance = 1e-3;
constexpr Range kDirectionRange{-1000.0, 1000.0};
constexpr double kLeastDirectionLength = 1e-6;

// Not std::isalpha: a locale may call more letters alphabetic than ROS allows in a name.
bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool isNamePart(const std::string& text) {
  const auto is_allowed = [](char c) { return isLetter(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !text.empty() && isLetter(text.front()) && std::all_of(text.begin(), text.end(), is_allowed);
}

Quaternion parseQuaternion(const YamlCursor& cursor) {
  const std::vector<YamlCursor> components = cursor.tuple(4);
  const Range range{-1.0 - kQuaternionNormTolerance, 1.0 + kQuaternionNormTolerance};
  const Quaternion q(components[3].number(range), components[0].number(range), components[1].number(range),
                     components[2].number(range));
  if (!(std::abs(q.norm() - 1.0) <= kQuaternionNormTolerance)) {
    cursor.fail("has norm " + std::to_string(q.norm()) +
                "; a rotation must have norm 1 within 0.001; give [x, y, z, w] of a unit quaternion");
  }
  return q.normalized();
}

/// Fixed axes as in URDF: roll about x, then pitch about y, then yaw about z.
Quaternion fromRollPitchYaw(const Vector3& rpy) {
  return Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
         Eigen::AngleAxisd(rpy.x(), Vector3::UnitX());
}

}  // namespace

std::string lowerExtension(const std::string& file) {
  std::string extension = fs::path(file).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

std::string parseName(const YamlCursor& cursor) {
  std::string name = cursor.text();
  if (!isNamePart(name) || name.size() > kMaxNameLength) {
    cursor.fail("is " + inQuotes(name) +
                "; names become parts of ROS topics, so each must begin with a letter, hold only letters, digits and "
                "underscores, and have at most 64 characters");
  }
  return name;
}

std::string parseRosName(const YamlCursor& cursor) {
  std::string name = cursor.text();
  if (name.front() == '~') {
    cursor.fail("is " + inQuotes(name) +
                "; a private name is of no node here: write it in full, for example /node/name");
  }
  std::size_t begin = name.front() == '/' ? 1 : 0;
  bool is_good = true;
  while (is_good && begin != std::string::npos) {
    const std::size_t slash = name.find('/', begin);
    is_good = isNamePart(name.substr(begin, slash == std::string::npos ? slash : slash - begin));
    begin = slash == std::string::npos ? slash : slash + 1;
  }
  if (!is_good) {
    cursor.fail("is " + inQuotes(name) +
                "; a ROS name must be parts joined by '/', each of letters, digits and underscores and beginning with "
                "a letter, for example /PSM1/measured_js");
  }
  return name;
}

std::string parseFrame(const YamlCursor& cursor) {
  std::string frame = cursor.text();
  if (frame.front() == '/' || frame.find(' ') != std::string::npos) {
    cursor.fail("is " + inQuotes(frame) + "; a tf frame must not begin with '/' nor hold spaces");
  }
  return frame;
}

std::string parseFile(const YamlCursor& cursor, const PathContext& paths, const std::vector<std::string>& extensions,
                      const std::string& advice) {
  const std::string uri = cursor.text();
  std::string file;
  try {
    file = resolvePath(uri, paths.base_directory, paths.package_path);
  } catch (const std::invalid_argument& error) {
    cursor.fail(error.what());
  }
  if (std::find(extensions.begin(), extensions.end(), lowerExtension(file)) == extensions.end()) {
    if (lowerExtension(file) == ".xacro") {
      const std::string urdf = uri.substr(0, uri.size() - std::string(".xacro").size());
      cursor.fail("file " + inQuotes(uri) + " is a xacro file; expand it first: xacro " + uri + " > " + urdf +
                  (lowerExtension(urdf) == ".urdf" ? "" : ".urdf") +
                  ", or name none and load its output into the parameter robot_description");
    }
    cursor.fail("file " + inQuotes(uri) + " has none of the allowed endings: " + joined(extensions) + advice);
  }
  try {
    requireRegularFile(file, "file");
  } catch (const std::invalid_argument& error) {
    const std::string problem = error.what();
    const bool is_missing = problem.find("does not exist") != std::string::npos;
    cursor.fail(problem + (is_missing ? "; relative paths start at the scene file" : ""));
  }
  return file;
}

PoseDescription parsePose(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  map.atMostOne({"rpy_rad", "quaternion_xyzw"});
  PoseDescription pose;
  if (const YamlCursor* value = map.find("position_m")) pose.X.translation() = value->vector3(kPositionRange);
  if (const YamlCursor* value = map.find("rpy_rad")) {
    pose.X.linear() = fromRollPitchYaw(value->vector3(kAngleRange)).toRotationMatrix();
  }
  if (const YamlCursor* value = map.find("quaternion_xyzw")) {
    pose.X.linear() = parseQuaternion(*value).toRotationMatrix();
  }
  if (const YamlCursor* value = map.find("tf_frame")) pose.tf_frame = parseFrame(*value);
  return pose;
}

Vector3 parseDirection(const YamlCursor& cursor) {
  const Vector3 direction = cursor.vector3(kDirectionRange);
  const double length = direction.norm();
  if (!(length >= kLeastDirectionLength)) {
    cursor.fail("has length " + std::to_string(length) + "; it must point somewhere: [0, 0, 1]");
  }
  return direction / length;
}

}  // namespace tissue_contact
