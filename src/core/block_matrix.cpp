#include "tissue_contact/core/block_matrix.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <queue>
#include <utility>

namespace tissue_contact {
namespace {

using Neighbours = std::vector<std::vector<int>>;  // ascending

/// Length of the longest chain of ever later neighbours that begins at each node: those that hold up most come first.
std::vector<int> chainsAfter(const Neighbours& neighbours) {
  std::vector<int> length(neighbours.size(), 0);
  for (std::size_t i = neighbours.size(); i-- > 0;) {
    for (const int j : neighbours[i]) {
      if (j > static_cast<int>(i)) length[i] = std::max(length[i], length[j] + 1);
    }
  }
  return length;
}

/// Nodes whose earlier neighbours all lie in slices that are finished, in the order in which they are to be taken: the
/// longest chain first, and of equal ones those with equally many blocks together, for a slice is as long as its
/// longest row.
class ReadyNodes {
 public:
  explicit ReadyNodes(const Neighbours& neighbours) : neighbours_(neighbours), chain_(chainsAfter(neighbours)) {
    for (std::size_t i = 0; i < neighbours.size(); ++i) {
      const auto beyond = std::lower_bound(neighbours[i].begin(), neighbours[i].end(), static_cast<int>(i));
      waits_for_.push_back(static_cast<int>(beyond - neighbours[i].begin()));
      blocks_.push_back(static_cast<int>(neighbours[i].end() - beyond));
      if (waits_for_.back() == 0) put(static_cast<int>(i));
    }
  }

  /// The next slice, ascending; empty at the end.
  std::vector<int> take() {
    std::vector<int> slice;
    for (; !ready_.empty() && slice.size() < BlockPattern::kRows; ready_.pop()) slice.push_back(-ready_.top()[2]);
    std::sort(slice.begin(), slice.end());
    for (const int i : slice) {
      for (const int j : neighbours_[i]) {
        if (j > i && --waits_for_[j] == 0) put(j);
      }
    }
    return slice;
  }

 private:
  void put(int node) { ready_.push({chain_[node], blocks_[node], -node}); }

  const Neighbours& neighbours_;
  std::vector<int> chain_;
  std::vector<int> waits_for_;
  std::vector<int> blocks_;
  std::priority_queue<std::array<int, 3>> ready_;
};

/// Gives each of the pattern's rows its columns beyond it, entry by entry.
void addEntries(const Neighbours& neighbours, const std::vector<int>& slice, BlockPattern& pattern) {
  std::array<int, BlockPattern::kRows> rows{};
  rows.fill(slice.front());
  std::copy(slice.begin(), slice.end(), rows.begin());
  pattern.rows.insert(pattern.rows.end(), rows.begin(), rows.end());
  const int entry = pattern.first.back();
  int entries = entry;
  for (std::size_t lane = 0; lane < slice.size(); ++lane) {
    pattern.lane_of[slice[lane]] = static_cast<int>(pattern.rows.size() - BlockPattern::kRows + lane);
    int next = entry;
    for (const int column : neighbours[slice[lane]]) {
      if (column < slice[lane]) continue;
      if (next == entries) {
        for (const int row : rows) pattern.columns.push_back(3 * row);
        ++entries;
      }
      pattern.columns[static_cast<std::size_t>(next++) * BlockPattern::kRows + lane] = 3 * column;
    }
  }
  pattern.first.push_back(entries);
}

/// Places of the blocks below the diagonal, with the slices made.
void findLower(const Neighbours& neighbours, BlockPattern& pattern) {
  std::vector<int> next(neighbours.size(), 0);  // per node: its blocks beyond the diagonal that have been seen
  std::size_t blocks = 0;
  for (const std::vector<int>& row : neighbours) blocks += row.size();
  pattern.lower.reserve(blocks / 2);
  pattern.lower_first.reserve(neighbours.size() + 1);
  pattern.lower_first.push_back(0);
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    for (const int column : neighbours[i]) {
      if (column > static_cast<int>(i)) break;
      const int slice = pattern.lane_of[column] / BlockPattern::kRows;
      const int lane = pattern.lane_of[column] % BlockPattern::kRows;
      const int entry = pattern.first[slice] + next[column]++;
      pattern.lower.push_back({column, BlockPattern::placeOf(entry, lane, true)});
    }
    pattern.lower_first.push_back(static_cast<int>(pattern.lower.size()));
  }
}

}  // namespace

std::shared_ptr<const BlockPattern> BlockPattern::fromNeighbours(std::vector<std::vector<int>>& neighbours) {
  for (std::vector<int>& row : neighbours) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
  }
  const auto pattern = std::make_shared<BlockPattern>();
  pattern->nodes = static_cast<int>(neighbours.size());
  pattern->lane_of.resize(neighbours.size());
  pattern->first = {0};
  ReadyNodes ready(neighbours);
  for (std::vector<int> slice = ready.take(); !slice.empty(); slice = ready.take()) {
    addEntries(neighbours, slice, *pattern);
  }
  findLower(neighbours, *pattern);
  pattern->columns.shrink_to_fit();
  pattern->rows.shrink_to_fit();
  pattern->first.shrink_to_fit();
  return pattern;
}

int BlockPattern::find(int row, int column) const {
  const int low = std::min(row, column);
  const int high = std::max(row, column);
  const int slice = lane_of[low] / kRows;
  const int lane = lane_of[low] % kRows;
  for (int k = first[slice]; low != high && k < first[slice + 1]; ++k) {
    if (columns[kRows * k + lane] == 3 * high) return placeOf(k, lane, row > column);
  }
  return -1;
}

BlockMatrix::BlockMatrix(std::shared_ptr<const BlockPattern> of)
    : pattern(std::move(of)), diagonal(pattern->nodes, Matrix3::Zero()), values(pattern->entries(), BlockLanes{}) {}

void BlockMatrix::setZero() {
  std::fill(diagonal.begin(), diagonal.end(), Matrix3::Zero());
  std::fill(values.begin(), values.end(), BlockLanes{});
}

void BlockMatrix::copyBlocks(const BlockMatrix& from) {
  assert(from.values.size() == values.size());
  std::copy(from.diagonal.begin(), from.diagonal.end(), diagonal.begin());
  std::copy(from.values.begin(), from.values.end(), values.begin());
}

void BlockMatrix::setSum(double a_scale, const BlockMatrix& a, double b_scale, const BlockMatrix& b) {
  assert(a.values.size() == values.size() && b.values.size() == values.size());
  for (std::size_t i = 0; i < diagonal.size(); ++i) diagonal[i] = a_scale * a.diagonal[i] + b_scale * b.diagonal[i];
  for (std::size_t k = 0; k < values.size(); ++k) {
    for (std::size_t m = 0; m < 9; ++m) {
      for (std::size_t lane = 0; lane < BlockPattern::kRows; ++lane) {
        values[k].at[m][lane] = a_scale * a.values[k].at[m][lane] + b_scale * b.values[k].at[m][lane];
      }
    }
  }
}

Vector3 BlockMatrix::offDiagonalProduct(int i, const NodalVectors& v) const {
  Vector3 sum = Vector3::Zero();
  pattern->forRow(i, [&](int j, int place) { sum += block(place) * v.col(j); });
  return sum;
}

}  // namespace tissue_contact
