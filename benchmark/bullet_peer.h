/// @file
/// Room `benchmark`: a sphere pressed and dragged over elastic tissue, solved by another engine, Bullet. A scene in;
/// the force on the sphere and the time of every step out. No Bullet type in this header; runBulletPeer is there only
/// in builds with Bullet (TISSUE_CONTACT_HAS_BULLET).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A rigid sphere on a prescribed path against one tissue, no gravity.
struct PeerScene {
  NodalVectors rest;  ///< m, 3 x n, world frame; undeformed and at rest when the run starts
  std::vector<Tetrahedron> tetrahedra;
  std::vector<Triangle> surface;  ///< outward; what the sphere can touch
  std::vector<bool> fixed;        ///< one flag per node
  double youngs_modulus_pa = 0.0;
  double poissons_ratio = 0.0;
  double density = 0.0;    ///< kg/m^3
  double damping_s = 0.0;  ///< stiffness-proportional damping
  double mu = 0.0;         ///< one coefficient, static and kinetic
  double sphere_radius_m = 0.0;
  std::function<Vector3(double)> sphere_centre;  ///< m, at a time in s from 0
  double dt_s = 0.0;
  int steps = 0;
};

struct PeerRun {
  std::vector<Vector3> forces_n;     ///< on the sphere, mean over each step
  std::vector<double> step_seconds;  ///< of the engine's own work, its sub-steps summed; without reading the force
  int nodes = 0;
  std::string how;  ///< engine and mode, for a table
};

/// Runs the scene in Bullet, each step in equal sub-steps where Bullet needs shorter ones for stability. Where Bullet
/// goes astray (a node farther off its place than the tissue is long) the remaining forces and times are NaN: a result
/// for the table, not an error. One core; deterministic but for the times.
/// @throws std::invalid_argument for a scene that is incomplete or out of range.
PeerRun runBulletPeer(const PeerScene& scene);

}  // namespace tissue_contact
