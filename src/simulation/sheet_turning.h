/// @file
/// Room `simulation`, private: how fast what touches a sheet moves beside its middle surface since the sheet turns. Contacts of a step and the
/// motion of the step before in; velocities for each out.
#pragma once

#include <vector>

#include "tissue_contact/simulation/solved_contact.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// Contacts hold nodes in the middle surface; the surface that touches is half a thickness away. A grip that turned by an angle shifted the
/// sheet that it held by that times half the thickness, until it let go (doc/method.md, "Sheets that are squeezed"). No allocation
/// once vectors have grown; nothing is done where all tissues are volumes.
class SheetTurning {
 public:
  explicit SheetTurning(const std::vector<Tissue>& tissues) : tissues_(tissues) {}

  /// How the sheets in each patch turn: the mean over the contacts that press. Of single triangles it would be fed back to them by friction:
  /// sheets between balls, with cells half as wide as they were thick, were thrown away.
  /// @param contacts of the step, with the forces of the step before; those of a shape follow one another.
  /// @param x, v per tissue, m and m/s.
  void prepare(const std::vector<SolvedContact>& contacts, const std::vector<NodalVectors>& x,
               const std::vector<NodalVectors>& v);

  /// Velocity of the surfaces of both sides beside their middle surfaces, m/s, world axes: to be added to the tool's.
  /// @param contact one of those of prepare().
  Vector3 at(const Contact& contact) const;

 private:
  struct Patch {
    ContactKey key;                  ///< of one of its contacts
    double weight = 0.0;             ///< N, of those that press
    Vector3 rate = Vector3::Zero();  ///< rad/s, world axes, about axes in the surface
  };
  double thicknessAt(const ContactKey& key) const;
  Vector3 rateOfNormal(const Contact& contact, const std::vector<NodalVectors>& x,
                       const std::vector<NodalVectors>& v) const;

  const std::vector<Tissue>& tissues_;
  std::vector<Patch> patches_;
};

}  // namespace tissue_contact
