/// @file
/// Room `ros`: a result file that is written whole or not at all.
#pragma once

#include <fstream>
#include <string>

namespace tissue_contact {

/// Writes to `<file>.part` and renames it when complete, so that `file` is never half a result. Numbers have as many
/// digits as a double needs to be read back to the same bits.
class WholeFile {
 public:
  /// Opens the part file. @throws std::runtime_error when it cannot be written.
  explicit WholeFile(std::string file);
  /// Removes the part file unless it was committed.
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  std::ostream& stream() { return stream_; }

  /// @throws std::runtime_error when the file could not be written completely.
  void commit();

 private:
  std::string file_;
  std::string part_;
  std::ofstream stream_;
  bool committed_ = false;
};

}  // namespace tissue_contact
