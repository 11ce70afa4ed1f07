/// @file
/// Room `validation`: a mesh file that a scene reads and that is gone afterwards.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace tissue_contact {

/// Exists in the system's temporary directory while this object does. The name holds the process, so that the same case
/// may run twice at a time.
class TemporaryFile {
 public:
  /// @param name with its ending, which tells the format.
  TemporaryFile(const std::string& name, const std::string& text)
      : path_((std::filesystem::temp_directory_path() / ("tissue_contact_" + std::to_string(getpid()) + "_" + name))
                  .string()) {
    std::ofstream file(path_);
    file << text;
    if (!file.flush()) throw std::runtime_error("cannot write " + path_ + ": is the temporary directory full?");
  }
  ~TemporaryFile() { std::remove(path_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace tissue_contact
