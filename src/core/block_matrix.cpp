#include "tissue_contact/core/block_matrix.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <queue>
#include <utility>

namespace tissue_contact {
namespace {

/// Of each node the others that share an element with it, ascending.
class Neighbours {
 public:
  struct Row {
    const int* first;
    const int* last;
    const int* begin() const { return first; }
    const int* end() const { return last; }
  };

  /// Elements as in BlockPattern::fromElements().
  Neighbours(const std::vector<int>& first, const std::vector<int>& nodes, std::size_t node_count);

  std::size_t size() const { return first_.size() - 1; }
  std::size_t pairs() const { return nodes_.size(); }
  Row operator[](std::size_t i) const { return {nodes_.data() + first_[i], nodes_.data() + first_[i + 1]}; }

 private:
  std::vector<int> first_;
  std::vector<int> nodes_;
};

/// Offsets of rows of these lengths, and the end.
std::vector<int> offsets(const std::vector<int>& lengths) {
  std::vector<int> first(lengths.size() + 1, 0);
  std::partial_sum(lengths.begin(), lengths.end(), first.begin() + 1);
  return first;
}

Neighbours::Neighbours(const std::vector<int>& first, const std::vector<int>& nodes, std::size_t node_count) {
  std::vector<int> lengths(node_count, 0);
  for (const int node : nodes) ++lengths[node];
  const std::vector<int> first_use = offsets(lengths);
  std::vector<int> elements(nodes.size());  // of each node
  std::vector<int> next(first_use.begin(), first_use.end() - 1);
  for (std::size_t e = 0; e + 1 < first.size(); ++e) {
    for (int k = first[e]; k < first[e + 1]; ++k) elements[next[nodes[k]]++] = static_cast<int>(e);
  }
  std::vector<int> found;  // the rows, each in the order of its elements
  std::vector<int> seen_by(node_count, -1);
  for (std::size_t i = 0; i < node_count; ++i) {
    const std::size_t before = found.size();
    seen_by[i] = static_cast<int>(i);
    for (int use = first_use[i]; use < first_use[i + 1]; ++use) {
      for (int k = first[elements[use]]; k < first[elements[use] + 1]; ++k) {
        if (std::exchange(seen_by[nodes[k]], static_cast<int>(i)) != static_cast<int>(i)) found.push_back(nodes[k]);
      }
    }
    lengths[i] = static_cast<int>(found.size() - before);
  }
  // Being neighbours is mutual: handing each row out to its members fills theirs in ascending order.
  first_ = offsets(lengths);
  nodes_.resize(found.size());
  next.assign(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < node_count; ++i) {
    for (int k = first_[i]; k < first_[i + 1]; ++k) nodes_[next[found[k]]++] = static_cast<int>(i);
  }
}

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
      const auto row = neighbours[i];
      const int* const beyond = std::lower_bound(row.begin(), row.end(), static_cast<int>(i));
      waits_for_.push_back(static_cast<int>(beyond - row.begin()));
      blocks_.push_back(static_cast<int>(row.end() - beyond));
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
        pattern.columns.insert(pattern.columns.end(), rows.begin(), rows.end());
        ++entries;
      }
      pattern.columns[static_cast<std::size_t>(next++) * BlockPattern::kRows + lane] = column;
    }
  }
  pattern.first.push_back(entries);
}

/// Places of the blocks below the diagonal, with the slices made.
void findLower(const Neighbours& neighbours, BlockPattern& pattern) {
  std::vector<int> next(neighbours.size(), 0);  // per node: its blocks beyond the diagonal that have been seen
  pattern.lower.reserve(neighbours.pairs() / 2);
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

std::shared_ptr<const BlockPattern> BlockPattern::fromElements(const std::vector<int>& first,
                                                               const std::vector<int>& nodes, std::size_t node_count) {
  const Neighbours neighbours(first, nodes, node_count);
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
  if (row == column) return -1;
  const int low = std::min(row, column);
  const int wanted = std::max(row, column);
  const int lane = lane_of[low] % kRows;
  int from = first[lane_of[low] / kRows];
  int to = first[lane_of[low] / kRows + 1];
  while (from < to) {  // ascending, with the row itself, where there is no block, at the end
    const int middle = (from + to) / 2;
    const int there = columns[kRows * middle + lane];
    if (there == wanted) return placeOf(middle, lane, row > column);
    if (there < wanted && there != low) {
      from = middle + 1;
    } else {
      to = middle;
    }
  }
  return -1;
}

BlockMatrix::BlockMatrix(std::shared_ptr<const BlockPattern> of)
    : pattern(std::move(of)), diagonal(pattern->nodes, Matrix3::Zero()), values(pattern->entries(), BlockLanes{}) {}

void BlockMatrix::carry(StateArchive& archive) {
  archive.carry(diagonal);
  archive.carryEach(values, [&](BlockLanes& entry) { archive.carry(entry.at); });
}

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
