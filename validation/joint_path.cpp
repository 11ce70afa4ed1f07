#include "validation/joint_path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {

JointPath loadJointPath(const std::string& file) {
  constexpr std::uintmax_t kMostBytes = 64U << 20U;
  std::istringstream text(readFile(file, "joint path", kMostBytes));
  JointPath path;
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    std::istringstream words(line);
    std::string word;
    if (number == 1) {
      while (std::getline(words, word, ',')) path.joints.push_back(word);
      continue;
    }
    std::vector<double>& row = path.rows.emplace_back();
    while (std::getline(words, word, ',')) {
      const std::optional<double> value = toDouble(word);
      if (value && std::isfinite(*value)) row.push_back(*value);
    }
    const bool complete = row.size() == path.joints.size() && !row.empty() &&
                          std::count(line.begin(), line.end(), ',') + 1 == static_cast<std::ptrdiff_t>(row.size());
    const std::size_t rows = path.rows.size();
    if (!complete || (rows > 1 && !(row.front() > path.rows[rows - 2].front()))) {
      throw std::invalid_argument(
          file + ":" + std::to_string(number) + ": must have one finite number for each of the " +
          std::to_string(path.joints.size()) +
          " columns of the first line, separated by commas, and times that rise; it is " + inQuotes(line));
    }
  }
  if (path.rows.size() < 2) throw std::invalid_argument(file + ": has fewer than two rows");
  path.joints.erase(path.joints.begin());
  return path;
}

std::vector<Vector3> graspPath(const std::string& directory) {
  const JointPath path = loadJointPath(directory + "/config/grasp_path.csv");
  if (path.joints != std::vector<std::string>{"insertion", "jaw"}) {
    throw std::invalid_argument("config/grasp_path.csv: the head must be time_s,insertion,jaw");
  }
  std::vector<Vector3> rows;
  for (const std::vector<double>& row : path.rows) rows.emplace_back(row[0], row[1], row[2]);
  return rows;
}

VectorX graspJoints(const Instrument& psm, const std::vector<Vector3>& path, double time_s) {
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
