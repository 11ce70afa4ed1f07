/// @file
/// Room `simulation`: how wrong the force on an instrument is likely to be, as far as mesh, step and solver go. What the elastic law and
/// its parameters leave out is another matter (law_error.h).
#pragma once

#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

/// Of the force on one instrument in the last step, N: how far it likely is from what endlessly small cells and steps and an exact
/// solution would give for the same tissue.
struct ForceErrorEstimate {
  /// Whether `mesh_n` is an estimate. It is not, and 0, where the instrument touches a sheet, a shell or a mass-spring volume.
  bool knows_mesh = true;
  double mesh_n = 0.0;
  /// The force times 0.18 of the slip over the contact radius, by which normals turn around a ball in the step: frames follow, but for what
  /// changes from step to step. Too small where they do not, at tools' sharp edges. With it, root of the sum of squares, what the step leaves out of
  /// the forces on the tissue: half of how much the rate of its momentum has changed since the step before, by the instrument's share of what
  /// instruments press on it with; at most all it presses with.
  double step_n = 0.0;
  /// .7 of what the step leaves unbalanced in all tissues that something touches, by the instrument's share of all pressing; at most all it presses with.
  double solver_n = 0.0;
  /// No error: the rate of the momentum of the tissue, by the instrument's share of what instruments press on it with; at most all it presses with. Where
  /// that is most of the force the tissue swings, and errors of earlier steps, which are in none of these, add up in where it has swung to.
  double inertia_n = 0.0;
  double total_n() const;  ///< root of the sum of squares: the parts have nothing to do with each other
};

/// What the estimates below are times, by what is averaged over patches: all change of volume and a part of that of shape (`distortion`), a
/// part of all strain (neo-Hookean tissue as it comes), or neither.
struct MeshErrorFactors {
  double of_strain;
  double of_lengths;
};
MeshErrorFactors meshErrorFactors(const ElementMaterials& materials);

/// Likely share of a contact force that is due to the mesh: of two errors of opposite sign what does not cancel, and a part of the first, hypot(e - s, .6 e). At most 1.
///
/// e, cells too stiff for the strain: of_strain recovered^1.7 (.97 where strain is averaged as said above, else 2.2), from recoveredStrainError() `recovered` within four contact radii of the
/// middle of a shape's contacts, radius sqrt(A / pi) for the rest area A of the nodes that carry force. s, contact too soft: `softened`, the share of the force that is lost
/// where vertices alone carry it, since flat triangles between them cut into the shape. The force hangs on how deep that is in the mean as on the shape's depth, dF = 4 mu a / (1 - nu) dd
/// for a contact radius a now; nothing in s is fitted. Factors, power and .6 are, to 71 runs against stored truths (press and drag of a ball, partial slip, a recorded robot over a
/// pad, a grasp) and against presses of a ball .2 to .8 of its radius deep, axially symmetric elements being the truth. Where five nodes or fewer carry a shape, what its lengths say
/// (expectedMeshError()) counts if that is more. How well it does: doc/accuracy.md, and doc/notes/accuracy.md for fits that were tried.
double likelyMeshError(double recovered, double softened, const MeshErrorFactors& factors);

/// Likely error of the force on a shape pressed in by most of its half extent, relative, from the lengths alone: for a word of warning before
/// anything moves. of_lengths (edge / half extent)^1.8: 0.5 by element, 0.3 averaged, 0.4 between; within a factor of two of what press and drag and the recorded robot meet on meshes of
/// .3 to 3 half extents.
double expectedMeshError(double surface_edge_m, double half_extent_m, const MeshErrorFactors& factors);

}  // namespace tissue_contact
