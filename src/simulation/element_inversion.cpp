#include "simulation/element_inversion.h"

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

constexpr double kHasSay = 0.1;  // of the volume at rest
constexpr double kLeast = 0.05;  // likewise
constexpr double kNext = 0.7;    // share to try next
/// Tissue that is slower than that beside a tool that is not lets the tool through.
constexpr double kLeastShare = 0.5;
/// An element that keeps this share of its volume is not looked at further.
constexpr double kSurely = kLeast / kHasSay;
/// Nodes that go less far, over the smallest height at rest, cannot take that share from an element that has a say: its heights are a tenth
/// of those at rest or more, unless its faces grew as well, and its nodes come nearer by twice that at most.
constexpr double kSlow = 0.5 * (1.0 - kSurely) * kHasSay;

double volumeAfter(const NodalVectors& x, const NodalVectors& v, double time_s, const Tetrahedron& element) {
  const auto place = [&](int corner) -> Vector3 { return x.col(element[corner]) + time_s * v.col(element[corner]); };
  const Vector3 first = place(0);
  return (place(1) - first).cross(place(2) - first).dot(place(3) - first) / 6.0;
}

}  // namespace

double shareBeforeInversion(const Tissue& tissue, const NodalVectors& x, const NodalVectors& v, double dt_s,
                            std::vector<char>& is_fast) {
  const double slow = kSlow * tissue.smallestHeight() / dt_s;
  is_fast.resize(static_cast<std::size_t>(v.cols()));
  for (Eigen::Index i = 0; i < v.cols(); ++i)
    is_fast[static_cast<std::size_t>(i)] = static_cast<char>(v.col(i).squaredNorm() > slow * slow);
  const auto fast = [&](const Tetrahedron& element, int corner) {
    return is_fast[static_cast<std::size_t>(element[corner])];
  };
  double share = 1.0;
  for (const Tetrahedron& element : tissue.tetrahedra()) {
    if ((fast(element, 0) | fast(element, 1) | fast(element, 2) | fast(element, 3)) == 0) continue;
    const double before = volumeAfter(x, v, 0.0, element);
    if (volumeAfter(x, v, share * dt_s, element) >= kSurely * before) continue;
    const double at_rest = signedVolume(tissue.restPositions(), element);
    if (before < kHasSay * at_rest) continue;
    while (volumeAfter(x, v, share * dt_s, element) < kLeast * at_rest) {
      if (share * kNext <= kLeastShare) return kLeastShare;
      share *= kNext;
    }
  }
  return share;
}

}  // namespace tissue_contact
