/// @file
/// Room `validation`: small scenes for invariances, as plain data, and what is recorded of a run.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/simulation/scene.h"
#include "validation/scene_transforms.h"

namespace tissue_contact {

/// A ball and a stick are pressed into a block of this model and dragged over it, with gravity; friction .5 / .3 and .4.
Scene twoToolsScene(ElasticModel model = ElasticModel::kCorotational);
/// A box and a tetrahedron (a closed mesh, from this STL file) are pressed into a neo-Hookean block with a stiff region.
Scene sharpToolsScene(const std::string& stl_file);
/// A ball presses a sheet with bending stiffness onto a soft block: tissue on tissue.
Scene sheetOnBlockScene();

/// The tetrahedron of sharpToolsScene(), ASCII STL.
std::string tetrahedronStl();

struct RunOptions {
  Units units;                      ///< that the scene is in
  Matrix3 R = Matrix3::Identity();  ///< by which it is turned
  int samples = 120;
  double sample_s = 0.001;
};

/// A run in metres, newtons and the unturned world; instruments and tissues in the order of their names.
struct Run {
  std::vector<Eigen::Matrix3Xd> forces;     ///< per instrument: one column per sample
  std::vector<Eigen::Matrix3Xd> torques;    ///< about the tip
  std::vector<NodalVectors> displacements;  ///< per tissue, at the end
  Vector3 normal = Vector3::Zero();         ///< of all contacts at the end: mean, by force, in the TURNED world
  long steps = 0;
};

/// Every tool goes down by 3 mm in the first half of the run, and along x by 3 mm, turning by .3 rad, in the second.
Run run(const Scene& scene, const RunOptions& options = {});

/// Largest difference of a force over the largest force of that instrument, of torques and of displacements likewise:
/// the worst of them.
double difference(const Run& a, const Run& b);

}  // namespace tissue_contact
