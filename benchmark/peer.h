/// @file
/// Room `benchmark`: press and drag by another engine, as a run like any other.
#pragma once

#include <string>
#include <vector>

#include "benchmark/scenes.h"

namespace tissue_contact {

bool hasPeer();  ///< whether this build has one

struct PeerResult {
  Run run;
  std::string name;
  std::string how;
};

/// Same mesh, motion, step and friction as ours with these settings. Only in builds with a peer.
/// @param damped false: without the tissue's damping, which costs the peer most of its time and changes a slow press little.
PeerResult runPeer(const BenchmarkScene& scene, const Settings& settings, const PressDragMotion& motion, bool damped);

/// The meshes and steps the peer is run at: the shipped one, and in a full run twice the step, the next finer mesh and the finest.
std::vector<Settings> peerSizes(const ScenePlan& plan, const SceneOptions& options);

}  // namespace tissue_contact
