/// @file
/// Room `core`: see stand_in_file.h. Formats: git-lfs specification version 1 (a text whose first line is the key
/// `version`); git-annex's pointer files ("/annex/objects/<key>") and links (into ".git/annex/objects").
#include "tissue_contact/core/stand_in_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "core/descriptor.h"

namespace tissue_contact {
namespace {

namespace fs = std::filesystem;

bool begins(const std::string& text, const char* with) { return text.rfind(with, 0) == 0; }

std::string beginningOf(const std::string& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "";
  const Descriptor opened(open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  std::string beginning(64, '\0');
  const ssize_t count = opened.isOpen() ? read(opened.number(), beginning.data(), beginning.size()) : 0;
  beginning.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  return beginning;
}

}  // namespace

std::string standInProblem(const std::string& file) {
  const std::string beginning = beginningOf(file);
  if (begins(beginning, "version https://git-lfs") || begins(beginning, "version http://git-media")) {
    return "is a git-lfs pointer, not the data itself; fetch the data in its repository with: git lfs pull";
  }
  std::error_code error;
  const bool annex_link = beginning.empty() && fs::is_symlink(file, error) && !fs::exists(file, error) &&
                          fs::read_symlink(file, error).string().find("annex/objects") != std::string::npos;
  if (annex_link || begins(beginning, "/annex/objects/")) {
    return "stands for data that git-annex keeps elsewhere; fetch the data in its repository with: git annex get";
  }
  return "";
}

}  // namespace tissue_contact
