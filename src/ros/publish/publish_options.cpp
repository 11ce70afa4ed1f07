#include "ros/publish/publish_options.h"

#include <stdexcept>
#include <utility>

#include "scene/yaml_reader.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {

PublishOptions parsePublish(const YamlMap& file) {
  PublishOptions publish;
  const YamlCursor* section = file.find("publish");
  if (section == nullptr) return publish;
  const YamlMap map = section->map();
  for (const auto& [key, rate] :
       {std::pair("mesh_rate_hz", &publish.mesh_rate_hz), std::pair("contacts_rate_hz", &publish.contacts_rate_hz),
        std::pair("status_rate_hz", &publish.status_rate_hz), std::pair("markers_rate_hz", &publish.markers_rate_hz)}) {
    if (const YamlCursor* value = map.find(key)) *rate = value->number(kPublishRateRange);
  }
  if (const YamlCursor* value = map.find("tf")) publish.tf = value->boolean();
  if (const YamlCursor* value = map.find("crtk")) publish.crtk = value->boolean();
  return publish;
}

PublishedMesh toPublishedMesh(const std::string& what, const std::string& name) {
  if (name == "refined") return PublishedMesh::kRefined;
  if (name == "unrefined") return PublishedMesh::kUnrefined;
  throw std::invalid_argument(what + " is " + inQuotes(name) + "; it must be refined or unrefined; default " +
                              kDefaultPublishedMesh);
}

}  // namespace tissue_contact
