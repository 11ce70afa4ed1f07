#include "tissue/stiff_parts.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/disjoint_sets.h"

namespace tissue_contact {
namespace {

/// The shear modulus that half of the volume does not exceed, Pa.
double medianModulus(const NodalVectors& x, const std::vector<Tetrahedron>& tetrahedra,
                     const ElementMaterials& materials, const std::vector<double>& moduli) {
  std::vector<std::pair<double, double>> shares;  // modulus and volume of each material
  shares.reserve(moduli.size());
  for (const double modulus : moduli) shares.emplace_back(modulus, 0.0);
  double left = 0.0;
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    const double volume = signedVolume(x, tetrahedra[e]);
    shares[materials.index(e)].second += volume;
    left += 0.5 * volume;
  }
  std::sort(shares.begin(), shares.end());
  std::size_t at = 0;
  while (at + 1 < shares.size() && (left -= shares[at].second) > 0.0) ++at;
  return shares[at].first;
}

std::vector<std::vector<int>> listed(const std::vector<bool>& is_member, DisjointSets& joined) {
  std::vector<std::vector<int>> parts;
  std::vector<int> part_of(is_member.size(), -1);  // by its first node
  for (std::size_t node = 0; node < is_member.size(); ++node) {
    if (!is_member[node]) continue;
    int& part = part_of[static_cast<std::size_t>(joined.first(static_cast<int>(node)))];
    if (part < 0) {
      part = static_cast<int>(parts.size());
      parts.emplace_back();
    }
    parts[static_cast<std::size_t>(part)].push_back(static_cast<int>(node));
  }
  return parts;
}

}  // namespace

std::vector<std::vector<int>> findStiffParts(const NodalVectors& x, const std::vector<Tetrahedron>& tetrahedra,
                                             const ElementMaterials& materials) {
  std::vector<double> moduli;
  for (const MaterialDescription& material : materials.materials) moduli.push_back(lameParameters(material).mu);
  const auto [least, most] = std::minmax_element(moduli.begin(), moduli.end());
  if (tetrahedra.empty() || *most < kStiffRatio * *least) return {};
  const double stiff = kStiffRatio * medianModulus(x, tetrahedra, materials, moduli);
  DisjointSets joined(static_cast<std::size_t>(x.cols()));
  std::vector<bool> is_member(static_cast<std::size_t>(x.cols()), false);
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    const Tetrahedron& nodes = tetrahedra[e];
    if (moduli[materials.index(e)] < stiff) continue;
    for (const int node : nodes) {
      joined.join(nodes[0], node);
      is_member[static_cast<std::size_t>(node)] = true;
    }
  }
  return listed(is_member, joined);
}

}  // namespace tissue_contact
