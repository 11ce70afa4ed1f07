/// @file
/// Room `mesh`: see mesh_file_cursor.h.
#include "mesh/reader/mesh_file_cursor.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <utility>

#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

// Not std::isspace: the answer must not depend on the locale of the process.
bool isSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

}  // namespace

std::string excerpt(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string out = "'";
  for (const char c : text.substr(0, kLongest)) out += (c >= ' ' && c <= '~') ? c : '?';
  return out + (text.size() > kLongest ? "...'" : "'");
}

MeshFileCursor::MeshFileCursor(std::string name, std::string bytes)
    : name_(std::move(name)), bytes_(std::move(bytes)) {}

void MeshFileCursor::fail(const std::string& message) const {
  if (binary()) throw std::invalid_argument(name_ + ", byte " + std::to_string(mark_) + ": " + message);
  const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(mark_);
  const auto line = 1 + std::count(bytes_.begin(), end, '\n');
  throw std::invalid_argument(name_ + ":" + std::to_string(line) + ": " + message);
}

void MeshFileCursor::skipSpace() {
  while (offset_ < bytes_.size() && isSpace(bytes_[offset_])) ++offset_;
  mark_ = offset_;
}

bool MeshFileCursor::atEnd() {
  skipSpace();
  return offset_ == bytes_.size();
}

std::string_view MeshFileCursor::word(const char* what) {
  if (atEnd())
    fail(std::string("the file ends where ") + what + " should be: it is truncated; export or copy it again");
  while (offset_ < bytes_.size() && !isSpace(bytes_[offset_])) ++offset_;
  return std::string_view(bytes_).substr(mark_, offset_ - mark_);
}

std::string_view MeshFileCursor::line() {
  mark_ = offset_;
  const std::size_t end = std::min(bytes_.find('\n', offset_), bytes_.size());
  offset_ = std::min(end + 1, bytes_.size());
  std::string_view text = std::string_view(bytes_).substr(mark_, end - mark_);
  if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
  return text;
}

void MeshFileCursor::endLine() {
  const std::string_view rest = line();
  const bool blank = std::all_of(rest.begin(), rest.end(), isSpace);
  if (!blank) fail("unexpected " + excerpt(rest) + " at the end of the line; export the file again");
}

void MeshFileCursor::failNumber(std::string_view text, const char* what, const char* kind) const {
  fail(std::string("expected ") + what + " (" + kind + "), found " + excerpt(text) +
       "; the section before is shorter than its count says, or the file is damaged: export it again");
}

std::uint64_t MeshFileCursor::rawBits(int bytes, const char* what) {
  mark_ = offset_;
  const auto size = static_cast<std::size_t>(bytes);
  if (remaining() < size) {
    fail(std::string("the file ends within ") + what + ": it is truncated; export or copy it again");
  }
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t at = encoding_ == Encoding::kBigEndian ? i : size - 1 - i;
    bits = (bits << 8U) | static_cast<unsigned char>(bytes_[offset_ + at]);
  }
  offset_ += size;
  return bits;
}

std::int64_t MeshFileCursor::integer(int bytes, const char* what) {
  if (!binary()) return textInteger(what);
  const std::uint64_t bits = rawBits(bytes, what);
  const std::uint64_t sign = std::uint64_t{1} << (8U * static_cast<unsigned>(bytes) - 1U);
  // Subtracting the sign bit twice extends it; the difference is modulo 2^64, as two's complement wants.
  return static_cast<std::int64_t>((bits ^ sign) - sign);
}

std::int64_t MeshFileCursor::textInteger(const char* what) {
  const std::string_view text = word(what);
  const std::optional<std::int64_t> value = toInteger(text);
  if (!value) failNumber(text, what, "a whole number of at most 64 bits");
  return *value;
}

double MeshFileCursor::real(int bytes, const char* what) {
  if (binary()) {
    const std::uint64_t bits = rawBits(bytes, what);
    if (bytes == 8) {
      double value = 0.0;
      std::memcpy(&value, &bits, sizeof value);
      return value;
    }
    const auto half = static_cast<std::uint32_t>(bits);
    float single = 0.0F;
    std::memcpy(&single, &half, sizeof single);
    return static_cast<double>(single);
  }
  const std::string_view text = word(what);
  const std::optional<double> value = toDouble(text);
  if (!value) failNumber(text, what, "a number that a double can hold");
  return *value;
}

void MeshFileCursor::skipPast(const std::string& marker) {
  const std::size_t found = bytes_.find(marker, offset_);
  if (found == std::string::npos) {
    fail("no " + marker + " follows: the file is truncated or damaged; export or copy it again");
  }
  mark_ = found;
  offset_ = found + marker.size();
}

void MeshFileCursor::skipBytes(std::size_t count) {
  if (count > remaining()) fail("the file ends within this section: it is truncated; export or copy it again");
  offset_ += count;
}

std::size_t MeshFileCursor::checkedCount(std::int64_t count, ItemSize item, const std::string& what) const {
  // As text a number takes a digit and a separator; the last one of a file may lack the separator.
  const std::size_t most = binary() ? remaining() / item.bytes : (remaining() + 1) / (2 * item.values);
  if (count < 0 || static_cast<std::uint64_t>(count) > most) {
    fail("the number of " + what + " is " + std::to_string(count) + ", but the " + std::to_string(remaining()) +
         " bytes that follow can hold 0 to " + std::to_string(most) +
         ": the file is truncated or damaged; export or copy it again");
  }
  return static_cast<std::size_t>(count);
}

}  // namespace tissue_contact
