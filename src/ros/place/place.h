/// @file
/// Room `ros/place`, private: tissue_contact_place: where things are in a scene before it runs. No roscore.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace tissue_contact {

struct PlaceOptions {
  std::string task;  ///< "base", "surface", "approach" or "picture"
  std::string scene_file;
  std::string bag_file;    ///< empty: none
  std::string urdf_file;   ///< empty: no scene parameter holds a URDF
  std::string measured;    ///< topic
  std::string instrument;  ///< empty: the first that moves
  double x_m = 0.0, y_m = 0.0;
  std::string out_file;
  bool help = false;  ///< show the usage and do nothing
};

/// What --help prints.
std::string placeUsage();

/// @param arguments without the program's name.
/// @throws std::invalid_argument naming the argument that is unknown, missing, without a value or of another task.
PlaceOptions parsePlaceOptions(const std::vector<std::string>& arguments);

/// Prints the pose of an instrument's base by registration of its tip to a topic of measured poses, as YAML to paste.
/// @throws std::exception saying what is wrong, as do those below.
void placeBase(const PlaceOptions& options);

/// Prints the points of tissue surfaces above and below x, y, the uppermost first, as YAML.
void placeSurface(const PlaceOptions& options);

/// Prints how near a bag's motion brings instruments to the tissues at rest.
void placeApproach(const PlaceOptions& options);

/// Writes a picture of the scene at its start, with the way of the tips where there is a bag.
void placePicture(const PlaceOptions& options);

/// main() of tissue_contact_place.
/// @return exit code: 0, or 1 after one message on stderr.
int runPlace(int argc, char** argv);

}  // namespace tissue_contact
