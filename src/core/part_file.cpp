#include "core/part_file.h"

#include <fcntl.h>
#include <sys/random.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <system_error>

#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/whole_file.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kBufferBytes = 1u << 16;
constexpr int kAttempts = 100;  // at a name that nobody has; the first is free but by a chance of 2^-64

std::string reason(int error) { return std::generic_category().message(error); }

std::string linkTarget(const OutputPlace& place) {
  std::array<char, 4096> target{};
  const ssize_t length = readlinkat(place.directory.number(), place.name.c_str(), target.data(), target.size());
  return std::string(target.data(), length > 0 ? static_cast<std::size_t>(length) : 0);
}

/// Nobody can foresee it, so nobody can plant a link under it.
std::string unforeseeableName(const std::string& target) {
  std::uint64_t number = 0;
  if (getrandom(&number, sizeof number, 0) != static_cast<ssize_t>(sizeof number)) {
    throw std::runtime_error("no random number from the system: " + reason(errno));
  }
  constexpr std::size_t kMostBytes = 220;  // of the 255 that a name may have
  char ending[32];
  std::snprintf(ending, sizeof ending, ".partial-%016llx", static_cast<unsigned long long>(number));
  return target.substr(0, kMostBytes) + ending;
}

}  // namespace

OutputPlace::OutputPlace(const std::string& file) : path(file) {
  const std::size_t slash = file.rfind('/');
  name = slash == std::string::npos ? file : file.substr(slash + 1);
  const std::string folder = slash == std::string::npos ? "." : file.substr(0, slash + 1);
  if (file == "-") refuse("results go to files, not to standard output; give a path (./- for a file of that name)");
  directory = Descriptor(open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!directory.isOpen() || fstat(directory.number(), &directory_status) != 0) {
    refuse(reason(errno) + "; results go to a folder that exists");
  }
  if (name.empty() || name == "." || name == "..") refuse("it is a directory; add the name of a file");
  look();
}

void OutputPlace::append(const std::string& ending) {
  name += ending;
  path += ending;
  look();
}

void OutputPlace::look() {
  struct stat found {};
  existing.reset();
  if (fstatat(directory.number(), name.c_str(), &found, AT_SYMLINK_NOFOLLOW) != 0) {
    if (errno != ENOENT) refuse(reason(errno));
    return;
  }
  if (S_ISLNK(found.st_mode)) {
    refuse("it is a symbolic link to '" + linkTarget(*this) + "'; give the path of the file itself");
  }
  if (!S_ISREG(found.st_mode)) refuse("it is " + fileTypeName(found.st_mode) + "; give the name of a file");
  if (faccessat(directory.number(), name.c_str(), W_OK, AT_EACCESS) != 0) {
    refuse(reason(errno) + "; it is there and write-protected");
  }
  existing = found;
}

bool OutputPlace::isSameAs(const OutputPlace& other) const {
  if (existing && other.existing) return isSameAs(*other.existing);
  return name == other.name && directory_status.st_dev == other.directory_status.st_dev &&
         directory_status.st_ino == other.directory_status.st_ino;
}

bool OutputPlace::isSameAs(const struct stat& file) const {
  return existing && existing->st_dev == file.st_dev && existing->st_ino == file.st_ino;
}

void OutputPlace::refuse(const std::string& why) const {
  throw std::invalid_argument("cannot write '" + path + "': " + why);
}

PartFile::PartFile(const std::string& file, Kind kind) : place_(file), buffer_(kBufferBytes) {
  open(kind);
  setp(buffer_.data(), buffer_.data() + buffer_.size());
}

PartFile::~PartFile() {
  if (!part_name_.empty()) unlinkat(place_.directory.number(), part_name_.c_str(), 0);
}

void PartFile::open(Kind kind) {
  // What replaces a private file is private from its first byte on.
  const mode_t mode = place_.existing ? S_IRUSR | S_IWUSR : S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP | S_IROTH | S_IWOTH;
  if (kind == Kind::kUnnamedIfPossible) {
    file_ = Descriptor(openat(place_.directory.number(), ".", O_TMPFILE | O_WRONLY | O_CLOEXEC, mode));
  }
  if (!file_.isOpen()) openNamed(mode);  // also for its reason, should both be impossible
  if (place_.existing) keepPermissions();
}

void PartFile::openNamed(mode_t mode) {
  for (int i = 0; i < kAttempts && !file_.isOpen(); ++i) {
    const std::string name = unforeseeableName(place_.name);
    file_ = Descriptor(
        openat(place_.directory.number(), name.c_str(), O_CREAT | O_EXCL | O_NOFOLLOW | O_WRONLY | O_CLOEXEC, mode));
    if (file_.isOpen()) part_name_ = name;
    if (!file_.isOpen() && errno != EEXIST) break;
  }
  if (file_.isOpen()) return;
  const bool is_full = errno == ENOSPC || errno == EDQUOT || errno == EMFILE || errno == ENFILE;
  is_full ? fail(errno) : place_.refuse(reason(errno));
}

void PartFile::keepPermissions() {
  const struct stat& old = *place_.existing;
  // The owner too where that is allowed; where not, the file is ours, and that is no reason to lose a result.
  if (fchown(file_.number(), old.st_uid, old.st_gid) != 0 &&
      fchown(file_.number(), static_cast<uid_t>(-1), old.st_gid) != 0) {
    errno = 0;
  }
  constexpr mode_t kPermissions = S_IRWXU | S_IRWXG | S_IRWXO;
  if (fchmod(file_.number(), old.st_mode & kPermissions) != 0) place_.refuse(reason(errno));
}

PartFile::int_type PartFile::overflow(int_type c) {
  writeOut();
  if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
  *pptr() = traits_type::to_char_type(c);
  pbump(1);
  return c;
}

int PartFile::sync() {
  writeOut();
  return 0;
}

void PartFile::writeOut() {
  const char* from = pbase();
  while (from < pptr()) {
    const ssize_t count = write(file_.number(), from, static_cast<std::size_t>(pptr() - from));
    if (count < 0 && errno != EINTR) fail(errno);
    if (count > 0) from += count;
  }
  setp(buffer_.data(), buffer_.data() + buffer_.size());
}

void PartFile::finish() { writeOut(); }

std::string PartFile::path() const { return "/proc/self/fd/" + std::to_string(file_.number()); }

void PartFile::giveName() {
  const std::string self = path();
  for (int i = 0; i < kAttempts; ++i) {
    const std::string name = unforeseeableName(place_.name);
    if (linkat(AT_FDCWD, self.c_str(), place_.directory.number(), name.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      part_name_ = name;
      return;
    }
    if (errno != EEXIST) break;
  }
  fail(errno);
}

void PartFile::place() {
  finish();
  if (part_name_.empty()) giveName();
  if (!file_.close()) fail(errno);
  try {
    place_.look();                                // another program may have put something there meanwhile
  } catch (const std::invalid_argument& error) {  // nobody's argument was wrong when the run began
    throw std::runtime_error(error.what());
  }
  if (renameat(place_.directory.number(), part_name_.c_str(), place_.directory.number(), place_.name.c_str()) != 0) {
    fail(errno);
  }
  part_name_.clear();
}

void PartFile::placeBeside(const std::string& ending) {
  try {
    place_.append(ending);
  } catch (const std::invalid_argument& error) {  // as in place()
    throw std::runtime_error(error.what());
  }
  place();
}

void PartFile::fail(int error) const { throw WriteError("cannot write '" + place_.path + "': " + reason(error)); }

}  // namespace tissue_contact
