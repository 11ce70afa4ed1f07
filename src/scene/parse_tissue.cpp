#include <cmath>

#include "scene_sections.h"

namespace tissue_contact {
namespace {

constexpr int kMaxCellsPerAxis = 200;
constexpr int kTetrahedraPerCell = 5;
constexpr int kMaxTetrahedra = 2000000;
constexpr int kMaxSheetCellsPerAxis = 1000;  // 2 triangles per cell: as many elements as a block may have
// Beyond this the smallest cells of a block are slivers whose stiffness drowns the others in round-off.
constexpr double kMaxCellRatio = 1e4;

constexpr Range kSizeRange{1e-6, 10.0, "m", "give metres, not millimetres"};
constexpr Range kThicknessRange{1e-6, 1.0, "m", "give metres: 2 mm is 0.002"};
constexpr Range kGrowthRange{1.0, 3.0};
constexpr Range kScaleRange{1e-6, 1000.0, "m per file unit", "a file in millimetres has 0.001"};
constexpr std::pair<const char*, AxisGrading::FineAt> kFineAt[] = {{"minimum", AxisGrading::FineAt::kMinimum},
                                                                   {"center", AxisGrading::FineAt::kCenter},
                                                                   {"maximum", AxisGrading::FineAt::kMaximum}};

AxisGrading parseAxisGrading(const YamlCursor& cursor, int cells) {
  const YamlMap map = cursor.map(MapKind::kAxisGrading);
  AxisGrading grading;
  if (const YamlCursor* value = map.find("fine_at")) grading.fine_at = value->choice(kFineAt);
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
  block.size_m = map.get("size_m").vector3(kSizeRange);
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

SheetDescription parseSheet(const YamlCursor& cursor) {
  const YamlMap map = cursor.map(MapKind::kSheet);
  const std::vector<YamlCursor> size = map.get("size_m").tuple(2);
  const std::vector<YamlCursor> cells = map.get("cells").tuple(2);
  SheetDescription sheet;
  sheet.size_m = Vector2{size[0].number(kSizeRange), size[1].number(kSizeRange)};
  sheet.cells = {cells[0].integer(1, kMaxSheetCellsPerAxis), cells[1].integer(1, kMaxSheetCellsPerAxis)};
  sheet.thickness_m = map.get("thickness_m").number(kThicknessRange);
  return sheet;
}

ShellDescription parseShell(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map(MapKind::kShell);
  ShellDescription shell;
  shell.file = parseFile(map.get("file"), paths, {".stl", ".obj", ".dae"});
  if (const YamlCursor* value = map.find("scale_m_per_unit")) shell.scale_m_per_unit = value->number(kScaleRange);
  shell.thickness_m = map.get("thickness_m").number(kThicknessRange);
  return shell;
}

decltype(TissueDescription::geometry) parseGeometry(const YamlMap& map, const PathContext& paths) {
  const std::string kind = map.exactlyOne({"block", "mesh", "sheet", "shell"});
  const YamlCursor& value = map.get(kind);
  if (kind == "block") return parseBlock(value);
  if (kind == "mesh") return parseMesh(value, paths);
  if (kind == "sheet") return parseSheet(value);
  return parseShell(value, paths);
}

}  // namespace

TissueDescription parseTissue(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map(MapKind::kTissue);
  TissueDescription tissue;
  tissue.name = parseName(map.get("name"));
  tissue.geometry = parseGeometry(map, paths);
  const bool is_membrane = std::holds_alternative<SheetDescription>(tissue.geometry) ||
                           std::holds_alternative<ShellDescription>(tissue.geometry);
  if (const YamlCursor* value = map.find("pose")) tissue.pose = parsePose(*value, MapKind::kPose);
  tissue.material = parseMaterial(map.get("material"), is_membrane);
  if (const YamlCursor* value = map.find("damping")) tissue.damping = parseDamping(*value);
  if (const YamlCursor* value = map.find("fibre_direction")) tissue.fibre_direction = parseDirection(*value);
  if (const YamlCursor* value = map.find("regions")) tissue.regions = parseTissueRegions(*value, tissue);
  if (const YamlCursor* value = map.find("fixed")) {
    for (const YamlCursor& region : value->list(0, kMostPlaces)) tissue.fixed.push_back(parseRegion(region));
  }
  return tissue;
}

}  // namespace tissue_contact
