/// @file
/// Room `validation`: the same scene said differently: in other units, turned, with its lists in another order. Scene in,
/// scene out.
#pragma once

#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {

/// How many new units one metre and one kilogram have. Seconds stay.
struct Units {
  double length = 1.0;
  double mass = 1.0;

  double force() const { return mass * length; }            ///< of one newton
  double torque() const { return mass * length * length; }  ///< of one newton metre
};

/// All numbers of a scene in other units. Shapes and meshes given by the scene are scaled; joints named in
/// `initial_joint_positions` and lengths inside URDFs are the caller's. Positions of tf frames are not known here.
Scene inUnits(Scene scene, const Units& units);

/// Gravity, tissues and instrument bases turned about the world's origin.
Scene turned(Scene scene, const Matrix3& R);

/// Instruments and friction entries listed the other way round.
Scene listedBackwards(Scene scene);

}  // namespace tissue_contact
