#include "validation/temporary_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace tissue_contact {
namespace {

/// 0, or what the system says is wrong.
int writeAll(int file, const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = write(file, text.data() + written, text.size() - written);
    if (count < 0 && errno != EINTR) return errno;
    if (count > 0) written += static_cast<std::size_t>(count);
  }
  return 0;
}

}  // namespace

TemporaryFile::TemporaryFile(const std::string& name, const std::string& text)
    : path_((std::filesystem::temp_directory_path() / ("tissue_contact_XXXXXX_" + name)).string()) {
  const int file = mkostemps(path_.data(), static_cast<int>(name.size()) + 1, O_CLOEXEC);
  int error = file < 0 ? errno : writeAll(file, text);
  if (file >= 0 && close(file) != 0 && error == 0) error = errno;
  if (error == 0) return;
  if (file >= 0) unlink(path_.c_str());
  throw std::runtime_error("cannot write '" + path_ + "': " + std::generic_category().message(error));
}

TemporaryFile::~TemporaryFile() { unlink(path_.c_str()); }

}  // namespace tissue_contact
