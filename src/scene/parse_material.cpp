#include <set>
#include <stdexcept>

#include "scene/scene_ranges.h"
#include "scene/scene_sections.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

constexpr Range kDensityRange{1.0, 1e5, "kg/m^3", "give kilograms per cubic metre: water is 1000, not 1"};
constexpr Range kBendingRange{0.0, 1e6, "N m", "0 bends freely; leave it out for a plate of the given thickness"};
constexpr Range kLabelRange{-1e300, 1e300};

constexpr std::pair<const char*, Dilatation> kDilatations[] = {
    {"auto", Dilatation::kAuto}, {"element", Dilatation::kElement}, {"patch", Dilatation::kPatch}};
constexpr std::pair<const char*, Distortion> kDistortions[] = {
    {"auto", Distortion::kAuto}, {"element", Distortion::kElement}, {"patch", Distortion::kPatch}};

BoxRegion parseBoxRegion(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  BoxRegion box;
  box.min_m = map.get("min_m").vector3(kPositionRange);
  box.max_m = map.get("max_m").vector3(kPositionRange);
  if ((box.min_m.array() > box.max_m.array()).any()) {
    cursor.fail("has a min_m greater than its max_m; min_m must be <= max_m along each axis; swap them");
  }
  return box;
}

PlaneRegion parsePlaneRegion(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  PlaneRegion plane;
  plane.point_m = map.get("point_m").vector3(kPositionRange);
  plane.normal = parseDirection(map.get("normal"));
  return plane;
}

std::vector<PronyTerm> parsePronySeries(const YamlCursor& cursor) {
  constexpr std::size_t kMostTerms = 8;  // more than measurements of tissue support
  std::vector<PronyTerm> terms;
  for (const YamlCursor& element : cursor.list(1, kMostTerms)) {
    const YamlMap map = element.map();
    terms.push_back(
        {map.get("modulus_ratio").number(PronyTerm::kModulusRatio), map.get("time_s").number(PronyTerm::kTime)});
  }
  return terms;
}

const MaterialPreset& presetAt(const YamlCursor& cursor) {
  const std::string name = cursor.text();
  try {
    return materialPreset(name);
  } catch (const std::invalid_argument& error) {
    cursor.fail(error.what());
  }
}

void setConstants(const MaterialPreset& preset, MaterialDescription& material) {
  material.youngs_modulus_pa = preset.youngs_modulus_pa;
  material.poissons_ratio = preset.poissons_ratio;
  material.density_kg_per_m3 = preset.density_kg_per_m3;
  material.preset = &preset;
}

/// What the map gives of them.
void parseConstants(const YamlMap& map, MaterialDescription& material) {
  if (const YamlCursor* value = map.find("youngs_modulus_pa")) material.youngs_modulus_pa = value->number(kYoungRange);
  if (const YamlCursor* value = map.find("poissons_ratio")) {
    material.poissons_ratio = value->number(MaterialDescription::kPoissonsRatio);
  }
  if (const YamlCursor* value = map.find("density_kg_per_m3"))
    material.density_kg_per_m3 = value->number(kDensityRange);
}

TissueRegion parseTissueRegion(const YamlCursor& cursor, const TissueDescription& tissue) {
  const YamlMap map = cursor.map();
  TissueRegion region;
  region.name = parseName(map.get("name"));
  region.where = parsePlaces(map.get("where"), 1);
  MaterialDescription& material = region.material;
  material = tissue.material;
  if (const YamlCursor* value = map.find("material")) {
    if (const MaterialPreset* preset = findPreset(*value)) setConstants(*preset, material);
    if (!value->isScalar()) parseConstants(value->map(), material);
  }
  region.damping_stiffness_s = tissue.damping.stiffness_s;
  if (const YamlCursor* value = map.find("damping")) {
    region.damping_stiffness_s = value->map().get("stiffness_s").number(kStiffnessDampingRange);
  }
  region.fibre_direction = tissue.fibre_direction;
  if (const YamlCursor* value = map.find("fibre_direction")) region.fibre_direction = parseDirection(*value);
  return region;
}

}  // namespace

Region parseRegion(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  const std::string kind = map.exactlyOne({"box", "plane", "sphere", "group", "cell_data"});
  const YamlCursor& value = map.get(kind);
  if (kind == "group") return GroupRegion{value.text()};
  if (kind == "cell_data") {
    const YamlMap data = value.map();
    return CellDataRegion{data.get("name").text(), data.get("value").number(kLabelRange)};
  }
  if (kind == "box") return parseBoxRegion(value);
  if (kind == "plane") return parsePlaneRegion(value);
  const YamlMap sphere = value.map();
  return SphereRegion{sphere.get("center_m").vector3(kPositionRange), sphere.get("radius_m").number(kShapeSizeRange)};
}

std::vector<Region> parsePlaces(const YamlCursor& cursor, std::size_t fewest) {
  std::vector<Region> places;
  for (const YamlCursor& place : cursor.list(fewest, kMostPlaces)) places.push_back(parseRegion(place));
  return places;
}

void requireFewPlaces(const YamlCursor& element, const std::string& kind, std::size_t places) {
  if (places <= kMostPlaces) return;
  element.fail("with this " + kind + " those of the tissue have " + std::to_string(places) +
               " places in their \"where\"; at most " + std::to_string(kMostPlaces) +
               " are allowed; use fewer, larger ones");
}

MaterialDescription parseMaterial(const YamlCursor& cursor, bool is_membrane) {
  MaterialDescription material;
  material.model = is_membrane ? ElasticModel::kMembrane : ElasticModel::kCorotational;
  if (const MaterialPreset* preset = findPreset(cursor)) setConstants(*preset, material);
  if (cursor.isScalar()) return material;
  const YamlMap map = cursor.map();
  if (const YamlCursor* value = map.find("model")) material.model = value->choice(kElasticModelNames);
  if (const YamlCursor* value = map.find("dilatation")) material.dilatation = value->choice(kDilatations);
  if (const YamlCursor* value = map.find("distortion")) material.distortion = value->choice(kDistortions);
  if (map.find("preset") == nullptr) {
    for (const char* key : {"youngs_modulus_pa", "poissons_ratio", "density_kg_per_m3"}) map.get(key);
  }
  parseConstants(map, material);
  if (const YamlCursor* value = map.find("prony_series")) material.prony_series = parsePronySeries(*value);
  if (const YamlCursor* value = map.find("bending_stiffness_n_m")) {
    if (!is_membrane) value->fail("only a sheet or shell has a bending stiffness of its own; remove the key");
    material.bending_stiffness_n_m = value->number(kBendingRange);
  }
  return material;
}

const MaterialPreset* findPreset(const YamlCursor& material) {
  if (material.isScalar()) return &presetAt(material);
  const YamlMap map = material.map();
  const YamlCursor* value = map.find("preset");
  return value == nullptr ? nullptr : &presetAt(*value);
}

DampingDescription parseDamping(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  DampingDescription damping;
  if (const YamlCursor* value = map.find("mass_per_s")) damping.mass_per_s = value->number(kMassDampingRange);
  if (const YamlCursor* value = map.find("stiffness_s")) damping.stiffness_s = value->number(kStiffnessDampingRange);
  return damping;
}

std::vector<TissueRegion> parseTissueRegions(const YamlCursor& cursor, const TissueDescription& tissue) {
  std::vector<TissueRegion> regions;
  std::set<std::string> seen;
  std::size_t places = 0;
  for (const YamlCursor& element : cursor.list(0, kMostPlaces)) {
    regions.push_back(parseTissueRegion(element, tissue));
    places += regions.back().where.size();
    requireFewPlaces(element, "region", places);
    if (!seen.insert(regions.back().name).second) {
      element.fail("the name " + inQuotes(regions.back().name) +
                   " is already used; regions of a tissue need different names, and one may have several places in "
                   "its \"where\"");
    }
  }
  return regions;
}

}  // namespace tissue_contact
