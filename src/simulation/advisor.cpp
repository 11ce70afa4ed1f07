#include "simulation/advisor.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <variant>

#include "tissue_contact/core/text.h"
#include "tissue_contact/simulation/force_error.h"
#include "tissue_contact/simulation/simulator.h"
#include "tissue_contact/tissue/element_materials.h"
#include "tissue_contact/tissue/make_elasticity.h"
#include "tissue_contact/tissue/material_preset.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {

std::string quoted(const std::string& name) { return "'" + name + "'"; }

namespace {

std::string sleepLine(const Scene& scene) {
  if (!scene.advisor.sleep) return "sleep: never, as advisor.sleep asks; every node is solved for in every step";
  if (!advisedSleep(scene)) {
    return std::string("sleep: never, since solver.method ") + solverMethodName(scene.solver.method) +
           " is for comparisons";
  }
  std::ostringstream line;
  line << "sleep: nodes at rest away from contacts are left out while holding them takes at most "
       << 100.0 * scene.advisor.sleep_error << " % of the contact force in all";
  if (!advisedSleepByParts(scene)) line << "; each tissue as a whole, since parts would cost the Cholesky factor";
  return line.str();
}

std::string modelLine(const Scene& scene, const TissueDescription& tissue) {
  std::ostringstream line;
  line << "tissue " << quoted(tissue.name) << ": " << elasticModelName(tissue.material.model);
  if (!tissue.material.prony_series.empty()) {
    line << ", its stress relaxes by " << tissue.material.prony_series.size() << " terms, so that it never sleeps";
    for (const PronyTerm& term : tissue.material.prony_series) {
      if (term.time_s >= scene.step.max_step_s) continue;
      line << "; the term of " << term.time_s << " s is faster than a step of " << scene.step.max_step_s
           << " s and brakes too much: take smaller steps, or give it as damping.stiffness_s";
    }
  } else if (tissue.material.model != ElasticModel::kCorotational) {
    line << ", as the scene says";
  } else if (scene.advisor.adapt_rotations && averagesDilatation(materialsOf(tissue))) {
    line << " always: strain is averaged over patches, which follow rotations";
  } else if (scene.advisor.adapt_rotations) {
    line << ", linear while no element turns by " << TetElasticity::kTurnOn << " rad (spurious strain below "
         << 0.5 * TetElasticity::kTurnOn * TetElasticity::kTurnOn << ")";
  } else {
    line << " always: rotations cost little beside the solver";
  }
  return line.str();
}

/// One constant, and where the scene has given another than the preset, both.
void writeConstant(std::ostream& line, const char* name, double value, double of_preset, const char* unit) {
  line << name << value << unit;
  if (value != of_preset) line << " (as the scene says; by name " << of_preset << ")";
}

/// Of a material by name. @param damping_stiffness_s null where it is not the preset's to give.
std::string presetLine(const std::string& owner, const MaterialDescription& material,
                       const double* damping_stiffness_s) {
  const MaterialPreset& preset = *material.preset;
  std::ostringstream line;
  line << "material of " << owner << ": " << preset.name;
  writeConstant(line, ", E ", material.youngs_modulus_pa, preset.youngs_modulus_pa, " Pa");
  if (preset.lowest_pa < preset.highest_pa) {
    line << " (range of the source: " << preset.lowest_pa << " to " << preset.highest_pa << ")";
  }
  writeConstant(line, ", nu ", material.poissons_ratio, preset.poissons_ratio, "");
  writeConstant(line, ", density ", material.density_kg_per_m3, preset.density_kg_per_m3, " kg/m^3");
  if (damping_stiffness_s != nullptr) {
    writeConstant(line, ", damping.stiffness_s ", *damping_stiffness_s, preset.damping_stiffness_s, " s");
  }
  line << "; " << preset.basis << "; source: " << preset.source;
  return line.str();
}

bool haveSameConstants(const MaterialDescription& a, const MaterialDescription& b) {
  return a.preset == b.preset && a.youngs_modulus_pa == b.youngs_modulus_pa && a.poissons_ratio == b.poissons_ratio &&
         a.density_kg_per_m3 == b.density_kg_per_m3;
}

/// Of a tissue and of those of its regions that have another.
void addPresetLines(const TissueDescription& tissue, std::vector<Advice>& lines) {
  const std::string owner = "tissue " + quoted(tissue.name);
  if (tissue.material.preset != nullptr) {
    lines.push_back({presetLine(owner, tissue.material, &tissue.damping.stiffness_s)});
  }
  for (const TissueRegion& region : tissue.regions) {
    if (region.material.preset == nullptr || haveSameConstants(region.material, tissue.material)) continue;
    lines.push_back({presetLine("region " + quoted(region.name) + " of " + owner, region.material, nullptr)});
  }
}

std::string pairLine(const Scene& scene, std::size_t pair, const FoldWatch& folds) {
  const TissuePair& names = scene.tissue_pairs[pair];
  if (names.tissue != names.other) {
    return "tissues " + quoted(names.tissue) + " and " + quoted(names.other) + ": looked at in every step";
  }
  const std::string start = "folds of tissue " + quoted(names.tissue) + ": ";
  if (!scene.advisor.skip_folds) return start + "looked for in every step, as advisor.self_contact asks";
  if (!folds.watches(pair)) return start + "looked for in every step: it is not convex at rest";
  std::ostringstream line;
  line << start << "convex at rest, so looked for only once some |F - I| reaches " << ConvexBody::kMostStrain;
  return line.str();
}

std::string frictionLine(const Scene& scene, const FrictionDescription& pair) {
  std::string line = pair.instrument.empty() ? "tissue " + quoted(pair.other_tissue) : quoted(pair.instrument);
  if (!pair.link.empty()) line += " (" + pair.link + ")";
  line += " on " + quoted(pair.tissue);
  if (!pair.region.empty()) line += " (" + pair.region + ")";
  line += ": ";
  if (pair.law.kind != FrictionLawDescription::Kind::kIsotropic) return line + "friction depends on direction";
  if (scene.advisor.general_friction) return line + "solved as if it depended on direction, as friction_path asks";
  if (pair.law.static_coefficients.at(0) == 0.0) return line + "no friction, nothing tangential is computed";
  return line + "isotropic friction, one coefficient for all directions";
}

/// Mean edge of the triangles that a square cell is cut into.
constexpr double kEdgePerCell = 1.138;

std::string rangeText(double from, double to) {
  return twoDigits(from) + (twoDigits(to) != twoDigits(from) ? " to " + twoDigits(to) : "");
}

/// Adds what to expect of the forces, and whether that is worth a warning.
/// @param under_smallest_m, under_largest_m edges that the smallest and the largest shape meet.
Advice withExpectedError(const TissueDescription& tissue, const std::string& mesh, double under_smallest_m,
                         double under_largest_m, const HalfExtents& shapes) {
  if (!(shapes.smallest_m > 0.0)) return {mesh};
  constexpr double kWorthAWord = 0.1;
  constexpr double kWorthAWarning = 0.5;  // good to a factor of two: off by a quarter at least
  constexpr double kCompared = 3.0;       // edges over half extents that expectedMeshError() was compared with
  const MeshErrorFactors factors = meshErrorFactors(materialsOf(tissue));
  const auto error = [&](double edge_m, double half_extent_m) {
    return expectedMeshError(std::min(edge_m, kCompared * half_extent_m), half_extent_m, factors);
  };
  const double most = error(under_smallest_m, shapes.smallest_m);
  const double least = error(under_largest_m, shapes.largest_m);
  std::string text = mesh + ", under shapes of " + rangeText(1e3 * shapes.smallest_m, 1e3 * shapes.largest_m) +
                     " mm half extent (a ball's radius): expect forces to be off by some " +
                     rangeText(100.0 * least, 100.0 * most);
  if (under_smallest_m > kCompared * shapes.smallest_m) text += " (or more)";
  text += " % when pressed in by most of a half extent";
  if (most > kWorthAWord) text += "; smaller cells help (tissues[].refinement)";
  return {text, least > kWorthAWarning};  // a tool's small parts seldom carry the force
}

}  // namespace

bool advisedSleep(const Scene& scene) {
  return scene.advisor.sleep && scene.solver.method == SolverMethod::kPredictorCorrector;
}

bool advisedSleepByParts(const Scene& scene) {
  // Waking parts solves the step again, which a time budget has no room for.
  return advisedSleep(scene) && scene.solver.relaxation == RelaxationKind::kGaussSeidel &&
         !(scene.solver.time_budget_s > 0.0);
}

double shortSurfaceEdge(const Tissue& tissue) {
  std::vector<double> edges;
  edges.reserve(tissue.surface().size());
  for (const Triangle& triangle : tissue.surface()) {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
      sum += (tissue.restPositions().col(triangle[i]) - tissue.restPositions().col(triangle[(i + 1) % 3])).norm();
    }
    edges.push_back(sum / 3.0);
  }
  const auto tenth = edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 10);
  std::nth_element(edges.begin(), tenth, edges.end());
  return *tenth;
}

Advice meshLine(const TissueDescription& tissue, double edge_m, const HalfExtents& shapes) {
  return withExpectedError(tissue,
                           "mesh of tissue " + quoted(tissue.name) + ": as it is, cells of " + twoDigits(1e3 * edge_m) +
                               " mm (its shorter surface edges)",
                           edge_m, edge_m, shapes);
}

Advice refinementLine(const TissueDescription& tissue, const TissueRefinement& refinement,
                      const std::vector<double>& cells_m, const HalfExtents& shapes) {
  std::ostringstream line;
  line.precision(3);
  line << "mesh of tissue " << quoted(tissue.name) << ": ";
  if (refinement.mesh().lasting > 0) {
    line << refinement.mesh().lasting
         << " nodes more than as it came, so that it bends, is held and has its regions as it should wherever tools "
            "are; ";
  }
  const bool is_coarse = refinement.bodyCoarsening() > 1.0;
  if (is_coarse) {
    line << "where nothing touches, its cells or those at the border of a part are " << refinement.bodyCoarsening()
         << " times as long as they should be, since it may have " << refinement.nodesAtMost()
         << " nodes: raise tissues[].refinement.nodes_at_most, in a map with the numbers that follow; ";
  }
  if (cells_m.empty()) {
    line << "stays as it is, since no instrument touches; for other tissues give refinement.cell_m";
    return {line.str(), is_coarse};
  }
  const FineCells& cells = refinement.cells();
  line << "refined to cells of " << 1e3 * cells_m.front() << " mm, " << 1e3 * cells.reach(cells_m.front())
       << " mm around what touches it, growing by " << cells.growth()
       << " per length beyond, and moved along with that; at most " << refinement.nodesAtMost()
       << " nodes, for which cells grow";
  Advice advice =
      withExpectedError(tissue, line.str(), kEdgePerCell * cells_m.front(), kEdgePerCell * cells_m.back(), shapes);
  advice.is_warning = advice.is_warning || is_coarse;
  return advice;
}

std::string coarseCellsText(const Simulator& simulator) {
  const CoarseCells& cells = simulator.report().coarse_cells;
  const auto tissue = static_cast<std::size_t>(cells.tissue);
  std::ostringstream text;
  text.precision(3);
  text << "tissue " << quoted(simulator.scene().tissues[tissue].name) << ": cells are " << cells.factor
       << " times as long as its refinement asks for, since its mesh, of " << simulator.tissues()[tissue].nodeCount()
       << " nodes now, may not have enough of them for shorter ones: forces are those of coarser cells. Raise "
          "tissues[].refinement.nodes_at_most, or give a larger tissues[].refinement.cell_m, in a map with the numbers "
          "that the log has of this mesh";
  return text.str();
}

std::vector<Advice> adviceLines(const Scene& scene, const FoldWatch& folds,
                                const std::vector<std::vector<Advice>>& meshes) {
  std::vector<Advice> lines = {{sleepLine(scene)}};
  for (std::size_t t = 0; t < scene.tissues.size(); ++t) {
    addPresetLines(scene.tissues[t], lines);
    lines.push_back({modelLine(scene, scene.tissues[t])});
    lines.insert(lines.end(), meshes[t].begin(), meshes[t].end());
  }
  for (std::size_t p = 0; p < scene.tissue_pairs.size(); ++p) lines.push_back({pairLine(scene, p, folds)});
  for (const FrictionDescription& pair : scene.friction) lines.push_back({frictionLine(scene, pair)});
  lines.push_back({scene.friction.empty() ? "friction: none is listed, so nothing tangential is computed"
                                          : "all other pairs: no friction, nothing tangential is computed"});
  return lines;
}

}  // namespace tissue_contact
