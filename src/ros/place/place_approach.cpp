#include <cstdint>
#include <iostream>
#include <optional>
#include <stdexcept>

#include "ros/approach_text.h"
#include "ros/place/place.h"
#include "ros/place/placed_scene.h"
#include "ros/place/recorded_motion.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {

void placeApproach(const PlaceOptions& options) {
  const PlacedScene placed(options);
  Simulator scene(placed.scene, placed.environment);
  Approach closest;
  std::int64_t closest_ns = 0;
  std::optional<std::int64_t> touched_ns;
  const auto take = [&](std::int64_t stamp_ns, const Simulator& moved) {
    for (std::size_t i = 0; i < moved.instruments().size(); ++i) {
      scene.placeInstrument(static_cast<int>(i), moved.jointPositions(static_cast<int>(i)));
    }
    const double before = closest.distance_m;
    scene.lowerClosestApproach(closest);
    if (closest.distance_m < before) closest_ns = stamp_ns;
    if (!touched_ns && closest.distance_m <= 0.0) touched_ns = stamp_ns;
  };
  playMotion(placed.scene, placed.environment, options.bag_file, take);
  if (closest.tissue < 0) throw std::runtime_error("the scene has no tissue, or no link that touches");
  if (touched_ns) {
    std::cout << "touches the tissue at rest first at " << stampText(*touched_ns) << " s; overlaps it by up to "
              << -closest.distance_m << " m:\n";
  } else {
    std::cout << "never touches:\n";
  }
  std::cout << approachText(scene, closest, closest_ns) << "\n";
}

}  // namespace tissue_contact
