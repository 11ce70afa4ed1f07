#include <algorithm>
#include <set>
#include <tuple>

#include "scene_sections.h"

namespace tissue_contact {
namespace {

using Law = FrictionLawDescription;

constexpr Range kCoefficientRange{0.0, 10.0};
constexpr Range kTensorRange{-10.0, 10.0};
constexpr Range kAngleRange{0.0, 6.283185307179586, "rad", "give radians from 0 to below 2 pi", false, true};
constexpr Range kSpeedRange{0.0, 1000.0, "m/s"};
constexpr Range kFactorRange{0.0, 1.0, "", "kinetic friction must not exceed the static one"};
constexpr std::size_t kMaxTableEntries = 1000;

constexpr std::pair<const char*, Law::Kind> kLaws[] = {{"isotropic", Law::Kind::kIsotropic},
                                                       {"orthotropic", Law::Kind::kOrthotropic},
                                                       {"asymmetric", Law::Kind::kAsymmetric},
                                                       {"table", Law::Kind::kTable},
                                                       {"tensor", Law::Kind::kTensor}};

template <typename Element>
std::vector<std::string> namesOf(const std::vector<Element>& list) {
  std::vector<std::string> names;
  names.reserve(list.size());
  for (const Element& element : list) names.push_back(element.name);
  return names;
}

/// Index of the name at `cursor` among `names`, which `owner` has.
std::size_t parseReference(const YamlCursor& cursor, const std::string& what, const std::vector<std::string>& names,
                           const std::string& owner) {
  const std::string name = cursor.text();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    cursor.fail("unknown " + what + " " + inQuotes(name) + "; " + suggestion(name, names) + owner + " has " +
                (names.empty() ? "none" : joined(names)));
  }
  return static_cast<std::size_t>(found - names.begin());
}

const TissueDescription& parseTissueName(const YamlCursor& cursor, const Scene& scene) {
  return scene.tissues[parseReference(cursor, "tissue", namesOf(scene.tissues), "the scene")];
}

/// Two names in an order of their own, so that a pair is the same whichever comes first.
std::pair<std::string, std::string> unordered(const std::string& a, const std::string& b) { return std::minmax(a, b); }

std::vector<double> numbers(const std::vector<YamlCursor>& list, const Range& range) {
  std::vector<double> values;
  values.reserve(list.size());
  for (const YamlCursor& element : list) values.push_back(element.number(range));
  return values;
}

/// A table's first column: it begins at 0, each value is greater than the one before.
std::vector<double> parseAscending(const YamlCursor& cursor, const Range& range) {
  const std::vector<YamlCursor> list = cursor.list(2, kMaxTableEntries);
  std::vector<double> values = numbers(list, range);
  if (values.front() != 0.0) list.front().fail("is the first value of a table; it must be 0; begin the table at 0");
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (!(values[i] > values[i - 1])) list[i].fail("is not greater than the value before it; sort the table");
  }
  return values;
}

std::vector<double> parseCoefficients(const YamlCursor& cursor, const Law& law) {
  switch (law.kind) {
    case Law::Kind::kIsotropic:
      return {cursor.number(kCoefficientRange)};
    case Law::Kind::kOrthotropic:
      return numbers(cursor.tuple(2, "numbers: along the axis, across it"), kCoefficientRange);
    case Law::Kind::kAsymmetric:
      return numbers(cursor.tuple(3, "numbers: forward, backward, sideways"), kCoefficientRange);
    case Law::Kind::kTable:
      return numbers(cursor.tuple(law.angles_rad.size(), "numbers, one for each of angles_rad"), kCoefficientRange);
    case Law::Kind::kTensor:
      break;
  }
  std::vector<double> entries;
  for (const YamlCursor& row : cursor.tuple(2, "rows [[m11, m12], [m21, m22]]")) {
    for (const double entry : numbers(row.tuple(2), kTensorRange)) entries.push_back(entry);
  }
  return entries;
}

/// A tensor's limits are compared where its law is built: they do not follow from its entries one by one.
void checkStaticNotBelowKinetic(const YamlCursor& cursor, const Law& law) {
  if (law.kind == Law::Kind::kTensor) return;
  for (std::size_t i = 0; i < law.static_coefficients.size(); ++i) {
    if (law.static_coefficients[i] >= law.kinetic_coefficients[i]) continue;
    (cursor.isScalar() ? cursor : cursor.list(0)[i])
        .fail("the static coefficient is smaller than the kinetic one; it must be >= kinetic; swap or equal them");
  }
}

void parseAxis(const YamlMap& map, bool has_fibre, bool has_link, Law& law) {
  if (law.kind == Law::Kind::kIsotropic) {
    if (const YamlCursor* axis = map.find("axis")) {
      axis->fail(
          "isotropic friction has no axis; remove it, or give an anisotropic law: orthotropic, asymmetric, table "
          "or tensor");
    }
    return;
  }
  const YamlCursor& axis = map.get("axis");
  if (!axis.isScalar()) {
    const Vector3 direction = parseDirection(axis.map(MapKind::kFrictionAxis).get("link_direction"));
    if (!has_link) axis.fail("tissue against tissue has no link; it must be fibre");
    law.axis = Law::Axis::kLink;
    law.link_axis = direction;
    return;
  }
  if (axis.text() != "fibre") {
    axis.fail("is " + inQuotes(axis.text()) + "; it must be fibre or {link_direction: [x, y, z]}");
  }
  if (!has_fibre) {
    axis.fail("is the tissue's fibre direction, which is not given; add fibre_direction to the tissue" +
              std::string(has_link ? " or give {link_direction: [x, y, z]}" : ""));
  }
  law.axis = Law::Axis::kFibre;
}

void parseSpeeds(const YamlMap& map, Law& law) {
  const YamlCursor* speeds = map.find("speeds_m_per_s");
  const YamlCursor* factors = map.find("speed_factors");
  if (speeds == nullptr && factors == nullptr) return;
  law.speeds_m_per_s = parseAscending(map.get("speeds_m_per_s"), kSpeedRange);
  law.speed_factors =
      numbers(map.get("speed_factors").tuple(law.speeds_m_per_s.size(), "numbers, one for each of speeds_m_per_s"),
              kFactorRange);
}

Law parseLaw(const YamlMap& map, bool has_fibre, bool has_link) {
  Law law;
  if (const YamlCursor* value = map.find("law")) law.kind = value->choice(kLaws);
  if (law.kind == Law::Kind::kTable) {
    law.angles_rad = parseAscending(map.get("angles_rad"), kAngleRange);
  } else if (const YamlCursor* value = map.find("angles_rad")) {
    value->fail("is for the law table only; remove it or give law: table");
  }
  const YamlCursor& static_cursor = map.get("static");
  law.static_coefficients = parseCoefficients(static_cursor, law);
  const YamlCursor* kinetic = map.find("kinetic");
  law.kinetic_coefficients = kinetic == nullptr ? law.static_coefficients : parseCoefficients(*kinetic, law);
  checkStaticNotBelowKinetic(static_cursor, law);
  parseAxis(map, has_fibre, has_link, law);
  parseSpeeds(map, law);
  return law;
}

void parseInstrumentSide(const YamlMap& map, const Scene& scene, FrictionDescription& friction) {
  const InstrumentDescription& instrument =
      scene.instruments[parseReference(map.get("instrument"), "instrument", namesOf(scene.instruments), "the scene")];
  friction.instrument = instrument.name;
  if (const YamlCursor* value = map.find("link")) {
    std::vector<std::string> links;
    for (const ContactLinkDescription& link : instrument.contact_links) links.push_back(link.link);
    friction.link = links[parseReference(*value, "link", links, "contact_links of " + instrument.name)];
  }
}

void parseTissueSide(const YamlMap& map, const Scene& scene, FrictionDescription& friction) {
  const YamlCursor& cursor = map.get("other_tissue");
  friction.other_tissue = parseTissueName(cursor, scene).name;
  if (const YamlCursor* value = map.find("link")) {
    value->fail("is for pairs with an instrument only; remove it or give \"instrument\" in place of \"other_tissue\"");
  }
  const auto wanted = unordered(friction.tissue, friction.other_tissue);
  const auto is_wanted = [&wanted](const TissuePair& pair) { return unordered(pair.tissue, pair.other) == wanted; };
  if (std::none_of(scene.tissue_pairs.begin(), scene.tissue_pairs.end(), is_wanted)) {
    cursor.fail(inQuotes(friction.tissue) + " and " + inQuotes(friction.other_tissue) +
                " are not among tissue_pairs, so they never touch; add {tissue: " + friction.tissue +
                ", other: " + friction.other_tissue + "} there");
  }
}

FrictionDescription parseFriction(const YamlCursor& cursor, const Scene& scene) {
  const YamlMap map = cursor.map(MapKind::kFriction);
  const bool has_instrument = map.exactlyOne({"instrument", "other_tissue"}) == "instrument";
  FrictionDescription friction;
  const TissueDescription& tissue = parseTissueName(map.get("tissue"), scene);
  friction.tissue = tissue.name;
  if (has_instrument) {
    parseInstrumentSide(map, scene, friction);
  } else {
    parseTissueSide(map, scene, friction);
  }
  Vector3 fibre = tissue.fibre_direction;
  if (const YamlCursor* value = map.find("region")) {
    const TissueRegion& region =
        tissue.regions[parseReference(*value, "region", namesOf(tissue.regions), "tissue " + tissue.name)];
    friction.region = region.name;
    fibre = region.fibre_direction;
  }
  friction.law = parseLaw(map, !fibre.isZero(), has_instrument);
  if (!has_instrument && (friction.law.kind == Law::Kind::kTable || friction.law.kind == Law::Kind::kTensor)) {
    // Two points of two tissues may meet as a contact of either; only laws that axis 1 mirrors are the same in both.
    map.get("law").fail(
        "works for an instrument on a tissue only; between tissues give isotropic, orthotropic or asymmetric");
  }
  return friction;
}

}  // namespace

std::vector<TissuePair> parseTissuePairs(const YamlCursor& cursor, const Scene& scene) {
  std::vector<TissuePair> pairs;
  std::set<std::pair<std::string, std::string>> seen;
  for (const YamlCursor& element : cursor.list(0, kMostPairs)) {
    const YamlMap map = element.map(MapKind::kTissuePair);
    pairs.push_back({parseTissueName(map.get("tissue"), scene).name, parseTissueName(map.get("other"), scene).name});
    const TissuePair& pair = pairs.back();
    if (!seen.insert(unordered(pair.tissue, pair.other)).second) {
      element.fail("the pair " + inQuotes(pair.tissue) + " and " + inQuotes(pair.other) +
                   " is given twice (the order does not matter); remove one");
    }
  }
  return pairs;
}

std::vector<FrictionDescription> parseFrictionPairs(const YamlCursor& cursor, const Scene& scene) {
  std::vector<FrictionDescription> pairs;
  std::set<std::tuple<std::string, std::string, std::string, std::string>> seen;
  for (const YamlCursor& element : cursor.list(0, kMostPairs)) {
    pairs.push_back(parseFriction(element, scene));
    const FrictionDescription& pair = pairs.back();
    const auto sides = unordered(pair.instrument + pair.other_tissue, pair.tissue);  // one of the two first is empty
    if (!seen.emplace(sides.first, pair.link, sides.second, pair.region).second) {
      element.fail("the pair " + inQuotes(pair.instrument + pair.other_tissue) + " and " + inQuotes(pair.tissue) +
                   (pair.link.empty() ? "" : ", link " + inQuotes(pair.link)) +
                   (pair.region.empty() ? "" : ", region " + inQuotes(pair.region)) + " is given twice; remove one");
    }
  }
  return pairs;
}

}  // namespace tissue_contact
