/// @file
/// Room `mesh`, private: another program, run once, in a folder of its own.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tissue_contact {

struct ProgramLimits {
  unsigned seconds = 0;   ///< wall time
  std::size_t bytes = 0;  ///< address space
};

struct ProgramEnd {
  bool found = true;       ///< false: there is no such program
  bool timed_out = false;  ///< ended by us
  bool well = false;       ///< it returned 0
  std::string output;      ///< what it printed, standard output and error; the first 64 KiB
};

/// Runs `arguments` (no shell: names are names), the first looked up in PATH, and waits for its end.
///
/// It sees neither the user's settings (HOME is the folder), nor his language (LC_ALL=C), nor a terminal, and one thread of
/// OpenMP. It dies with this process. For start-up, not for a step.
/// @param folder its working directory.
/// @throws std::system_error when no process can be started.
ProgramEnd runProgram(const std::vector<std::string>& arguments, const std::string& folder,
                      const ProgramLimits& limits);

/// A folder that exists as long as this object and this process, however that ends, which only its owner may enter.
class ScratchFolder {
 public:
  /// @throws std::system_error when none can be made.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::string& path() const { return path_; }
  std::string path(const std::string& name) const { return path_ + "/" + name; }

 private:
  std::string path_;
  int lives_ = -1;  ///< end of a pipe: closed, the folder goes
};

}  // namespace tissue_contact
