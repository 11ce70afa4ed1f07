#include <cmath>

#include "scene_sections.h"

namespace tissue_contact {
namespace {

constexpr int kMaxCellsPerAxis = 200;
constexpr int kTetrahedraPerCell = 5;
constexpr int kMaxTetrahedra = 2000000;
// Beyond this the smallest cells of a block are slivers whose stiffness drowns the others in round-off.
constexpr double kMaxCellRatio = 1e4;

constexpr Range kBlockSizeRange{1e-6, 10.0, "m", "give metres, not millimetres"};
constexpr Range kGrowthRange{1.0, 3.0};
constexpr Range kScaleRange{1e-6, 1000.0, "m per file unit", "a file in millimetres has 0.001"};
constexpr Range kYoungRange{1.0, 1e12, "Pa", "give pascals: 5 kPa is 5000, 1 MPa is 1e6"};
constexpr Range kPoissonRange{-1.0, 0.5, "", "0.5 itself (incompressible) cannot be simulated, 0.49 can", true, true};
constexpr Range kDensityRange{1.0, 1e5, "kg/m^3", "give kilograms per cubic metre: water is 1000, not 1"};
constexpr Range kMassDampingRange{0.0, 1e4, "1/s"};
constexpr Range kStiffnessDampingRange{0.0, 10.0, "s", "give seconds: 2 ms is 0.002"};
constexpr Range kNormalRange{-1000.0, 1000.0};

AxisGrading parseAxisGrading(const YamlCursor& cursor, int cells) {
  const YamlMap map = cursor.map(MapKind::kAxisGrading);
  AxisGrading grading;
  if (const YamlCursor* value = map.find("fine_at")) {
    const std::string text = value->text();
    if (text == "minimum") {
      grading.fine_at = AxisGrading::FineAt::kMinimum;
    } else if (text == "maximum") {
      grading.fine_at = AxisGrading::FineAt::kMaximum;
    } else if (text != "center") {
      value->fail("is " + inQuotes(text) + "; it must be minimum, center or maximum");
    }
  }
  const YamlCursor& growth = map.get("growth");
  grading.growth = growth.number(kGrowthRange);
  const int steps = grading.fine_at == AxisGrading::FineAt::kCenter ? (cells - 1) / 2 : cells - 1;
  const double ratio = std::pow(grading.growth, steps);
  if (!(ratio <= kMaxCellRatio)) {
    growth.fail("makes the largest of " + std::to_string(cells) + " cells " + std::to_string(ratio) +
                " times as long as the smallest; at most 10000 is allowed; lower growth or cells");
  }
  return grading;
}

BlockDescription parseBlock(const YamlCursor& cursor) {
  const YamlMap map = cursor.map(MapKind::kBlock);
  BlockDescription block;
  block.size_m = map.get("size_m").vector3(kBlockSizeRange);
  const YamlCursor& cells = map.get("cells");
  const std::vector<YamlCursor> counts = cells.tuple(3);
  int tetrahedra = kTetrahedraPerCell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block.cells[axis] = counts[axis].integer(1, kMaxCellsPerAxis);
    tetrahedra *= block.cells[axis];  // at most 5 * 200^3, well inside an int
  }
  if (tetrahedra > kMaxTetrahedra) {
    cells.fail("makes " + std::to_string(tetrahedra) + " tetrahedra (5 per cell); at most " +
               std::to_string(kMaxTetrahedra) + " are allowed; use fewer cells or grading");
  }
  if (const YamlCursor* value = map.find("grading")) {
    const YamlMap axes = value->map(MapKind::kGrading);
    const std::array<const char*, 3> names = {"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (const YamlCursor* given = axes.find(names[axis])) {
        block.grading[axis] = parseAxisGrading(*given, block.cells[axis]);
      }
    }
  }
  return block;
}

MeshDescription parseMesh(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map(MapKind::kMesh);
  MeshDescription mesh;
  mesh.file = parseFile(map.get("file"), paths, {".msh", ".vtk"});
  if (const YamlCursor* value = map.find("scale_m_per_unit")) mesh.scale_m_per_unit = value->number(kScaleRange);
  if (const YamlCursor* value = map.find("remove_unreferenced_nodes")) {
    mesh.remove_unreferenced_nodes = value->boolean();
  }
  return mesh;
}

MaterialDescription parseMaterial(const YamlCursor& cursor) {
  const YamlMap map = cursor.map(MapKind::kMaterial);
  MaterialDescription material;
  if (const YamlCursor* value = map.find("model")) {
    const std::string text = value->text();
    if (text == "linear") {
      material.model = ElasticModel::kLinear;
    } else if (text != "corotational") {
      value->fail("is " + inQuotes(text) + "; it must be linear or corotational");
    }
  }
  material.youngs_modulus_pa = map.get("youngs_modulus_pa").number(kYoungRange);
  material.poissons_ratio = map.get("poissons_ratio").number(kPoissonRange);
  material.density_kg_per_m3 = map.get("density_kg_per_m3").number(kDensityRange);
  return material;
}

DampingDescription parseDamping(const YamlCursor& cursor) {
  const YamlMap map = cursor.map(MapKind::kDamping);
  DampingDescription damping;
  if (const YamlCursor* value = map.find("mass_per_s")) damping.mass_per_s = value->number(kMassDampingRange);
  if (const YamlCursor* value = map.find("stiffness_s")) damping.stiffness_s = value->number(kStiffnessDampingRange);
  return damping;
}

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
  const YamlCursor& normal = map.get("normal");
  plane.normal = normal.vector3(kNormalRange);
  const double length = plane.normal.norm();
  if (!(length >= 1e-6)) normal.fail("has length " + std::to_string(length) + "; it must point somewhere: [0, 0, 1]");
  plane.normal /= length;
  return plane;
}

Region parseFixedRegion(const YamlCursor& cursor) {
  const YamlMap map = cursor.map(MapKind::kFixedRegion);
  const std::string kind = map.exactlyOne({"box", "plane", "sphere"});
  const YamlCursor& value = map.get(kind);
  if (kind == "box") return parseBoxRegion(value);
  if (kind == "plane") return parsePlaneRegion(value);
  const YamlMap sphere = value.map(MapKind::kFixedSphere);
  return SphereRegion{sphere.get("center_m").vector3(kPositionRange), sphere.get("radius_m").number(kShapeSizeRange)};
}

}  // namespace

TissueDescription parseTissue(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map(MapKind::kTissue);
  TissueDescription tissue;
  tissue.name = parseName(map.get("name"));
  if (map.exactlyOne({"block", "mesh"}) == "block") {
    tissue.geometry = parseBlock(map.get("block"));
  } else {
    tissue.geometry = parseMesh(map.get("mesh"), paths);
  }
  if (const YamlCursor* value = map.find("pose")) tissue.pose = parsePose(*value, MapKind::kPose);
  tissue.material = parseMaterial(map.get("material"));
  if (const YamlCursor* value = map.find("damping")) tissue.damping = parseDamping(*value);
  if (const YamlCursor* value = map.find("fixed")) {
    for (const YamlCursor& region : value->list(0)) tissue.fixed.push_back(parseFixedRegion(region));
  }
  return tissue;
}

}  // namespace tissue_contact
