#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <variant>

#include "core/disjoint_sets.h"
#include "simulation/advisor.h"
#include "tissue/body_edges.h"
#include "tissue/spring_stiffness.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {

std::optional<Advice> sizeDoubt(const TissueDescription& tissue, const NodalVectors& rest, const HalfExtents& shapes) {
  const auto* const mesh = std::get_if<MeshDescription>(&tissue.geometry);
  const auto* const shell = std::get_if<ShellDescription>(&tissue.geometry);
  constexpr double kLongOrgan = 2.0;  // m
  constexpr double kHugeTool = 0.5;   // m, half extent
  const Vector3 size = rest.rowwise().maxCoeff() - rest.rowwise().minCoeff();
  const bool is_small = size.maxCoeff() < shapes.smallest_m;
  const bool is_of_file = mesh != nullptr || shell != nullptr;
  const bool is_tool_huge = is_small && shapes.smallest_m > kHugeTool;
  if (!(is_of_file && (is_small || size.maxCoeff() >= kLongOrgan)) && !is_tool_huge) return std::nullopt;
  std::string text = "tissue " + quoted(tissue.name) + " is " + twoDigits(1e3 * size.x()) + " x " +
                     twoDigits(1e3 * size.y()) + " x " + twoDigits(1e3 * size.z()) + " mm";
  if (is_small) {
    text +=
        ", smaller than every instrument's shape (" + twoDigits(1e3 * shapes.smallest_m) + " mm half extent and more)";
  }
  if (is_tool_huge) return Advice{text + ": are lengths of the URDF in millimetres? They are metres", true};
  return Advice{text + ": is the unit of its file that of the scene? It has scale_m_per_unit " +
                    twoDigits(mesh != nullptr ? mesh->scale_m_per_unit : shell->scale_m_per_unit) +
                    " (1 for metres, 0.001 for millimetres)",
                true};
}

std::optional<Advice> heldDoubt(const TissueDescription& description, const Tissue& tissue) {
  if (!std::holds_alternative<MeshDescription>(description.geometry)) return std::nullopt;
  const auto is_fixed = [&](int node) { return tissue.fixed()[static_cast<std::size_t>(node)]; };
  double longest_m = 0.0;
  for (const Tetrahedron& nodes : tissue.tetrahedra()) {
    const auto fixed = std::count_if(nodes.begin(), nodes.end(), is_fixed);
    if (fixed == 0 || fixed == 4) continue;
    for (const int a : nodes) {
      for (const int b : nodes) {
        longest_m = std::max(longest_m, (tissue.restPositions().col(a) - tissue.restPositions().col(b)).norm());
      }
    }
  }
  if (longest_m <= longestBodyEdge(tissue.restPositions(), tissue.tetrahedra(), description.refinement)) {
    return std::nullopt;
  }
  const auto held = std::count(tissue.fixed().begin(), tissue.fixed().end(), true);
  return Advice{"tissue " + quoted(description.name) + ": `fixed` holds " + std::to_string(held) + " of " +
                    std::to_string(tissue.nodeCount()) + " nodes, beside edges of up to " + twoDigits(1e3 * longest_m) +
                    " mm. The body bends too stiffly with such, and where the border of `fixed` runs through them it "
                    "is held elsewhere: forces may be off by a third; refinement (auto, fine or a map) cuts them",
                true};
}

std::optional<Advice> unitDoubt(const TissueDescription& tissue) {
  constexpr double kSoft = 100.0;   // Pa; brain has some 500
  constexpr double kLight = 100.0;  // kg/m^3; lung has some 300
  constexpr double kSlow = 0.5;     // s; figures of organs are some milliseconds
  const auto doubt = [&](const char* key, double value, const char* question) {
    return Advice{
        "tissue " + quoted(tissue.name) + ": " + key + " is " + twoDigits(value) + ", which no tissue has: " + question,
        true};
  };
  double softest_pa = tissue.material.youngs_modulus_pa;
  for (const TissueRegion& region : tissue.regions) {
    softest_pa = std::min(softest_pa, region.material.youngs_modulus_pa);
  }
  if (softest_pa < kSoft) {
    return doubt("material.youngs_modulus_pa", softest_pa, "is it in kPa? Give 1000 times as much");
  }
  if (tissue.material.density_kg_per_m3 < kLight) {
    return doubt("material.density_kg_per_m3", tissue.material.density_kg_per_m3,
                 "is it in g/cm^3? Give 1000 times as much");
  }
  if (tissue.damping.stiffness_s > kSlow) {
    return doubt("damping.stiffness_s", tissue.damping.stiffness_s, "is it in milliseconds? Give a thousandth");
  }
  return std::nullopt;
}

std::optional<Advice> stepDoubt(const Scene& scene, const TissueDescription& tissue) {
  constexpr double kShort = 0.0025;  // s: 2 ms, as many recordings are played with, are let pass
  const double step_s = scene.step.max_step_s;
  const double own_s = tissue.damping.stiffness_s;
  if (step_s <= std::max(kShort, own_s)) return std::nullopt;
  return Advice{
      "tissue " + quoted(tissue.name) + ": steps of " + twoDigits(1e3 * step_s) +
          " ms damp what it does by itself as so much of damping.stiffness_s would, beside its own " +
          twoDigits(1e3 * own_s) +
          " ms: where it swings or is shaken forces may be off by a third and more, which force errors do not "
          "tell; slow presses are right. step.max_step_s of 0.001 is the default",
      false};
}

namespace {

/// Nodes of parts (of which no two share an element) in which none is fixed.
struct LooseNodes {
  int count = 0;
  int first = 0;
};

LooseNodes looseNodes(const Tissue& tissue) {
  DisjointSets parts(static_cast<std::size_t>(tissue.nodeCount()));
  const auto joinAll = [&parts](const auto& elements) {
    for (const auto& element : elements) {
      for (const int node : element) parts.join(element[0], node);
    }
  };
  joinAll(tissue.tetrahedra());
  joinAll(tissue.surface());
  std::vector<bool> is_held(static_cast<std::size_t>(tissue.nodeCount()), false);  // by a part's first node
  for (int node = 0; node < tissue.nodeCount(); ++node) {
    if (tissue.fixed()[static_cast<std::size_t>(node)]) is_held[static_cast<std::size_t>(parts.first(node))] = true;
  }
  LooseNodes loose;
  for (int node = tissue.nodeCount() - 1; node >= 0; --node) {
    if (is_held[static_cast<std::size_t>(parts.first(node))]) continue;
    ++loose.count;
    loose.first = node;
  }
  return loose;
}

bool liesOnAnother(const Scene& scene, const std::string& tissue) {
  return std::any_of(scene.tissue_pairs.begin(), scene.tissue_pairs.end(), [&](const TissuePair& pair) {
    return pair.tissue != pair.other && (pair.tissue == tissue || pair.other == tissue);
  });
}

Advice loosePartsDoubt(const Tissue& tissue, const LooseNodes& loose) {
  const Vector3 place = tissue.restPositions().col(loose.first);
  std::ostringstream text;
  text.precision(3);
  text << "tissue " << quoted(tissue.name()) << ": `fixed` holds no node of some of its parts, " << loose.count
       << " of its " << tissue.nodeCount() << " nodes, of which one is at (" << place.x() << ", " << place.y() << ", "
       << place.z()
       << ") m in the world: what touches them pushes them away. Parts that share no element do not hang together; "
          "hold each, join them in the mesh, or leave out what is not wanted";
  return Advice{text.str(), true};
}

/// Whether half of the nodes of one of a block's faces across `axis` are fixed. Nodes of the lattice come first, x fastest.
bool isHeldAlongAFace(const BlockDescription& block, int axis, const std::vector<bool>& fixed) {
  const auto along = static_cast<std::size_t>(axis);
  std::array<int, 2> on_face{};
  std::array<int, 2> held{};
  std::array<int, 3> at{};
  std::size_t node = 0;
  for (at[2] = 0; at[2] <= block.cells[2]; ++at[2]) {
    for (at[1] = 0; at[1] <= block.cells[1]; ++at[1]) {
      for (at[0] = 0; at[0] <= block.cells[0]; ++at[0], ++node) {
        if (at[along] != 0 && at[along] != block.cells[along]) continue;
        const std::size_t face = at[along] == 0 ? 0 : 1;
        ++on_face[face];
        held[face] += static_cast<int>(fixed[node]);
      }
    }
  }
  return 2 * held[0] >= on_face[0] || 2 * held[1] >= on_face[1];
}

}  // namespace

std::optional<Advice> supportDoubt(const Scene& scene, std::size_t tissue, const std::vector<Tissue>& tissues) {
  const TissueDescription& description = scene.tissues[tissue];
  const std::vector<bool>& fixed = tissues[tissue].fixed();
  if (std::find(fixed.begin(), fixed.end(), false) == fixed.end()) {
    return Advice{
        "tissue " + quoted(description.name) +
            ": `fixed` holds all of its nodes, so nothing presses on it and all wrenches are zero; of a plane it "
            "holds what lies against its normal",
        true};
  }
  if (liesOnAnother(scene, description.name) || tissues[tissue].attachmentStiffness() > 0.0) return std::nullopt;
  const bool is_held = std::find(fixed.begin(), fixed.end(), true) != fixed.end();
  if (is_held) {
    const LooseNodes loose = looseNodes(tissues[tissue]);
    if (loose.count == 0) return std::nullopt;
    return loosePartsDoubt(tissues[tissue], loose);
  }
  const bool may_lie_somewhere = !scene.gravity_m_per_s2.isZero();  // on an instrument, as a body on an inclined plate
  if (may_lie_somewhere) return std::nullopt;
  return Advice{
      "tissue " + quoted(description.name) +
          ": nothing holds it, so what touches it pushes it away and forces are those of its inertia; give it "
          "`fixed` or `attachments`, or something to lie on in tissue_pairs",
      true};
}

std::optional<Advice> bendingDoubt(const Scene& scene, std::size_t tissue, const std::vector<Tissue>& tissues) {
  constexpr double kSlender = 4.0;  // times as long as thick: with less, shear and compression give way first
  constexpr int kEnoughCells = 4;   // over the thickness
  const TissueDescription& description = scene.tissues[tissue];
  const auto* const block = std::get_if<BlockDescription>(&description.geometry);
  if (block == nullptr || liesOnAnother(scene, description.name) || tissues[tissue].attachmentStiffness() > 0.0) {
    return std::nullopt;
  }
  int fewest = kEnoughCells;
  double thickness_m = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (block->size_m.maxCoeff() < kSlender * block->size_m[axis]) continue;
    if (isHeldAlongAFace(*block, axis, tissues[tissue].fixed())) return std::nullopt;
    const int cells = block->cells[static_cast<std::size_t>(axis)];
    if (cells >= fewest) continue;
    fewest = cells;
    thickness_m = block->size_m[axis];
  }
  if (fewest == kEnoughCells) return std::nullopt;
  return Advice{"tissue " + quoted(description.name) + " has " + std::to_string(fewest) +
                    (fewest == 1 ? " cell" : " cells") + " over its thickness of " + twoDigits(1e3 * thickness_m) +
                    " mm: where it bends it is too stiff, by a tenth to three times, most with long cells, whatever is "
                    "expected of the mesh under the tool; block.cells: " +
                    std::to_string(kEnoughCells) + " there, no longer than they are thick, leave less than a tenth",
                true};
}

std::optional<Advice> springDoubt(const TissueDescription& description, const Tissue& tissue) {
  if (description.material.model != ElasticModel::kMassSpring) return std::nullopt;
  constexpr double kMostPressure = 0.04;  // of Young's modulus; from .05 on elements were seen to turn inside out
  const double factor = leastWantedSpringFactor(tissue.restPositions(), tissue.tetrahedra());
  double softest_pa = description.material.youngs_modulus_pa;
  for (const TissueRegion& region : description.regions) {
    softest_pa = std::min(softest_pa, region.material.youngs_modulus_pa);
  }
  std::string text;
  if (factor < kLeastSpringFactor) {
    text += ": its cells are so uneven that as a mass_spring body they would need springs of " + twoDigits(factor) +
            " times their stiffness to be as stiff along all directions, and have " + twoDigits(kLeastSpringFactor) +
            ". A press on cells 1.25 to 1.5 times as wide as high has .75 to .85 of its force, on cells twice as wide "
            "a third, and "
            "deep ones make them fall in; cells twice as high as wide sag less than half as far as they should. Give "
            "cells about as wide as high, or another material.model";
  }
  if (description.pressure_pa > kMostPressure * softest_pa) {
    text += (text.empty() ? ": " : "; and ") + std::string("pressure_pa is ") +
            twoDigits(description.pressure_pa / softest_pa) +
            " of Young's modulus: springs do not mind being turned inside out, and from .05 to .1 of it on parts of a "
            "body are, without an error being told; give material.model neo_hookean";
  }
  if (text.empty()) return std::nullopt;
  return Advice{"tissue " + quoted(description.name) + text, true};
}

namespace {

bool isClosed(const std::vector<Triangle>& surface) {
  std::vector<std::array<int, 2>> edges;
  edges.reserve(3 * surface.size());
  for (const Triangle& t : surface) {
    for (std::size_t i = 0; i < 3; ++i) {
      const int next = t[(i + 1) % 3];
      edges.push_back({std::min(t[i], next), std::max(t[i], next)});
    }
  }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size(); i += 2) {
    if (i + 1 == edges.size() || edges[i] != edges[i + 1]) return false;
  }
  return true;
}

}  // namespace

std::optional<Advice> inflationDoubt(const TissueDescription& description, const Tissue& tissue) {
  if (!isMembrane(description) || description.pressure_pa == 0.0 || !description.pressure_where.empty()) {
    return std::nullopt;
  }
  if (!isClosed(tissue.surface())) return std::nullopt;
  const NodalVectors& x = tissue.restPositions();
  const Vector3 origin = x.rowwise().mean();
  double area = 0.0;
  double volume = 0.0;
  for (const Triangle& t : tissue.surface()) {
    const Vector3 doubled = (x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0]));
    area += 0.5 * doubled.norm();
    volume += (x.col(t[0]) - origin).dot(doubled) / 6.0;
  }
  const double inflating_pa = volume > 0.0 ? -description.pressure_pa : description.pressure_pa;
  const double radius = 3.0 * std::abs(volume) / area;  // a ball's; of other shapes less than where they curve least
  // p = 2 h E (s - 1) / ((1 - nu) R s^2) of a ball of stretch s, membrane.h's law; most at s = 2.
  const MaterialDescription& material = description.material;
  const double most_pa =
      tissue.thickness() * material.youngs_modulus_pa / (2.0 * (1.0 - material.poissons_ratio) * radius);
  const bool is_held_by_springs = tissue.attachmentStiffness() * radius > inflating_pa * area;
  if (!(inflating_pa > most_pa) || is_held_by_springs) return std::nullopt;
  return Advice{"tissue " + quoted(description.name) + ": its closed shell is inflated by " + twoDigits(inflating_pa) +
                    " Pa, more than the " + twoDigits(most_pa) +
                    " Pa that a ball of its size, thickness and material can bear, E h / (2 (1 - nu) R) with R " +
                    twoDigits(1e3 * radius) +
                    " mm: it has no shape of rest and blows up until its steps are discarded; give less pressure, or "
                    "a thicker or stiffer wall",
                true};
}

}  // namespace tissue_contact
