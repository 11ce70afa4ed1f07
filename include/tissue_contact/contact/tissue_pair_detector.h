/// @file
/// Room `contact`: tissue surfaces against each other, and folds of one surface against itself. Surface positions in,
/// contacts out.
#pragma once

#include <memory>
#include <vector>

#include "tissue_contact/contact/contact.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/tissue_surface.h"

namespace tissue_contact {

/// Indices of two tissues that may touch; the same index twice: folds of one tissue.
struct TouchingTissues {
  int tissue = 0;
  int other = 0;
};

class TissuePairDetector {
 public:
  /// @param surfaces of all tissues of the scene. Parts of one that are near each other at rest are no folds.
  /// @throws std::invalid_argument for an unknown index or a pair listed twice (in either order).
  TissuePairDetector(std::vector<TouchingTissues> pairs, SharedSurfaces surfaces);
  ~TissuePairDetector();
  TissuePairDetector(TissuePairDetector&&) noexcept;
  TissuePairDetector& operator=(TissuePairDetector&&) noexcept;

  /// Appends every vertex-face and edge-edge pair nearer than the margin of the tissues: `tissue` and `nodes` hold one point, the
  /// `other_*` members the point in the instrument's place, n from it into `tissue`. At most 4 nodes have a weight.
  /// What is appended is sorted by key. Deterministic: depends on the arguments alone. No allocation once vectors have
  /// grown. Not thread-safe. Non-finite positions give no contact. Which pairs count: src/contact/pair/vertex_face.h and
  /// edge_edge.h.
  /// @param margins_m per pair of tissues.
  /// @param apart per pair: known not to touch and left out; empty: none is.
  /// @param known contacts between tissues of the step before (edge_edge.h); empty: there were none.
  /// @throws std::invalid_argument for sizes that differ from the construction's and a margin not finite or < 0.
  void detect(const std::vector<NodalVectors>& positions, const std::vector<double>& margins_m,
              const std::vector<bool>& apart, const std::vector<ContactKey>& known, std::vector<Contact>& contacts);
  /// All pairs, with the same margin.
  void detect(const std::vector<NodalVectors>& positions, double margin_m, std::vector<Contact>& contacts);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace tissue_contact
