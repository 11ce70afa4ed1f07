#include "tissue/body_edges.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <variant>
#include <vector>

#include "mesh/region.h"

namespace tissue_contact {
namespace {

constexpr double kDiagonal = 1.7320508075688772;  // of a cube over its side: the longest edge of a cell's tetrahedra

/// Groups and cell data are of whole elements, so that none has their border in it.
bool isShape(const Region& region) { return !std::holds_alternative<MemberRegion>(region); }

/// How far a sphere or box reaches, m: a diameter, or a box's second longest side, since of flat ones on the surface the third says nothing.
double extentOf(const Region& region) {
  if (const auto* sphere = std::get_if<SphereRegion>(&region)) return 2.0 * sphere->radius_m;
  const auto* const box = std::get_if<BoxRegion>(&region);
  if (box == nullptr) return std::numeric_limits<double>::infinity();
  const Vector3 sides = box->max_m - box->min_m;
  return sides.sum() - sides.maxCoeff() - sides.minCoeff();
}

/// Whether the middle of a sphere or box lies in a tetrahedron, which may be far larger.
bool holdsMiddle(const std::array<Vector3, 4>& corners, const Region& region) {
  Vector3 middle;
  if (const auto* sphere = std::get_if<SphereRegion>(&region)) {
    middle = sphere->center_m;
  } else if (const auto* box = std::get_if<BoxRegion>(&region)) {
    middle = 0.5 * (box->min_m + box->max_m);
  } else {
    return false;
  }
  Matrix3 edges;
  for (int i = 0; i < 3; ++i) edges.col(i) = corners[i + 1] - corners[0];
  constexpr double kRounding = 1e-9;  // a patch on the surface has its middle on a face
  const Vector3 shares = edges.partialPivLu().solve(middle - corners[0]);
  return shares.minCoeff() >= -kRounding && shares.sum() <= 1.0 + kRounding;  // of a flat one they are no numbers
}

/// How long edges may be where, as short as the number of nodes allows.
class BodyEdges {
 public:
  /// @param shortest_m on any border.
  BodyEdges(const TetMesh& mesh, const TissueDescription& tissue, double edge_m, double shortest_m)
      : is_block_(std::holds_alternative<BlockDescription>(tissue.geometry)),
        rounding_m_(roundingDistance(mesh.positions)),
        cells_across_(tissue.refinement.choice().cells_across),
        asked_m_(edge_m),
        edge_m_(edge_m),
        shortest_m_(shortest_m) {
    Border fixed{{}, kHalf, false};
    std::copy_if(tissue.fixed.begin(), tissue.fixed.end(), std::back_inserter(fixed.where), isShape);
    borders_.push_back(fixed);
    for (const TissueRegion& region : tissue.regions) addParts(region.where, false);
    for (const Attachment& attachment : tissue.attachments) addParts(attachment.where, true);
    if (tissue.pressure_pa != 0.0) addParts(tissue.pressure_where, true);
    findNear(mesh);
    double smallest_m = 0.5 * edge_m_;
    for (const Border& border : borders_) smallest_m = std::min(smallest_m, border.edge_m);
    shortest_m_ = smallest_m;
  }

  double longest(const ElementPart& part) const {
    double squared_m2 = 0.0;
    for (const Vector3& a : part.corners) {
      for (const Vector3& b : part.corners) squared_m2 = std::max(squared_m2, (a - b).squaredNorm());
    }
    double most_m = is_block_ ? std::numeric_limits<double>::infinity() : edge_m_;  // its cells are as the scene says
    for (std::size_t i = first_near_[part.unrefined]; i < first_near_[part.unrefined + 1]; ++i) {
      const Border& border = borders_[near_[i]];
      const double edge_m = onBorder(border);
      const bool may_count = edge_m < most_m && squared_m2 > edge_m * edge_m && (part.at_surface || !border.on_surface);
      if (may_count && isOn(border, part.corners)) most_m = edge_m;
    }
    return most_m;
  }

  /// Those of small parts first, then all.
  void lengthen(double factor) {
    if (shortest_m_ >= 0.5 * edge_m_) edge_m_ *= factor;
    shortest_m_ *= factor;
  }

  /// By what factor edges are longer than at first, at most.
  double coarsening() const {
    double most = edge_m_ / asked_m_;
    for (const Border& border : borders_) {
      most = std::max(most, onBorder(border) / std::min(0.5 * asked_m_, border.edge_m));
    }
    return most;
  }

 private:
  static constexpr double kHalf = std::numeric_limits<double>::infinity();
  struct Border {
    std::vector<Region> where;
    double edge_m;  ///< wanted; kHalf: half of what is wanted elsewhere
    bool on_surface;
  };

  void addParts(const std::vector<Region>& where, bool on_surface) {
    for (const Region& part : where) {
      if (!isShape(part)) continue;
      borders_.push_back({{part}, std::max(kDiagonal / cells_across_ * extentOf(part), shortest_m_), on_surface});
    }
  }

  /// So that many regions cost no more than a look at each from each element. What is near none asks for no cells.
  void findNear(const TetMesh& mesh) {
    std::vector<bool> is_near_any(borders_.size(), false);
    first_near_.push_back(0);
    for (const Tetrahedron& nodes : mesh.tetrahedra) {
      const Vector3 corner = mesh.positions.col(nodes[0]);
      double size_m = rounding_m_;
      for (const int node : nodes) size_m = std::max(size_m, (mesh.positions.col(node) - corner).norm() + rounding_m_);
      for (std::size_t b = 0; b < borders_.size(); ++b) {
        const std::vector<Region>& where = borders_[b].where;
        const auto is_near = [&](const Region& region) { return mayHoldWithin(region, corner, size_m); };
        const auto holds_all = [&](const Region& region) {  // shapes are convex: no border runs through it then
          return std::all_of(nodes.begin(), nodes.end(),
                             [&](int node) { return holds(region, mesh.positions.col(node), rounding_m_); });
        };
        if (std::none_of(where.begin(), where.end(), is_near) || std::any_of(where.begin(), where.end(), holds_all)) {
          continue;
        }
        is_near_any[b] = true;
        near_.push_back(b);
      }
      first_near_.push_back(near_.size());
    }
    for (std::size_t b = 0; b < borders_.size(); ++b) {
      if (!is_near_any[b]) borders_[b].edge_m = kHalf;
    }
  }

  double onBorder(const Border& border) const { return std::min(0.5 * edge_m_, std::max(border.edge_m, shortest_m_)); }

  bool isOn(const Border& border, const std::array<Vector3, 4>& corners) const {
    return bordersIn(border.where, corners, rounding_m_) ||
           (border.edge_m != kHalf && holdsMiddle(corners, border.where.front()));
  }

  bool is_block_;
  double rounding_m_;
  double cells_across_;
  double asked_m_;
  double edge_m_;      ///< anywhere; half of it on borders
  double shortest_m_;  ///< on any border
  std::vector<Border> borders_;
  std::vector<std::size_t> near_;        ///< per element of the unrefined mesh: borders that may run through it,
  std::vector<std::size_t> first_near_;  ///< from here on
};

}  // namespace

double longestBodyEdge(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                       const RefinementDescription& refinement) {
  double volume_m3 = 0.0;
  for (const Tetrahedron& nodes : tetrahedra) volume_m3 += signedVolume(rest, nodes);
  return kDiagonal * std::cbrt(volume_m3) / refinement.choice().cells_across;
}

double refineBody(const TetMesh& mesh, const TissueDescription& tissue, Bisection& bisection) {
  constexpr double kLonger = 1.189207115002721;  // fourth root of 2
  constexpr double kShortest = 1e-3;  // of the mesh's size, and of edges elsewhere: so that few attempts find what fits
  const auto unrefined = static_cast<std::size_t>(mesh.positions.cols());
  const std::size_t most_nodes = std::max(mostNodes(tissue.refinement, unrefined), unrefined);
  const double size_m = (mesh.positions.rowwise().maxCoeff() - mesh.positions.rowwise().minCoeff()).norm();
  const double asked_m =
      std::max(longestBodyEdge(mesh.positions, mesh.tetrahedra, tissue.refinement), kShortest * size_m);
  if (!(asked_m > 0.0)) return 1.0;  // lengths whose products underflow
  BodyEdges edges(mesh, tissue, asked_m, kShortest * asked_m);
  const auto limit = [&edges](const ElementPart& part) { return edges.longest(part); };
  while (!bisection.refineLasting(limit, unrefined + (most_nodes - unrefined) / 2)) edges.lengthen(kLonger);
  return edges.coarsening();
}

}  // namespace tissue_contact
