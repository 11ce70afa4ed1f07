#include "tissue_contact/core/resolve_path.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& uri, const std::string& problem) {
  throw std::invalid_argument("path \"" + uri + "\" " + problem);
}

fs::path inPackage(const std::string& uri, const std::string& rest, const PackagePath& package_path) {
  const std::size_t slash = rest.find('/');
  const std::size_t start = slash == std::string::npos ? slash : rest.find_first_not_of('/', slash);
  if (slash == 0 || start == std::string::npos) refuse(uri, "must read package://<package>/<path>");
  const std::string package = rest.substr(0, slash);
  const std::string directory = package_path ? package_path(package) : "";
  if (directory.empty()) {
    refuse(uri, "names the ROS package \"" + package +
                    "\", which is not known; install it, source its setup file, name the folder it lies in in "
                    "ROS_PACKAGE_PATH, or give a plain path");
  }
  return fs::path(directory) / rest.substr(start);
}

}  // namespace

std::string resolvePath(const std::string& uri, const std::string& base_directory, const PackagePath& package_path) {
  if (uri.empty()) refuse(uri, "is empty; give a file");
  // A NUL would silently cut the path short in the system calls that follow.
  if (std::any_of(uri.begin(), uri.end(), isControl)) {
    throw std::invalid_argument("a path holds control characters; remove them");
  }
  fs::path path;
  const std::size_t scheme_end = uri.find("://");
  const std::string rest = scheme_end == std::string::npos ? uri : uri.substr(scheme_end + 3);
  const std::string scheme = scheme_end == std::string::npos ? "" : uri.substr(0, scheme_end);
  if (scheme_end == std::string::npos) {
    path = fs::path(base_directory) / uri;  // an absolute uri replaces the base
  } else if (scheme == "package") {
    path = inPackage(uri, rest, package_path);
  } else if (scheme == "file") {
    if (rest.empty() || rest.front() != '/') refuse(uri, "must read file:///<absolute path>");
    path = rest;
  } else {
    refuse(uri, "has the unknown scheme \"" + scheme + "\"; use package://, file:// or a plain path");
  }
  // ".." stays in: taking it out of the text would lead elsewhere when a directory before it is a symbolic link.
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  if (error) refuse(uri, "cannot be made absolute: " + error.message());
  return absolute.string();
}

}  // namespace tissue_contact
