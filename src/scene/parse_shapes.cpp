#include "scene_sections.h"

namespace tissue_contact {
namespace {

// A mirroring (negative) scale would turn the surface inside out.
constexpr Range kMeshScaleRange{1e-9, 1e6, "m per file unit", "a mesh in millimetres has 0.001"};

MeshGeometry parseMeshGeometry(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map(MapKind::kShapeMesh);
  MeshGeometry mesh;
  mesh.file = parseFile(map.get("file"), paths, {".stl", ".obj", ".dae"});
  if (const YamlCursor* value = map.find("scale")) {
    mesh.scale =
        value->isScalar() ? Vector3::Constant(value->number(kMeshScaleRange)).eval() : value->vector3(kMeshScaleRange);
  }
  return mesh;
}

ShapeGeometry parseGeometry(const YamlMap& map, const PathContext& paths) {
  const std::string kind = map.exactlyOne({"sphere", "box", "cylinder", "mesh"});
  const YamlCursor& value = map.get(kind);
  if (kind == "sphere") {
    return SphereGeometry{value.map(MapKind::kShapeSphere).get("radius_m").number(kShapeSizeRange)};
  }
  if (kind == "box") return BoxGeometry{value.map(MapKind::kShapeBox).get("size_m").vector3(kShapeSizeRange)};
  if (kind == "mesh") return parseMeshGeometry(value, paths);
  const YamlMap cylinder = value.map(MapKind::kShapeCylinder);
  return CylinderGeometry{cylinder.get("radius_m").number(kShapeSizeRange),
                          cylinder.get("length_m").number(kShapeSizeRange)};
}

ShapeDescription parseShape(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map(MapKind::kShape);
  ShapeDescription shape;
  shape.geometry = parseGeometry(map, paths);
  if (const YamlCursor* value = map.find("pose")) shape.X_LS = parsePose(*value, MapKind::kShapePose).X;
  return shape;
}

}  // namespace

ContactLinkDescription parseContactLink(const YamlCursor& cursor, const PathContext& paths) {
  if (cursor.isScalar()) return {cursor.text(), {}};
  const YamlMap map = cursor.map(MapKind::kContactLink);
  ContactLinkDescription link;
  link.link = map.get("link").text();
  if (const YamlCursor* value = map.find("shapes")) {
    for (const YamlCursor& shape : value->list(1, kMostContactLinks)) link.shapes.push_back(parseShape(shape, paths));
  }
  return link;
}

}  // namespace tissue_contact
