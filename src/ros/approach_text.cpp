#include "ros/approach_text.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

/// To a tenth of a millimetre, as far as anybody measures a pose.
std::string pointText(const Vector3& p) {
  const auto rounded = [](double x) { return std::round(x * 1e4) / 1e4 + 0.0; };
  std::ostringstream text;
  text << '(' << rounded(p.x()) << ", " << rounded(p.y()) << ", " << rounded(p.z()) << ')';
  return text.str();
}

}  // namespace

bool touchesTissue(const Simulator& simulator) {
  const std::vector<SolvedContact>& contacts = simulator.contacts();
  return std::any_of(contacts.begin(), contacts.end(), [](const SolvedContact& contact) {
    return contact.contact.key.instrument >= 0 && contact.state != ContactState::kOpen;
  });
}

bool beganInContact(const Simulator& simulator, const Approach& start) {
  constexpr double kJustTouching_m = 1e-4;  // as far as anybody measures a pose
  return simulator.stepCount() == 1 && start.distance_m < -kJustTouching_m && touchesTissue(simulator);
}

std::string approachText(const Simulator& simulator, const Approach& approach, std::int64_t stamp_ns) {
  const Instrument& instrument = simulator.instruments()[static_cast<std::size_t>(approach.instrument)];
  const ContactLink& link = instrument.contactLinks()[static_cast<std::size_t>(approach.link)];
  std::ostringstream text;
  text << "closest approach " << approach.distance_m << " m at " << stampText(stamp_ns) << " s: '" << instrument.name()
       << "', link '" << instrument.model().links()[static_cast<std::size_t>(link.link)].name << "', shape "
       << approach.shape + 1 << " of " << link.shapes.size() << ", to tissue '"
       << simulator.scene().tissues[static_cast<std::size_t>(approach.tissue)].name << "' at "
       << pointText(approach.p_W) << " m; a base moved by " << pointText(approach.distance_m * approach.normal_W)
       << " m would make it just touch there";
  return text.str();
}

}  // namespace tissue_contact
