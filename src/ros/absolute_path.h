/// @file
/// Room `ros`, private: files as messages and manifests name them.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

#include "tissue_contact/core/resolve_path.h"
#include "tissue_contact/ros/environment.h"

namespace tissue_contact {

/// A file that an argument names, which may be a URI. @throws as resolvePath().
inline std::string withoutUri(const std::string& file) {
  return file.find("://") == std::string::npos ? file : resolvePath(file, "", packagePath);
}

/// As given where the working directory is gone.
inline std::string absolutePath(const std::string& file) {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::absolute(file, error);
  return error ? file : path.lexically_normal().string();
}

}  // namespace tissue_contact
