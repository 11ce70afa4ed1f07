#include "tissue_contact/tissue/tissue.h"

#include <algorithm>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "mesh/face_table.h"
#include "tissue/attached_elasticity.h"
#include "tissue/element_patches.h"
#include "tissue/membrane.h"
#include "tissue/placed_mesh.h"
#include "tissue/stiff_parts.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/mesh/tissue_surface.h"
#include "tissue_contact/mesh/triangle_mesh.h"
#include "tissue_contact/tissue/make_elasticity.h"

namespace tissue_contact {
namespace {

bool sameSeries(const std::vector<PronyTerm>& a, const std::vector<PronyTerm>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const PronyTerm& s, const PronyTerm& t) {
    return s.modulus_ratio == t.modulus_ratio && s.time_s == t.time_s;
  });
}

void checkModel(const TissueDescription& description) {
  const MaterialDescription& material = description.material;
  if ((material.model == ElasticModel::kMembrane) != isMembrane(description)) {
    const std::string fits = isMembrane(description) ? "'; a sheet or shell must be a membrane; remove the key"
                                                     : "'; a block or mesh is a volume, no membrane; give linear, "
                                                       "corotational, neo_hookean or mass_spring";
    throw EntryError("material.model",
                     tissueLabel(description) + ": model is '" + elasticModelName(material.model) + fits);
  }
  if (material.dilatation == Dilatation::kPatch && !isContinuum(material.model)) {
    throw EntryError("material.dilatation",
                     tissueLabel(description) +
                         ": dilatation is 'patch', which only the models linear, corotational and "
                         "neo_hookean know; remove the key");
  }
  if (material.distortion == Distortion::kPatch && !isContinuum(material.model)) {
    throw EntryError("material.distortion",
                     tissueLabel(description) +
                         ": distortion is 'patch', which only the models linear, corotational and "
                         "neo_hookean know; remove the key");
  }
  if (material.distortion == Distortion::kPatch && !material.prony_series.empty()) {
    throw EntryError("material.distortion", tissueLabel(description) +
                                                ": distortion is 'patch', but stress that relaxes is that of "
                                                "elements; remove the key, or prony_series");
  }
  if (material.distortion == Distortion::kPatch && material.dilatation == Dilatation::kElement) {
    throw EntryError("material.distortion",
                     tissueLabel(description) +
                         ": distortion is 'patch' while dilatation is 'element'; patches average "
                         "both or the dilatation alone: remove one of the keys");
  }
  if (!material.prony_series.empty() && !isContinuum(material.model)) {
    throw EntryError("material.prony_series", tissueLabel(description) + ": model is '" +
                                                  elasticModelName(material.model) +
                                                  "', whose stress does not relax; give linear, corotational or "
                                                  "neo_hookean, or remove the key");
  }
  for (std::size_t r = 0; r < description.regions.size(); ++r) {
    const TissueRegion& region = description.regions[r];
    const std::string entry = elementOf("regions", r) + ".material";
    if (region.material.dilatation != description.material.dilatation) {
      throw EntryError(entry + ".dilatation", tissueLabel(description) + ", region '" + region.name +
                                                  "': dilatation is not that of the tissue; give all regions the same");
    }
    if (region.material.distortion != description.material.distortion) {
      throw EntryError(entry + ".distortion", tissueLabel(description) + ", region '" + region.name +
                                                  "': distortion is not that of the tissue; give all regions the same");
    }
    if (!sameSeries(region.material.prony_series, material.prony_series)) {
      throw EntryError(entry + ".prony_series", tissueLabel(description) + ", region '" + region.name +
                                                    "': its Prony series is not that of the tissue; give all regions "
                                                    "the same");
    }
    if (region.material.model == material.model) continue;
    throw EntryError(entry + ".model", tissueLabel(description) + ", region '" + region.name + "': model is '" +
                                           elasticModelName(region.material.model) +
                                           "'; it must be that of the tissue, '" + elasticModelName(material.model) +
                                           "': give parts of different models as tissues of their own");
  }
}

/// What a refined mesh would not leave as it is: springs along edges, and stress that elements remember.
void checkRefinement(const TissueDescription& description) {
  if (description.refinement.mode == RefinementDescription::Mode::kNever) return;
  const char* obstacle = nullptr;
  if (isMembrane(description)) {
    obstacle = "a sheet or shell, of which only even meshes bend alike everywhere";
  } else if (!isContinuum(description.material.model)) {
    obstacle = "a mass-spring volume, whose stiffness is that of the edges it has";
  } else if (!description.material.prony_series.empty()) {
    obstacle = "tissue whose stress relaxes, since new elements would not know what it was";
  } else if (std::any_of(description.attachments.begin(), description.attachments.end(),
                         [](const Attachment& one) { return one.stiffness_n_per_m > 0.0; })) {
    obstacle =
        "tissue attached by stiffness_n_per_m, which would grow with the number of nodes: give stiffness_pa_per_m";
  }
  if (obstacle == nullptr) return;
  throw EntryError("refinement", tissueLabel(description) + ": refinement is asked for of " + obstacle +
                                     "; remove the key, or make it never");
}

void checkNumbers(const MaterialDescription& material, double damping_stiffness_s, const std::string& owner) {
  checkMaterial(material, owner);
  requirePositive(owner + "density_kg_per_m3", material.density_kg_per_m3, "kg/m^3");
  requireNonNegative(owner + "damping stiffness_s", damping_stiffness_s, "s");
}

void checkAttachment(const Attachment& attachment, const std::string& owner) {
  if (attachment.where.empty()) {
    throw EntryError("where", owner + " has no region; give at least one");
  }
  const double per_area = attachment.stiffness_pa_per_m;
  const double per_node = attachment.stiffness_n_per_m;
  if ((per_area == 0.0) == (per_node == 0.0)) {
    throw EntryError("", owner + (per_area == 0.0 ? " has no stiffness" : " has two stiffnesses") +
                             "; give exactly one of stiffness_pa_per_m (of a surface) and stiffness_n_per_m (of each "
                             "node)");
  }
  if (per_area != 0.0) requirePositive(owner + ": stiffness_pa_per_m", per_area, "Pa/m");
  if (per_node != 0.0) requirePositive(owner + ": stiffness_n_per_m", per_node, "N/m");
}

double leastShearModulus(const TissueDescription& description) {
  double least = lameParameters(description.material).mu;
  for (const TissueRegion& region : description.regions) least = std::min(least, lameParameters(region.material).mu);
  return least;
}

/// Of stresses linear in the strain the work of shrinking a body under p has no minimum beyond p = 2 mu (doc/method.md).
void checkPressure(const TissueDescription& description) {
  const ElasticModel model = description.material.model;
  const double most = 2.0 * leastShearModulus(description);
  const bool is_free = description.fixed.empty() && description.attachments.empty();
  std::ostringstream message;
  message << tissueLabel(description) << ": pressure_pa is " << description.pressure_pa << " Pa, under which a ";
  if (model == ElasticModel::kLinear && is_free && description.pressure_pa != 0.0) {
    message << "free body of the linear model tumbles, since its stress does not turn with it; give material.model "
               "corotational, or hold it by fixed or attachments";
    throw EntryError("pressure_pa", message.str());
  }
  const bool is_small_strain = model == ElasticModel::kLinear || model == ElasticModel::kCorotational;
  if (!is_small_strain || !description.pressure_where.empty() || description.pressure_pa < most) return;
  message << elasticModelName(model) << " tissue may collapse from twice its shear modulus on, here " << most
          << " Pa; give material.model neo_hookean, or less pressure";
  throw EntryError("pressure_pa", message.str());
}

void checkLoads(const TissueDescription& description) {
  const std::string label = tissueLabel(description);
  for (std::size_t a = 0; a < description.attachments.size(); ++a) {
    atEntry(elementOf("attachments", a),
            [&] { checkAttachment(description.attachments[a], label + ", attachment " + std::to_string(a)); });
  }
  atEntry("pressure_pa", [&] { requireFinite(label + ": pressure_pa", description.pressure_pa, "Pa"); });
  checkPressure(description);
  if (description.pressure_where.empty() || description.pressure_pa != 0.0) return;
  throw EntryError("pressure_where",
                   label +
                       ": pressure_where says where a pressure acts, but pressure_pa is 0 or missing; "
                       "give pressure_pa, or remove pressure_where");
}

}  // namespace

void checkTissue(const TissueDescription& description) {
  checkModel(description);
  checkRefinement(description);
  atEntry("material", [&] {
    checkNumbers(description.material, description.damping.stiffness_s, tissueLabel(description) + ": ");
  });
  atEntry("damping.mass_per_s", [&] {
    requireNonNegative(tissueLabel(description) + ": damping mass_per_s", description.damping.mass_per_s, "1/s");
  });
  for (std::size_t r = 0; r < description.regions.size(); ++r) {
    const TissueRegion& region = description.regions[r];
    atEntry(elementOf("regions", r) + ".material", [&] {
      checkNumbers(region.material, region.damping_stiffness_s,
                   tissueLabel(description) + ", region '" + region.name + "': ");
    });
  }
  checkLoads(description);
}

namespace {

/// The tissue's own material first, then its regions'.
ElementMaterials elementMaterials(const TissueDescription& description, const std::vector<int>& element_regions) {
  ElementMaterials materials = materialsOf(description);
  materials.damping_s.push_back(description.damping.stiffness_s);
  for (const TissueRegion& region : description.regions) materials.damping_s.push_back(region.damping_stiffness_s);
  for (const int region : element_regions) materials.of_element.push_back(region + 1);
  return materials;
}

/// If all elements damp alike, takes that out of the materials and returns it; else 0.
double takeUniformDamping(std::size_t elements, ElementMaterials& materials) {
  const double first = materials.dampingOf(0);
  for (std::size_t e = 1; e < elements; ++e) {
    if (materials.dampingOf(e) != first) return 0.0;
  }
  materials.damping_s.clear();
  return first;
}

/// Per element the first of the materials that is as stiff as its own and damps as it does. Empty: there is one.
std::vector<int> stiffnessesOf(const ElementMaterials& materials) {
  const auto isAlike = [&](std::size_t a, std::size_t b) {
    const MaterialDescription& one = materials.materials[a];
    const MaterialDescription& other = materials.materials[b];
    return one.youngs_modulus_pa == other.youngs_modulus_pa && one.poissons_ratio == other.poissons_ratio &&
           (materials.damping_s.empty() || materials.damping_s[a] == materials.damping_s[b]);
  };
  std::vector<int> first(materials.materials.size());
  for (std::size_t m = 0; m < first.size(); ++m) {
    std::size_t like = 0;
    while (!isAlike(like, m)) ++like;
    first[m] = static_cast<int>(like);
  }
  std::vector<int> of_element;
  for (const int material : materials.of_element) of_element.push_back(first[static_cast<std::size_t>(material)]);
  return of_element;
}

VectorX lumpedMasses(const Tissue& tissue, const ElementMaterials& materials) {
  VectorX masses = VectorX::Zero(tissue.nodeCount());
  for (std::size_t e = 0; e < tissue.tetrahedra().size(); ++e) {
    const Tetrahedron& nodes = tissue.tetrahedra()[e];
    const double quarter = 0.25 * materials.of(e).density_kg_per_m3 * signedVolume(tissue.restPositions(), nodes);
    for (const int node : nodes) masses[node] += quarter;
  }
  if (!tissue.tetrahedra().empty()) return masses;
  for (std::size_t e = 0; e < tissue.surface().size(); ++e) {
    const Triangle& nodes = tissue.surface()[e];
    const double density = materials.of(e).density_kg_per_m3;
    const double third = density * tissue.thickness() * triangleArea(tissue.restPositions(), nodes) / 3.0;
    for (const int node : nodes) masses[node] += third;
  }
  return masses;
}

/// See Tissue::thicknessStiffness().
VectorX thicknessStiffnessOf(const Tissue& tissue, const ElementMaterials& materials) {
  // Beyond it as at it, 3.8 E: what is nearly incompressible flows out sideways. As stiff is a bonded layer between plates
  // that are five times as wide as it is thick: E (1 + 2 S^2), S = 1.2 (Gent and Lindley, Proc. Inst. Mech. Eng. 173, 1959).
  constexpr double kMostPoissonsRatio = 0.45;
  VectorX stiffness = VectorX::Zero(tissue.nodeCount());
  for (std::size_t t = 0; t < tissue.surface().size(); ++t) {
    MaterialDescription material = materials.of(t);
    material.poissons_ratio = std::min(material.poissons_ratio, kMostPoissonsRatio);
    const LameParameters lame = lameParameters(material);
    const double third = triangleArea(tissue.restPositions(), tissue.surface()[t]) / 3.0;
    for (const int node : tissue.surface()[t]) {
      stiffness[node] += (lame.lambda + 2.0 * lame.mu) * third / (0.5 * tissue.thickness());
    }
  }
  return stiffness;
}

double smallestHeightOf(const NodalVectors& x, const std::vector<Tetrahedron>& tetrahedra) {
  double smallest = tetrahedra.empty() ? 0.0 : std::numeric_limits<double>::infinity();
  for (const Tetrahedron& nodes : tetrahedra) {
    double largest_area = 0.0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      largest_area = std::max(largest_area, triangleArea(x, outwardFace(nodes, i)));
    }
    smallest = std::min(smallest, 3.0 * signedVolume(x, nodes) / largest_area);
  }
  return smallest;
}

}  // namespace

struct Tissue::ElasticParts {
  std::vector<int> patch_of;  ///< see PlacedMesh
  std::vector<NodeSpring> springs;
};

Tissue::Tissue(const TissueDescription& description, const Pose& X_WT, const MeshSizeCheck& on_size,
               const MeshPreparation& preparation)
    : Tissue(description, placeMesh(description, X_WT, on_size, preparation)) {}

Tissue::Tissue(const TissueDescription& description, const Pose& X_WT, const BisectedMesh& mesh)
    : Tissue(description, placeMesh(description, X_WT, mesh)) {}

Tissue::Tissue(const TissueDescription& description, PlacedMesh&& placed)
    : name_(description.name),
      thickness_(placed.thickness),
      parts_(std::make_shared<ElasticParts>(ElasticParts{std::move(placed.patch_of), std::move(placed.springs)})),
      pressure_(description.pressure_pa) {
  for (const NodeSpring& spring : parts_->springs) attachment_stiffness_ += spring.stiffness;
  rest_ = std::move(placed.rest);
  tetrahedra_ = std::move(placed.tetrahedra);
  surface_ = std::move(placed.surface);
  fixed_ = std::move(placed.fixed);
  surface_regions_ = std::move(placed.surface_regions);
  element_regions_ = std::move(placed.element_regions);
  surface_fibres_ = std::move(placed.surface_fibres);
  pressed_ = std::move(placed.pressed);
  smallest_height_ = smallestHeightOf(rest_, tetrahedra_);
  changeMaterials(description);
}

void Tissue::changeMaterials(const TissueDescription& description) {
  ElementMaterials materials = elementMaterials(description, element_regions_);
  const std::size_t elements = tetrahedra_.empty() ? surface_.size() : tetrahedra_.size();
  // Springs are damped as the tissue, also where all its elements belong to regions that are damped otherwise.
  const bool is_uniform = parts_->springs.empty() || materials.dampingOf(0) == description.damping.stiffness_s;
  damping_ = {description.damping.mass_per_s, is_uniform ? takeUniformDamping(elements, materials) : 0.0};
  masses_ = lumpedMasses(*this, materials);
  stiff_parts_ = findStiffParts(rest_, tetrahedra_, materials);
  if (!tetrahedra_.empty()) {
    elasticity_ = makeVolumeElasticity(rest_, tetrahedra_, fixed_, materials,
                                       cutAtMaterials(parts_->patch_of, stiffnessesOf(materials)));
  } else {
    elasticity_ = std::make_unique<Membrane>(rest_, surface_, fixed_, thickness_, materials);
    thickness_stiffness_ = thicknessStiffnessOf(*this, materials);
  }
  if (parts_->springs.empty()) return;
  elasticity_ = std::make_unique<AttachedElasticity>(std::move(elasticity_), rest_, parts_->springs,
                                                     description.damping.stiffness_s);
}

void Tissue::addPressure(const NodalVectors& x, NodalVectors& forces) const {
  for (const Triangle& triangle : pressed_) {
    const Vector3 edge = x.col(triangle[1]) - x.col(triangle[0]);
    const Vector3 other = x.col(triangle[2]) - x.col(triangle[0]);
    const Vector3 third = (pressure_ / 6.0) * edge.cross(other);  // p A n / 3, n outward
    for (const int node : triangle) forces.col(node) -= third;
  }
}

double meanSurfaceEdge(const Tissue* tissues, std::size_t count) {
  EdgeLengths all;
  for (std::size_t k = 0; k < count; ++k) {
    const EdgeLengths own = edgeLengths(tissues[k].restPositions(), tissues[k].surface());
    all.sum_m += own.sum_m;
    all.count += own.count;
  }
  return all.count > 0 ? all.sum_m / static_cast<double>(all.count) : 0.0;
}

}  // namespace tissue_contact
