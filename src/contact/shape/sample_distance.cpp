#include "contact/shape/sample_distance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <thread>
#include <utility>

namespace tissue_contact {
namespace {

constexpr int kBlock = GridPlan::kBlock;
constexpr double kBand = 10.0;  // spacings from the surface within which every sample is measured

/// Work on slices that write to places of their own: the result does not depend on the number of threads.
/// @param progress called by this thread alone; may be empty.
template <typename Work>
void forEachSlice(int count, const Work& work, const std::function<void(double)>& progress) {
  const int threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 4);
  std::vector<std::thread> others;
  const auto run = [&work, count, threads](int first) {
    for (int i = first; i < count; i += threads) work(i);
  };
  for (int t = 1; t < threads; ++t) others.emplace_back(run, t);
  for (int i = 0; i < count; i += threads) {
    work(i);
    if (progress) progress(static_cast<double>(i + 1) / count);
  }
  for (std::thread& one : others) one.join();
}

/// Of a block of samples.
struct Corners {
  std::array<double, 8> values{};
  std::array<Vector3, 8> points;
};

class Sampler {
 public:
  Sampler(const WindingTree& all, const TriangleTree& outer, const GridPlan& plan) : all_(all), tree_(outer) {
    for (int a = 0; a < 3; ++a) {
      coarse_size_[a] = plan.blocks[a] + 1;
      grid_.size[a] = kBlock * plan.blocks[a] + 1;
    }
    grid_.origin = plan.origin;
    grid_.spacing = plan.spacing;
    coarse_.resize(static_cast<std::size_t>(coarse_size_[0]) * coarse_size_[1] * coarse_size_[2]);
    grid_.samples.resize(static_cast<std::size_t>(grid_.size[0]) * grid_.size[1] * grid_.size[2]);
  }

  DistanceGrid run(const std::function<void(double)>& progress) {
    forEachSlice(
        coarse_size_[2], [this](int k) { sampleCoarse(k); }, nullptr);
    forEachSlice(
        coarse_size_[2], [this](int k) { sampleBlocks(k); }, progress);
    return std::move(grid_);
  }

 private:
  double& coarse(int i, int j, int k) {
    return coarse_[(static_cast<std::size_t>(k) * coarse_size_[1] + j) * coarse_size_[0] + i];
  }
  /// On the side of the sample before, or of a corner of the block, when the surface cannot pass between.
  bool isInside(const Vector3& p, double distance, double before, const Corners& corners) const {
    if (std::max(distance, std::abs(before)) > grid_.spacing && before != 0.0) return before < 0.0;
    for (int c = 0; c < 8; ++c) {
      const double way = (p - corners.points[c]).norm();
      if (std::max(distance, std::abs(corners.values[c])) > 1.000001 * way) return corners.values[c] < 0.0;
    }
    return all_.isInside(p);
  }

  void sampleCoarse(int k) {
    for (int j = 0; j < coarse_size_[1]; ++j) {
      double bound = std::numeric_limits<double>::infinity();
      for (int i = 0; i < coarse_size_[0]; ++i) {
        const Vector3 p = grid_.point(kBlock * i, kBlock * j, kBlock * k);
        const double distance = std::sqrt(tree_.squaredDistance(p, bound * bound));
        coarse(i, j, k) = all_.isInside(p) ? -distance : distance;
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
    Corners corners;
    double nearest = std::numeric_limits<double>::infinity();
    std::array<int, 3> count{};
    for (int a = 0; a < 3; ++a) count[a] = std::min(kBlock, grid_.size[a] - kBlock * block[a]);
    for (int c = 0; c < 8; ++c) {
      std::array<int, 3> at = block;
      for (int a = 0; a < 3; ++a) at[a] = std::min(at[a] + ((c >> a) & 1), coarse_size_[a] - 1);
      corners.values[c] = coarse(at[0], at[1], at[2]);
      corners.points[c] = grid_.point(kBlock * at[0], kBlock * at[1], kBlock * at[2]);
      nearest = std::min(nearest, std::abs(corners.values[c]));
    }
    // No point of the block is farther from one of its corners than 3.5 spacings, so it is all on one side.
    const bool far = nearest > (kBand + kBlock) * grid_.spacing;
    for (int k = 0; k < count[2]; ++k) {
      for (int j = 0; j < count[1]; ++j) {
        const std::size_t row = grid_.index(kBlock * block[0], kBlock * block[1] + j, kBlock * block[2] + k);
        if (far) {
          for (int i = 0; i < count[0]; ++i) grid_.samples[row + i] = interpolated(corners.values, i, j, k);
        } else {
          measureRow(grid_.point(kBlock * block[0], kBlock * block[1] + j, kBlock * block[2] + k), count[0], row,
                     corners);
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

  void measureRow(const Vector3& start, int count, std::size_t row, const Corners& corners) {
    double bound = std::numeric_limits<double>::infinity();
    double before = 0.0;
    for (int i = 0; i < count; ++i) {
      const Vector3 p = start + Vector3(i * grid_.spacing, 0.0, 0.0);
      const double distance = std::sqrt(tree_.squaredDistance(p, bound * bound));
      before = isInside(p, distance, i > 0 ? before : 0.0, corners) ? -distance : distance;
      grid_.samples[row + i] = static_cast<float>(before);
      bound = 1.000001 * (distance + grid_.spacing);
    }
  }

  const WindingTree& all_;    ///< tells inside from outside
  const TriangleTree& tree_;  ///< tells how far
  DistanceGrid grid_;
  std::array<int, 3> coarse_size_{};
  std::vector<double> coarse_;
};

}  // namespace

namespace {

double paddingAround(const Vector3& extent) { return 0.2 * extent.minCoeff() + 0.005 * extent.maxCoeff(); }

}  // namespace

Vector3 paddedExtent(const NodalVectors& vertices) {
  const Vector3 extent = vertices.rowwise().maxCoeff() - vertices.rowwise().minCoeff();
  return extent.array() + 2.0 * paddingAround(extent);
}

GridPlan planGrid(const TriangleMesh& mesh, double sample_count) {
  const Vector3 low = mesh.vertices.rowwise().minCoeff();
  const Vector3 high = mesh.vertices.rowwise().maxCoeff();
  const Vector3 extent = high - low;
  const double padding = paddingAround(extent);
  GridPlan plan;
  plan.spacing = std::cbrt((extent.array() + 2.0 * padding).prod() / sample_count);
  // Two more spacings: the spline ends one inside the samples, and its values beside a flat face need one.
  const double around = padding + 2.0 * plan.spacing;
  for (int a = 0; a < 3; ++a) {
    plan.blocks[a] = std::max(1, static_cast<int>(std::ceil((extent[a] + 2.0 * around) / (kBlock * plan.spacing))));
    plan.origin[a] = 0.5 * (low[a] + high[a]) - 0.5 * kBlock * plan.blocks[a] * plan.spacing;
  }
  return plan;
}

DistanceGrid sampleDistance(const WindingTree& all, const TriangleTree& outer, const GridPlan& plan,
                            const std::function<void(double)>& progress) {
  return Sampler(all, outer, plan).run(progress);
}

}  // namespace tissue_contact
