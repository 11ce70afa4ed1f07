#include "tissue_contact/core/read_file.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "core/descriptor.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

namespace fs = std::filesystem;

bool begins(const std::string& text, const char* with) { return text.rfind(with, 0) == 0; }

std::string beginningOf(const std::string& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "";
  const Descriptor opened(open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  std::string beginning(64, '\0');
  const ssize_t count = opened.isOpen() ? read(opened.number(), beginning.data(), beginning.size()) : 0;
  beginning.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  return beginning;
}

/// "is a git-lfs pointer ...; fetch it with: git lfs pull" and the like for a file that stands for data kept elsewhere, as a
/// clone without git-lfs or git-annex leaves it; also for a link that leads into a git-annex store which is not there. Empty
/// when it is none of these or cannot be read. Formats: git-lfs specification version 1 (a text whose first line is the key
/// `version`); git-annex's pointer files ("/annex/objects/<key>") and links (into ".git/annex/objects").
std::string standInProblem(const std::string& file) {
  const std::string beginning = beginningOf(file);
  if (begins(beginning, "version https://git-lfs") || begins(beginning, "version http://git-media")) {
    return "is a git-lfs pointer, not the data itself; fetch the data in its repository with: git lfs pull";
  }
  std::error_code error;
  const bool annex_link = beginning.empty() && fs::is_symlink(file, error) && !fs::exists(file, error) &&
                          fs::read_symlink(file, error).string().find("annex/objects") != std::string::npos;
  if (annex_link || begins(beginning, "/annex/objects/")) {
    return "stands for data that git-annex keeps elsewhere; fetch the data in its repository with: git annex get";
  }
  return "";
}

[[noreturn]] void refuse(const std::string& file, const std::string& what, const std::string& why) {
  throw std::invalid_argument(what + " '" + file + "' " + why);
}

/// The name of a file beside `file` that differs in capitals alone (CAD programs write .STL); empty if there is none.
std::string otherCapitals(const std::string& file) {
  const auto lower = [](std::string name) {
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    return name;
  };
  std::error_code error;
  const std::filesystem::path path = std::filesystem::absolute(file, error);
  for (std::filesystem::directory_iterator at(path.parent_path(), error), end; !error && at != end;
       at.increment(error)) {
    std::string name = at->path().filename().string();
    if (name != path.filename() && lower(name) == lower(path.filename().string())) return name;
  }
  return {};
}

/// Of a relative path: roslaunch starts nodes elsewhere than where it was typed in.
std::string whereLookedFor(const std::string& file) {
  std::error_code error;
  const std::filesystem::path here = std::filesystem::current_path(error);
  return error || file.empty() || std::filesystem::path(file).is_absolute()
             ? ""
             : " in '" + printable(here.string(), 4096) + "'";
}

[[noreturn]] void refuseUnreadable(const std::string& file, const std::string& what, int error) {
  if (error == ENOENT || error == ENOTDIR) {
    const std::string other = otherCapitals(file);
    refuse(file, what,
           "does not exist" + whereLookedFor(file) + "; correct the path" +
               (other.empty() ? "" : " ('" + printable(other) + "' lies there)"));
  }
  refuse(file, what, "cannot be read: " + std::generic_category().message(error));
}

void requireRegular(const std::string& file, const std::string& what, const struct stat& status) {
  if (S_ISREG(status.st_mode)) return;
  const std::string advice = S_ISDIR(status.st_mode) ? "give a file in it" : "save what it yields and give that file";
  refuse(file, what, "is not a regular file but " + fileTypeName(status.st_mode) + "; " + advice);
}

void requireSize(const std::string& file, const std::string& what, std::uintmax_t bytes, std::uintmax_t max_bytes) {
  if (bytes == 0) refuse(file, what, "is empty");
  if (bytes > max_bytes) {
    refuse(file, what, "has " + std::to_string(bytes) + " bytes; at most " + std::to_string(max_bytes) + " are read");
  }
}

}  // namespace

OpenFile openRegularFile(const std::string& file, const std::string& what, std::uintmax_t max_bytes) {
  if (const std::string problem = standInProblem(file); !problem.empty()) refuse(file, what, problem);
  struct stat status {};
  // Looked at before it is opened, since opening alone does something to some devices ...
  if (stat(file.c_str(), &status) != 0) refuseUnreadable(file, what, errno);
  requireRegular(file, what, status);
  OpenFile opened{Descriptor(open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)), 0};
  if (!opened.descriptor.isOpen()) refuseUnreadable(file, what, errno);
  // ... and after, since another file may have taken the name.
  if (fstat(opened.descriptor.number(), &status) != 0) refuseUnreadable(file, what, errno);
  requireRegular(file, what, status);
  opened.bytes = static_cast<std::uintmax_t>(status.st_size);
  requireSize(file, what, opened.bytes, max_bytes);
  return opened;
}

std::string fileTypeName(unsigned mode) {
  if (S_ISREG(mode)) return "";
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISFIFO(mode)) return "a FIFO (named pipe)";
  if (S_ISSOCK(mode)) return "a socket";
  if (S_ISLNK(mode)) return "a symbolic link";
  return S_ISCHR(mode) || S_ISBLK(mode) ? "a device" : "of an unknown type";
}

void requireRegularFile(const std::string& file, const std::string& what, std::uintmax_t max_bytes) {
  openRegularFile(file, what, max_bytes);
}

std::string readFile(const std::string& file, const std::string& what, std::uintmax_t max_bytes) {
  const OpenFile opened = openRegularFile(file, what, max_bytes);
  const auto bytes = static_cast<std::size_t>(opened.bytes);
  std::string content(bytes + 1, '\0');  // one more, to see whether it has grown since
  std::size_t filled = 0;
  while (filled < content.size()) {
    const ssize_t count = read(opened.descriptor.number(), content.data() + filled, content.size() - filled);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) refuseUnreadable(file, what, errno);
    if (count == 0) break;
    filled += static_cast<std::size_t>(count);
  }
  if (filled != bytes) refuse(file, what, "changes while it is read; give a copy that nobody writes to");
  content.resize(bytes);
  return content;
}

}  // namespace tissue_contact
