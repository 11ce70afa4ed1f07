#include "tissue_contact/scene/scene.h"

namespace tissue_contact {

std::string placeOf(const Scene& scene, const std::string& entry) {
  std::string place = scene.file;
  std::string around = entry;
  while (!around.empty() && scene.entry_lines.count(around) == 0) {
    const std::size_t end = around.find_last_of(".[");
    around.resize(end == std::string::npos ? 0 : end);
  }
  const auto found = scene.entry_lines.find(around);
  if (found != scene.entry_lines.end()) place += ":" + std::to_string(found->second);
  const std::string shown = entry.empty() ? "scene" : entry;
  return place.empty() ? shown : place + ": " + shown;
}

}  // namespace tissue_contact
