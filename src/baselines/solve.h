/// @file
/// Tool tissue_contact_solve: a contact problem file in; impulses, velocities, states and residuals on a stream out.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace tissue_contact {

/// @param arguments without the program's name.
/// @return exit code: 0 the tolerance is met, 1 it is not, 2 bad usage or input (said on `errors`).
int runSolve(const std::vector<std::string>& arguments, std::ostream& output, std::ostream& errors);

}  // namespace tissue_contact
