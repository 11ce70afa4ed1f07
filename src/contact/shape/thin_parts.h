/// @file
/// Room `contact`, private: parts of a mesh that fall between the samples of its distance (start-up only).
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "contact/shape/distance_grid.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// A point of the surface is thin where the grid has next to nothing of the solid half a spacing and one behind it: walls
/// thinner than about a spacing. Edges and tips of thick solids are thin as well, but no farther than some spacings.
class ThinParts {
 public:
  struct Part {
    double share = 0.0;             ///< of the surface; 0: there is none
    Vector3 p_S = Vector3::Zero();  ///< a point of it near its middle, m
    double thickness_m = 0.0;       ///< of the mesh there
  };

  /// @param mesh in the frame of the grid.
  /// @param points that are looked at, about.
  ThinParts(const TriangleMesh& mesh, const DistanceGrid& grid, double points);

  /// Of the surface that is thin.
  double share() const { return share_; }

  /// Of what is thin and farther than four spacings from all that is not, the largest part that hangs together.
  Part largest(const TriangleMesh& mesh) const;

  /// Where a part is lost altogether, the distance to what is left of the solid, about, m; else 0.
  double lostAt(const Vector3& p_S) const;

 private:
  struct Point {
    Vector3 p_S;
    Vector3 normal;
    double share;
    bool is_lost;  ///< nothing of the solid is behind it
  };
  std::size_t cellOf(const Vector3& p) const;
  void dropNearThick(std::vector<std::uint8_t> thick);
  void measureLost();

  const DistanceGrid& grid_;
  double share_ = 0.0;
  std::vector<Point> far_;  ///< thin ones, far from what is thick
  std::unordered_map<std::size_t, double>
      lost_;  ///< by the cell of the grid around a sample: how far it is to what is left, m
};

}  // namespace tissue_contact
