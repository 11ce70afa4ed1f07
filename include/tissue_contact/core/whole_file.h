/// @file
/// Room `core`: a result file that is written whole or not at all, and that replaces nothing but a result.
#pragma once

#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace tissue_contact {

class PartFile;

/// What was to be written was not, by no fault of what was asked for: the disk is full, say.
class WriteError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writes into a file without a name (where the file system has none: under an unpredictable name beside the target that
/// says "partial") and gives it the target's name when complete. So the target is never half a result, whatever ends the
/// program; of two writers the last wins, and both write whole files. An existing target must be a regular file that may
/// be written; its permissions are kept. Symbolic links are refused, since replacing one leaves the file behind it as it was
/// and writing through it lets a planted link choose what is destroyed.
class WholeFile {
 public:
  /// @throws std::invalid_argument when the target is no regular file or no file can be made beside it, naming the file and
  ///   the reason.
  explicit WholeFile(const std::string& file);
  /// Leaves no trace unless it was committed.
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  /// Numbers have as many digits as a double needs to be read back to the same bits. A write that fails throws
  /// WriteError naming the file and the reason.
  std::ostream& stream() { return stream_; }

  /// By which a library that opens files by name writes into it, in place of the stream. Valid in this process, until the file has its
  /// name.
  std::string path() const;

  /// Hands all to the system, so that of several files none takes its place when one does not fit on the disk.
  /// @throws std::runtime_error naming the file and the reason.
  void finish();

  /// Finishes and takes the target's place.
  /// @throws as finish().
  void commit();

  /// The same for what is only a part of the result: takes the place of the target's name with kPartialEnding behind it.
  void commitPartial();
  static constexpr const char* kPartialEnding = ".partial";

 private:
  std::unique_ptr<PartFile> part_;
  std::ostream stream_;
};

/// A file by the role in which the user named it, such as {"--csv", "out.csv"}; an empty path is no file.
struct NamedFile {
  std::string role;
  std::string path;
};

/// Refuses outputs that are no place for a result (see WholeFile), that are one of the inputs or each other: the same
/// file by whatever path, symbolic or hard link. Creates nothing.
/// @throws std::invalid_argument naming both files by role and path.
void requireFreeOutputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs);

/// Hands what was printed to the system.
/// @throws std::runtime_error naming the reason when that fails, or has before.
void requireWritten(std::ostream& standard_output);

}  // namespace tissue_contact
