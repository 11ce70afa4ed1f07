/// @file
/// Room `validation`: tables of joint positions over time, such as config/grasp_path.csv.
#pragma once

#include <algorithm>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/instrument.h"

namespace tissue_contact {

struct JointPath {
  std::vector<std::string> joints;        ///< as the first line names them, after the time
  std::vector<std::vector<double>> rows;  ///< time, s, then a position for each joint
};

/// @throws std::invalid_argument naming the file that cannot be read, or its line that has not one number per column.
inline JointPath loadJointPath(const std::string& file) {
  constexpr std::uintmax_t kMostBytes = 64U << 20U;
  std::istringstream text(readFile(file, "joint path", kMostBytes));
  JointPath path;
  for (std::string line; std::getline(text, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    if (path.joints.empty()) {
      for (std::string word; words >> word;) path.joints.push_back(word);
      continue;
    }
    std::vector<double>& row = path.rows.emplace_back();
    for (double value = 0.0; words >> value;) row.push_back(value);
    if (row.size() != path.joints.size()) throw std::invalid_argument(file + ": not one number per column: " + line);
  }
  if (path.rows.size() < 2) throw std::invalid_argument(file + ": has fewer than two rows");
  path.joints.erase(path.joints.begin());
  return path;
}

/// config/grasp_path.csv of the package at `directory`: time (s), insertion (m), jaw (rad) at the ends of its phases.
inline std::vector<Vector3> graspPath(const std::string& directory) {
  const JointPath path = loadJointPath(directory + "/config/grasp_path.csv");
  if (path.joints != std::vector<std::string>{"insertion", "jaw"}) {
    throw std::invalid_argument("config/grasp_path.csv: the head must be time_s,insertion,jaw");
  }
  std::vector<Vector3> rows;
  for (const std::vector<double>& row : path.rows) rows.emplace_back(row[0], row[1], row[2]);
  return rows;
}

/// The joints at a time of that path, smooth from phase to phase; the others where they start.
inline VectorX graspJoints(const Instrument& psm, const std::vector<Vector3>& path, double time_s) {
  const auto after =
      std::find_if(path.begin() + 1, path.end() - 1, [&](const Vector3& row) { return time_s <= row.x(); });
  const double part = (time_s - (after - 1)->x()) / (after->x() - (after - 1)->x());
  const Vector3 row = *(after - 1) + part * part * (3.0 - 2.0 * part) * (*after - *(after - 1));
  VectorX positions = psm.initialPositions();
  positions[psm.model().findJoint("insertion")] = row.y();
  positions[psm.model().findJoint("jaw")] = row.z();
  return positions;
}

}  // namespace tissue_contact
