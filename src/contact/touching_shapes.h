/// @file
/// Room `contact`, private: the shapes with which instruments touch, and what those of one instrument are to each other. Instruments in;
/// shapes with their distances out.
#pragma once

#include <memory>
#include <vector>

#include "contact/leaving_face.h"
#include "contact/shape/shape_distance.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/mesh/mesh_preparation.h"

namespace tissue_contact {

/// One shape of one instrument's touching link.
struct TouchingShape {
  int instrument;
  int contact_link;  // index into Instrument::contactLinks()
  int shape;         // index into ContactLink::shapes
  int link;          // index into RobotModel::links()
  Pose X_LS;
  std::unique_ptr<ShapeDistance> distance;
  double half_extent;  ///< smallest, m
};

/// Of the smaller half extent of two shapes: the radius of the ball that fills the groove between them. Jaws keep their
/// outline, and the groove of two parallel cylinders its walls at 48 degrees and more, which no friction below 1.1 locks.
constexpr double kGrooveRadius = 0.5;

/// Of all instruments, in their order. Mesh shapes are prepared, or read from the cache.
/// @throws std::invalid_argument when a mesh shape has no mesh or no inside.
std::vector<TouchingShape> touchingShapes(const std::vector<Instrument>& instruments,
                                          const MeshPreparation& preparation);

/// The other shapes of a shape's instrument. They close a way that they come as near to as the filling of their groove with the shape reaches, and one to
/// a face that looks at them: a vertex that jaws hold must not slip out beside one.
class OtherShapes final : public ShapesBeside {
 public:
  /// @param X_WL of the links of the instrument. All must outlive this.
  OtherShapes(const std::vector<TouchingShape>& shapes, const TouchingShape& own, const std::vector<Pose>& X_WL)
      : shapes_(shapes), own_(own), X_WL_(X_WL) {}

  bool closeWay(const Vector3& p_S, const Vector3& end_S, const Vector3& normal_S) const override;

 private:
  const std::vector<TouchingShape>& shapes_;
  const TouchingShape& own_;
  const std::vector<Pose>& X_WL_;
};

}  // namespace tissue_contact
