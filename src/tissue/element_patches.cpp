#include "tissue/element_patches.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "mesh/face_table.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kPatchSize = 5;

/// Up to four neighbours of each tetrahedron, -1 at the boundary.
std::vector<std::array<int, 4>> neighboursThroughFaces(const std::vector<Tetrahedron>& tetrahedra) {
  const std::vector<FaceUse> faces = sortedFaces(tetrahedra);
  std::vector<std::array<int, 4>> neighbours(tetrahedra.size(), {-1, -1, -1, -1});
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    const FaceUse& a = faces[i];
    const FaceUse& b = faces[i + 1];
    if (a.nodes != b.nodes) continue;
    neighbours[a.tetrahedron][a.opposite] = static_cast<int>(b.tetrahedron);
    neighbours[b.tetrahedron][b.opposite] = static_cast<int>(a.tetrahedron);
  }
  return neighbours;
}

/// The tetrahedron outside all patches that shares most faces with `patch`, of those the first; -1: none.
int nextFor(const std::vector<int>& patch, const std::vector<std::array<int, 4>>& neighbours,
            const std::vector<int>& patch_of) {
  int best = -1;
  std::ptrdiff_t most = 0;
  for (const int member : patch) {
    for (const int candidate : neighbours[member]) {
      if (candidate < 0 || patch_of[candidate] >= 0) continue;
      const auto shared = std::count_if(neighbours[candidate].begin(), neighbours[candidate].end(), [&](int other) {
        return std::find(patch.begin(), patch.end(), other) != patch.end();
      });
      if (shared > most || (shared == most && candidate < best)) {
        most = shared;
        best = candidate;
      }
    }
  }
  return best;
}

/// Corners of a tetrahedron in ascending order of x, y, z: exact, so that no rounding decides an order.
std::array<std::array<double, 3>, 4> placeOf(const NodalVectors& rest, const Tetrahedron& tetrahedron) {
  std::array<std::array<double, 3>, 4> corners;
  for (int i = 0; i < 4; ++i) {
    const Vector3 p = rest.col(tetrahedron[i]);
    corners[i] = {p.x(), p.y(), p.z()};
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Indices of the tetrahedra in the order of their places.
std::vector<int> orderByPlace(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra) {
  std::vector<std::pair<std::array<std::array<double, 3>, 4>, int>> places;
  places.reserve(tetrahedra.size());
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    places.emplace_back(placeOf(rest, tetrahedra[e]), static_cast<int>(e));
  }
  std::sort(places.begin(), places.end());
  std::vector<int> order;
  order.reserve(places.size());
  for (const auto& place : places) order.push_back(place.second);
  return order;
}

/// Patches of tetrahedra in the order in which they are to be grown.
std::vector<int> growPatches(const std::vector<Tetrahedron>& tetrahedra) {
  const std::vector<std::array<int, 4>> neighbours = neighboursThroughFaces(tetrahedra);
  std::vector<int> patch_of(tetrahedra.size(), -1);
  int patches = 0;
  for (std::size_t first = 0; first < tetrahedra.size(); ++first) {
    if (patch_of[first] >= 0) continue;
    std::vector<int> patch;
    for (int next = static_cast<int>(first); next >= 0 && patch.size() < kPatchSize;) {
      patch_of[next] = patches;
      patch.push_back(next);
      next = nextFor(patch, neighbours, patch_of);
    }
    // What is left between others would be stiff on its own: it joins a neighbour.
    int joined = -1;
    for (const int other : neighbours[first]) {
      if (other >= 0 && patch_of[other] != patches && (joined < 0 || other < joined)) joined = other;
    }
    if (2 * patch.size() < kPatchSize && joined >= 0) {
      for (const int member : patch) patch_of[member] = patch_of[joined];
    } else {
      ++patches;
    }
  }
  return patch_of;
}

}  // namespace

std::vector<int> patchesByFaces(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra) {
  const std::vector<int> order = orderByPlace(rest, tetrahedra);
  std::vector<Tetrahedron> sorted;
  sorted.reserve(order.size());
  for (const int e : order) sorted.push_back(tetrahedra[e]);
  const std::vector<int> patch_of_sorted = growPatches(sorted);
  std::vector<int> patch_of(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) patch_of[order[k]] = patch_of_sorted[k];
  return patch_of;
}

std::vector<int> cutAtMaterials(const std::vector<int>& patch_of, const std::vector<int>& materials) {
  if (materials.empty()) return patch_of;
  std::map<std::pair<int, int>, int> numbers;
  std::vector<int> cut;
  cut.reserve(patch_of.size());
  for (std::size_t e = 0; e < patch_of.size(); ++e) {
    cut.push_back(
        numbers.emplace(std::pair(patch_of[e], materials[e]), static_cast<int>(numbers.size())).first->second);
  }
  return cut;
}

std::vector<int> patchesByCells(std::size_t tetrahedra, int cell_size) {
  std::vector<int> patch_of(tetrahedra);
  for (std::size_t e = 0; e < tetrahedra; ++e) patch_of[e] = static_cast<int>(e) / cell_size;
  return patch_of;
}

}  // namespace tissue_contact
