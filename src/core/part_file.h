/// @file
/// Room `core` (private): where WholeFile writes to until the file is complete.
#pragma once

#include <sys/stat.h>

#include <optional>
#include <streambuf>
#include <string>
#include <vector>

#include "core/descriptor.h"

namespace tissue_contact {

/// The place of a result: a name in an open directory, which stays the same when the working directory changes or folders
/// are renamed.
struct OutputPlace {
  /// @throws std::invalid_argument when there is no such directory, or something else than a writable regular file.
  explicit OutputPlace(const std::string& file);

  /// Goes on to the place beside this one.
  /// @throws as the constructor.
  void append(const std::string& ending);
  /// Looks again at what has the name.
  /// @throws as the constructor.
  void look();
  bool isSameAs(const OutputPlace& other) const;
  bool isSameAs(const struct stat& file) const;
  [[noreturn]] void refuse(const std::string& why) const;

  std::string path;
  std::string name;
  Descriptor directory;
  struct stat directory_status {};
  std::optional<struct stat> existing;
};

/// Buffered writing to an unfinished file. Failing writes throw WriteError.
class PartFile : public std::streambuf {
 public:
  enum class Kind { kUnnamedIfPossible, kNamed };
  /// @throws std::invalid_argument when the place is bad or the file cannot be made.
  explicit PartFile(const std::string& file, Kind kind = Kind::kUnnamedIfPossible);
  ~PartFile() override;

  /// Writes what is buffered.
  void finish();
  /// Takes the place of the target.
  void place();
  /// Takes the place of the target's name with this behind it.
  void placeBeside(const std::string& ending);
  /// Of the open file, whatever name it has.
  std::string path() const;

 protected:
  int_type overflow(int_type c) override;
  int sync() override;

 private:
  void open(Kind kind);
  void openNamed(mode_t mode);
  void keepPermissions();
  void giveName();
  void writeOut();
  [[noreturn]] void fail(int error) const;

  OutputPlace place_;
  Descriptor file_;
  std::string part_name_;  ///< empty: it has none
  std::vector<char> buffer_;
};

}  // namespace tissue_contact
