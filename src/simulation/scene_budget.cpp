/// @file
/// Room `simulation`: see scene_budget.h.
#include "simulation/scene_budget.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

/// Largest resident size while a tissue is built and stepped, over its elements: 3960 bytes on a sheet of 180 000
/// triangles, 1440 on a block of 320 000 tetrahedra. A tenth (neo-Hookean tissue that averages all it can) to a third is added for what a scene may hold besides: a
/// damping matrix where regions differ in damping, regions, fibres, tissue pairs.
std::size_t bytesOf(const TissueDescription& tissue, std::size_t elements) {
  constexpr std::size_t kPerTriangle = 5200;     // bending couples twelve nodes; both sides are surface
  constexpr std::size_t kPerTetrahedron = 2000;  // corotational with patches; neo-Hookean 80 to 230 more, others less
  constexpr std::size_t kPronySeries = 2200;     // a second set of elements, two matrices more
  constexpr std::size_t kPerTerm = 100;
  const std::size_t terms = tissue.material.prony_series.size();
  const std::size_t relaxing = terms > 0 ? kPronySeries + kPerTerm * terms : 0;
  return elements * (isMembrane(tissue) ? kPerTriangle : kPerTetrahedron + relaxing);
}

/// Of the Cholesky factor in the ordering used: measured on blocks of 1331 to 4096 and sheets of 2601 to 10 201 nodes,
/// 280 n^1.5 and 1900 n^1.25 bytes to 2 %.
double factorBytesOf(const TissueDescription& tissue, std::size_t nodes) {
  const auto n = static_cast<double>(nodes);
  return isMembrane(tissue) ? 1900.0 * std::pow(n, 1.25) : 280.0 * std::pow(n, 1.5);
}

bool isFactored(const SolverDescription& solver) {
  return solver.relaxation == RelaxationKind::kCholesky || solver.method == SolverMethod::kReference ||
         solver.method == SolverMethod::kCondensedLcp;
}

std::string megabytes(std::size_t bytes) { return std::to_string(bytes >> 20U) + " MB"; }

/// Nodes and elements of a block or sheet.
std::optional<std::array<std::size_t, 2>> sizeOf(const TissueDescription& tissue) {
  std::array<std::size_t, 2> size = {1, 1};
  const auto multiply = [&size](int cells) {
    const auto count = static_cast<std::size_t>(cells > 0 ? cells : 0);  // the generators refuse those
    size[0] *= count + 1;
    size[1] *= count;
  };
  if (const auto* block = std::get_if<BlockDescription>(&tissue.geometry)) {
    for (const int cells : block->cells) multiply(cells);
    size[1] *= static_cast<std::size_t>(
        tissue.refinement.mode == RefinementDescription::Mode::kNever ? BlockSplit::kFive : BlockSplit::kSix);
    return size;
  }
  if (const auto* sheet = std::get_if<SheetDescription>(&tissue.geometry)) {
    for (const int cells : sheet->cells) multiply(cells);
    size[1] *= 2;
    return size;
  }
  return std::nullopt;
}

}  // namespace

std::string sizeText(const TissueDescription& tissue, std::size_t nodes, std::size_t elements) {
  return std::to_string(elements) + (isMembrane(tissue) ? " triangles, " : " tetrahedra, ") + std::to_string(nodes) +
         " nodes, about " + megabytes(bytesOf(tissue, elements));
}

void SceneBudget::addGenerated() {
  for (std::size_t t = 0; t < scene_.tissues.size(); ++t) {
    const auto size = sizeOf(scene_.tissues[t]);
    if (size) atEntry(elementOf("tissues", t), [&] { add(scene_.tissues[t], (*size)[0], (*size)[1]); });
  }
}

void SceneBudget::add(const TissueDescription& tissue, std::size_t nodes, std::size_t elements) {
  if (tissue.refinement.mode != RefinementDescription::Mode::kNever) {
    constexpr std::size_t kElementsPerNode = 6;  // at most: as in the inside of a large block
    nodes = std::max(nodes, mostNodes(tissue.refinement, nodes));
    elements = std::max(elements, kElementsPerNode * nodes);
  }
  const std::string own = "tissue '" + tissue.name + "' has " + sizeText(tissue, nodes, elements);
  const std::string fix = "; use fewer cells, grading or a coarser mesh";
  elements_ += elements;
  if (elements_ > kMostElements) {
    throw EntryError("", own + "; that makes " + std::to_string(elements_) + " elements in the scene, at most " +
                             std::to_string(kMostElements) + " are allowed" + fix);
  }
  bytes_ += bytesOf(tissue, elements);
  if (bytes_ > kMostBytes) {
    throw EntryError("", own + "; that makes about " + megabytes(bytes_) + " for the scene, at most " +
                             megabytes(kMostBytes) + " are allowed" + fix);
  }
  if (!isFactored(scene_.solver)) return;
  const double factor = factorBytesOf(tissue, nodes);
  if (!(static_cast<double>(factor_bytes_) + factor <= static_cast<double>(kMostFactorBytes))) {
    throw EntryError("", own + "; its Cholesky factor takes about " +
                             std::to_string(std::llround(factor / (1U << 20U))) +
                             " MB, those of the scene may take at most " + megabytes(kMostFactorBytes) +
                             "; use solver: {relaxation: gauss_seidel} or fewer cells");
  }
  factor_bytes_ += static_cast<std::size_t>(factor);
}

void SceneBudget::add(const Instrument& instrument) {
  for (std::size_t l = 0; l < instrument.contactLinks().size(); ++l) {
    const ContactLink& link = instrument.contactLinks()[l];
    shapes_ += link.shapes.size();
    for (const CollisionShape& shape : link.shapes) {
      if (!shape.mesh) continue;
      ++mesh_shapes_;
      shape_triangles_ += shape.mesh->triangles.size();
    }
    const auto check = [&](std::size_t count, std::size_t most, const char* what) {
      if (count <= most) return;
      throw EntryError(elementOf("contact_links", l), "with those of link '" + link.name + "' the scene has " +
                                                          std::to_string(count) + what + "; at most " +
                                                          std::to_string(most) +
                                                          " are allowed; name fewer links, or simpler shapes of your "
                                                          "own");
    };
    check(shapes_, kMostShapes, " shapes that touch tissue");
    check(mesh_shapes_, kMostMeshShapes, " mesh shapes");
    check(shape_triangles_, kMostShapeTriangles, " triangles in mesh shapes");
  }
}

void BuildProgress::beginTissue(const TissueDescription& tissue, const std::string& ordinal, std::size_t nodes,
                                std::size_t elements) {
  all_ += elements;
  unsaid_ += elements;
  if (!say_ || unsaid_ < kWorthALine) return;
  unsaid_ = 0;
  say_("building tissue '" + tissue.name + "' (" + ordinal + "): " + sizeText(tissue, nodes, elements));
}

void BuildProgress::stage(const std::string& line) const {
  if (say_ && all_ >= kWorthALine) say_(line);
}

}  // namespace tissue_contact
