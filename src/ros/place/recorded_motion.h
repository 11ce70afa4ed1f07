/// @file
/// Room `ros/place`, private: instruments moved by a bag through empty space. A scene and a bag in; joint positions and link poses out.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/scene_environment.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Plays the bag as the replay does, without tissues.
/// @param take gets the instruments at every moment, with its stamp.
/// @throws std::exception as the replay of that bag.
void playMotion(const Scene& scene, const SceneEnvironment& environment, const std::string& bag_file,
                const std::function<void(std::int64_t stamp_ns, const Simulator& instruments)>& take);

}  // namespace tissue_contact
