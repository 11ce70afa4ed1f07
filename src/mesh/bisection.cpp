#include "mesh/bisection.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "mesh/face_table.h"

namespace tissue_contact {
namespace {

/// Tetrahedra of a patch of parts: two cuts make four. (Of eight, contact is too soft: doc/notes/method.md.)
constexpr int kLargestPatch = 4;
/// Fewer, stiff on their own, join a patch beside them, but for what is left where one of an unrefined patch's few is cut.
constexpr int kSmallestPatch = 3;

bool contains(const Tetrahedron& tetrahedron, int node) {
  return std::find(tetrahedron.begin(), tetrahedron.end(), node) != tetrahedron.end();
}

Tetrahedron replaced(Tetrahedron nodes, int node, int by) {
  std::replace(nodes.begin(), nodes.end(), node, by);
  return nodes;
}

/// Of one half of a tetrahedron: the new face between the halves lies opposite to the end of the cut edge that the half keeps.
std::array<int, 4> outerOfHalf(const Tetrahedron& whole, const std::array<int, 4>& outer, int kept) {
  std::array<int, 4> half = outer;
  half[static_cast<std::size_t>(std::find(whole.begin(), whole.end(), kept) - whole.begin())] = -1;
  return half;
}

NodalVectors columns(const std::vector<int>& indices, const std::vector<Vector3>& of) {
  NodalVectors result(3, static_cast<Eigen::Index>(indices.size()));
  for (std::size_t i = 0; i < indices.size(); ++i) result.col(static_cast<Eigen::Index>(i)) = of[indices[i]];
  return result;
}

}  // namespace

Bisection::Bisection(const TetMesh& base, const std::vector<int>& patch_of)
    : base_nodes_(static_cast<std::size_t>(base.positions.cols())), base_patch_of_(patch_of) {
  for (Eigen::Index i = 0; i < base.positions.cols(); ++i) x_.emplace_back(base.positions.col(i));
  uncut_at_.resize(base_nodes_);
  for (std::size_t e = 0; e < base.tetrahedra.size(); ++e) {
    add(base.tetrahedra[e], static_cast<int>(e), {-1, -1, -1, -1});
    element_places_.push_back(centroid(elements_.back()));
  }
  for (const OuterFace& face : outerFaces(base.tetrahedra)) {
    elements_[face.tetrahedron].outer[face.opposite] = static_cast<int>(triangle_places_.size());
    triangle_places_.push_back(faceCentroid(elements_[face.tetrahedron], face.opposite));
  }
  base_triangles_ = triangle_places_.size();
  base_patches_.resize(patch_of.empty() ? 0 : 1 + *std::max_element(patch_of.begin(), patch_of.end()));
  for (std::size_t e = 0; e < patch_of.size(); ++e) base_patches_[patch_of[e]].push_back(static_cast<int>(e));
  lasting_nodes_ = base_nodes_;
  lasting_elements_ = patch_of.size();
}

/// Back to the unrefined mesh with its lasting cuts.
void Bisection::start() {
  x_.resize(lasting_nodes_);
  parents_.resize(lasting_nodes_ - base_nodes_);
  for (std::vector<int>& elements : uncut_at_) elements.clear();
  elements_.resize(lasting_elements_);
  for (std::size_t e = 0; e < lasting_elements_; ++e) {
    int& child = elements_[e].first_child;
    if (child >= static_cast<int>(lasting_elements_)) child = -1;
    if (child >= 0) continue;
    for (const int node : elements_[e].nodes) uncut_at_[node].push_back(static_cast<int>(e));
  }
}

/// Of edges of one length: by where their middles are, and by their nodes where coordinates cannot tell.
bool Bisection::comesBefore(const std::array<int, 2>& a, const std::array<int, 2>& b) const {
  const Vector3 p = x_[a[0]] + x_[a[1]];
  const Vector3 q = x_[b[0]] + x_[b[1]];
  return std::make_tuple(p.x(), p.y(), p.z(), std::minmax(a[0], a[1])) <
         std::make_tuple(q.x(), q.y(), q.z(), std::minmax(b[0], b[1]));
}

/// By a total order, so that neighbours agree.
void Bisection::findLongest(Element& element) const {
  element.squared_m2 = -1.0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const std::array<int, 2> edge = {element.nodes[i], element.nodes[j]};
      const double squared_m2 = (x_[edge[0]] - x_[edge[1]]).squaredNorm();
      if (squared_m2 < element.squared_m2) continue;
      if (squared_m2 == element.squared_m2 && !comesBefore(element.longest, edge)) continue;
      element.longest = edge;
      element.squared_m2 = squared_m2;
    }
  }
  if (element.longest[0] > element.longest[1]) std::swap(element.longest[0], element.longest[1]);
}

int Bisection::add(const Tetrahedron& nodes, int place, const std::array<int, 4>& outer) {
  Element element;
  element.nodes = nodes;
  element.place = place;
  element.outer = outer;
  findLongest(element);
  const int index = static_cast<int>(elements_.size());
  for (const int node : nodes) uncut_at_[node].push_back(index);
  elements_.push_back(element);
  return index;
}

Vector3 Bisection::centroid(const Element& element) const {
  return 0.25 * (x_[element.nodes[0]] + x_[element.nodes[1]] + x_[element.nodes[2]] + x_[element.nodes[3]]);
}

Vector3 Bisection::faceCentroid(const Element& element, std::size_t opposite) const {
  const Triangle nodes = outwardFace(element.nodes, opposite);
  return (x_[nodes[0]] + x_[nodes[1]] + x_[nodes[2]]) / 3.0;
}

std::array<Vector3, 4> Bisection::corners(const Element& element) const {
  return {x_[element.nodes[0]], x_[element.nodes[1]], x_[element.nodes[2]], x_[element.nodes[3]]};
}

template <typename LimitOf>
bool Bisection::cutBeyond(const LimitOf& limit_of, std::size_t most_nodes) {
  constexpr double kRounding = 1.0 + 1e-9;              // edges of one length differ by rounding
  for (std::size_t e = 0; e < elements_.size(); ++e) {  // children come at the end
    if (elements_[e].first_child >= 0) continue;
    const double most_m = limit_of(elements_[e]);
    if (!(elements_[e].squared_m2 > kRounding * most_m * most_m)) continue;
    if (!cut(static_cast<int>(e), most_nodes)) return false;
  }
  return true;
}

bool Bisection::refineLasting(const PartLimit& limit, std::size_t most_nodes) {
  lasting_nodes_ = base_nodes_;
  lasting_elements_ = base_patch_of_.size();
  element_places_.resize(lasting_elements_);
  triangle_places_.resize(base_triangles_);
  whole_elements_.clear();
  whole_triangles_.clear();
  start();
  const auto limit_of = [&](const Element& element) {
    const bool at_surface = std::any_of(element.outer.begin(), element.outer.end(), [](int face) { return face >= 0; });
    return limit({corners(element), at_surface, static_cast<std::size_t>(element.place)});  // until nameParts()
  };
  if (!cutBeyond(limit_of, most_nodes)) return false;
  lasting_nodes_ = x_.size();
  lasting_elements_ = elements_.size();
  nameParts();
  return true;
}

/// What lasting cuts have made, and is not cut itself, gets places of its own.
void Bisection::nameParts() {
  for (std::size_t e = base_patch_of_.size(); e < lasting_elements_; ++e) {
    Element& element = elements_[e];
    if (element.first_child >= 0) continue;
    whole_elements_.push_back(std::exchange(element.place, static_cast<int>(element_places_.size())));
    element_places_.push_back(centroid(element));
    for (std::size_t i = 0; i < element.outer.size(); ++i) {
      if (element.outer[i] < 0) continue;
      whole_triangles_.push_back(std::exchange(element.outer[i], static_cast<int>(triangle_places_.size())));
      triangle_places_.push_back(faceCentroid(element, i));
    }
  }
}

std::vector<LastingPart> Bisection::lastingParts() const {
  std::vector<LastingPart> parts;
  const auto add = [&](const std::vector<int>& whole_of, const std::vector<Vector3>& places) {
    const std::size_t first = places.size() - whole_of.size();
    for (std::size_t i = 0; i < whole_of.size(); ++i) parts.push_back({places[first + i], places[whole_of[i]]});
  };
  add(whole_elements_, element_places_);
  add(whole_triangles_, triangle_places_);
  return parts;
}

bool Bisection::refine(const EdgeLimit& limit, std::size_t most_nodes, BisectedMesh& result) {
  start();
  if (!cutBeyond([&](const Element& element) { return limit(centroid(element)); }, most_nodes)) return false;
  write(result);
  result.lasting = static_cast<int>(lasting_nodes_ - base_nodes_);
  return true;
}

/// Cuts an element, and before it those around its longest edge that have a longer one. Edges grow along that path, so that it
/// ends.
bool Bisection::cut(int element, std::size_t most_nodes) {
  waiting_.assign(1, element);
  while (!waiting_.empty()) {
    const Element& next = elements_[waiting_.back()];
    if (next.first_child >= 0) {
      waiting_.pop_back();
      continue;
    }
    const std::array<int, 2> edge = next.longest;
    const int longer = firstWithLonger(edge);
    if (longer >= 0) {
      waiting_.push_back(longer);
      continue;
    }
    if (x_.size() >= most_nodes) return false;
    cutRing(edge);
  }
  return true;
}

/// Collects the elements around an edge. @return one of them whose longest edge is another; -1: none.
int Bisection::firstWithLonger(const std::array<int, 2>& edge) {
  ring_.clear();
  // One node of a star has all of its elements, the other a few. Both name those of the edge in the same order.
  const bool first_has_fewer = uncut_at_[edge[0]].size() <= uncut_at_[edge[1]].size();
  const int other_end = edge[first_has_fewer ? 1 : 0];
  for (const int other : uncut_at_[edge[first_has_fewer ? 0 : 1]]) {
    if (!contains(elements_[other].nodes, other_end)) continue;
    if (elements_[other].longest != edge) return other;
    ring_.push_back(other);
  }
  return -1;
}

void Bisection::cutRing(const std::array<int, 2>& edge) {
  const int middle = static_cast<int>(x_.size());
  x_.emplace_back(0.5 * (x_[edge[0]] + x_[edge[1]]));
  parents_.push_back(edge);
  if (uncut_at_.size() < x_.size()) uncut_at_.emplace_back();
  for (const int whole : ring_) {
    const Tetrahedron nodes = elements_[whole].nodes;
    const std::array<int, 4> outer = elements_[whole].outer;
    const int place = elements_[whole].place;
    for (const int node : nodes) {
      std::vector<int>& there = uncut_at_[node];
      there.erase(std::lower_bound(there.begin(), there.end(), whole));
    }
    const int first_child = add(replaced(nodes, edge[1], middle), place, outerOfHalf(nodes, outer, edge[0]));
    elements_[whole].first_child = first_child;
    add(replaced(nodes, edge[0], middle), place, outerOfHalf(nodes, outer, edge[1]));
  }
}

void Bisection::countLeaves() {
  for (std::size_t e = elements_.size(); e-- > 0;) {  // children come after their parents
    const int child = elements_[e].first_child;
    elements_[e].leaves = child < 0 ? 1 : elements_[child].leaves + elements_[child + 1].leaves;
  }
}

void Bisection::write(BisectedMesh& result) {
  countLeaves();
  result.mesh.positions.resize(3, static_cast<Eigen::Index>(x_.size()));
  for (std::size_t i = 0; i < x_.size(); ++i) result.mesh.positions.col(static_cast<Eigen::Index>(i)) = x_[i];
  result.mesh.tetrahedra.clear();
  result.surface.clear();
  result.parents = parents_;
  result.patch_of.clear();
  element_place_of_.clear();
  triangle_place_of_.clear();
  patches_ = 0;
  for (const std::vector<int>& patch : base_patches_) {
    int uncut = -1;
    for (const int element : patch) {
      if (elements_[element].first_child >= 0) {
        writePatches(element, result);
      } else {
        if (uncut < 0) uncut = patches_++;
        writeLeaves(element, uncut, result);
      }
    }
  }
  result.element_places = columns(element_place_of_, element_places_);
  result.surface_places = columns(triangle_place_of_, triangle_places_);
}

/// The parts of a cut element, in patches of parts that were one.
void Bisection::writePatches(int root, BisectedMesh& result) {
  const int child = elements_[root].first_child;
  if (elements_[root].leaves <= kLargestPatch) {
    writeLeaves(root, patches_++, result);
    return;
  }
  const bool first_is_small = elements_[child].leaves < kSmallestPatch;
  const int last = first_is_small ? child : child + 1;
  const int before = first_is_small ? child + 1 : child;
  writePatches(before, result);
  if (elements_[last].leaves < kSmallestPatch) {
    joinSmall(last, before, result);
  } else {
    writePatches(last, result);
  }
}

/// All parts of an element as one patch.
void Bisection::writeLeaves(int element, int patch, BisectedMesh& result) {
  const int child = elements_[element].first_child;
  if (child < 0) {
    const Tetrahedron& nodes = elements_[element].nodes;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const int triangle = elements_[element].outer[i];
      if (triangle < 0) continue;
      result.surface.push_back(outwardFace(nodes, i));
      triangle_place_of_.push_back(triangle);
    }
    element_place_of_.push_back(elements_[element].place);
    result.mesh.tetrahedra.push_back(nodes);
    result.patch_of.push_back(patch);
    return;
  }
  writeLeaves(child, patch, result);
  writeLeaves(child + 1, patch, result);
}

/// Adds the few parts of an element to a patch, of those just written of `other`, that shares a face with one of them.
void Bisection::joinSmall(int small, int other, BisectedMesh& result) {
  const std::size_t end = result.mesh.tetrahedra.size();
  const std::size_t begin = end - static_cast<std::size_t>(elements_[other].leaves);
  writeLeaves(small, -1, result);
  int patch = result.patch_of[begin];
  for (std::size_t s = end; s < result.mesh.tetrahedra.size(); ++s) {
    for (std::size_t e = begin; e < end; ++e) {
      const Tetrahedron& nodes = result.mesh.tetrahedra[e];
      const auto shared = std::count_if(nodes.begin(), nodes.end(),
                                        [&](int node) { return contains(result.mesh.tetrahedra[s], node); });
      if (shared == 3) patch = result.patch_of[e];
    }
  }
  std::replace(result.patch_of.begin() + static_cast<std::ptrdiff_t>(end), result.patch_of.end(), -1, patch);
}

}  // namespace tissue_contact
