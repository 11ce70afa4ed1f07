#include "tissue_contact/core/whole_file.h"

#include <sys/stat.h>

#include <cerrno>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "core/part_file.h"

namespace tissue_contact {
namespace {

std::string named(const NamedFile& file) { return file.role + " '" + file.path + "'"; }

OutputPlace placeOf(const NamedFile& output) {
  try {
    return OutputPlace(output.path);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(output.role + ": " + error.what());
  }
}

void requireOther(bool is_same, const NamedFile& output, const NamedFile& other) {
  if (!is_same) return;
  throw std::invalid_argument(named(output) + " is the same file as " + named(other) + "; give another name");
}

}  // namespace

WholeFile::WholeFile(const std::string& file) : part_(std::make_unique<PartFile>(file)), stream_(part_.get()) {
  stream_.precision(std::numeric_limits<double>::max_digits10);
  stream_.exceptions(std::ios::badbit);  // the stream then passes on what the buffer throws
}

WholeFile::~WholeFile() = default;

void WholeFile::finish() { part_->finish(); }

void WholeFile::commit() { part_->place(); }

std::string WholeFile::path() const { return part_->path(); }

void WholeFile::commitPartial() { part_->placeBeside(kPartialEnding); }

void requireFreeOutputs(const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs) {
  std::vector<OutputPlace> places;
  std::vector<NamedFile> seen;
  for (const NamedFile& output : outputs) {
    if (output.path.empty()) continue;
    for (const NamedFile& input : inputs) {
      struct stat status {};
      // Before the place is judged, so that a link to an input is called that.
      struct stat target {};
      const bool both =
          !input.path.empty() && stat(input.path.c_str(), &status) == 0 && stat(output.path.c_str(), &target) == 0;
      requireOther(both && target.st_dev == status.st_dev && target.st_ino == status.st_ino, output, input);
    }
    OutputPlace place = placeOf(output);
    for (std::size_t i = 0; i < places.size(); ++i) requireOther(place.isSameAs(places[i]), output, seen[i]);
    places.push_back(std::move(place));
    seen.push_back(output);
  }
}

void requireWritten(std::ostream& standard_output) {
  errno = 0;
  if (standard_output.flush()) return;
  // The reason of an earlier failure is lost.
  const std::string reason = errno != 0 ? std::generic_category().message(errno) : "an earlier write failed";
  throw std::runtime_error("cannot write to standard output: " + reason);
}

}  // namespace tissue_contact
