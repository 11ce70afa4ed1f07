/// @file
/// Room `simulation`, private: which nodes of a tissue sleep: they have come to rest away from contacts, are held where
/// they are and left out of the step until they would move. Positions, forces and contacts of each step in; the nodes
/// to solve for, and what holding the others amounts to, out.
///
/// A node falls asleep when it has stayed within kStillPerEdge of an edge for kStillTime, no contact is within a ring
/// of elements, and the force on it is below its share of half the allowed sum. Without a contact on the tissue, all
/// its nodes fall asleep together or none does; a tissue without a fixed or attached node never sleeps, for it may
/// drift. While
/// nodes sleep, the force that holding each of them takes is known exactly, as what its equation of motion leaves with
/// v = 0; the sum of their magnitudes never exceeds `allowed`: before it would, within the same step, those that are
/// held by more than their share wake, with the ring around them, and the step is solved again.
///
/// Error bound: a held force h at a node changes the force on a tool by h . (displacement of the node per displacement
/// of the tool), by reciprocity of the linearised elastic body. In a body that is held at its base that ratio is at
/// most about 1 and falls with distance, so the error of a force is at most about `allowed`. Where the tool sits near
/// the root of a lever, the far end moves more than the tool, and the bound grows by that ratio. Positions of sleepers
/// are within kStillPerEdge of an edge of where they were last seen to stay.
#pragma once

#include <vector>

#include "tissue_contact/core/state_archive.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// One tissue's share. No allocation once nodes have slept.
class TissueSleep {
 public:
  static constexpr double kStillPerEdge = 1e-3;
  static constexpr double kStillTime = 0.5;   ///< s: half a swing at 1 Hz
  static constexpr double kCheckTime = 0.02;  ///< s, between two checks of who may sleep
  /// Share of the free nodes that must be ready before any falls asleep: each time the elements to evaluate change.
  static constexpr double kWorthwhile = 0.1;

  /// @param fixed per node.
  /// @param body the tissue's system of each step; both must outlive it.
  /// @param edge_m length of an element's edge.
  /// @param attachment_n_per_m what attachments hold the whole tissue by, N/m; 0: none.
  /// @param by_parts some nodes may sleep while others are awake.
  TissueSleep(const std::vector<bool>& fixed, const BodySystem& body, double edge_m, double attachment_n_per_m,
              bool by_parts);

  void wakeAll();
  void carry(StateArchive& archive);

  int sleepers() const { return static_cast<int>(sleepers_.size()); }
  bool allAsleep() const { return free_nodes_ > 0 && sleepers() == free_nodes_; }
  const std::vector<bool>& still() const { return still_; }  ///< per node: fixed or asleep

  /// A contact acts on this node: it and the ring around it wake, all nodes if all sleep.
  void touch(int node);

  /// Sums up what the sleepers are held by, after the solve of a step, and wakes those held by too much. `woken` gets
  /// them.
  /// @param loads elastic force, pressure and weight of each node, N.
  /// @param v the answer, m/s.
  /// @param allowed_n the most the sum may be.
  /// @param repeats how often this step has been solved already.
  /// @return whether any woke: the step is to be solved again.
  bool wakeHeld(const NodalVectors& loads, const NodalVectors& v, double dt, double allowed_n, int repeats,
                std::vector<int>& woken);
  double heldForce() const { return held_force_; }  ///< sum of magnitudes, N

  /// Ends a step of `dt`.
  /// @return whether it is time to call rest().
  bool isTimeToCheck(double dt);

  /// Lets nodes fall asleep.
  /// @param touched nodes that contacts act on.
  /// @return whether any did: their velocity is to become 0.
  bool rest(const NodalVectors& x, const NodalVectors& loads, double allowed_n, const std::vector<int>& touched);

  /// Force that moves a node by an edge while its neighbours stay, mean over the free nodes, N: the measure
  /// of the allowed sum while nothing presses. Where attachments alone hold the tissue, at most what moves all of it by
  /// an edge against them.
  double ownForce() const { return own_force_; }

 private:
  void wake(int node) {
    still_[node] = fixed_[node];
    still_checks_[node] = 0;
  }
  void wakeRing(int node);
  void countStillTime(const NodalVectors& x);
  void findReady(const NodalVectors& loads, double allowed_n, const std::vector<int>& touched);
  void listSleepers();
  Vector3 heldBy(int node, const NodalVectors& loads, const NodalVectors& v, double dt) const;

  const std::vector<bool>& fixed_;
  const BodySystem& body_;
  double radius_;  ///< within which a node is still, m
  bool may_drift_ = false;
  bool by_parts_;
  double own_force_ = 0.0;
  int free_nodes_ = 0;
  std::vector<bool> still_;
  std::vector<int> sleepers_;       ///< ascending
  std::vector<bool> beside_awake_;  ///< per sleeper: a neighbour of it is awake
  std::vector<double> held_;        ///< scratch, per sleeper, N
  NodalVectors anchors_;            ///< where each node was when it last moved by more than the radius
  std::vector<unsigned char> still_checks_;
  std::vector<int> ready_;    ///< scratch
  std::vector<bool> near_;    ///< scratch, per node: in a contact or in the ring around one
  double since_check_ = 0.0;  ///< s
  double held_force_ = 0.0;
};

}  // namespace tissue_contact
