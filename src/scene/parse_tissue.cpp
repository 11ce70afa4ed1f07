#include "scene/scene_sections.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {
namespace {

constexpr int kMaxCellsPerAxis = 200;
constexpr int kMaxSheetCellsPerAxis = 1000;  // 2 triangles per cell: as many elements as a block may have

constexpr int kMostRefinedNodes = 300'000;

constexpr Range kSizeRange{1e-6, 10.0, "m", "give metres, not millimetres"};
constexpr Range kCellRange{1e-5, 1.0, "m", "give metres: 6 mm is 0.006"};
constexpr double kMostCoarsening = 20.0;
constexpr Range kThicknessRange{1e-6, 1.0, "m", "give metres: 2 mm is 0.002"};
constexpr Range kGrowthRange{1.0, 3.0};
constexpr Range kCellGrowthRange{0.05, 2.0};
constexpr Range kScaleRange{1e-6, 1000.0, "m per file unit", "a file in millimetres has 0.001"};
constexpr Range kAreaStiffnessRange{1.0, 1e12, "Pa/m", "give N/m per m^2: 1 N/mm on 1 cm^2 is 1e7"};
constexpr Range kNodeStiffnessRange{1e-6, 1e9, "N/m", "give newtons per metre: 1 N/mm is 1000"};
constexpr Range kPressureRange{-1e7, 1e7, "Pa", "give pascals: 12 mmHg is 1600"};
constexpr std::pair<const char*, AxisGrading::FineAt> kFineAt[] = {{"minimum", AxisGrading::FineAt::kMinimum},
                                                                   {"center", AxisGrading::FineAt::kCenter},
                                                                   {"maximum", AxisGrading::FineAt::kMaximum}};
constexpr std::pair<const char*, CoincidentNodes> kCoincidentNodes[] = {
    {"refuse", CoincidentNodes::kRefuse}, {"merge", CoincidentNodes::kMerge}, {"keep", CoincidentNodes::kKeep}};

AxisGrading parseAxisGrading(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  AxisGrading grading;
  if (const YamlCursor* value = map.find("fine_at")) grading.fine_at = value->choice(kFineAt);
  grading.growth = map.get("growth").number(kGrowthRange);
  return grading;
}

BlockDescription parseBlock(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  BlockDescription block;
  block.size_m = map.get("size_m").vector3(kSizeRange);
  const std::vector<YamlCursor> counts = map.get("cells").tuple(3);
  for (std::size_t axis = 0; axis < 3; ++axis) block.cells[axis] = counts[axis].integer(1, kMaxCellsPerAxis);
  if (const YamlCursor* value = map.find("grading")) {
    const YamlMap axes = value->map();
    const std::array<const char*, 3> names = {"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (const YamlCursor* given = axes.find(names[axis])) block.grading[axis] = parseAxisGrading(*given);
    }
  }
  atEntry(cursor.path(), [&] { checkBlock(block); });
  return block;
}

/// A surface needs a size of cells, a tetrahedral mesh has its own.
void requireCells(const YamlMap& map, const std::string& file) {
  const std::string ending = lowerExtension(file);
  const bool is_surface = ending != ".msh" && ending != ".vtk";
  if (is_surface && map.find("cell_size_m") == nullptr) {
    map.get("file").fail(
        "is a surface; to fill it with tetrahedra give the edge of the cells as well: cell_size_m: 0.006");
  }
  for (const char* key : {"cell_size_m", "cell_size_inside_m"}) {
    const YamlCursor* value = is_surface ? nullptr : map.find(key);
    if (value != nullptr)
      value->fail("is for surfaces (.stl, .obj, .ply); this file has tetrahedra of its own: remove the key");
  }
  for (const char* key : {"remove_unreferenced_nodes", "coincident_nodes"}) {
    const YamlCursor* value = is_surface ? map.find(key) : nullptr;
    if (value != nullptr) value->fail("is for tetrahedral meshes; a surface that is filled has no such nodes");
  }
}

MeshDescription parseMesh(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map();
  MeshDescription mesh;
  mesh.file = parseFile(map.get("file"), paths, {".msh", ".vtk", ".stl", ".obj", ".ply"},
                        "; to convert tetrahedra of other programs: meshio convert FILE organ.vtk");
  requireCells(map, mesh.file);
  if (const YamlCursor* value = map.find("scale_m_per_unit")) mesh.scale_m_per_unit = value->number(kScaleRange);
  if (const YamlCursor* value = map.find("remove_unreferenced_nodes")) {
    mesh.remove_unreferenced_nodes = value->boolean();
  }
  if (const YamlCursor* value = map.find("coincident_nodes")) mesh.coincident_nodes = value->choice(kCoincidentNodes);
  if (const YamlCursor* value = map.find("cell_size_m")) mesh.cell_size_m = value->number(kCellRange);
  if (const YamlCursor* value = map.find("cell_size_inside_m")) {
    mesh.cell_size_inside_m = value->number(
        Range{mesh.cell_size_m, kMostCoarsening * mesh.cell_size_m, "m", "from cell_size_m to twenty times that"});
  }
  return mesh;
}

SheetDescription parseSheet(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  const std::vector<YamlCursor> size = map.get("size_m").tuple(2);
  const std::vector<YamlCursor> cells = map.get("cells").tuple(2);
  SheetDescription sheet;
  sheet.size_m = Vector2{size[0].number(kSizeRange), size[1].number(kSizeRange)};
  sheet.cells = {cells[0].integer(1, kMaxSheetCellsPerAxis), cells[1].integer(1, kMaxSheetCellsPerAxis)};
  sheet.thickness_m = map.get("thickness_m").number(kThicknessRange);
  return sheet;
}

ShellDescription parseShell(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map();
  ShellDescription shell;
  shell.file = parseFile(map.get("file"), paths, {".stl", ".obj", ".dae"});
  if (const YamlCursor* value = map.find("scale_m_per_unit")) shell.scale_m_per_unit = value->number(kScaleRange);
  shell.thickness_m = map.get("thickness_m").number(kThicknessRange);
  return shell;
}

decltype(TissueDescription::geometry) parseTissueGeometry(const YamlMap& map, const PathContext& paths) {
  const std::string kind = map.exactlyOne({"block", "mesh", "sheet", "shell"});
  const YamlCursor& value = map.get(kind);
  if (kind == "block") return parseBlock(value);
  if (kind == "mesh") return parseMesh(value, paths);
  if (kind == "sheet") return parseSheet(value);
  return parseShell(value, paths);
}

RefinementDescription parseRefinement(const YamlCursor& cursor) {
  using Mode = RefinementDescription::Mode;
  RefinementDescription refinement;
  if (cursor.isScalar()) {
    constexpr std::pair<const char*, Mode> kModes[] = {
        {"never", Mode::kNever}, {"auto", Mode::kAuto}, {"fine", Mode::kFine}};
    refinement.mode = cursor.choice(kModes);
    return refinement;
  }
  const YamlMap map = cursor.map();
  refinement.mode = Mode::kGiven;
  refinement.cell_m = map.get("cell_m").number(kSizeRange);
  if (const YamlCursor* value = map.find("reach_m")) refinement.reach_m = value->number(kSizeRange);
  if (const YamlCursor* value = map.find("growth")) refinement.growth = value->number(kCellGrowthRange);
  if (const YamlCursor* value = map.find("nodes_at_most")) {
    refinement.nodes_at_most = value->integer(1, kMostRefinedNodes);
  }
  return refinement;
}

std::vector<Attachment> parseAttachments(const YamlCursor& cursor) {
  std::vector<Attachment> attachments;
  std::size_t places = 0;
  for (const YamlCursor& element : cursor.list(0, kMostPlaces)) {
    const YamlMap map = element.map();
    Attachment& attachment = attachments.emplace_back();
    attachment.where = parsePlaces(map.get("where"), 1);
    places += attachment.where.size();
    requireFewPlaces(element, "attachment", places);
    if (map.exactlyOne({"stiffness_pa_per_m", "stiffness_n_per_m"}) == "stiffness_pa_per_m") {
      attachment.stiffness_pa_per_m = map.get("stiffness_pa_per_m").number(kAreaStiffnessRange);
    } else {
      attachment.stiffness_n_per_m = map.get("stiffness_n_per_m").number(kNodeStiffnessRange);
    }
  }
  return attachments;
}

}  // namespace

TissueDescription parseTissue(const YamlCursor& cursor, const PathContext& paths) {
  const YamlMap map = cursor.map();
  TissueDescription tissue;
  tissue.name = parseName(map.get("name"));
  tissue.geometry = parseTissueGeometry(map, paths);
  if (const YamlCursor* value = map.find("refinement")) tissue.refinement = parseRefinement(*value);
  if (const YamlCursor* value = map.find("pose")) tissue.pose = parsePose(*value);
  tissue.material = parseMaterial(map.get("material"), isMembrane(tissue));
  if (const MaterialPreset* preset = findPreset(map.get("material"))) {
    tissue.damping.stiffness_s = preset->damping_stiffness_s;
  }
  if (const YamlCursor* value = map.find("damping")) tissue.damping = parseDamping(*value);
  if (const YamlCursor* value = map.find("fibre_direction")) tissue.fibre_direction = parseDirection(*value);
  if (const YamlCursor* value = map.find("regions")) tissue.regions = parseTissueRegions(*value, tissue);
  if (const YamlCursor* value = map.find("fixed")) tissue.fixed = parsePlaces(*value, 0);
  if (const YamlCursor* value = map.find("attachments")) tissue.attachments = parseAttachments(*value);
  if (const YamlCursor* value = map.find("pressure_pa")) tissue.pressure_pa = value->number(kPressureRange);
  if (const YamlCursor* value = map.find("pressure_where")) tissue.pressure_where = parsePlaces(*value, 1);
  atEntry(cursor.path(), [&] { checkTissue(tissue); });
  return tissue;
}

}  // namespace tissue_contact
