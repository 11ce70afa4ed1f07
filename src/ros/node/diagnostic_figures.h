/// @file
/// Room `ros/node`, private: the keys of /diagnostics (doc/reference.md). Figures in, a status with them out.
#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include "ros/node/live_figures.h"

namespace tissue_contact {

/// @param worst_lag_s of wrenches since the status before.
void addFigures(const LiveFigures& figures, double worst_lag_s, diagnostic_updater::DiagnosticStatusWrapper& status);

}  // namespace tissue_contact
