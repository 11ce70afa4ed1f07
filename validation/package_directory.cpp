#include "validation/package_directory.h"

#include <filesystem>
#include <system_error>

namespace tissue_contact {

std::string packageDirectory() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  // <prefix>/lib/tissue_contact/<program>, <prefix>/share/tissue_contact
  const std::filesystem::path share = program.parent_path().parent_path().parent_path() / "share" / "tissue_contact";
  if (!error && std::filesystem::exists(share / "urdf" / "probe.urdf", error)) return share.string();
  return TISSUE_CONTACT_SOURCE_DIR;
}

}  // namespace tissue_contact
