/// @file
/// Room `ros`: see whole_file.h.
#include "tissue_contact/ros/whole_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

namespace tissue_contact {
namespace {

[[noreturn]] void throwUnwritable(const std::string& file) {
  throw std::runtime_error("cannot write '" + file + "': " + std::strerror(errno));
}

}  // namespace

WholeFile::WholeFile(std::string file) : file_(std::move(file)), part_(file_ + ".part"), stream_(part_) {
  if (!stream_) throwUnwritable(part_);
  stream_.precision(std::numeric_limits<double>::max_digits10);
}

WholeFile::~WholeFile() {
  if (committed_) return;
  stream_.close();
  std::remove(part_.c_str());
}

void WholeFile::commit() {
  stream_.close();
  if (!stream_) throwUnwritable(part_);
  if (std::rename(part_.c_str(), file_.c_str()) != 0) throwUnwritable(file_);
  committed_ = true;
}

}  // namespace tissue_contact
