#include "validation/scene_transforms.h"

#include <algorithm>

namespace tissue_contact {
namespace {

void scale(Region& region, double length) {
  if (auto* box = std::get_if<BoxRegion>(&region)) {
    box->min_m *= length;
    box->max_m *= length;
  } else if (auto* plane = std::get_if<PlaneRegion>(&region)) {
    plane->point_m *= length;
  } else if (auto* sphere = std::get_if<SphereRegion>(&region)) {
    sphere->center_m *= length;
    sphere->radius_m *= length;
  }
}

void scale(MaterialDescription& material, const Units& units) {
  material.youngs_modulus_pa *= units.mass / units.length;
  material.density_kg_per_m3 *= units.mass / (units.length * units.length * units.length);
  material.bending_stiffness_n_m *= units.torque();  // negative ones stand for a plate's and stay so
}

void scale(TissueDescription& tissue, const Units& units) {
  if (auto* block = std::get_if<BlockDescription>(&tissue.geometry)) {
    block->size_m *= units.length;
  } else if (auto* mesh = std::get_if<MeshDescription>(&tissue.geometry)) {
    mesh->scale_m_per_unit *= units.length;
  } else if (auto* sheet = std::get_if<SheetDescription>(&tissue.geometry)) {
    sheet->size_m *= units.length;
    sheet->thickness_m *= units.length;
  } else {
    auto& shell = std::get<ShellDescription>(tissue.geometry);
    shell.scale_m_per_unit *= units.length;
    shell.thickness_m *= units.length;
  }
  tissue.pose.X.translation() *= units.length;
  scale(tissue.material, units);
  for (Region& region : tissue.fixed) scale(region, units.length);
  for (Attachment& attachment : tissue.attachments) {
    attachment.stiffness_pa_per_m *= units.mass / (units.length * units.length);
    attachment.stiffness_n_per_m *= units.mass;
    for (Region& where : attachment.where) scale(where, units.length);
  }
  tissue.pressure_pa *= units.mass / units.length;
  for (Region& where : tissue.pressure_where) scale(where, units.length);
  for (TissueRegion& region : tissue.regions) {
    scale(region.material, units);
    for (Region& where : region.where) scale(where, units.length);
  }
}

void scale(ShapeDescription& shape, double length) {
  shape.X_LS.translation() *= length;
  if (auto* sphere = std::get_if<SphereGeometry>(&shape.geometry)) {
    sphere->radius_m *= length;
  } else if (auto* box = std::get_if<BoxGeometry>(&shape.geometry)) {
    box->size_m *= length;
  } else if (auto* cylinder = std::get_if<CylinderGeometry>(&shape.geometry)) {
    cylinder->radius_m *= length;
    cylinder->length_m *= length;
  } else {
    std::get<MeshGeometry>(shape.geometry).scale *= length;
  }
}

}  // namespace

Scene inUnits(Scene scene, const Units& units) {
  scene.gravity_m_per_s2 *= units.length;
  for (TissueDescription& tissue : scene.tissues) scale(tissue, units);
  for (InstrumentDescription& instrument : scene.instruments) {
    instrument.base_pose.X.translation() *= units.length;
    for (ContactLinkDescription& link : instrument.contact_links) {
      for (ShapeDescription& shape : link.shapes) scale(shape, units.length);
    }
  }
  for (FrictionDescription& friction : scene.friction) {
    for (double& speed : friction.law.speeds_m_per_s) speed *= units.length;
    for (double& pressure : friction.law.pressures_pa) pressure *= units.mass / units.length;
  }
  return scene;
}

Scene turned(Scene scene, const Matrix3& R) {
  scene.gravity_m_per_s2 = R * scene.gravity_m_per_s2;
  const auto turn = [&](Pose& X) {
    X.translation() = R * X.translation();
    X.linear() = R * X.linear();
  };
  for (TissueDescription& tissue : scene.tissues) turn(tissue.pose.X);
  for (InstrumentDescription& instrument : scene.instruments) turn(instrument.base_pose.X);
  return scene;
}

Scene listedBackwards(Scene scene) {
  std::reverse(scene.instruments.begin(), scene.instruments.end());
  std::reverse(scene.friction.begin(), scene.friction.end());
  return scene;
}

}  // namespace tissue_contact
