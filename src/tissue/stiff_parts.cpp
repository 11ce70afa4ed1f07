#include "tissue/stiff_parts.h"

#include <algorithm>
#include <numeric>

namespace tissue_contact {
namespace {

/// Nodes that elements join, as a forest: each points to another of its part or, the first, to itself.
class JoinedNodes {
 public:
  explicit JoinedNodes(std::size_t nodes) : towards_(nodes) { std::iota(towards_.begin(), towards_.end(), 0); }

  int first(int node) {
    int& towards = towards_[static_cast<std::size_t>(node)];
    while (towards != towards_[static_cast<std::size_t>(towards)])
      towards = towards_[static_cast<std::size_t>(towards)];
    return towards;
  }
  void join(int a, int b) {
    const int one = first(a), other = first(b);
    towards_[static_cast<std::size_t>(std::max(one, other))] = std::min(one, other);
  }

 private:
  std::vector<int> towards_;
};

}  // namespace

std::vector<std::vector<int>> findStiffParts(const std::vector<Tetrahedron>& tetrahedra, const ElementMaterials& materials,
                                         Eigen::Index nodes) {
  const auto shearModulus = [](const MaterialDescription& material) { return lameParameters(material).mu; };
  const double stiff = kStiffRatio * shearModulus(materials.materials.front());
  std::vector<bool> is_stiff;
  for (const MaterialDescription& material : materials.materials) is_stiff.push_back(shearModulus(material) >= stiff);
  std::vector<std::vector<int>> parts;
  if (tetrahedra.empty() || std::find(is_stiff.begin(), is_stiff.end(), true) == is_stiff.end()) return parts;
  JoinedNodes joined(static_cast<std::size_t>(nodes));
  std::vector<bool> is_member(static_cast<std::size_t>(nodes), false);
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    if (!is_stiff[materials.index(e)]) continue;
    for (const int node : tetrahedra[e]) {
      joined.join(tetrahedra[e][0], node);
      is_member[static_cast<std::size_t>(node)] = true;
    }
  }
  std::vector<int> part_of(static_cast<std::size_t>(nodes), -1);  // by its first node
  for (int node = 0; node < nodes; ++node) {
    if (!is_member[static_cast<std::size_t>(node)]) continue;
    int& part = part_of[static_cast<std::size_t>(joined.first(node))];
    if (part < 0) {
      part = static_cast<int>(parts.size());
      parts.emplace_back();
    }
    parts[static_cast<std::size_t>(part)].push_back(node);
  }
  return parts;
}

}  // namespace tissue_contact
