#include "tissue_contact/core/cache_folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <system_error>
#include <utility>

#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/whole_file.h"

namespace tissue_contact {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostCacheBytes = std::uintmax_t{256} << 20U;

/// Only the last one is private to us; those above it belong to all programs.
void makeDirectory(const std::string& directory) {
  std::error_code error;
  fs::create_directories(fs::path(directory).parent_path(), error);
  mkdir(directory.c_str(), S_IRWXU);  // where it fails, writing says why
}

/// Why files there are not to be believed; empty when they are.
std::string distrust(const std::string& directory) {
  struct stat status {};
  if (stat(directory.c_str(), &status) != 0 || (status.st_mode & S_IWOTH) == 0) return "";
  return "everybody may write there; chmod o-w it";
}

}  // namespace

std::string userCacheDirectory() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value == nullptr ? "" : value);
  };
  // The specification of these directories: a relative path is to be ignored.
  const std::string cache = variable("XDG_CACHE_HOME");
  if (!cache.empty() && cache.front() == '/') return cache + "/tissue_contact";
  const std::string home = variable("HOME");
  return home.empty() || home.front() != '/' ? "" : home + "/.cache/tissue_contact";
}

CacheFolder::CacheFolder(std::string directory, std::string extension)
    : directory_(std::move(directory)), extension_(std::move(extension)) {}

std::string CacheFolder::path(const std::string& key) const {
  return (fs::path(directory_) / (key + extension_)).string();
}

std::string CacheFolder::read(const std::string& key) const {
  if (directory_.empty() || !distrust(directory_).empty()) return "";
  try {
    return readFile(path(key), "prepared mesh", kMostCacheBytes);
  } catch (const std::exception&) {
    return "";
  }
}

std::string CacheFolder::write(const std::string& key, const std::vector<std::string>& pieces) const {
  if (directory_.empty()) return "";
  makeDirectory(directory_);
  if (const std::string why = distrust(directory_); !why.empty()) {
    return "cannot write to '" + directory_ + "' (" + why + ")";
  }
  try {
    WholeFile file(path(key));
    for (const std::string& piece : pieces) {
      file.stream().write(piece.data(), static_cast<std::streamsize>(piece.size()));
    }
    file.commit();
  } catch (const std::exception& error) {
    return error.what();
  }
  removeOldest();
  return "";
}

/// Whether a file in the directory is one of ours: the key's digits, the extension and what follows it.
bool CacheFolder::isOurs(const std::string& name, const std::string& ending) const {
  return name.size() >= ContentKey::kDigits + ending.size() &&
         name.compare(ContentKey::kDigits, ending.size(), ending) == 0 &&
         name.find_first_not_of("0123456789abcdef") == ContentKey::kDigits;
}

void CacheFolder::removeOldest() const {
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  std::uintmax_t bytes = 0;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory_, error)) {
    const std::string name = entry.path().filename().string();
    // What a run that was killed has left where files cannot be without a name; one that still writes is done in minutes.
    const bool is_left = isOurs(name, extension_ + ".partial-") &&
                         entry.last_write_time(error) < fs::file_time_type::clock::now() - std::chrono::hours(1);
    if (is_left && !error) fs::remove(entry.path(), error);
    if (!isOurs(name, extension_) || name.size() != ContentKey::kDigits + extension_.size()) continue;
    files.emplace_back(entry.last_write_time(error), entry.path());
    const std::uintmax_t size = entry.file_size(error);
    if (!error) bytes += size;
  }
  std::sort(files.begin(), files.end());
  for (const auto& [time, path] : files) {
    if (bytes <= kMostCacheBytes) return;
    const std::uintmax_t size = fs::file_size(path, error);
    if (!error && fs::remove(path, error)) bytes -= std::min(bytes, size);
  }
}

}  // namespace tissue_contact
