/// @file
/// Room `simulation`, private: which tissue pairs cannot touch. Pairs and positions in; those that cannot touch out.
#pragma once

#include <optional>
#include <vector>

#include "tissue_contact/contact/tissue_pair_detector.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/convex_body.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// Folds of a volume that is convex at rest, while it is not deformed far enough (see convex_body.h). No contact is
/// missed in a step in which no node moves farther than the travel that is given.
class FoldWatch {
 public:
  FoldWatch() = default;
  FoldWatch(const std::vector<TouchingTissues>& pairs, const std::vector<Tissue>& tissues);

  /// What is watched of a tissue that may fold; none where it may not, or cannot be left out.
  std::optional<ConvexBody> bodyOf(int index, const Tissue& tissue) const;
  /// Goes on with another mesh of a tissue, whose body is exchanged for that before.
  void swapMesh(int index, std::optional<ConvexBody>& body);

  /// Per pair, whether it can be left out; empty: none ever can. No allocation.
  /// @param travels_m per tissue: the way any node of it may go in the coming step.
  const std::vector<bool>& apart(const std::vector<NodalVectors>& positions, const std::vector<double>& travels_m);

  bool watches(std::size_t pair) const { return !bodies_.empty() && bodies_[pair].has_value(); }

 private:
  std::vector<TouchingTissues> pairs_;
  std::vector<std::optional<ConvexBody>> bodies_;  ///< per pair
  std::vector<bool> apart_;
};

}  // namespace tissue_contact
