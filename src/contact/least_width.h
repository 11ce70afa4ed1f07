/// @file
/// Room `contact`, private: how thin a tissue is. Its surface at rest in; a length out.
#pragma once

#include "mesh/surface/moving_surface.h"

namespace tissue_contact {

/// Least width at rest along the world's axes and the surface's own principal ones, m: a flat layer has its thickness, whichever way it lies,
/// all else more. Allocates.
double leastWidth(const MovingSurface& surface);

}  // namespace tissue_contact
