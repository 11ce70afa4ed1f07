/// @file
/// Room `ros`, private: what a scene file says of publishing.
#pragma once

namespace tissue_contact {

class YamlMap;

/// Rates are of simulated (message) time; 0 switches a topic off.
struct PublishOptions {
  double mesh_rate_hz = 30.0;
  double contacts_rate_hz = 100.0;
  double status_rate_hz = 10.0;
  double markers_rate_hz = 30.0;
  bool tf = false;  ///< publish the instrument links' transforms
};

/// The section `publish`, defaults for what it does not name.
/// @throws as loadScene(), which may call it (scene/read_more.h).
PublishOptions parsePublish(const YamlMap& file);

}  // namespace tissue_contact
