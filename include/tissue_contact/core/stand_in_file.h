/// @file
/// Room `core`: files that stand for data kept elsewhere, as a clone without git-lfs or git-annex leaves them.
#pragma once

#include <string>

namespace tissue_contact {

/// "is a git-lfs pointer ...; fetch it with: git lfs pull" and the like; empty when the file is none of these or cannot
/// be read. Also for a path that does not exist because its link leads into a git-annex store. Reads at most 64 bytes of
/// a regular file, nothing of any other. Never throws for a bad path.
std::string standInProblem(const std::string& file);

}  // namespace tissue_contact
