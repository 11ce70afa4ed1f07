/// @file
/// Room `mesh`, private: a bounded cursor over the bytes of a mesh file. One interface for ASCII and binary numbers,
/// so that a reader is written once for both; every failure names the file and the line (ASCII) or byte offset
/// (binary).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tissue_contact {

/// What one item of a counted section takes at least: numbers if it is written as text, bytes if it is binary.
struct ItemSize {
  std::size_t values;
  std::size_t bytes;
};

/// Reads forward only, but for `seek`. Nothing here allocates more than the file's own bytes.
/// Every reading function throws std::invalid_argument (see `fail`) when the file ends or holds something else.
class MeshFileCursor {
 public:
  enum class Encoding { kAscii, kLittleEndian, kBigEndian };

  /// @param name of the file, for messages; `bytes` its whole contents.
  MeshFileCursor(std::string name, std::string bytes);

  /// How `integer` and `real` read from here on. Words and lines are text in every encoding.
  void setEncoding(Encoding encoding) { encoding_ = encoding; }
  bool binary() const { return encoding_ != Encoding::kAscii; }

  const std::string& name() const { return name_; }
  std::size_t offset() const { return offset_; }
  std::size_t remaining() const { return bytes_.size() - offset_; }
  void seek(std::size_t offset) { mark_ = offset_ = offset; }

  /// Skips white space; true if nothing follows.
  bool atEnd();

  /// Next run of characters without white space. `what` names the thing expected, for the message at the end of the
  /// file.
  std::string_view word(const char* what);

  /// From here to the end of the line, which is consumed and not returned.
  std::string_view line();

  /// Consumes the rest of a header line, which must be blank: binary data starts right behind its newline.
  void endLine();

  /// A whole number: text, or two's complement of 1, 2, 4 or 8 bytes.
  std::int64_t integer(int bytes, const char* what);

  /// A whole number that is text in every encoding.
  std::int64_t textInteger(const char* what);

  /// A number: text (nan and inf are numbers here), or IEEE 754 of 4 or 8 bytes.
  double real(int bytes, const char* what);

  /// Moves behind the next `marker`, which must exist.
  void skipPast(const std::string& marker);

  /// Skips as many bytes, which must exist.
  void skipBytes(std::size_t count);

  /// `count` as a size, refused if negative or if the rest of the file cannot hold as many items.
  std::size_t checkedCount(std::int64_t count, ItemSize item, const std::string& what) const;

  /// Throws "<file>:<line>: <message>" or "<file>, byte <offset>: <message>", about the last thing that was read.
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void skipSpace();
  std::uint64_t rawBits(int bytes, const char* what);
  [[noreturn]] void failNumber(std::string_view text, const char* what, const char* kind) const;

  std::string name_;
  std::string bytes_;
  std::size_t offset_ = 0;
  std::size_t mark_ = 0;  ///< where the last thing read begins
  Encoding encoding_ = Encoding::kAscii;
};

/// `text` in quotes, shortened and with bytes that do not print replaced, fit for a message.
std::string excerpt(std::string_view text);

}  // namespace tissue_contact
