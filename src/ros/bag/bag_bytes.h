/// @file
/// Room `ros` (private): bytes of a bag file, as they lie there or decompressed, in order and never all at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "core/descriptor.h"

namespace tissue_contact {

/// Something is wrong with a bag's contents. The text names no file: whoever opened it adds that, and the remedy.
class BagError : public std::runtime_error {
 public:
  enum class Remedy {
    kCopyAgain,  ///< bytes are not what was written
    kReindex,    ///< the messages may all be there, but not what says where they are
    kAsSaid,     ///< the text says all that can be said
  };
  explicit BagError(const std::string& what, Remedy remedy = Remedy::kCopyAgain)
      : std::runtime_error(what), remedy_(remedy) {}
  Remedy remedy() const { return remedy_; }

 private:
  Remedy remedy_;
};

/// A regular file, open for reading.
class InputFile {
 public:
  /// Never waits: a FIFO, device or directory is refused.
  /// @throws std::runtime_error naming the file and the reason.
  explicit InputFile(const std::string& name);

  std::uint64_t size() const { return file_.bytes; }
  /// Reads `size` bytes at `position`.
  /// @throws BagError when they cannot be read or are no longer there.
  void read(std::uint64_t position, char* to, std::size_t size) const;

 private:
  OpenFile file_;
};

class ByteSource {
 public:
  ByteSource() = default;
  virtual ~ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// The next bytes, at most `size` (> 0); 0 at the end.
  /// @throws BagError.
  virtual std::size_t read(char* to, std::size_t size) = 0;
  /// Passes over at most `size` bytes without reading them; returns how many, which may be 0 anywhere.
  virtual std::uint64_t skip(std::uint64_t size);
};

enum class Compression { kNone, kBz2, kLz4 };

/// `size` bytes of a file from `position` on, which lie within it, decompressed. The memory it takes depends on the
/// format alone (at most 8 MB), not on what the data claim or become.
/// @param file must outlive the source.
std::unique_ptr<ByteSource> openBytes(const InputFile& file, std::uint64_t position, std::uint64_t size,
                                      Compression compression);

}  // namespace tissue_contact
