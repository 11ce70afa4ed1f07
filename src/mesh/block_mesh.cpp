/// @file
/// Room `mesh`: makeBlockMesh: sizes, cells and grading in, structured tetrahedral mesh of a block out.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tissue_contact/core/check.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

constexpr std::array<char, 3> kAxisNames = {'x', 'y', 'z'};

// Longest over shortest cell edge of an axis. Beyond it the smallest cells are slivers whose stiffness drowns the others in
// round-off.
constexpr double kMostEdgeRatio = 1e4;

std::string axisKey(const char* key, std::size_t axis) {
  return std::string("block ") + key + " along " + kAxisNames[axis];
}

/// How many cells lie between cell i and the finest one: the exponent of its growth.
int stepsFromFinest(AxisGrading::FineAt fine_at, int i, int cells) {
  if (fine_at == AxisGrading::FineAt::kMinimum) return i;
  if (fine_at == AxisGrading::FineAt::kMaximum) return cells - 1 - i;
  return std::abs(2 * i + 1 - cells) / 2;  // one finest cell if their number is odd, two if it is even
}

void checkCells(const std::array<int, 3>& cells) {
  std::int64_t total = kTetrahedraPerCell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (cells[axis] < 1) throwBadValue(axisKey("cells", axis), cells[axis], "", "at least 1");
    total *= cells[axis];  // at most 2e6 times 2^31: no overflow
    if (total > static_cast<std::int64_t>(kMostElements)) {
      throw std::invalid_argument("block cells make at least " + std::to_string(total) +
                                  " tetrahedra (5 per cell); at most " + std::to_string(kMostElements) +
                                  " are allowed; use fewer cells or grading");
    }
  }
}

void checkGrowth(int cells, const AxisGrading& grading, std::size_t axis) {
  if (!(grading.growth >= 1.0) || !std::isfinite(grading.growth)) {
    throwBadValue(axisKey("growth", axis), grading.growth, "", "finite and >= 1 (1 = even spacing)");
  }
  const int most =
      std::max(stepsFromFinest(grading.fine_at, 0, cells), stepsFromFinest(grading.fine_at, cells - 1, cells));
  const double ratio = std::pow(grading.growth, most);
  if (!(ratio <= kMostEdgeRatio)) {
    throwBadValue(axisKey("growth", axis), grading.growth, "",
                  "such that the largest of the " + std::to_string(cells) + " cells is at most 10000, not " +
                      std::to_string(ratio) + ", times as long as the smallest; lower growth or cells");
  }
}

/// Coordinates of the nodes along one axis, from `low` to `low + size`. Even and centred spacings are mirror images of
/// themselves to the last bit, so that a symmetric block answers symmetrically.
std::vector<double> axisCoordinates(double low, double size, int cells, const AxisGrading& grading) {
  const auto count = static_cast<std::size_t>(cells);
  std::vector<double> sum(count + 1, 0.0);  // of cell lengths, the finest cell being 1
  for (std::size_t i = 0; i < count; ++i) {
    sum[i + 1] = sum[i] + std::pow(grading.growth, stepsFromFinest(grading.fine_at, static_cast<int>(i), cells));
  }
  const double high = low + size;
  std::vector<double> x(count + 1);
  // The last quotient is exactly 1, hence the last node exactly on the face.
  for (std::size_t i = 0; i <= count; ++i) x[i] = low + size * (sum[i] / sum[count]);
  const bool symmetric = grading.growth == 1.0 || grading.fine_at == AxisGrading::FineAt::kCenter;
  for (std::size_t i = 0; symmetric && i <= count / 2; ++i) {
    x[count - i] = 2 * i == count ? 0.5 * (low + high) : (low + high) - x[i];
  }
  return x;
}

/// The eight corners of a cell are numbered dx + 2 dy + 4 dz. First tetrahedron: the one in the middle, on four corners
/// of which no two share an edge of the cell; the other four cut off the remaining corners.
constexpr std::array<std::array<int, 4>, 5> kEvenCell = {
    {{0, 5, 3, 6}, {1, 3, 0, 5}, {2, 0, 3, 6}, {4, 6, 5, 0}, {7, 5, 6, 3}}};
constexpr std::array<std::array<int, 4>, 5> kOddCell = {
    {{1, 2, 4, 7}, {0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}}};

/// Each along the edges from corner 0 to corner 7, the diagonal of the cell that all six share (Kuhn).
constexpr std::array<std::array<int, 4>, 6> kSixths = {
    {{0, 1, 3, 7}, {0, 5, 1, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 6, 4, 7}}};

/// @param mirror bits by which corners are mirrored: 1 along x, 2 along y, 4 along z.
template <std::size_t N>
void appendCell(const std::array<std::array<int, 4>, N>& split, int mirror, const std::array<int, 3>& cell,
                const std::array<int, 3>& cells, std::vector<Tetrahedron>& tetrahedra) {
  const int row = cells[0] + 1;
  const int layer = row * (cells[1] + 1);
  const int corner = cell[0] + row * cell[1] + layer * cell[2];
  const bool turns_over = mirror == 1 || mirror == 2 || mirror == 4 || mirror == 7;
  for (const std::array<int, 4>& tet : split) {
    Tetrahedron nodes{};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const int at = tet[i] ^ mirror;
      nodes[i] = corner + (at & 1) + row * ((at >> 1) & 1) + layer * (at >> 2);
    }
    if (turns_over) std::swap(nodes[2], nodes[3]);
    tetrahedra.push_back(nodes);
  }
}

void appendCell(BlockSplit split, const std::array<int, 3>& cell, const std::array<int, 3>& cells,
                std::vector<Tetrahedron>& tetrahedra) {
  if (split == BlockSplit::kSix) {
    const int mirror = cell[0] % 2 + 2 * (cell[1] % 2) + 4 * (cell[2] % 2);
    appendCell(kSixths, mirror, cell, cells, tetrahedra);
  } else {
    const bool even = (cell[0] + cell[1] + cell[2]) % 2 == 0;
    appendCell(even ? kEvenCell : kOddCell, 0, cell, cells, tetrahedra);
  }
}

}  // namespace

void checkBlock(const BlockDescription& block) {
  atEntry("cells", [&] { checkCells(block.cells); });
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double size = block.size_m[static_cast<Eigen::Index>(axis)];
    atEntry("size_m", [&] { requirePositive(axisKey("size", axis), size, "m"); });
    atEntry(std::string("grading.") + kAxisNames[axis] + ".growth",
            [&] { checkGrowth(block.cells[axis], block.grading[axis], axis); });
  }
}

TetMesh makeBlockMesh(const BlockDescription& block, BlockSplit split) {
  checkBlock(block);
  std::array<std::vector<double>, 3> axes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double size = block.size_m[static_cast<Eigen::Index>(axis)];
    axes[axis] = axisCoordinates(axis == 2 ? 0.0 : -0.5 * size, size, block.cells[axis], block.grading[axis]);
  }
  TetMesh mesh;
  mesh.positions.resize(3, static_cast<Eigen::Index>(axes[0].size() * axes[1].size() * axes[2].size()));
  Eigen::Index node = 0;
  for (const double z : axes[2]) {
    for (const double y : axes[1]) {
      for (const double x : axes[0]) mesh.positions.col(node++) = Vector3(x, y, z);
    }
  }
  mesh.tetrahedra.reserve(static_cast<std::size_t>(split) * block.cells[0] * block.cells[1] * block.cells[2]);
  for (int k = 0; k < block.cells[2]; ++k) {
    for (int j = 0; j < block.cells[1]; ++j) {
      for (int i = 0; i < block.cells[0]; ++i) appendCell(split, {i, j, k}, block.cells, mesh.tetrahedra);
    }
  }
  return mesh;
}

}  // namespace tissue_contact
