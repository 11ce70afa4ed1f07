/// @file
/// Room `core`: paths as scenes and robot models write them.
#pragma once

#include <functional>
#include <string>

namespace tissue_contact {

/// Directory of a ROS package, or "" when it is not known. The ROS room has packagePath().
using PackagePath = std::function<std::string(const std::string& package)>;

/// Turns `uri` into an absolute path: `package://name/rest` through `package_path`, `file:///rest`, an absolute path,
/// or a path relative to `base_directory`. The file need not exist; one that a URI names with %20 and the like for its characters, as it
/// ought to, is found where no file has the name that is written.
/// @throws std::invalid_argument naming the uri when the package is unknown or the scheme is not one of these.
std::string resolvePath(const std::string& uri, const std::string& base_directory, const PackagePath& package_path);

/// The URI that names the file of that absolute path to whatever reads URIs, RViz say: `file://` and the path, %20 and the like for what a
/// URI may not have as it is (RFC 3986).
std::string fileUri(const std::string& path);

}  // namespace tissue_contact
