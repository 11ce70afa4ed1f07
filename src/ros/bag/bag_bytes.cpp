#include "ros/bag/bag_bytes.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <utility>

namespace tissue_contact {
namespace {

class FileBytes : public ByteSource {
 public:
  FileBytes(const InputFile& file, std::uint64_t position, std::uint64_t size)
      : file_(file), position_(position), end_(position + size) {}

  std::size_t read(char* to, std::size_t size) override {
    const std::size_t count = std::min<std::uint64_t>(size, end_ - position_);
    file_.read(position_, to, count);
    position_ += count;
    return count;
  }

  std::uint64_t skip(std::uint64_t size) override {
    const std::uint64_t count = std::min(size, end_ - position_);
    position_ += count;
    return count;
  }

 private:
  const InputFile& file_;
  std::uint64_t position_;
  std::uint64_t end_;
};

/// What both decompressors read their input through.
class CompressedBytes : public ByteSource {
 protected:
  CompressedBytes(const InputFile& file, std::uint64_t position, std::uint64_t size) : file_(file, position, size) {}

  /// Makes sure that there is input, unless the file's stretch has ended.
  void refill() {
    if (left_ > 0) return;
    left_ = file_.read(input_.data(), input_.size());
    next_ = input_.data();
  }

  char* next_ = nullptr;
  std::size_t left_ = 0;

 private:
  FileBytes file_;
  std::array<char, 1 << 15> input_;
};

class Bz2Bytes : public CompressedBytes {
 public:
  Bz2Bytes(const InputFile& file, std::uint64_t position, std::uint64_t size) : CompressedBytes(file, position, size) {
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  ~Bz2Bytes() override { BZ2_bzDecompressEnd(&stream_); }

  std::size_t read(char* to, std::size_t size) override {
    stream_.next_out = to;
    stream_.avail_out = static_cast<unsigned>(std::min<std::size_t>(size, 1U << 30));
    while (!ended_ && stream_.next_out == to) {
      refill();
      if (left_ == 0) throw BagError("its bzip2 data are cut off");
      stream_.next_in = next_;
      stream_.avail_in = static_cast<unsigned>(left_);
      const int result = BZ2_bzDecompress(&stream_);
      next_ = stream_.next_in;
      left_ = stream_.avail_in;
      if (result != BZ_OK && result != BZ_STREAM_END) throw BagError("its bzip2 data are damaged");
      ended_ = result == BZ_STREAM_END;
    }
    return static_cast<std::size_t>(stream_.next_out - to);
  }

 private:
  bz_stream stream_{};
  bool ended_ = false;
};

class Lz4Bytes : public CompressedBytes {
 public:
  Lz4Bytes(const InputFile& file, std::uint64_t position, std::uint64_t size) : CompressedBytes(file, position, size) {
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context_, LZ4F_VERSION)) != 0) {
      throw std::bad_alloc();
    }
  }
  ~Lz4Bytes() override { LZ4F_freeDecompressionContext(context_); }

  std::size_t read(char* to, std::size_t size) override {
    std::size_t written = 0;
    while (!ended_ && written == 0) {
      refill();
      std::size_t taken = left_;
      written = size;  // without input it may still hand out what it holds
      const std::size_t result = LZ4F_decompress(context_, to, &written, next_, &taken, nullptr);
      if (LZ4F_isError(result) != 0) throw BagError("its lz4 data are damaged");
      if (written == 0 && taken == 0 && result != 0) throw BagError("its lz4 data are cut off");
      next_ += taken;
      left_ -= taken;
      ended_ = result == 0;
    }
    return written;
  }

 private:
  LZ4F_dctx* context_ = nullptr;
  bool ended_ = false;
};

}  // namespace

InputFile::InputFile(const std::string& name) try : file_(openRegularFile(name, "bag")) {
} catch (const std::invalid_argument& error) {
  throw std::runtime_error(error.what());  // as for all else that is wrong with a bag
}

void InputFile::read(std::uint64_t position, char* to, std::size_t size) const {
  while (size > 0) {
    const ssize_t count = pread(file_.descriptor.number(), to, size, static_cast<off_t>(position));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0)
      throw BagError("byte " + std::to_string(position) + " cannot be read: " + std::strerror(errno),
                     BagError::Remedy::kAsSaid);
    if (count == 0) throw BagError("it has become shorter while it was read", BagError::Remedy::kAsSaid);
    to += count;
    size -= static_cast<std::size_t>(count);
    position += static_cast<std::uint64_t>(count);
  }
}

std::uint64_t ByteSource::skip(std::uint64_t /*size*/) { return 0; }

std::unique_ptr<ByteSource> openBytes(const InputFile& file, std::uint64_t position, std::uint64_t size,
                                      Compression compression) {
  switch (compression) {
    case Compression::kBz2:
      return std::make_unique<Bz2Bytes>(file, position, size);
    case Compression::kLz4:
      return std::make_unique<Lz4Bytes>(file, position, size);
    case Compression::kNone:
      break;
  }
  return std::make_unique<FileBytes>(file, position, size);
}

}  // namespace tissue_contact
