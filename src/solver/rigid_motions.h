/// @file
/// Room `solver`, private: deflation of the sweeps over one body by the rigid motions of its stiff parts. A part that is far stiffer than
/// what is around it moves as one, and node after node sweeps are slow to move it; between a sweep forth and the sweep back each part is
/// shifted and turned to where the energy v'A v / 2 - (b + J'lambda)'v is least.
///
/// Jonsthovel, van Gijzen, Vuik, Kasbergen & Scarpas, "Preconditioned Conjugate Gradient Method Enhanced by Deflation of Rigid Body Modes
/// Applied to Composite Materials", CMES 47 (2009) 97-118. Figures: doc/notes/method.md.
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "core/padded_vectors.h"
#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// With Z, a part's six rigid motions, and L, A below the diagonal: a sweep forth from v0 to v leaves the defect -L'(v - v0), whose part
/// along Z is -(L Z)'(v - v0). L Z, which has rows at the part and beside it alone, is found once in a step.
///
/// Nodes that contacts may move have no part in it (Deflation): the rest of the part moves beside them.
class RigidMotions {
 public:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Rows = Eigen::Matrix<double, 3, 6>;

  /// Velocity at `arm` from the middle of what moves, of three shifts and three turns.
  static Rows motionsOf(const Vector3& arm);
  static Vector3 velocityOf(const Vector6& motion, const Vector3& arm) {
    return motion.head<3>() + motion.tail<3>().cross(arm);
  }

  /// Of a step. Allocates only for more parts, or larger ones in their places, than before.
  /// @param body with stiff parts; stays until the next begin() or none().
  /// @param excluded nodes that contacts may move, ascending.
  void begin(const BodySystem& body, const std::vector<int>& excluded);
  void none() { used_ = 0; }
  bool any() const { return used_ > 0; }

  /// A sweep forth begins.
  void beginForth();

  /// A node has moved since the sweep forth, which changes L v of node j by `added`, N s.
  void follow(int j, const Vector3& added) {
    if (used_ > 0) followInParts(j, added);
  }

  /// With what else moved followed. Moves v (m/s) and `lower`, L v (N s).
  /// @param begun where the sweep forth began, m/s.
  /// @param changed called with a node and by how much its row of A v has changed, but for what is above the diagonal, N s.
  template <class Changed>
  void correct(const PaddedVectors& begun, PaddedVectors& v, PaddedVectors& lower, const Changed& changed) {
    for (std::size_t p = 0; p < used_; ++p) {
      const Vector6 motion = wanted(parts_[p], begun, v);
      for (const Member& member : parts_[p].members) {
        const Vector3 moved = velocityOf(motion, member.arm);
        vectorOf(v[static_cast<std::size_t>(member.node)]) += moved;
        changed(member.node, ownProduct(member.node, moved));
      }
      for (const Row& row : parts_[p].rows) {
        const Vector3 added = row.lower * motion;
        vectorOf(lower[static_cast<std::size_t>(row.node)]) += added;
        follow(row.node, added);
        changed(row.node, added);
      }
    }
  }

 private:
  struct Member {
    int node;
    Vector3 arm;  ///< from the middle of the part, over its radius
  };
  struct Row {
    int node;
    Rows lower;  ///< of L Z, N s
  };
  /// The first three of Z shift it by 1 m/s, the others turn it so that 1 m/s is the speed at its radius.
  struct Part {
    std::vector<Member> members;
    std::vector<Row> rows;
    Eigen::LLT<Matrix6> energy;  ///< of Z'A Z, J
    Vector6 followed;            ///< Z' of what was followed since the sweep forth, J
  };

  /// Of what mass alone has of it, as in Deflation.
  static constexpr double kLeastEnergy = 0.5;
  /// Reciprocal condition of Z'A Z; that of nodes in a line, which turn about it for nothing, is round-off.
  static constexpr double kLeastCondition = 1e-10;

  /// Z' of a vector (N s) at a member.
  static Vector6 along(const Vector3& arm, const Vector3& vector);

  bool measure(const std::vector<int>& nodes, const std::vector<int>& excluded, Part& part);
  void use();
  void addBelow(const Member& member, Part& part);
  bool factor(Part& part) const;
  void followInParts(int j, const Vector3& added);
  Matrix3 ownBlock(int node) const;
  Vector3 ownProduct(int node, const Vector3& v) const { return ownBlock(node) * v; }
  Vector6 wanted(const Part& part, const PaddedVectors& begun, const PaddedVectors& v) const;

  const BodySystem* body_ = nullptr;
  std::vector<Part> parts_;  ///< the first used_ of them; others keep their memory
  std::size_t used_ = 0;
  struct Place {
    int part = -1;
    int member = -1;
  };
  std::vector<Place> place_of_;  ///< per node: where it is a member
  std::vector<int> row_of_;      ///< scratch, per node: its row in the part that is measured, else -1
};

}  // namespace tissue_contact
