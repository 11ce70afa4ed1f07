#include "simulation/sheet_thickness.h"

#include <algorithm>
#include <tuple>

namespace tissue_contact {

SheetThickness::SheetThickness(const std::vector<Tissue>& tissues)
    : tissues_(tissues), any_sheet_(std::any_of(tissues.begin(), tissues.end(), [](const Tissue& tissue) {
        return tissue.thicknessStiffness().size() > 0;
      })) {}

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

  stiffnesses_.assign(contacts.size(), {0.0, 0.0});
  for (auto begin = pressed_.cbegin(); begin != pressed_.cend();) {
    const auto end = std::find_if(begin, pressed_.cend(), [&](const Pressed& one) {
      return std::tie(one.tissue, one.node, one.by) != std::tie(begin->tissue, begin->node, begin->by);
    });
    divide(begin, end);
    begin = end;
  }
  compliances_.resize(contacts.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    compliances_[c] = 0.0;
    for (const double stiffness : stiffnesses_[c]) compliances_[c] += stiffness > 0.0 ? 1.0 / stiffness : 0.0;
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
  const double stiffness = tissues_[begin->tissue].thicknessStiffness()[begin->node];
  for (auto one = begin; one != end; ++one) {
    const double sum = one->presses ? pressing : pressing + one->weight;
    stiffnesses_[one->contact][one->side] += stiffness * one->weight / std::max(sum, 1.0);
  }
}

}  // namespace tissue_contact
