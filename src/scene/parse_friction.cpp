#include <algorithm>
#include <set>
#include <tuple>

#include "friction/check_friction_law.h"
#include "scene/scene_ranges.h"
#include "scene/scene_sections.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

using Law = FrictionLawDescription;

constexpr std::size_t kMaxTableEntries = 1000;

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

void parseAxis(const YamlMap& map, Law& law) {
  if (law.kind == Law::Kind::kIsotropic) {
    if (const YamlCursor* axis = map.find("axis")) {
      axis->fail(
          "isotropic friction has no axis; remove it, or give an anisotropic law: orthotropic, asymmetric, table "
          "or tensor");
    }
    return;
  }
  const YamlCursor& axis = map.get("axis");
  law.axis = axis.isScalar() ? Law::Axis::kFibre : Law::Axis::kLink;
  if (!axis.isScalar()) law.link_axis = parseDirection(axis.map().get("link_direction"));
  if (axis.isScalar() && axis.text() != "fibre") {
    axis.fail("is " + inQuotes(axis.text()) + "; it must be fibre or {link_direction: [x, y, z]}");
  }
}

/// The lists of one factor over another quantity; none where neither key is given.
void parseFactors(const YamlMap& map, const std::string& over, const Range& over_range, std::vector<double>& values,
                  const std::string& factor, const Range& factor_range, std::vector<double>& factors) {
  if (map.find(over) == nullptr && map.find(factor) == nullptr) return;
  values = numbers(map.get(over).list(2, kMaxTableEntries), over_range);
  factors = numbers(map.get(factor).tuple(values.size(), "numbers, one for each of " + over), factor_range);
}

Law parseLaw(const YamlMap& map) {
  Law law;
  if (const YamlCursor* value = map.find("law")) law.kind = value->choice(kFrictionLawNames);
  if (law.kind == Law::Kind::kTable) {
    law.angles_rad = numbers(map.get("angles_rad").list(2, kMaxTableEntries), Law::kAngles);
  } else if (const YamlCursor* value = map.find("angles_rad")) {
    value->fail("is for the law table only; remove it or give law: table");
  }
  law.static_coefficients = parseCoefficients(map.get("static"), law);
  const YamlCursor* kinetic = map.find("kinetic");
  law.kinetic_coefficients = kinetic == nullptr ? law.static_coefficients : parseCoefficients(*kinetic, law);
  parseAxis(map, law);
  parseFactors(map, "speeds_m_per_s", Law::kSpeeds, law.speeds_m_per_s, "speed_factors", Law::kSpeedFactors,
               law.speed_factors);
  parseFactors(map, "pressures_pa", Law::kPressures, law.pressures_pa, "pressure_factors", Law::kPressureFactors,
               law.pressure_factors);
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
  const YamlMap map = cursor.map();
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
  friction.law = parseLaw(map);
  atEntry(cursor.path(), [&] {
    requireLawForPair(friction, !fibre.isZero());
    checkFrictionLaw(friction.law);
  });
  return friction;
}

}  // namespace

std::vector<TissuePair> parseTissuePairs(const YamlCursor& cursor, const Scene& scene) {
  std::vector<TissuePair> pairs;
  std::set<std::pair<std::string, std::string>> seen;
  for (const YamlCursor& element : cursor.list(0, kMostPairs)) {
    const YamlMap map = element.map();
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
    const std::string other = pair.instrument + pair.other_tissue;  // one of the two is empty
    // A region is one of `tissue`; both tissues may have one of that name.
    const auto sides = pair.region.empty() ? unordered(other, pair.tissue) : std::pair(other, pair.tissue);
    if (!seen.emplace(sides.first, pair.link, sides.second, pair.region).second) {
      element.fail("the pair " + inQuotes(other) + " and " + inQuotes(pair.tissue) +
                   (pair.link.empty() ? "" : ", link " + inQuotes(pair.link)) +
                   (pair.region.empty() ? "" : ", region " + inQuotes(pair.region)) + " is given twice; remove one");
    }
  }
  return pairs;
}

}  // namespace tissue_contact
