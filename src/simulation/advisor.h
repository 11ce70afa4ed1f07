/// @file
/// Room `simulation`, private: the model advisor: which of the cheaper models suit a scene. Scene in; choices, and a
/// line about each with its reason, out.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "simulation/fold_watch.h"
#include "simulation/tissue_refinement.h"
#include "simulation/touched_places.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/simulator.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// A name as these lines have it.
std::string quoted(const std::string& name);

/// Whether nodes at rest may be left out: the scene lets them, and its method is the one meant for use. The others are
/// there to be compared with, and solve all.
bool advisedSleep(const Scene& scene);

/// Whether parts of a tissue may sleep, or only all of it: each change of the nodes awake would cost a Cholesky
/// relaxation its factor.
bool advisedSleepByParts(const Scene& scene);

/// One line per choice: what it is about, what was chosen, why.
/// @param meshes about each tissue.
std::vector<Advice> adviceLines(const Scene& scene, const FoldWatch& folds,
                                const std::vector<std::vector<Advice>>& meshes);

/// A warning where a tissue from a file is so small or so large that its unit is likely another than the scene says, or every instrument so large that
/// the URDF's is; else none.
/// @param rest 3 x n, m.
std::optional<Advice> sizeDoubt(const TissueDescription& tissue, const NodalVectors& rest, const HalfExtents& shapes);

/// A warning where a tissue from a file is held beside elements so long that it cannot bend as it should, nor be held where the border of
/// `fixed` runs through them; else none.
std::optional<Advice> heldDoubt(const TissueDescription& description, const Tissue& tissue);

/// A warning where a constant of a tissue is such as that of no tissue, and likely in another unit; else none.
std::optional<Advice> unitDoubt(const TissueDescription& tissue);

/// Where steps are so long that what a tissue does by itself is damped by them more than by its own damping: what to expect; else none.
std::optional<Advice> stepDoubt(const Scene& scene, const TissueDescription& tissue);

/// A warning where nothing holds a tissue, or all of it is held, so that nothing can press on it; else none.
std::optional<Advice> supportDoubt(const Scene& scene, std::size_t tissue, const std::vector<Tissue>& tissues);

/// A warning where a block has so few cells over its thickness that it bends too stiffly, and may bend; else none.
std::optional<Advice> bendingDoubt(const Scene& scene, std::size_t tissue, const std::vector<Tissue>& tissues);

/// A warning where the cells of a mass-spring volume are so uneven that it is far from isotropic, or the pressure on it turns
/// springs inside out; else none.
std::optional<Advice> springDoubt(const TissueDescription& description, const Tissue& tissue);

/// A warning where a closed shell is inflated by more than its wall can bear at any size; else none.
std::optional<Advice> inflationDoubt(const TissueDescription& description, const Tissue& tissue);

/// What the mesh of a volume is, and what it is likely to do to the forces of the instruments' shapes: a warning where
/// even the largest shape meets coarse cells.
/// @param edge_m of the shorter triangles of the surface.
Advice meshLine(const TissueDescription& tissue, double edge_m, const HalfExtents& shapes);

/// The same of a mesh that follows. A warning also where the body itself gets too few nodes.
/// @param cells_m edges of the finest cells under all shapes, ascending; none: nothing asks for any.
Advice refinementLine(const TissueDescription& tissue, const TissueRefinement& refinement,
                      const std::vector<double>& cells_m, const HalfExtents& shapes);

/// Of a tenth of the surface's triangles the mean edge is shorter, m.
double shortSurfaceEdge(const Tissue& tissue);

}  // namespace tissue_contact
