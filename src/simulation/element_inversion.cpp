#include "simulation/element_inversion.h"

#include <array>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

constexpr double kCheckedVolumeRatio = 0.1;  // to that at rest
constexpr double kLeastVolumeRatio = 0.05;   // likewise
/// An element that keeps this share of its volume is not looked at further.
constexpr double kKeptVolume = kLeastVolumeRatio / kCheckedVolumeRatio;
/// Nodes that go less far, over the smallest height at rest, do not take that share from an element that is looked at: two
/// opposite edges, at a tenth of their distance at rest, come nearer by twice that, and a height may be twice that distance.
constexpr double kSlow = 0.25 * (1.0 - kKeptVolume) * kCheckedVolumeRatio;
/// No less: tissue that is much slower than the tool beside it lets the tool through.
constexpr std::array<double, 3> kShares = {1.0, 0.7, 0.5};

double volumeAfter(const NodalVectors& x, const NodalVectors& v, double time_s, const Tetrahedron& element) {
  const auto place = [&](int corner) -> Vector3 { return x.col(element[corner]) + time_s * v.col(element[corner]); };
  const Vector3 first = place(0);
  return (place(1) - first).cross(place(2) - first).dot(place(3) - first) / 6.0;
}

}  // namespace

double shareBeforeInversion(const Tissue& tissue, const NodalVectors& x, const NodalVectors& v, double dt_s,
                            std::vector<char>& is_fast) {
  if (tissue.tetrahedra().empty()) return 1.0;
  const double slow = kSlow * tissue.smallestHeight() / dt_s;
  is_fast.resize(static_cast<std::size_t>(v.cols()));
  for (Eigen::Index i = 0; i < v.cols(); ++i)
    is_fast[static_cast<std::size_t>(i)] = static_cast<char>(v.col(i).squaredNorm() > slow * slow);
  const auto fast = [&](const Tetrahedron& element, int corner) {
    return is_fast[static_cast<std::size_t>(element[corner])];
  };
  std::size_t share = 0;
  for (const Tetrahedron& element : tissue.tetrahedra()) {
    if ((fast(element, 0) | fast(element, 1) | fast(element, 2) | fast(element, 3)) == 0) continue;
    const double before = volumeAfter(x, v, 0.0, element);
    if (volumeAfter(x, v, kShares[share] * dt_s, element) >= kKeptVolume * before) continue;
    const double at_rest = signedVolume(tissue.restPositions(), element);
    if (before < kCheckedVolumeRatio * at_rest) continue;
    while (share + 1 < kShares.size() &&
           volumeAfter(x, v, kShares[share] * dt_s, element) < kLeastVolumeRatio * at_rest) {
      ++share;
    }
  }
  return kShares[share];
}

}  // namespace tissue_contact
