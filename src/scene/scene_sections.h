/// @file
/// Room `scene`, private: the parts of a scene file, each YAML value in, plain data out. All fail as YamlCursor::fail
/// does.
#pragma once

#include <string>
#include <vector>

#include "scene/yaml_reader.h"
#include "tissue_contact/baselines/solver_description.h"
#include "tissue_contact/core/placed_pose.h"
#include "tissue_contact/core/resolve_path.h"
#include "tissue_contact/instrument/instrument_description.h"
#include "tissue_contact/mesh/region_description.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/tissue/material_description.h"
#include "tissue_contact/tissue/material_preset.h"
#include "tissue_contact/tissue/tissue_description.h"

namespace tissue_contact {

/// What the paths in a scene are resolved with.
struct PathContext {
  std::string base_directory;
  const PackagePath& package_path;
};

/// Any coordinate of a position: far beyond an operating room, near enough to find millimetres typed for metres.
constexpr Range kPositionRange{-1000.0, 1000.0, "m"};
/// Edge or radius of a shape or region.
constexpr Range kShapeSizeRange{1e-6, 100.0, "m", "give metres"};

/// Lengths of lists, all far beyond what a scene needs: pairs of tissues and instruments, and all friction entries for each
/// of them, are held as tables.
constexpr std::size_t kMostBodies = 100;    ///< tissues; instruments
constexpr std::size_t kMostTopics = 100;    ///< of an instrument
constexpr std::size_t kMostPairs = 10'000;  ///< tissue pairs; friction entries
constexpr std::size_t kMostPlaces = 1000;   ///< of all regions of a tissue, of its attachments, of its `fixed`, of its
                                            ///< pressure: each looks at all elements

/// A name that may become part of a ROS topic: [A-Za-z][A-Za-z0-9_]*, at most 64 characters.
std::string parseName(const YamlCursor& cursor);
/// A name of a ROS topic or parameter: parts as in parseName() joined by '/', which may also begin with '/'.
std::string parseRosName(const YamlCursor& cursor);
/// A tf frame: not beginning with '/' (tf2 refuses that), without spaces.
std::string parseFrame(const YamlCursor& cursor);
/// Absolute path of a regular file that exists and whose name ends in one of `extensions` (lower case, with the dot).
/// @param advice what to tell who names a file with another one.
std::string parseFile(const YamlCursor& cursor, const PathContext& paths, const std::vector<std::string>& extensions,
                      const std::string& advice = "");
/// Ending of a file name, with the dot.
std::string lowerExtension(const std::string& file);
PoseDescription parsePose(const YamlCursor& cursor);
/// A direction of any length but 0; returned as a unit vector.
Vector3 parseDirection(const YamlCursor& cursor);

Region parseRegion(const YamlCursor& cursor);
/// A list of at least `fewest` regions.
std::vector<Region> parsePlaces(const YamlCursor& cursor, std::size_t fewest);
/// Refuses an entry of a tissue with which all of its `kind` have too many places.
void requireFewPlaces(const YamlCursor& element, const std::string& kind, std::size_t places);
/// The preset that a material names, alone or as `preset`; null: none.
const MaterialPreset* findPreset(const YamlCursor& material);
/// `is_membrane`: the tissue is a sheet or shell.
MaterialDescription parseMaterial(const YamlCursor& cursor, bool is_membrane);
DampingDescription parseDamping(const YamlCursor& cursor);
/// `tissue` has all but its regions: what they inherit.
std::vector<TissueRegion> parseTissueRegions(const YamlCursor& cursor, const TissueDescription& tissue);
TissueDescription parseTissue(const YamlCursor& cursor, const PathContext& paths);
InstrumentDescription parseInstrument(const YamlCursor& cursor, const PathContext& paths);
/// `scene` has its tissues.
std::vector<TissuePair> parseTissuePairs(const YamlCursor& cursor, const Scene& scene);
/// `scene` has its tissues, instruments and tissue pairs.
std::vector<FrictionDescription> parseFrictionPairs(const YamlCursor& cursor, const Scene& scene);
SolverDescription parseSolver(const YamlCursor& cursor);

}  // namespace tissue_contact
