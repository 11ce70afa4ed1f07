#include "tissue_contact/core/resolve_path.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& uri, const std::string& problem) {
  throw std::invalid_argument("path \"" + uri + "\" " + problem);
}

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

/// `text` with the characters that each %XX of it stands for (RFC 3986, section 2.1); any other % stays.
std::string percentDecoded(const std::string& text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = text[i] == '%' && i + 2 < text.size() ? hexDigit(text[i + 1]) : -1;
    const int low = high < 0 ? -1 : hexDigit(text[i + 2]);
    if (low >= 0) i += 2;
    decoded += low < 0 ? text[i] : static_cast<char>(16 * high + low);
  }
  return decoded;
}

/// The file that a URI's path names in a folder: as it stands if that is there, which is how most URDFs write spaces, else decoded, as RViz reads it.
fs::path ofUri(const fs::path& folder, const std::string& rest) {
  const std::string decoded = percentDecoded(rest);
  std::error_code unreadable;
  const bool is_decoded = decoded != rest && std::none_of(decoded.begin(), decoded.end(), isControl) &&
                          !fs::exists(folder / rest, unreadable) && fs::exists(folder / decoded, unreadable);
  return folder / (is_decoded ? decoded : rest);
}

fs::path inPackage(const std::string& uri, const std::string& rest, const PackagePath& package_path) {
  const std::size_t slash = rest.find('/');
  const std::size_t start = slash == std::string::npos ? slash : rest.find_first_not_of('/', slash);
  if (slash == 0 || start == std::string::npos) refuse(uri, "must read package://<package>/<path>");
  const std::string package = rest.substr(0, slash);
  const std::string directory = package_path ? package_path(package) : "";
  if (directory.empty()) {
    refuse(uri,
           "names the ROS package \"" + package +
               "\", which is not known; install it, source its setup file, name the folder that it lies in, with its "
               "package.xml, in ROS_PACKAGE_PATH, or give a plain path");
  }
  return ofUri(directory, rest.substr(start));
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
    path = ofUri("/", rest);
  } else {
    refuse(uri, "has the unknown scheme \"" + scheme + "\"; use package://, file:// or a plain path");
  }
  // ".." stays in: taking it out of the text would lead elsewhere when a directory before it is a symbolic link.
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  if (error) refuse(uri, "cannot be made absolute: " + error.message());
  return absolute.string();
}

std::string fileUri(const std::string& path) {
  const std::string plain = "/-._~!$&'()*+,;=:@";  // what else a path in a URI may have, beside letters and digits
  std::string uri = "file://";
  for (const char c : path) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                          plain.find(c) != std::string::npos;
    constexpr const char* kDigits = "0123456789ABCDEF";
    if (is_plain) {
      uri += c;
    } else {
      uri.append({'%', kDigits[byte / 16], kDigits[byte % 16]});
    }
  }
  return uri;
}

}  // namespace tissue_contact
