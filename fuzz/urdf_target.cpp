/// @file
/// Robot models: URDF text in, a kinematic tree that can be moved out.
#include <stdexcept>

#include "fuzz/fuzz_support.h"
#include "tissue_contact/instrument/collision_shape.h"
#include "tissue_contact/instrument/instrument_description.h"
#include "tissue_contact/instrument/parse_urdf.h"

using namespace tissue_contact;

namespace {

void move(const RobotModel& model, double position) {
  std::vector<Pose> X_BL;
  const auto joints = static_cast<Eigen::Index>(model.joints().size());
  model.forwardKinematics(VectorX::Constant(joints, position), X_BL);
  fuzz::require(X_BL.size() == model.links().size(), "a pose per link");
}

void check(const RobotModel& model) {
  fuzz::require(!model.links().empty(), "a model has links");
  for (std::size_t i = 0; i < model.links().size(); ++i) {
    const RobotModel::Link& link = model.links()[i];
    fuzz::require(link.parent < static_cast<int>(i), "parents come first");
    fuzz::require(model.findLink(link.name) == static_cast<int>(i), "links are found by name");
    fuzz::require(link.joint < static_cast<int>(model.joints().size()), "joint indices in range");
    for (const ShapeDescription& shape : link.geometry.collision) {
      if (std::holds_alternative<MeshGeometry>(shape.geometry)) continue;  // would open files by names of the input
      try {
        makeCollisionShape(shape);
      } catch (const std::invalid_argument&) {
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const RobotModel model = parseUrdf(fuzz::textOf(data, size), "input", "", {});
    check(model);
    for (const double position : {0.0, 0.5, -3.0}) move(model, position);
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
