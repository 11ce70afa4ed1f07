/// @file
/// Room `scene`: the numbers of a scene that may change while it is simulated. A scene and changes by name in, the changed scene out,
/// checked as a scene file is. What goes on how: Simulator::retune().
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/range.h"
#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {

/// A number that may change.
struct Tunable {
  std::string
      key;  ///< by names, "tissues/liver/youngs_modulus_pa": letters, digits, '_', '/', '.' and what a URDF calls its links
  std::string text;  ///< what it is, for people
  double value = 0.0;
  Range range;
  bool is_whole = false;  ///< an integer
};

/// A number to be changed.
struct TunedNumber {
  std::string key;
  double value = 0.0;
};

/// In the order of the scene. Of regions only what the scene gives them: the rest follows their tissue. Not among them are the
/// coefficients of friction given as a table.
std::vector<Tunable> tunables(const Scene& scene);

/// The scene with other numbers. None of them is taken, or all.
/// @throws std::invalid_argument naming the key that is unknown or given twice, or the value, its range and the fix; also where
///   numbers do not go together (kinetic friction above static), as a scene file with them would be refused.
Scene tuned(const Scene& scene, const std::vector<TunedNumber>& numbers);

/// Those of `now` that are not as in `before`, which is the same scene but for such numbers.
std::vector<TunedNumber> differences(const Scene& before, const Scene& now);

}  // namespace tissue_contact
