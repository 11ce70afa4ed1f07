/// @file
/// Room `solver`, private: a coarse level for the sweeps over one body, of rigid motions of a few large parts that overlap and blend into each
/// other. Sweeps pass a motion on from node to node, and are slow where it has far to go: in what is slender, stiff beside its mass, stepped
/// in long steps or nearly incompressible.
///
/// Sarkis, "Partition of Unity Coarse Spaces: Enhanced Versions, Discontinuous Coefficients and Applications to Elasticity", Domain
/// Decomposition Methods in Science and Engineering XIV (2003) 149-158. Figures: doc/notes/method.md.
#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "core/padded_vectors.h"
#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// With Z, the rigid motions of all parts, each times the part's weight at the node: of a defect r the direction Z (Z'A Z)^-1 Z'r.
///
/// Nodes that contacts may move have no part in it (Deflation).
class CoarseMotions {
 public:
  static constexpr std::size_t kMostParts = 16;

  /// A node's share in a part.
  struct Share {
    std::size_t part;
    double weight;
  };

  /// Of a step. Allocates the first time, and for a body of more nodes or other parts than before.
  /// @param body without x: has none. @param excluded nodes that contacts may move, ascending.
  void begin(const BodySystem& body, const std::vector<int>& excluded);
  void none() { any_ = false; }
  bool any() const { return any_; }

  /// @param defect N s, per node. @param along m/s; 0 at nodes that are fixed or excluded.
  void direction(const PaddedVectors& defect, PaddedVectors& along);

 private:
  static constexpr std::size_t kLeastNodes = 20;  ///< of a part, or there are fewer parts; of all that take part

  void findParts(const BlockPattern& pattern);
  template <class Visit>
  void spread(const BlockPattern& pattern, int from, const Visit& visit);
  void blend(const BlockPattern& pattern, const std::array<int, kMostParts>& middles, int end);
  void place(const NodalVectors& x);
  bool factor(const BodySystem& body);
  void solve();

  bool any_ = false;
  std::shared_ptr<const BlockPattern> pattern_;  ///< of which the parts are
  std::size_t parts_ = 0;
  std::vector<std::size_t> first_;  ///< nodes + 1 offsets into shares_
  std::vector<Share> shares_;
  std::vector<unsigned char> takes_part_;  ///< per node, in this step
  PaddedVectors place_;                    ///< from the middle of the body, over its size
  /// Of a part: motions about its middle, over its radius, as motions about that of the body.
  std::vector<Eigen::Matrix<double, 6, 6>> about_middle_;
  std::vector<std::array<double, 36>> sums_;  ///< scratch, of pairs of parts
  Eigen::MatrixXd energy_;                    ///< Z'A Z, J, below the diagonal
  Eigen::LLT<Eigen::MatrixXd> factor_;        ///< of it
  VectorX motion_;                            ///< scratch: of all parts
  // Scratch of findParts().
  std::vector<std::pair<int, int>> front_;          ///< nodes and their hops
  std::vector<int> joined_;                         ///< nodes with blocks
  std::vector<int> nearest_;                        ///< per node
  std::vector<std::pair<std::size_t, Share>> met_;  ///< nodes with their shares, part after part
};

}  // namespace tissue_contact
