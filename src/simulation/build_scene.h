/// @file
/// Room `simulation`, private: turns a scene description and its environment into instruments and tissues.
#pragma once

#include <memory>
#include <vector>

#include "simulation/tissue_refinement.h"
#include "tissue_contact/contact/tissue_pair_detector.h"
#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/scene_environment.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// @throws std::invalid_argument naming what is wrong in the scene or its files.
std::vector<Instrument> buildInstruments(const Scene& scene, const SceneEnvironment& environment);
/// @param refinements gets one per tissue, null where the mesh never changes.
std::vector<Tissue> buildTissues(const Scene& scene, const SceneEnvironment& environment,
                                 std::vector<std::unique_ptr<TissueRefinement>>& refinements);

/// The scene's tissue pairs by index.
/// @throws std::invalid_argument naming a tissue that is not there.
std::vector<TouchingTissues> buildTissuePairs(const Scene& scene);

/// The linearised cones and impulses know one coefficient for all directions.
/// @throws std::invalid_argument when solver.method is one of them and some friction depends on direction.
void requireMethodForLaws(const Scene& scene);

}  // namespace tissue_contact
