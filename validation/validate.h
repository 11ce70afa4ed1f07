/// @file
/// Room `validation`: `tissue_contact_validate`, which runs closed forms and hard cases and prints what came out. Command line
/// in; table, JSON file and exit code out.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace tissue_contact {

/// @param arguments without the program's name. @param out table. @param messages errors, and a progress bar if
///   `show_bar` (a terminal).
/// @return exit code: 0 all within tolerance, 1 something is not, 2 the command line or a file is wrong.
int runValidate(const std::vector<std::string>& arguments, std::ostream& out, std::ostream& messages, bool show_bar);

}  // namespace tissue_contact
