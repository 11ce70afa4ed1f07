#include "tissue_contact/simulation/scene.h"

#include <algorithm>

#include "tissue_contact/core/entry_error.h"

namespace tissue_contact {

bool takesUrdfFromParameter(const Scene& scene) {
  const auto takes_it = [](const InstrumentDescription& one) { return !one.robot_description_parameter.empty(); };
  return std::any_of(scene.instruments.begin(), scene.instruments.end(), takes_it);
}

std::string placeOf(const Scene& scene, const std::string& entry) {
  std::string place = scene.file;
  std::string around = entry;
  while (!around.empty() && scene.entry_lines.count(around) == 0) {
    const std::size_t end = around.find_last_of(".[");
    around.resize(end == std::string::npos ? 0 : end);
  }
  const auto found = scene.entry_lines.find(around);
  if (found != scene.entry_lines.end()) place += found->second > 0 ? ":" + std::to_string(found->second) : " (--set)";
  const std::string shown = entry.empty() ? "scene" : entry;
  return place.empty() ? shown : place + ": " + shown;
}

void requireLawForPair(const FrictionDescription& pair, bool has_fibre) {
  using Law = FrictionLawDescription;
  const bool is_tool = !pair.instrument.empty();
  if (!is_tool && pair.law.axis == Law::Axis::kLink) {
    throw EntryError("axis", "tissue against tissue has no link; it must be fibre");
  }
  if (!is_tool && (pair.law.kind == Law::Kind::kTable || pair.law.kind == Law::Kind::kTensor)) {
    throw EntryError("law",
                     "works for an instrument on a tissue only; between tissues give isotropic, orthotropic or "
                     "asymmetric");
  }
  if (pair.law.axis == Law::Axis::kFibre && !has_fibre) {
    throw EntryError("axis", "is the tissue's fibre direction, which is not given; add fibre_direction to the tissue" +
                                 std::string(is_tool ? " or give {link_direction: [x, y, z]}" : ""));
  }
}

}  // namespace tissue_contact
