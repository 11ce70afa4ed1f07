/// @file
/// Room `validation`: cases with a closed form or a benchmark figure. Sources at the head of each case's file.
#pragma once

namespace tissue_contact {

class Report;

void validateIncline(Report& report);

}  // namespace tissue_contact
