/// @file
/// Room `validation`: a mesh file that a scene reads and that is gone afterwards.
#pragma once

#include <string>

namespace tissue_contact {

/// Exists in the system's temporary directory (TMPDIR) while this object does. Only its owner may read it, and nobody
/// can foresee its name.
class TemporaryFile {
 public:
  /// @param name with its ending, which tells the format.
  /// @throws std::runtime_error naming the file and the reason when it cannot be written.
  TemporaryFile(const std::string& name, const std::string& text);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace tissue_contact
