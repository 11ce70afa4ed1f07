/// @file
/// Room `validation`: tables of joint positions over time, such as config/grasp_path.csv.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/instrument.h"

namespace tissue_contact {

struct JointPath {
  std::vector<std::string> joints;        ///< as the first line names them, after the time
  std::vector<std::vector<double>> rows;  ///< time, s, then a position for each joint
};

/// @throws std::invalid_argument naming the file that cannot be read, or its line that has not one number per column.
JointPath loadJointPath(const std::string& file);

/// config/grasp_path.csv of the package at `directory`: time (s), insertion (m), jaw (rad) at the ends of its phases.
std::vector<Vector3> graspPath(const std::string& directory);

/// The joints at a time of that path, smooth from phase to phase; the others where they start.
VectorX graspJoints(const Instrument& psm, const std::vector<Vector3>& path, double time_s);

}  // namespace tissue_contact
