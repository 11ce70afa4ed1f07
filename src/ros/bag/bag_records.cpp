#include "ros/bag/bag_records.h"

#include <algorithm>

namespace tissue_contact {
namespace {

constexpr std::size_t kBuffer = 1 << 14;

/// Data grow by at most so much at a time, so that a length which is not backed by bytes takes no memory.
constexpr std::size_t kGrowth = 1 << 20;

/// Where a chunk was cut off there are at most so many bytes of it.
constexpr std::uint64_t kMaxZeros = (1ULL << 32U) + BagRecords::kMaxHeader;

}  // namespace

void BagFields::parse(std::string bytes) {
  bytes_ = std::move(bytes);
  fields_.clear();
  std::string_view rest = bytes_;
  while (!rest.empty()) {
    std::uint32_t size = 0;
    if (rest.size() < sizeof size) throw BagError("a header field is cut off");
    std::memcpy(&size, rest.data(), sizeof size);
    rest.remove_prefix(sizeof size);
    if (size > rest.size()) throw BagError("a header field is longer than its header");
    const std::string_view field = rest.substr(0, size);
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) throw BagError("a header field has no '='");
    fields_.emplace_back(field.substr(0, equals), field.substr(equals + 1));
    rest.remove_prefix(size);
  }
}

const std::string_view* BagFields::find(std::string_view name) const {
  for (const auto& [key, value] : fields_) {
    if (key == name) return &value;
  }
  return nullptr;
}

std::string_view BagFields::text(std::string_view name) const {
  const std::string_view* value = find(name);
  if (value == nullptr) throw BagError("header field '" + std::string(name) + "' is missing");
  return *value;
}

BagRecords::BagRecords(std::unique_ptr<ByteSource> source, std::uint64_t begin, std::uint64_t end)
    : source_(std::move(source)), buffer_(kBuffer), position_(begin), end_(end), data_position_(begin) {}

void BagRecords::fail(const std::string& why) const {
  throw BagError("record at byte " + std::to_string(record_position_) + ": " + why);
}

bool BagRecords::fill() {
  buffer_begin_ = 0;
  buffer_end_ = source_->read(buffer_.data(), buffer_.size());
  return buffer_end_ > 0;
}

void BagRecords::read(char* to, std::size_t size) {
  while (size > 0) {
    if (buffer_begin_ == buffer_end_ && !fill()) fail("it is cut off");
    const std::size_t count = std::min(size, buffer_end_ - buffer_begin_);
    std::memcpy(to, buffer_.data() + buffer_begin_, count);
    buffer_begin_ += count;
    position_ += count;
    to += count;
    size -= count;
  }
}

std::uint32_t BagRecords::length() {
  std::uint32_t value = 0;
  if (end_ - position_ < sizeof value) fail("it is cut off");
  read(reinterpret_cast<char*>(&value), sizeof value);
  if (value > end_ - position_) {
    fail("a length of " + std::to_string(value) + " bytes, where " + std::to_string(end_ - position_) + " are left");
  }
  return value;
}

/// What is left has to be: a file of any size may be all zeros and take no room, but not the time to look.
void BagRecords::requireZeros() {
  if (end_ - position_ > kMaxZeros) fail("an empty header");
  while (position_ < end_) {
    if (buffer_begin_ == buffer_end_ && !fill()) fail("it is cut off");
    const std::size_t count = std::min<std::uint64_t>(end_ - position_, buffer_end_ - buffer_begin_);
    const char* const begin = buffer_.data() + buffer_begin_;
    if (std::any_of(begin, begin + count, [](char c) { return c != '\0'; })) fail("an empty header");
    buffer_begin_ += count;
    position_ += count;
  }
}

Op BagRecords::next() {
  skipData();
  record_position_ = position_;
  const std::uint32_t header_size = length();
  if (header_size == 0) {
    requireZeros();
    data_position_ = end_;
    data_size_ = 0;
    return Op::kZeros;
  }
  if (header_size > kMaxHeader) {
    fail("a header of " + std::to_string(header_size) + " bytes; at most " + std::to_string(kMaxHeader) + " are read");
  }
  std::string header(header_size, '\0');
  read(header.data(), header.size());
  data_size_ = length();
  data_position_ = position_;
  try {
    fields_.parse(std::move(header));
    return static_cast<Op>(fields_.number<std::uint8_t>("op"));
  } catch (const BagError& error) {
    fail(error.what());
  }
}

std::string BagRecords::data(std::uint32_t limit) {
  if (dataLeft() > limit) {
    throw BagError("record at byte " + std::to_string(record_position_) + ": " + std::to_string(dataLeft()) +
                       " bytes of data, of which at most " + std::to_string(limit) + " are read",
                   BagError::Remedy::kAsSaid);
  }
  std::string bytes;
  while (dataLeft() > 0) {
    const std::size_t count = std::min<std::uint64_t>(dataLeft(), kGrowth);
    bytes.resize(bytes.size() + count);
    read(bytes.data() + bytes.size() - count, count);
  }
  return bytes;
}

void BagRecords::skipData() {
  while (dataLeft() > 0) {
    if (buffer_begin_ == buffer_end_) {
      const std::uint64_t skipped = source_->skip(dataLeft());
      position_ += skipped;
      if (skipped > 0) continue;
      if (!fill()) fail("it is cut off");
    }
    const std::size_t count = std::min<std::uint64_t>(dataLeft(), buffer_end_ - buffer_begin_);
    buffer_begin_ += count;
    position_ += count;
  }
}

void BagRecords::finish() {
  skipData();
  if (buffer_begin_ != buffer_end_ || fill()) fail("there are bytes behind it that do not belong here");
}

}  // namespace tissue_contact
