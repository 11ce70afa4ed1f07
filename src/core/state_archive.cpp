#include "tissue_contact/core/state_archive.h"

#include <cstring>
#include <stdexcept>
#include <utility>

#include "tissue_contact/core/content_hash.h"

namespace tissue_contact {

namespace {

std::uint64_t checksumOf(const char* bytes, std::size_t size) {
  ContentHash hash;
  hash.add(bytes, size);
  return hash.value();
}

}  // namespace

StateArchive::StateArchive(const std::string& title) : reading_(false), bytes_(title + '\n') {}

StateArchive::StateArchive(const std::string& title, std::string bytes) : reading_(true), bytes_(std::move(bytes)) {
  at_ = title.size() + 1;
  if (bytes_.compare(0, at_, title + '\n') != 0) {
    throw std::invalid_argument("does not begin with '" + title + "': it is no saved state, or one of another version");
  }
  std::uint64_t stored = 0;
  if (bytes_.size() < at_ + sizeof stored) throw std::invalid_argument("ends before its checksum: it is cut off");
  end_ = bytes_.size() - sizeof stored;
  std::memcpy(&stored, bytes_.data() + end_, sizeof stored);
  if (stored != checksumOf(bytes_.data(), end_)) {
    throw std::invalid_argument("does not have the checksum that it ends with: it is damaged or cut off");
  }
}

void StateArchive::section(const std::string& name) {
  std::string stored = name;
  std::uint64_t size = name.size();
  section_ = name;
  bytes(&size, sizeof size);
  if (size != name.size()) refuse("something else stands there");
  bytes(stored.data(), stored.size());
  if (stored != name) refuse("'" + stored + "' stands there");
}

void StateArchive::carry(bool& value) {
  unsigned char byte = value ? 1 : 0;
  bytes(&byte, sizeof byte);
  value = byte != 0;
}

void StateArchive::carry(std::vector<bool>& values) {
  requireSize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    unsigned char value = values[i] ? 1 : 0;
    bytes(&value, sizeof value);
    values[i] = value != 0;
  }
}

void StateArchive::require(std::uint64_t known, const std::string& meaning) {
  std::uint64_t stored = known;
  bytes(&stored, sizeof stored);
  if (stored != known) refuse(meaning);
}

void StateArchive::refuse(const std::string& reason) const { throw std::invalid_argument(section_ + ": " + reason); }

void StateArchive::requireIndex(int index, int least, std::size_t count, const char* what) const {
  if (!reading_ || (index >= least && index < static_cast<int>(count))) return;
  refuse(std::string(what) + ' ' + std::to_string(index) + ", of " + std::to_string(count));
}

std::string StateArchive::finish() {
  const std::uint64_t hash = checksumOf(bytes_.data(), bytes_.size());
  bytes_.append(reinterpret_cast<const char*>(&hash), sizeof hash);
  return std::move(bytes_);
}

void StateArchive::requireEnd() const {
  if (at_ != end_) refuse("more stands behind it than belongs there");
}

void StateArchive::bytes(void* data, std::size_t size) {
  if (!reading_) {
    bytes_.append(static_cast<const char*>(data), size);
    return;
  }
  if (size > end_ - at_) refuse("the state ends within it");
  if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
  at_ += size;
}

void StateArchive::requireSize(std::uint64_t size) {
  std::uint64_t stored = size;
  bytes(&stored, sizeof stored);
  if (stored != size) refuse(std::to_string(stored) + " values, where the scene has " + std::to_string(size));
}

std::size_t StateArchive::carrySize(std::size_t size, std::size_t most) {
  std::uint64_t stored = size;
  bytes(&stored, sizeof stored);
  if (reading_ && stored > end_ - at_) refuse("more entries than there are bytes");
  if (stored > most) refuse(std::to_string(stored) + " entries, where at most " + std::to_string(most) + " may be");
  return stored;
}

}  // namespace tissue_contact
