/// @file
/// Room `core`: a folder of files that can be made again, named by a hash of what they were made from.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/content_hash.h"

namespace tissue_contact {

/// $XDG_CACHE_HOME/tissue_contact, else ~/.cache/tissue_contact; empty (no cache) when neither is set.
std::string userCacheDirectory();

/// Files of one kind, "<key><extension>", in a directory. Nothing here throws: what goes wrong costs time, not the result.
class CacheFolder {
 public:
  /// @param directory made when missing; empty: there is no cache. @param extension with its dot.
  CacheFolder(std::string directory, std::string extension);

  /// Content of a file; empty when there is none, it cannot be read, or everybody may write to the directory.
  std::string read(const std::string& key) const;

  /// Writes a file, whole or not at all, and removes the oldest beyond 256 MB in all.
  /// @return why it cannot; empty when all is well or there is no cache.
  std::string write(const std::string& key, const std::vector<std::string>& pieces) const;

  /// Path of a file, whether it exists or not.
  std::string path(const std::string& key) const;

 private:
  bool isOurs(const std::string& name, const std::string& ending) const;
  void removeOldest() const;

  std::string directory_;
  std::string extension_;
};

}  // namespace tissue_contact
