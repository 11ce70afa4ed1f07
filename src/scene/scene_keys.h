/// @file
/// Room `scene`, private: which keys each map of a scene file may have. One table serves the loader, its messages and
/// the test that keeps doc/scene.md complete.
#pragma once

#include "tissue_contact/scene/load_scene.h"

namespace tissue_contact {

/// Kinds of maps in a scene file; maps with free keys (joint names) are not among them.
enum class MapKind {
  kScene,
  kTissue,
  kBlock,
  kGrading,
  kAxisGrading,
  kMesh,
  kSheet,
  kShell,
  kMaterial,
  kDamping,
  kFixedRegion,
  kFixedBox,
  kFixedPlane,
  kFixedSphere,
  kTissueRegion,
  kRegionMaterial,
  kRegionDamping,
  kInstrument,
  kJointStateTopic,
  kContactLink,
  kShape,
  kShapeSphere,
  kShapeBox,
  kShapeCylinder,
  kShapeMesh,
  kShapePose,
  kPose,
  kTissuePair,
  kFriction,
  kFrictionAxis,
  kStep,
  kSolver,
  kAdvisor,
  kPublish,
};

/// Name and allowed keys of one kind of map.
const SceneMapKeys& mapKeys(MapKind kind);

}  // namespace tissue_contact
