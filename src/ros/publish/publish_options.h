/// @file
/// Room `ros`, private: what a scene file says of publishing, and which mesh is published.
#pragma once

#include <string>

#include "tissue_contact/core/range.h"

namespace tissue_contact {

class YamlMap;

constexpr Range kPublishRateRange{0.0, 10000.0, "Hz", "0 switches the topic off"};

/// Rates are of simulated (message) time; 0 switches a topic off.
struct PublishOptions {
  double mesh_rate_hz = 30.0;
  double contacts_rate_hz = 100.0;
  double status_rate_hz = 10.0;
  double markers_rate_hz = 30.0;
  bool tf = false;    ///< publish the instrument links' transforms
  bool crtk = false;  ///< publish wrenches as CRTK has them, beside ours
};

/// Which mesh of tissues that are refined while the simulator runs. A parameter of the node and not of the scene: who looks on, and how
/// well connected, is no matter of what is simulated.
enum class PublishedMesh {
  kRefined,    ///< the one computed with; nodes and surface change
  kUnrefined,  ///< for ever the one at the start, its nodes where those of the refined mesh are
};

inline constexpr const char* kDefaultPublishedMesh = "refined";

/// @return the mesh of that name; @throws std::invalid_argument beginning with `what`.
PublishedMesh toPublishedMesh(const std::string& what, const std::string& name);

/// The section `publish`, defaults for what it does not name.
/// @throws as loadScene(), which may call it (scene/read_more.h).
PublishOptions parsePublish(const YamlMap& file);

}  // namespace tissue_contact
