/// @file
/// Room `contact`: what contact detection asks of an instrument shape: its signed distance, and where on a
/// triangle that distance is least. Everything in the shape's frame S, metres.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "contact/shape/gradient_set.h"
#include "mesh/surface/triangle_geometry.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/collision_shape.h"
#include "tissue_contact/instrument/instrument_description.h"
#include "tissue_contact/mesh/mesh_preparation.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

struct MeshField;

struct SignedDistance {
  double distance = 0.0;              ///< m, > 0 outside
  Vector3 normal = Vector3::UnitX();  ///< its gradient: unit, outward
};

/// Where on a triangle a shape is nearest or deepest.
struct ClosestPoint {
  Vector3 weights = Vector3::UnitX();  ///< barycentric
  double distance = 0.0;               ///< signed distance there
  GradientSet gradients;               ///< at that point, one unless it lies on a ridge
  bool beyond_rim = false;             ///< an edge between smooth parts of the shape is nearest
};

/// A corner of the shape near a triangle.
struct ShapeCorner {
  int index = -1;
  Vector3 p_S = Vector3::Zero();
};

/// Const after construction but for scratch memory: not thread-safe.
class ShapeDistance {
 public:
  virtual ~ShapeDistance() = default;

  /// Length by which tolerances are measured, m: a typical half-extent, > 0.
  virtual double size() const = 0;

  /// Half-extents of the axis-aligned box around the shape after rotating it by `R_WS`, and that box's centre in S.
  virtual Vector3 halfExtents(const Matrix3& R_WS) const = 0;
  virtual Vector3 boxCentre() const { return Vector3::Zero(); }

  /// Of a mesh no more than that where it is farther from the mesh's box than a grid reaches.
  virtual SignedDistance at(const Vector3& p_S) const = 0;

  /// At any distance, at some cost.
  virtual SignedDistance atAnyDistance(const Vector3& p_S) const { return at(p_S); }

  /// Adds the gradients of the smooth parts that are nearest, but for twice `reach`, to a point no farther outside than `reach`, m: more
  /// than one beside a ridge. None of a shape without ridges.
  virtual void gradientsNear(const Vector3& /*p_S*/, double /*reach*/, GradientSet& /*gradients*/) const {}

  /// The point of the triangle where the signed distance is least. False when that is certainly more than `margin`.
  virtual bool closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const = 0;

  /// The surface as it acts, where it is not that of the geometry itself; null: draw the geometry.
  virtual const TriangleMesh* drawn() const { return nullptr; }

  /// Radius with which the distance rounds edges of the geometry, m.
  virtual double edgeRadius() const { return 0.0; }

  /// Whether flat parts exist that can lie flush on a triangle, so that tissue vertices and shape corners matter.
  virtual bool hasFlatParts() const { return true; }
  /// m, how far it is to where two smooth parts of the shape are equally far and round-off tells which of their gradients counts; 0 there,
  /// elsewhere right but for a small factor. Infinite: there is no such place.
  virtual double toRidge(const Vector3& /*p_S*/) const { return std::numeric_limits<double>::infinity(); }

  /// Corners that are the shape's foremost points in direction `forward` (unit; see kCornerSlope), at least those in
  /// `box`. Cleared first.
  virtual void foremostCorners(const Vector3& forward, const Eigen::AlignedBox3d& box,
                               std::vector<ShapeCorner>& corners) const;

  /// Corners deeper than this below a triangle have come from its other side, m.
  virtual double cornerReach() const { return size(); }
};

/// The signed distances of many shapes: those of one mesh share its field.
class ShapeDistances {
 public:
  explicit ShapeDistances(MeshPreparation preparation) : preparation_(std::move(preparation)) {}

  /// The exact signed distance of a shape, of a mesh a sampled one.
  /// @throws std::invalid_argument naming a mesh that was not loaded, has no usable triangle, a triangle that refers to
  ///   a vertex it does not have, or no inside.
  std::unique_ptr<ShapeDistance> make(const CollisionShape& shape);

 private:
  std::unique_ptr<ShapeDistance> makeMesh(const MeshGeometry& geometry,
                                          const std::shared_ptr<const TriangleMesh>& mesh);

  MeshPreparation preparation_;
  std::map<std::tuple<std::string, double, double, double>, std::shared_ptr<const MeshField>> fields_;
};

std::unique_ptr<ShapeDistance> makeSphereDistance(double radius);
std::unique_ptr<ShapeDistance> makeBoxDistance(const Vector3& half_extents);
std::unique_ptr<ShapeDistance> makeCylinderDistance(double radius, double half_length);

}  // namespace tissue_contact
