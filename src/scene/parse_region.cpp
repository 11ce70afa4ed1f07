#include "scene_sections.h"

namespace tissue_contact {
namespace {

BoxRegion parseBoxRegion(const YamlCursor& cursor) {
  const YamlMap map = cursor.map(MapKind::kFixedBox);
  BoxRegion box;
  box.min_m = map.get("min_m").vector3(kPositionRange);
  box.max_m = map.get("max_m").vector3(kPositionRange);
  if ((box.min_m.array() > box.max_m.array()).any()) {
    cursor.fail("has a min_m greater than its max_m; min_m must be <= max_m along each axis; swap them");
  }
  return box;
}

PlaneRegion parsePlaneRegion(const YamlCursor& cursor) {
  const YamlMap map = cursor.map(MapKind::kFixedPlane);
  PlaneRegion plane;
  plane.point_m = map.get("point_m").vector3(kPositionRange);
  plane.normal = parseDirection(map.get("normal"));
  return plane;
}

}  // namespace

Region parseRegion(const YamlCursor& cursor) {
  const YamlMap map = cursor.map(MapKind::kFixedRegion);
  const std::string kind = map.exactlyOne({"box", "plane", "sphere"});
  const YamlCursor& value = map.get(kind);
  if (kind == "box") return parseBoxRegion(value);
  if (kind == "plane") return parsePlaneRegion(value);
  const YamlMap sphere = value.map(MapKind::kFixedSphere);
  return SphereRegion{sphere.get("center_m").vector3(kPositionRange), sphere.get("radius_m").number(kShapeSizeRange)};
}

}  // namespace tissue_contact
