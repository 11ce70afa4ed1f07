#include "tissue/placed_mesh.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <variant>

#include "mesh/conformity.h"
#include "mesh/labels.h"
#include "mesh/region.h"
#include "mesh/shell_notes.h"
#include "tissue/body_edges.h"
#include "tissue/element_patches.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/mesh/triangle_mesh.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {
namespace {

constexpr const char* kCentroid = "centroid of a surface triangle";

/// For each point (3 x n, m, in T) the last region that holds it, -1 if none does.
std::vector<int> regionsOfPoints(const NodalVectors& points, const std::vector<TissueRegion>& regions,
                                 double rounding) {
  std::vector<int> found(static_cast<std::size_t>(points.cols()), -1);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Vector3 x = points.col(static_cast<Eigen::Index>(i));
    for (std::size_t r = regions.size(); r-- > 0 && found[i] < 0;) {  // the last one counts
      if (anyHolds(regions[r].where, x, rounding)) found[i] = static_cast<int>(r);
    }
  }
  return found;
}

void tellSize(const NodalVectors& positions, std::size_t elements, const MeshSizeCheck& on_size) {
  if (on_size) on_size(static_cast<std::size_t>(positions.cols()), elements);
}

struct VolumeMesh {
  TetMesh mesh;
  std::vector<int> patch_of;
  MeshLabels labels;  ///< where the description names some
};

bool namesAnyLabels(const TissueDescription& tissue) {
  return namesLabels(tissue.fixed) || namesLabels(tissue.pressure_where) ||
         std::any_of(tissue.regions.begin(), tissue.regions.end(),
                     [](const auto& r) { return namesLabels(r.where); }) ||
         std::any_of(tissue.attachments.begin(), tissue.attachments.end(),
                     [](const auto& a) { return namesLabels(a.where); });
}

/// The description with groups and cell data as the places they are.
TissueDescription withPlaces(const TissueDescription& given, const MeshLabels& labels, const TetMesh& mesh) {
  TissueDescription tissue = given;
  const auto resolve = [&](std::vector<Region>& regions, const std::string& entry) {
    regions = withPlaces(regions, labels, mesh, entry, tissueLabel(given));
  };
  resolve(tissue.fixed, "fixed");
  resolve(tissue.pressure_where, "pressure_where");
  for (std::size_t r = 0; r < tissue.regions.size(); ++r) {
    resolve(tissue.regions[r].where, elementOf("regions", r) + ".where");
  }
  for (std::size_t a = 0; a < tissue.attachments.size(); ++a) {
    resolve(tissue.attachments[a].where, elementOf("attachments", a) + ".where");
  }
  return tissue;
}

VolumeMesh volumeMesh(const TissueDescription& description, const std::string& source, const MeshSizeCheck& on_size,
                      const MeshPreparation& preparation) {
  VolumeMesh made;
  const auto check = [&](const std::string& owner) {
    tellSize(made.mesh.positions, made.mesh.tetrahedra.size(), on_size);
    checkTetMesh(made.mesh, owner);
  };
  if (const auto* block = std::get_if<BlockDescription>(&description.geometry)) {
    const bool follows = description.refinement.mode != RefinementDescription::Mode::kNever;
    const BlockSplit split = follows ? BlockSplit::kSix : BlockSplit::kFive;
    atEntry("block", [&] {
      made.mesh = makeBlockMesh(*block, split);
      check(source);
    });
    // All of a cell: over halves of it, three of six each, a flap of one cell bends 3.8 times too stiffly (RefinedFlap).
    made.patch_of = patchesByCells(made.mesh.tetrahedra.size(), static_cast<int>(split));
  } else {
    const auto& mesh = std::get<MeshDescription>(description.geometry);
    atEntry("mesh.file", [&] {
      made.mesh = loadTetMesh(mesh, preparation, namesAnyLabels(description) ? &made.labels : nullptr);
      const std::string owner = source + ", mesh file '" + mesh.file + "'";
      check(owner);
      checkConforming(made.mesh, owner);
    });
    made.patch_of = patchesByFaces(made.mesh.positions, made.mesh.tetrahedra);
  }
  return made;
}

void setVolume(TetMesh mesh, std::vector<Triangle> surface, std::vector<int> patch_of, PlacedMesh& placed) {
  placed.surface = std::move(surface);
  placed.rest = std::move(mesh.positions);
  placed.tetrahedra = std::move(mesh.tetrahedra);
  placed.patch_of = std::move(patch_of);
}

void setSheet(TriangleMesh mesh, double thickness, const std::string& source, const MeshSizeCheck& on_size,
              PlacedMesh& placed) {
  tellSize(mesh.vertices, mesh.triangles.size(), on_size);
  if (!(thickness > 0.0) || !std::isfinite(thickness)) {
    throw EntryError("thickness_m",
                     source + ": thickness_m is " + std::to_string(thickness) + " m; it must be finite and > 0");
  }
  checkSheetMesh(mesh, source);
  placed.rest = std::move(mesh.vertices);
  placed.surface = std::move(mesh.triangles);
  placed.thickness = thickness;
}

void setMembrane(const TissueDescription& description, const std::string& source, const MeshSizeCheck& on_size,
                 const MeshPreparation& preparation, PlacedMesh& placed) {
  if (const auto* sheet = std::get_if<SheetDescription>(&description.geometry)) {
    atEntry("sheet", [&] { setSheet(makeSheetMesh(*sheet), sheet->thickness_m, source, on_size, placed); });
  } else {
    const auto& shell = std::get<ShellDescription>(description.geometry);
    TriangleMesh read = atEntry("shell.file", [&] { return loadShellMesh(shell); });
    const std::string owner = source + ", mesh file '" + shell.file + "'";
    atEntry("shell", [&] { setSheet(std::move(read), shell.thickness_m, owner, on_size, placed); });
    if (!preparation.say) return;
    for (const std::string& note : shellNotes({placed.rest, placed.surface})) {
      preparation.say("mesh file '" + shell.file + "': " + note);
    }
  }
}

template <std::size_t N>
NodalVectors centroids(const NodalVectors& x, const std::vector<std::array<int, N>>& elements) {
  NodalVectors centres = NodalVectors::Zero(3, static_cast<Eigen::Index>(elements.size()));
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (const int node : elements[e]) centres.col(static_cast<Eigen::Index>(e)) += x.col(node) / N;
  }
  return centres;
}

bool sameMaterial(const TissueDescription& tissue, const TissueRegion& region) {
  const MaterialDescription& a = tissue.material;
  const MaterialDescription& b = region.material;
  return a.youngs_modulus_pa == b.youngs_modulus_pa && a.poissons_ratio == b.poissons_ratio &&
         a.density_kg_per_m3 == b.density_kg_per_m3 && a.bending_stiffness_n_m == b.bending_stiffness_n_m &&
         tissue.damping.stiffness_s == region.damping_stiffness_s;
}

/// Regions by element and surface triangle, positions being in T. Refuses a region without effect: most likely it is
/// misplaced.
void setRegions(const TissueDescription& description, const std::string& source, PlacedMesh& placed) {
  if (description.regions.empty()) return;
  const double rounding = roundingDistance(placed.rest);
  const auto regionsOf = [&](const NodalVectors& points) {
    return regionsOfPoints(points, description.regions, rounding);
  };
  placed.surface_regions = regionsOf(placed.surface_places);
  placed.element_regions = placed.isVolume() ? regionsOf(placed.element_places) : placed.surface_regions;
  for (std::size_t r = 0; r < description.regions.size(); ++r) {
    const auto anyIn = [r](const std::vector<int>& regions) {
      return std::find(regions.begin(), regions.end(), static_cast<int>(r)) != regions.end();
    };
    const bool has_elements = anyIn(placed.element_regions);
    if (has_elements || (anyIn(placed.surface_regions) && sameMaterial(description, description.regions[r]))) continue;
    std::ostringstream message;
    message << source << ": region '" << description.regions[r].name
            << "' holds no element's centroid (or later regions hold them all); the mesh lies within ("
            << placed.rest.rowwise().minCoeff().transpose() << ") to (" << placed.rest.rowwise().maxCoeff().transpose()
            << ") m of the tissue frame: move or enlarge the region, or give the tissue a finer mesh, or `refinement`, "
               "which is fine around regions (where it is: more nodes_at_most)";
    throw EntryError(elementOf("regions", r) + ".where", message.str());
  }
}

/// Coefficients over the edges of a triangle of the unit direction along which the fibre runs in it; zero if it runs
/// across.
Vector2 fibreIn(const NodalVectors& x, const Triangle& triangle, const Vector3& fibre) {
  constexpr double kAcross = 1e-6;  // sine of the angle to the normal below which the direction is rounding
  Eigen::Matrix<double, 3, 2> edges;
  for (int i = 0; i < 2; ++i) edges.col(i) = x.col(triangle[i + 1]) - x.col(triangle[0]);
  const Vector3 normal = edges.col(0).cross(edges.col(1)).normalized();
  const Vector3 unit = fibre.stableNormalized();
  const Vector3 along = unit - unit.dot(normal) * normal;
  if (!(along.norm() > kAcross)) return Vector2::Zero();
  const Matrix2 gram = edges.transpose() * edges;
  return gram.inverse() * (edges.transpose() * along.normalized());
}

/// What an attachment adds to the springs, N/m per node, positions being in T.
void addAttachment(const Attachment& attachment, const std::string& entry, const std::string& source,
                   const PlacedMesh& placed, VectorX& stiffness) {
  if (attachment.stiffness_n_per_m > 0.0) {
    const std::vector<bool> nodes = heldPoints(placed.rest, attachment.where, entry, "node", source);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (nodes[i]) stiffness[static_cast<Eigen::Index>(i)] += attachment.stiffness_n_per_m;
    }
    return;
  }
  const std::vector<bool> triangles = heldPoints(placed.surface_places, attachment.where, entry, kCentroid, source);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (!triangles[t]) continue;
    const double third = attachment.stiffness_pa_per_m * triangleArea(placed.rest, placed.surface[t]) / 3.0;
    for (const int node : placed.surface[t]) stiffness[node] += third;
  }
}

/// Fixed nodes, which never move, get no spring. Refuses an attachment that holds no other.
void setSprings(const TissueDescription& description, const std::string& source, PlacedMesh& placed) {
  if (description.attachments.empty()) return;
  VectorX all = VectorX::Zero(placed.rest.cols());
  for (std::size_t a = 0; a < description.attachments.size(); ++a) {
    const std::string entry = elementOf("attachments", a);
    VectorX stiffness = VectorX::Zero(placed.rest.cols());
    addAttachment(description.attachments[a], entry + ".where", source, placed, stiffness);
    for (Eigen::Index i = 0; i < stiffness.size(); ++i) {
      if (placed.fixed[static_cast<std::size_t>(i)]) stiffness[i] = 0.0;
    }
    if (stiffness.isZero(0.0)) {
      throw EntryError(entry + ".where", source + ": all nodes that attachment " + std::to_string(a) +
                                             " holds are fixed already; remove it, or enlarge its region");
    }
    all += stiffness;
  }
  for (Eigen::Index i = 0; i < all.size(); ++i) {
    if (all[i] > 0.0) placed.springs.push_back({static_cast<int>(i), all[i]});
  }
}

void setPressed(const TissueDescription& description, const std::string& source, PlacedMesh& placed) {
  if (description.pressure_pa == 0.0) return;
  if (description.pressure_where.empty()) {
    placed.pressed = placed.surface;
    return;
  }
  const std::vector<bool> triangles =
      heldPoints(placed.surface_places, description.pressure_where, "pressure_where", kCentroid, source);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (triangles[t]) placed.pressed.push_back(placed.surface[t]);
  }
}

void checkFibre(const Vector3& fibre, const std::string& entry, const std::string& owner) {
  if (fibre.allFinite()) return;
  std::ostringstream message;
  message << owner << "fibre_direction is (" << fibre.transpose() << "); it must be finite";
  throw EntryError(entry + "fibre_direction", message.str());
}

void setFibres(const TissueDescription& description, const std::string& source, PlacedMesh& placed) {
  checkFibre(description.fibre_direction, "", source + ": ");
  bool any = !description.fibre_direction.isZero(0.0);
  for (std::size_t r = 0; r < description.regions.size(); ++r) {
    const TissueRegion& region = description.regions[r];
    checkFibre(region.fibre_direction, elementOf("regions", r) + ".", source + ", region '" + region.name + "': ");
    any = any || !region.fibre_direction.isZero(0.0);
  }
  if (!any) return;
  for (std::size_t t = 0; t < placed.surface.size(); ++t) {
    const int region = placed.surface_regions.empty() ? -1 : placed.surface_regions[t];
    const Vector3& fibre = region < 0 ? description.fibre_direction : description.regions[region].fibre_direction;
    placed.surface_fibres.push_back(fibreIn(placed.rest, placed.surface[t], fibre));
  }
}

/// What a description says about nodes, elements and surface of the mesh it is given, in T; then the mesh goes to the world.
void finish(const TissueDescription& description, const Pose& X_WT, PlacedMesh& placed) {
  const std::string source = tissueLabel(description);
  setRegions(description, source, placed);
  setFibres(description, source, placed);
  setSprings(description, source, placed);
  setPressed(description, source, placed);
  placed.rest = (X_WT.linear() * placed.rest).colwise() + X_WT.translation();
}

}  // namespace

std::string tissueLabel(const TissueDescription& description) { return "tissue '" + description.name + "'"; }

PlacedMesh placeMesh(const TissueDescription& given, const Pose& X_WT, const MeshSizeCheck& on_size,
                     const MeshPreparation& preparation) {
  checkTissue(given);
  const std::string source = tissueLabel(given);
  PlacedMesh placed;
  VolumeMesh made;
  if (isMembrane(given)) {
    setMembrane(given, source, on_size, preparation, placed);
  } else {
    made = volumeMesh(given, source, on_size, preparation);
  }
  const TissueDescription description = withPlaces(given, made.labels, made.mesh);
  if (!isMembrane(given)) {
    std::vector<Triangle> surface = boundaryTriangles(made.mesh.tetrahedra);
    setVolume(std::move(made.mesh), std::move(surface), std::move(made.patch_of), placed);
  }
  placed.element_places = centroids(placed.rest, placed.tetrahedra);
  placed.surface_places = centroids(placed.rest, placed.surface);
  placed.fixed = fixedNodes(placed.rest, description.fixed, source);
  finish(description, X_WT, placed);
  return placed;
}

RefinableMesh refinableMesh(const TissueDescription& description, const MeshSizeCheck& on_size,
                            const MeshPreparation& preparation) {
  checkTissue(description);
  const VolumeMesh made = volumeMesh(description, tissueLabel(description), on_size, preparation);
  RefinableMesh refinable{withPlaces(description, made.labels, made.mesh), Bisection(made.mesh, made.patch_of), 1.0};
  refinable.body_coarsening = refineBody(made.mesh, refinable.description, refinable.bisection);
  const std::vector<LastingPart> parts = refinable.bisection.lastingParts();
  const double rounding = roundingDistance(made.mesh.positions);
  const auto addParts = [&](std::vector<Region>& regions) { regions = withParts(regions, parts, rounding); };
  addParts(refinable.description.pressure_where);
  for (TissueRegion& region : refinable.description.regions) addParts(region.where);
  for (Attachment& attachment : refinable.description.attachments) addParts(attachment.where);
  return refinable;
}

PlacedMesh placeMesh(const TissueDescription& description, const Pose& X_WT, const BisectedMesh& mesh) {
  PlacedMesh placed;
  setVolume(mesh.mesh, mesh.surface, mesh.patch_of, placed);
  placed.element_places = mesh.element_places;
  placed.surface_places = mesh.surface_places;
  const NodalVectors unrefined = placed.rest.leftCols(mesh.unrefinedNodes());
  placed.fixed = fixedNodes(unrefined, description.fixed, tissueLabel(description));
  placed.fixed.resize(static_cast<std::size_t>(placed.rest.cols()), false);
  // A group has no places between its nodes: in it is what halves an edge of two of them.
  std::vector<bool> in_group(placed.fixed.size(), false);
  std::vector<Region> groups;
  std::copy_if(description.fixed.begin(), description.fixed.end(), std::back_inserter(groups),
               [](const Region& region) { return std::holds_alternative<MemberRegion>(region); });
  const double rounding = roundingDistance(unrefined);
  for (Eigen::Index k = 0; k < unrefined.cols(); ++k) {
    in_group[static_cast<std::size_t>(k)] = anyHolds(groups, placed.rest.col(k), rounding);
  }
  for (Eigen::Index k = unrefined.cols(); k < placed.rest.cols(); ++k) {
    const auto node = static_cast<std::size_t>(k);
    const auto [a, b] = mesh.parents[static_cast<std::size_t>(k - unrefined.cols())];
    in_group[node] = in_group[a] && in_group[b];
    // One that comes later, between two that move, would be held back from where it is.
    const bool is_lasting = k - unrefined.cols() < mesh.lasting;
    placed.fixed[node] = is_lasting ? in_group[node] || anyHolds(description.fixed, placed.rest.col(k), rounding)
                                    : placed.fixed[a] && placed.fixed[b];
  }
  finish(description, X_WT, placed);
  return placed;
}

}  // namespace tissue_contact
