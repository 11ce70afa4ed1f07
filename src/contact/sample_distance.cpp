#include "contact/sample_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>

namespace tissue_contact {
namespace {

constexpr int kBlock = GridPlan::kBlock;
constexpr double kBand = 10.0;  // spacings from the surface within which every sample is measured

/// Work on slices that write to places of their own: the result does not depend on the number of threads.
template <typename Work>
void forEachSlice(int count, const Work& work) {
  const int threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 4);
  std::vector<std::thread> others;
  const auto run = [&work, count, threads](int first) {
    for (int i = first; i < count; i += threads) work(i);
  };
  for (int t = 1; t < threads; ++t) others.emplace_back(run, t);
  run(0);
  for (std::thread& one : others) one.join();
}

class Sampler {
 public:
  Sampler(const SurfaceTree& tree, const GridPlan& plan) : tree_(tree) {
    for (int a = 0; a < 3; ++a) {
      coarse_size_[a] = plan.blocks[a] + 1;
      grid_.size[a] = kBlock * plan.blocks[a] + 1;
    }
    grid_.origin = plan.origin;
    grid_.spacing = plan.spacing;
    coarse_.resize(static_cast<std::size_t>(coarse_size_[0]) * coarse_size_[1] * coarse_size_[2]);
    grid_.samples.resize(static_cast<std::size_t>(grid_.size[0]) * grid_.size[1] * grid_.size[2]);
  }

  DistanceGrid run() {
    forEachSlice(coarse_size_[2], [this](int k) { sampleCoarse(k); });
    forEachSlice(coarse_size_[2], [this](int k) { sampleBlocks(k); });
    return std::move(grid_);
  }

 private:
  double& coarse(int i, int j, int k) {
    return coarse_[(static_cast<std::size_t>(k) * coarse_size_[1] + j) * coarse_size_[0] + i];
  }
  bool isInside(const Vector3& p) const { return tree_.windingNumber(p) > 0.5; }

  void sampleCoarse(int k) {
    for (int j = 0; j < coarse_size_[1]; ++j) {
      double bound = std::numeric_limits<double>::infinity();
      for (int i = 0; i < coarse_size_[0]; ++i) {
        const Vector3 p = grid_.point(kBlock * i, kBlock * j, kBlock * k);
        const double distance = std::sqrt(tree_.squaredDistance(p, bound * bound));
        coarse(i, j, k) = isInside(p) ? -distance : distance;
        bound = 1.000001 * (distance + kBlock * grid_.spacing);
      }
    }
  }

  void sampleBlocks(int k) {
    for (int j = 0; j < coarse_size_[1]; ++j) {
      for (int i = 0; i < coarse_size_[0]; ++i) sampleBlock({i, j, k});
    }
  }

  /// The samples from coarse sample `block` on, up to the next along each axis.
  void sampleBlock(const std::array<int, 3>& block) {
    std::array<double, 8> corners{};
    double nearest = std::numeric_limits<double>::infinity();
    std::array<int, 3> count{};
    for (int a = 0; a < 3; ++a) count[a] = std::min(kBlock, grid_.size[a] - kBlock * block[a]);
    for (int c = 0; c < 8; ++c) {
      std::array<int, 3> at = block;
      for (int a = 0; a < 3; ++a) at[a] = std::min(at[a] + ((c >> a) & 1), coarse_size_[a] - 1);
      corners[c] = coarse(at[0], at[1], at[2]);
      nearest = std::min(nearest, std::abs(corners[c]));
    }
    // No point of the block is farther from one of its corners than 3.5 spacings, so it is all on one side.
    const bool far = nearest > (kBand + kBlock) * grid_.spacing;
    for (int k = 0; k < count[2]; ++k) {
      for (int j = 0; j < count[1]; ++j) {
        const std::size_t row = grid_.index(kBlock * block[0], kBlock * block[1] + j, kBlock * block[2] + k);
        if (far) {
          for (int i = 0; i < count[0]; ++i) grid_.samples[row + i] = interpolated(corners, i, j, k);
        } else {
          measureRow(grid_.point(kBlock * block[0], kBlock * block[1] + j, kBlock * block[2] + k), count[0], row);
        }
      }
    }
  }

  static float interpolated(const std::array<double, 8>& corners, int i, int j, int k) {
    const std::array<double, 3> t = {static_cast<double>(i) / kBlock, static_cast<double>(j) / kBlock,
                                     static_cast<double>(k) / kBlock};
    double sum = 0.0;
    for (int c = 0; c < 8; ++c) {
      double weight = 1.0;
      for (int a = 0; a < 3; ++a) weight *= (c >> a) & 1 ? t[a] : 1.0 - t[a];
      sum += weight * corners[c];
    }
    return static_cast<float>(sum);
  }

  /// The surface cannot pass between neighbours of which one is farther from it than the other.
  void measureRow(const Vector3& start, int count, std::size_t row) {
    double bound = std::numeric_limits<double>::infinity();
    double before = 0.0;
    for (int i = 0; i < count; ++i) {
      const Vector3 p = start + Vector3(i * grid_.spacing, 0.0, 0.0);
      const double distance = std::sqrt(tree_.squaredDistance(p, bound * bound));
      const bool same_side = i > 0 && std::max(distance, std::abs(before)) > grid_.spacing;
      before = (same_side ? before < 0.0 : isInside(p)) ? -distance : distance;
      grid_.samples[row + i] = static_cast<float>(before);
      bound = 1.000001 * (distance + grid_.spacing);
    }
  }

  const SurfaceTree& tree_;
  DistanceGrid grid_;
  std::array<int, 3> coarse_size_{};
  std::vector<double> coarse_;
};

}  // namespace

GridPlan planGrid(const TriangleMesh& mesh, double spacing, double padding) {
  GridPlan plan;
  plan.spacing = spacing;
  const Vector3 low = mesh.vertices.rowwise().minCoeff();
  const Vector3 high = mesh.vertices.rowwise().maxCoeff();
  // One more spacing, since the spline ends that much inside the samples.
  const double around = padding + spacing;
  for (int a = 0; a < 3; ++a) {
    plan.blocks[a] = std::max(1, static_cast<int>(std::ceil((high[a] - low[a] + 2.0 * around) / (kBlock * spacing))));
    plan.origin[a] = 0.5 * (low[a] + high[a]) - 0.5 * kBlock * plan.blocks[a] * spacing;
  }
  return plan;
}

DistanceGrid sampleDistance(const SurfaceTree& tree, const GridPlan& plan) { return Sampler(tree, plan).run(); }

}  // namespace tissue_contact
