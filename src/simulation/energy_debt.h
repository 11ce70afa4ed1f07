/// @file
/// Room `simulation`, private: energy that steps have brought into a tissue from nothing.
#pragma once

#include <vector>

#include "tissue_contact/core/state_archive.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Leaves a share of the velocities `v` (3 x nodes); of a tissue of which nothing is fixed of those about the centre of mass's, which no force of
/// its own changes (its spin is not kept).
void slowDown(const VectorX& mass, bool is_free, double share, NodalVectors& v);

/// Implicit steps are stable once they are solved, linear ones. What a few iterations reach may hold more energy than the step before and what did work
/// since, as may one that is solved to the tolerance where a stiff body turns about an edge or a point that holds it: that is
/// stretch to the step, with forces far larger than those that drive it; and steps that pass it on grow without bound. So the balance of such steps is made up (doc/method.md, "When a
/// step ends"), and what there is too much is taken from the velocities, as far as they go; of a step that was cut short also in later ones until one is solved.
class EnergyDebt {
 public:
  /// Nothing is owed, and the next step has none before it.
  void clear();

  /// A step begins. Slows `v` down by what is owed. Allocates only for more nodes than ever before.
  /// @param forces elastic forces, attachments and pressure where the nodes are, N, 3 x nodes.
  /// @param mass kg, per node.
  /// @param is_free nothing of the tissue is fixed: the velocity of its centre of mass is left alone, since no force of its own changes that (nor its spin,
  /// which is not kept).
  /// @param v velocities, m/s, 3 x nodes; those that finish() was followed by.
  void begin(const NodalVectors& forces, const VectorX& mass, const Vector3& gravity_m_per_s2, bool is_free,
             NodalVectors& v);

  /// The step that began ends.
  /// @param contact_work_j by contacts on the tissue in it. @param was_cut before the tolerance: what is owed then stays so.
  /// @param is_free_of_contact nothing pressed on it: of a step that was solved the balance is made up then alone, since what the tolerance
  /// leaves of a slow press may be more than its kinetic energy.
  void finish(double dt_s, double contact_work_j, bool was_cut, bool is_free_of_contact);

  /// @param nodes of the tissue.
  void carry(StateArchive& archive, Eigen::Index nodes);

 private:
  std::vector<Vector3>
      forces_;  ///< per node, where the last step began, N; empty: there was none. Keeps its memory when it is cleared
  double kinetic_j_ = 0.0;     ///< as it began
  double dt_s_ = 0.0;          ///< of it; 0: it did not end
  double contact_work_j_ = 0;  ///< in it
  bool was_cut_ = false;
  bool counts_ = false;  ///< its balance is made up
  double owed_j_ = 0.0;
};

}  // namespace tissue_contact
