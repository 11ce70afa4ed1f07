/// @file
/// Room `ros`, private: files as messages and manifests name them.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace tissue_contact {

/// As given where the working directory is gone.
inline std::string absolutePath(const std::string& file) {
  std::error_code error;
  const std::filesystem::path path = std::filesystem::absolute(file, error);
  return error ? file : path.lexically_normal().string();
}

}  // namespace tissue_contact
