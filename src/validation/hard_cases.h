/// @file
/// Room `validation`: cases that break simulators: extreme materials, steps, friction, geometry and motion. Each states the
/// band its force must stay in.
#pragma once

namespace tissue_contact {

class Report;

}  // namespace tissue_contact
