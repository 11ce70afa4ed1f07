#include "tissue_contact/scene/tuning.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <stdexcept>
#include <utility>

#include "friction/check_friction_law.h"
#include "scene/scene_ranges.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {
namespace {

/// Where a number stands in a scene.
struct Place {
  std::string key;
  std::string text;
  Range range;
  double* number = nullptr;
  int* whole = nullptr;                 ///< in place of `number`
  std::vector<double*> followers = {};  ///< of regions, which the scene gives none of their own

  double value() const { return whole != nullptr ? *whole : *number; }
  void set(double value) const {
    if (whole != nullptr) {
      *whole = static_cast<int>(value);
      return;
    }
    *number = value;
    for (double* follower : followers) *follower = value;
  }
};

class Places {
 public:
  explicit Places(Scene& scene) : scene_(scene) {
    for (std::size_t t = 0; t < scene.tissues.size(); ++t) addTissue(t);
    for (FrictionDescription& pair : scene.friction) addFriction(pair);
    SolverDescription& solver = scene.solver;
    all_.push_back(
        {"solver/iterations", "at most so many iterations per step", {1, kMaxIterations}, nullptr, &solver.iterations});
    all_.push_back({"solver/contact_passes",
                    "at most so many passes over the contacts per iteration",
                    {1, kMaxContactPasses},
                    nullptr,
                    &solver.contact_passes});
    all_.push_back(
        {"solver/tolerance",
         "stop when an iteration changes less than this, and all nodes together lack less than twice this (relative)",
         kToleranceRange, &solver.tolerance});
  }

  const std::vector<Place>& all() const { return all_; }

 private:
  void addTissue(std::size_t t) {
    TissueDescription& tissue = scene_.tissues[t];
    const std::string key = "tissues/" + tissue.name + "/";
    const std::string of = " of tissue " + tissue.name;
    const auto first = all_.size();
    addMaterial(key, of, tissue.material, tissue.damping.stiffness_s);
    all_.push_back(
        {key + "damping_mass_per_s", "damping by mass" + of + ", 1/s", kMassDampingRange, &tissue.damping.mass_per_s});
    for (std::size_t r = 0; r < tissue.regions.size(); ++r) {
      const std::string entry = elementOf(elementOf("tissues", t) + ".regions", r);
      addRegion(entry, key, of, tissue.regions[r], first);
    }
  }

  void addMaterial(const std::string& key, const std::string& of, MaterialDescription& material, double& damping_s) {
    all_.push_back(
        {key + "youngs_modulus_pa", "Young's modulus" + of + ", Pa", kYoungRange, &material.youngs_modulus_pa});
    all_.push_back({key + "poissons_ratio", "Poisson's ratio" + of, MaterialDescription::kPoissonsRatio,
                    &material.poissons_ratio});
    all_.push_back(
        {key + "damping_stiffness_s", "damping by stiffness" + of + ", s", kStiffnessDampingRange, &damping_s});
  }

  /// @param entry its path in the scene file. @param first of the places of its tissue, in the order of addMaterial().
  void addRegion(const std::string& entry, const std::string& of_tissue, const std::string& of, TissueRegion& region,
                 std::size_t first) {
    const std::size_t begin = all_.size();
    addMaterial(of_tissue + "regions/" + region.name + "/", ", region " + region.name + of, region.material,
                region.damping_stiffness_s);
    constexpr const char* kGiven[] = {".material.youngs_modulus_pa", ".material.poissons_ratio",
                                      ".damping.stiffness_s"};
    // `material: NAME` is an entry without any below it.
    const auto below = scene_.entry_lines.lower_bound(entry + ".material.");
    const bool has_keys = below != scene_.entry_lines.end() && below->first.rfind(entry + ".material.", 0) == 0;
    const bool is_by_name = scene_.entry_lines.count(entry + ".material.preset") > 0 ||
                            (scene_.entry_lines.count(entry + ".material") > 0 && !has_keys);
    constexpr std::size_t kOfPreset = 2;  // the first two
    std::size_t place = begin;
    for (std::size_t i = 0; i < std::size(kGiven); ++i) {
      if ((is_by_name && i < kOfPreset) || scene_.entry_lines.count(entry + kGiven[i]) > 0) {
        ++place;
        continue;
      }
      all_[first + i].followers.push_back(all_[place].number);
      all_.erase(all_.begin() + static_cast<std::ptrdiff_t>(place));
    }
  }

  void addFriction(FrictionDescription& pair) {
    if (pair.law.kind == FrictionLawDescription::Kind::kTable) return;
    const auto with = [](const std::string& body, const std::string& part) {
      return part.empty() ? body : body + "." + part;
    };
    const std::string one = pair.instrument.empty() ? pair.other_tissue : with(pair.instrument, pair.link);
    const std::string other = with(pair.tissue, pair.region);
    const std::string key = "friction/" + one + "/" + other + "/";
    const std::string of = " friction coefficient of " + one + " on " + other;
    addCoefficients(key + "static", "static" + of, pair.law, pair.law.static_coefficients);
    addCoefficients(key + "kinetic", "kinetic" + of, pair.law, pair.law.kinetic_coefficients);
  }

  void addCoefficients(const std::string& key, const std::string& text, const FrictionLawDescription& law,
                       std::vector<double>& coefficients) {
    const bool is_tensor = law.kind == FrictionLawDescription::Kind::kTensor;
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      const bool is_only = coefficients.size() == 1;
      all_.push_back(
          {is_only ? key : key + "/" + std::to_string(i),
           is_only ? text : text + ", number " + std::to_string(i) + " of " + std::to_string(coefficients.size()),
           is_tensor ? kTensorRange : kCoefficientRange, &coefficients[i]});
    }
  }

  Scene& scene_;
  std::vector<Place> all_;
};

const Place& placeOfKey(const std::vector<Place>& places, const std::string& key) {
  const auto found = std::find_if(places.begin(), places.end(), [&](const Place& place) { return place.key == key; });
  if (found != places.end()) return *found;
  std::vector<std::string> keys;
  keys.reserve(places.size());
  for (const Place& place : places) keys.push_back(place.key);
  constexpr std::size_t kMaxName = 256;
  const std::string nearest = nearestWord(key, keys);
  throw std::invalid_argument(
      "'" + printable(key, kMaxName) + "' is no number of this scene that may change while it runs; " +
      (nearest.empty() ? "" : "did you mean '" + nearest + "'? ") + "There are " + joined(keys));
}

/// What no number shows by itself.
void checkTogether(const Scene& scene) {
  for (std::size_t t = 0; t < scene.tissues.size(); ++t) {
    atEntry(elementOf("tissues", t), [&] { checkTissue(scene.tissues[t]); });
  }
  for (std::size_t i = 0; i < scene.friction.size(); ++i) {
    atEntry(elementOf("friction", i), [&] { checkFrictionLaw(scene.friction[i].law); });
  }
}

}  // namespace

std::vector<Tunable> tunables(const Scene& scene) {
  Scene copy = scene;
  const Places places(copy);
  std::vector<Tunable> all;
  for (const Place& place : places.all()) {
    all.push_back({place.key, place.text, place.value(), place.range, place.whole != nullptr});
  }
  return all;
}

Scene tuned(const Scene& scene, const std::vector<TunedNumber>& numbers) {
  Scene changed = scene;
  const Places places(changed);
  std::set<std::string> seen;
  for (const TunedNumber& number : numbers) {
    const Place& place = placeOfKey(places.all(), number.key);
    if (!seen.insert(number.key).second) throw std::invalid_argument(number.key + " is given twice; give it once");
    place.range.require(number.key, number.value);
    if (place.whole != nullptr && number.value != std::floor(number.value)) {
      throw std::invalid_argument(number.key + " is " + std::to_string(number.value) + "; it must be a whole number");
    }
    place.set(number.value);
  }
  try {
    checkTogether(changed);
  } catch (const EntryError& error) {
    throw std::invalid_argument(error.entry() + ": " + error.what());
  }
  return changed;
}

std::vector<TunedNumber> differences(const Scene& before, const Scene& now) {
  const std::vector<Tunable> old = tunables(before);
  const std::vector<Tunable> all = tunables(now);
  std::vector<TunedNumber> changes;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].value != old.at(i).value) changes.push_back({all[i].key, all[i].value});
  }
  return changes;
}

}  // namespace tissue_contact
