/// @file
/// Room `tissue`: what every tissue model gives a time step, whatever its elements. Positions in; elastic forces and
/// the stiffness (and damping) matrix of the step's linearisation out.
#pragma once

#include <memory>
#include <vector>

#include "tissue_contact/core/block_matrix.h"
#include "tissue_contact/core/state_archive.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Model: const after construction. Thread-safe for different states.
class Elasticity {
 public:
  /// What changes while simulating. Use a state only with the model that made it.
  struct State {
    virtual ~State() = default;
    /// Writes or reads all that the model keeps from one update to the next, see StateArchive. Extended by models that keep more.
    virtual void carry(StateArchive& archive) {
      stiffness.carry(archive);
      damping.carry(archive);
      archive.carry(elapsed_s);
    }
    BlockMatrix stiffness;  ///< K, N/m, symmetric; rows of fixed nodes hold nothing
    BlockMatrix damping;    ///< D, N s/m, where materials damp differently by region, of the same pattern; else no rows
    /// Set by the caller: the model may leave out rotations while they are small, where it says that it can.
    bool adapt_rotations = false;
    /// Set by the caller for models with memory, s: the step that update() prepares, and the time since the last update,
    /// which update() takes and sets to 0.
    double step_s = 0.0;
    double elapsed_s = 0.0;
  };
  virtual ~Elasticity() = default;

  /// State of the undeformed body; allocates.
  virtual std::unique_ptr<State> makeState() const = 0;

  /// The same for a body that is at positions x, m, already: models whose tangent follows x assemble it there at once, and not
  /// undeformed first. Allocates.
  virtual std::unique_ptr<State> makeStateAt(const NodalVectors& /*x*/) const { return makeState(); }

  /// The same for a body that was of other materials until now: its state then, of a model of the same elements, tells what it
  /// remembers. Allocates.
  virtual std::unique_ptr<State> makeStateAfter(const State& /*before*/, const NodalVectors& x) const {
    return makeStateAt(x);
  }

  /// Elastic forces (N, overwritten) at positions x (m), and the matrices brought up to date. No allocation.
  virtual void update(const NodalVectors& x, State& state, NodalVectors& forces) const = 0;

  /// From now on update() need not evaluate elements all of whose nodes are in `still`: as long as those nodes stay where
  /// they are in x, the forces of such elements are what they are now. Models that cannot tell evaluate all elements.
  /// @param still per node; none set: evaluate everything again. Allocates when first used.
  virtual void holdStill(const std::vector<bool>& /*still*/, const NodalVectors& /*x*/, State& /*state*/) const {}

  /// Whether forces depend on more than where the nodes are now: what rests may then be pushed all the same.
  virtual bool hasMemory() const { return false; }

  /// Elastic energy (J), 0 undeformed. For tests and energy reports.
  virtual double energy(const NodalVectors& x) const = 0;
};

}  // namespace tissue_contact
