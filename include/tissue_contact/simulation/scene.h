/// @file
/// Room `simulation`: a scene as plain data in SI units: what the YAML file says, checked, with every path resolved and
/// every default filled in. Each room describes its own part. Keys, units and defaults: doc/scene.md.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tissue_contact/baselines/solver_description.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/friction/friction_law_description.h"
#include "tissue_contact/instrument/instrument_description.h"
#include "tissue_contact/tissue/tissue_description.h"

namespace tissue_contact {

/// Two tissues that may touch each other; the same one twice: folds of one tissue.
struct TissuePair {
  std::string tissue;
  std::string other;
};

/// Friction of one pair. Pairs not listed are frictionless. The most specific entry counts: with link and region, with
/// link, with region, with neither.
struct FrictionDescription {
  std::string instrument;  ///< empty when `other_tissue` is given
  std::string link;        ///< of the instrument; empty: all
  std::string tissue;
  std::string region;        ///< of the tissue; empty: everywhere
  std::string other_tissue;  ///< tissue against tissue (or its own folds)
  FrictionLawDescription law;
};

/// Which joint states the simulation stops at.
enum class StatePolicy {
  kAuto,        ///< whoever plays them decides: kEveryState for recordings, kNewestState beside a robot driver
  kEveryState,  ///< each, in the order of their stamps; nothing is skipped however long it takes
  kNewestState  ///< the newest there is; older ones are merged into the motion towards it
};

struct StepDescription {
  double max_step_s = 0.001;  ///< an interval between joint states is cut into equal steps no longer than this
  double max_gap_s = 1.0;     ///< a longer interval between joint states is simulated as this long (counted)
  StatePolicy joint_states = StatePolicy::kAuto;
  double max_lag_s = 0.02;  ///< how far the answer may lag behind the newest joint state under kNewestState
};

/// Which simplifications the simulator may choose for itself, where the scene allows them.
struct AdvisorDescription {
  bool sleep = true;             ///< nodes at rest away from contacts are left out
  double sleep_error = 0.001;    ///< what holds them may sum up to this share of the contact force
  bool adapt_rotations = false;  ///< corotational bodies are linear while nothing in them turns far
  bool skip_folds = true;        ///< folds of convex bodies are not looked for while they are impossible
  bool general_friction =
      false;  ///< isotropic friction and none take the path of directional laws: to measure its cost
};

struct Scene {
  std::string file;  ///< where it was read from, for messages; may be empty
  /// Line of each entry in it by its path, "tissues[0].material"; 0: set from outside; empty for a scene that was not read.
  std::map<std::string, int> entry_lines;
  std::string world_frame = "world";
  Vector3 gravity_m_per_s2 = Vector3::Zero();
  std::vector<TissueDescription> tissues;
  std::vector<InstrumentDescription> instruments;
  std::vector<TissuePair> tissue_pairs;
  std::vector<FrictionDescription> friction;
  StepDescription step;
  SolverDescription solver;
  AdvisorDescription advisor;
};

/// Whether an instrument of it takes its URDF from a parameter.
bool takesUrdfFromParameter(const Scene& scene);

/// "file:line: entry" for messages, the line being that of the nearest entry around it that the file has; without what
/// the scene does not know.
std::string placeOf(const Scene& scene, const std::string& entry);

/// Two points of two tissues may meet as a contact of either, so that only laws that axis 1 mirrors are the same in both;
/// and no link of an instrument is there. @param has_fibre whether the tissue, or its region, has a fibre direction.
/// @throws EntryError of an entry of a friction pair, "law" or "axis".
void requireLawForPair(const FrictionDescription& pair, bool has_fibre);

}  // namespace tissue_contact
