#include "simulation/friction_table.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "tissue_contact/core/entry_error.h"

namespace tissue_contact {

struct FrictionTable::Entry {
  FrictionLawDescription numbers;
  bool is_of_region = false;
  CoulombLaw law;                                          ///< axis and kinetic factor are filled in per contact
  std::unique_ptr<const AnisotropicFriction> anisotropic;  ///< what law.anisotropic points to
};

struct FrictionTable::Surface {
  const Tissue* tissue = nullptr;
  TrianglesOfNodes triangles_of_node;  ///< see trianglesOf()

  /// The surface triangle of a point: of those that share it (an edge, a vertex), the one that faces most against
  /// `outward` (unit). -1 where triangles are not kept.
  int triangleOf(const std::array<int, 3>& nodes, const Vector3& weights, const Vector3& outward,
                 const NodalVectors& x) const {
    if (triangles_of_node.empty()) return -1;
    int anchor = 0;
    weights.maxCoeff(&anchor);
    int best = -1;
    double most = -2.0;  // below every cosine
    for (const int t : triangles_of_node[nodes[anchor]]) {
      const Triangle& triangle = tissue->surface()[t];
      const auto lacks = [&](int i) {
        return weights[i] > 0.0 && std::find(triangle.begin(), triangle.end(), nodes[i]) == triangle.end();
      };
      if (lacks(0) || lacks(1) || lacks(2)) continue;
      const Vector3 first = x.col(triangle[1]) - x.col(triangle[0]);
      const Vector3 second = x.col(triangle[2]) - x.col(triangle[0]);
      const double facing = first.cross(second).normalized().dot(outward);
      if (best >= 0 && !(facing > most)) continue;
      best = t;
      most = facing;
    }
    return best;
  }
};

namespace {

/// An isotropic law as one that depends on direction, with the same friction along both axes.
FrictionLawDescription directional(FrictionLawDescription law) {
  if (law.kind != FrictionLawDescription::Kind::kIsotropic) return law;
  law.kind = FrictionLawDescription::Kind::kOrthotropic;
  law.static_coefficients.resize(2, law.static_coefficients.at(0));
  law.kinetic_coefficients.resize(2, law.kinetic_coefficients.at(0));
  return law;
}

template <typename Named>
int indexOf(const std::vector<Named>& all, const std::string& name, const std::string& kind,
            std::string (*name_of)(const Named&)) {
  std::string known;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (name_of(all[i]) == name) return static_cast<int>(i);
    known += (i == 0 ? "" : ", ") + name_of(all[i]);
  }
  throw std::invalid_argument("friction names the unknown " + kind + " '" + name + "'; there is " +
                              (known.empty() ? "none" : known));
}

std::string nameOfInstrument(const InstrumentDescription& instrument) { return instrument.name; }
std::string nameOfTissue(const TissueDescription& tissue) { return tissue.name; }
std::string nameOfRegion(const TissueRegion& region) { return region.name; }
std::string nameOfLink(const ContactLink& link) { return link.name; }

/// Entries in the order in which later ones replace earlier ones: neither, region, link, link and region.
int specificity(const FrictionDescription& entry) {
  return (entry.link.empty() ? 0 : 2) + (entry.region.empty() ? 0 : 1);
}

}  // namespace

FrictionTable::~FrictionTable() = default;
FrictionTable::FrictionTable(FrictionTable&&) noexcept = default;
FrictionTable& FrictionTable::operator=(FrictionTable&&) noexcept = default;

FrictionTable::FrictionTable(const Scene& scene, const std::vector<Instrument>& instruments,
                             const std::vector<Tissue>& tissues) {
  std::vector<ByRegion> none;
  for (const TissueDescription& tissue : scene.tissues) none.emplace_back(1 + tissue.regions.size(), -1);
  for (const Instrument& instrument : instruments) {
    by_link_.emplace_back(instrument.contactLinks().size(), none);
    std::vector<int>& links = links_.emplace_back();
    for (const ContactLink& link : instrument.contactLinks()) links.push_back(link.link);
  }
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    between_tissues_.emplace_back(tissues.size(), none[t]);
  }
  for (const Tissue& tissue : tissues) surfaces_.push_back({&tissue, trianglesOf(tissue)});
  std::vector<std::size_t> sorted(scene.friction.size());
  std::iota(sorted.begin(), sorted.end(), std::size_t{0});
  std::stable_sort(sorted.begin(), sorted.end(), [&](std::size_t a, std::size_t b) {
    return specificity(scene.friction[a]) < specificity(scene.friction[b]);
  });
  for (const std::size_t i : sorted) {
    atEntry(elementOf("friction", i), [&] { add(scene.friction[i], scene, instruments, tissues); });
  }
}

TrianglesOfNodes FrictionTable::trianglesOf(const Tissue& tissue) {
  return tissue.surfaceRegions().empty() && tissue.surfaceFibres().empty() ? TrianglesOfNodes()
                                                                           : trianglesOfNodes(tissue);
}

void FrictionTable::swapSurface(int index, TrianglesOfNodes& triangles) {
  surfaces_[index].triangles_of_node.swap(triangles);
}

void FrictionTable::add(const FrictionDescription& description, const Scene& scene,
                        const std::vector<Instrument>& instruments, const std::vector<Tissue>& tissues) {
  const int tissue = indexOf(scene.tissues, description.tissue, "tissue", nameOfTissue);
  const TissueDescription& described = scene.tissues[tissue];
  const int region = description.region.empty() ? -1
                                                : indexOf(described.regions, description.region,
                                                          "region of tissue '" + described.name + "'", nameOfRegion);
  requireLawForPair(description, !tissues[tissue].surfaceFibres().empty());
  const int index = static_cast<int>(entries_.size());
  Entry& entry = entries_.emplace_back();
  entry.numbers = scene.advisor.general_friction ? directional(description.law) : description.law;
  entry.is_of_region = region >= 0;
  entry.anisotropic = makeAnisotropicFriction(entry.numbers);
  entry.law.anisotropic = entry.anisotropic.get();
  if (entry.anisotropic == nullptr) {
    entry.law.mu_static = description.law.static_coefficients.at(0);
    entry.law.mu_kinetic = description.law.kinetic_coefficients.at(0);
  }
  const auto put = [&](ByRegion& by_region) {
    if (region >= 0) {
      by_region[1 + region] = index;
    } else {
      std::fill(by_region.begin(), by_region.end(), index);
    }
  };
  if (description.instrument.empty()) {
    const int other = indexOf(scene.tissues, description.other_tissue, "tissue", nameOfTissue);
    put(between_tissues_[tissue][other]);
    return;
  }
  const int instrument = indexOf(scene.instruments, description.instrument, "instrument", nameOfInstrument);
  if (!description.link.empty()) {
    const int link = indexOf(instruments[instrument].contactLinks(), description.link,
                             "contact link of instrument '" + description.instrument + "'", nameOfLink);
    put(by_link_[instrument][link][tissue]);
    return;
  }
  for (std::vector<ByRegion>& of_link : by_link_[instrument]) put(of_link[tissue]);
}

/// The entry of a contact with the surface it names (its regions and fibres count), and how its axis 1 is turned.
FrictionTable::Found FrictionTable::find(const Contact& contact, const std::vector<NodalVectors>& x) const {
  const ContactKey& key = contact.key;
  const Vector3 n = contact.R_WC.col(0);
  const auto in = [&](const ByRegion& by_region, int tissue, const std::array<int, 3>& nodes, const Vector3& weights,
                      double sign) {
    Found found;
    found.tissue = tissue;
    found.triangle = surfaces_[tissue].triangleOf(nodes, weights, -sign * n, x[tissue]);
    found.axis_sign = sign;
    const std::vector<int>& regions = surfaces_[tissue].tissue->surfaceRegions();
    const int index = by_region[found.triangle >= 0 && !regions.empty() ? 1 + regions[found.triangle] : 0];
    if (index >= 0) found.entry = &entries_[index];
    return found;
  };
  if (key.instrument >= 0) {
    return in(by_link_[key.instrument][key.link][key.tissue], key.tissue, contact.nodes, contact.weights, 1.0);
  }
  const Found named =
      in(between_tissues_[key.tissue][key.other_tissue], key.tissue, contact.nodes, contact.weights, 1.0);
  // The contact may have the pair the other way round: the entry's `other_tissue` is what the contact calls `tissue`, so
  // that what moves forward over what is turned round.
  const Found turned = in(between_tissues_[key.other_tissue][key.tissue], key.other_tissue, contact.other_nodes,
                          contact.other_weights, -1.0);
  if (named.entry == nullptr || turned.entry == nullptr) return named.entry != nullptr ? named : turned;
  // Which of the two has the vertex must not count: that of a region, of two such the one listed first.
  if (named.entry->is_of_region != turned.entry->is_of_region) return named.entry->is_of_region ? named : turned;
  return named.entry <= turned.entry ? named : turned;
}

Vector3 FrictionTable::axisOf(const Found& found, const Contact& contact, const std::vector<NodalVectors>& x,
                              const std::vector<std::vector<Pose>>& X_WL) const {
  const ContactKey& key = contact.key;
  if (found.entry->numbers.axis == FrictionLawDescription::Axis::kLink) {
    return X_WL[key.instrument][links_[key.instrument][key.link]].linear() * found.entry->numbers.link_axis;
  }
  const Tissue& tissue = *surfaces_[found.tissue].tissue;
  if (found.triangle < 0 || tissue.surfaceFibres().empty()) return Vector3::Zero();
  const Triangle& nodes = tissue.surface()[found.triangle];
  const Vector2& along = tissue.surfaceFibres()[found.triangle];
  const NodalVectors& p = x[found.tissue];
  return found.axis_sign *
         (along[0] * (p.col(nodes[1]) - p.col(nodes[0])) + along[1] * (p.col(nodes[2]) - p.col(nodes[0])));
}

bool FrictionTable::dependsOnPressure() const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [](const Entry& entry) { return !entry.numbers.pressures_pa.empty(); });
}

CoulombLaw FrictionTable::at(const Contact& contact, const std::vector<NodalVectors>& x,
                             const std::vector<std::vector<Pose>>& X_WL, const ContactBefore& before) const {
  const Found found = find(contact, x);
  const Entry* entry = found.entry;
  if (entry == nullptr) return {};
  CoulombLaw law = entry->law;
  // One factor for both, so that static friction stays the larger one.
  const double of_pressure = pressureFactor(entry->numbers, before.pressure);
  const double of_both = of_pressure * kineticFactor(entry->numbers, before.sliding_speed);
  if (law.anisotropic == nullptr) {
    law.mu_static *= of_pressure;
    law.mu_kinetic *= of_both;
    return law;
  }
  law.static_factor = of_pressure;
  law.kinetic_factor = of_both;
  // An axis along the normal has no direction in the contact plane: the frame's own t1 stands in.
  const Vector2 in_plane = contact.R_WC.rightCols<2>().transpose() * axisOf(found, contact, x, X_WL);
  const double length = in_plane.norm();
  if (length > 0.0) law.axis = in_plane / length;
  return law;
}

}  // namespace tissue_contact
