#include "simulation/sheet_thickness.h"

#include <algorithm>
#include <tuple>

#include "tissue_contact/mesh/triangle_mesh.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {
namespace {

/// Per node, N/m: what half the thickness resists with in simple shear over the node's share of the area at rest.
VectorX shearStiffnessOf(const Tissue& tissue, const TissueDescription& description) {
  VectorX stiffness = VectorX::Zero(tissue.nodeCount());
  for (std::size_t t = 0; t < tissue.surface().size(); ++t) {
    const int region = tissue.surfaceRegions().empty() ? -1 : tissue.surfaceRegions()[t];
    const double G = lameParameters(region < 0 ? description.material : description.regions[region].material).mu;
    const double third = triangleArea(tissue.restPositions(), tissue.surface()[t]) / 3.0;
    for (const int node : tissue.surface()[t]) stiffness[node] += G * third / (0.5 * tissue.thickness());
  }
  return stiffness;
}

}  // namespace

SheetThickness::SheetThickness(const std::vector<Tissue>& tissues)
    : tissues_(tissues), any_sheet_(std::any_of(tissues.begin(), tissues.end(), [](const Tissue& tissue) {
        return tissue.thicknessStiffness().size() > 0;
      })) {}

void SheetThickness::setMaterials(const std::vector<TissueDescription>& descriptions) {
  shear_stiffness_.resize(tissues_.size());
  for (std::size_t t = 0; t < tissues_.size(); ++t) {
    if (tissues_[t].thickness() > 0.0) shear_stiffness_[t] = shearStiffnessOf(tissues_[t], descriptions[t]);
  }
}

void SheetThickness::prepare(const std::vector<SolvedContact>& contacts) {
  if (!any_sheet_) return;
  pressed_.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    add(contacts[c], c, 0);
    if (contacts[c].contact.key.other_tissue >= 0) add(contacts[c], c, 1);
  }
  const auto order = [](const Pressed& one) {
    return std::tie(one.tissue, one.node, one.by, one.contact, one.side, one.weight);
  };
  std::sort(pressed_.begin(), pressed_.end(),
            [&](const Pressed& one, const Pressed& other) { return order(one) < order(other); });

  stiffnesses_.assign(contacts.size(), {});
  for (auto begin = pressed_.cbegin(); begin != pressed_.cend();) {
    const auto end = std::find_if(begin, pressed_.cend(), [&](const Pressed& one) {
      return std::tie(one.tissue, one.node, one.by) != std::tie(begin->tissue, begin->node, begin->by);
    });
    divide(begin, end);
    begin = end;
  }
  compliances_.resize(contacts.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    compliances_[c] = SheetCompliance();
    for (const Stiffness& stiffness : stiffnesses_[c]) {
      if (!(stiffness.normal > 0.0)) continue;
      compliances_[c].normal += 1.0 / stiffness.normal;
      compliances_[c].tangential += 1.0 / stiffness.tangential;
    }
  }
}

void SheetThickness::add(const SolvedContact& solved, std::size_t contact, int side) {
  const Contact& at = solved.contact;
  const int tissue = side == 0 ? at.key.tissue : at.key.other_tissue;
  if (tissues_[tissue].thicknessStiffness().size() == 0) return;
  const std::array<int, 4> by = {at.key.instrument, at.key.link, at.key.shape,
                                 side == 0 ? at.key.other_tissue : at.key.tissue};
  const bool presses = at.gap_m < 0.0 || !solved.force_on_tissue_n.isZero(0.0);
  for (int i = 0; i < 3; ++i) {
    const double weight = side == 0 ? at.weights[i] : at.other_weights[i];
    if (weight == 0.0) continue;
    pressed_.push_back({tissue, side == 0 ? at.nodes[i] : at.other_nodes[i], by, contact, side, weight, presses});
  }
}

/// Among the contacts of one shape on one node, of whose area they bear no more than their weights. One that does not press
/// yet is told what it would have beside those that do.
void SheetThickness::divide(std::vector<Pressed>::const_iterator begin, std::vector<Pressed>::const_iterator end) {
  double pressing = 0.0;
  for (auto one = begin; one != end; ++one) pressing += one->presses ? one->weight : 0.0;
  const double normal = tissues_[begin->tissue].thicknessStiffness()[begin->node];
  const double tangential = shear_stiffness_[begin->tissue][begin->node];
  for (auto one = begin; one != end; ++one) {
    const double sum = one->presses ? pressing : pressing + one->weight;
    const double share = one->weight / std::max(sum, 1.0);
    Stiffness& stiffness = stiffnesses_[one->contact][one->side];
    stiffness.normal += normal * one->weight / std::max(sum, 1.0);
    stiffness.tangential += tangential * share;
  }
}

}  // namespace tissue_contact
