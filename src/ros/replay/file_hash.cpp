#include "ros/replay/file_hash.h"

#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "tissue_contact/core/read_file.h"

namespace tissue_contact {
namespace {

void require(int done) {
  if (done != 1) throw std::runtime_error("SHA-256 is not to be had from this libcrypto");
}

std::string inDigits(const unsigned char* bytes, unsigned count) {
  std::string digits;
  for (unsigned i = 0; i < count; ++i) {
    digits += "0123456789abcdef"[bytes[i] >> 4U];
    digits += "0123456789abcdef"[bytes[i] & 15U];
  }
  return digits;
}

}  // namespace

FileHash hashOfFile(const std::string& file, const std::string& what) {
  requireRegularFile(file, what);
  std::ifstream stream(file, std::ios::binary);
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  require(static_cast<int>(context != nullptr));
  require(EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr));
  FileHash hash;
  std::vector<char> part(std::size_t{1} << 16U);
  while (stream.read(part.data(), static_cast<std::streamsize>(part.size())) || stream.gcount() > 0) {
    const auto count = static_cast<std::size_t>(stream.gcount());
    require(EVP_DigestUpdate(context.get(), part.data(), count));
    hash.bytes += count;
  }
  if (!stream.eof()) throw std::invalid_argument(what + " '" + file + "' cannot be read to its end");
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned length = 0;
  require(EVP_DigestFinal_ex(context.get(), digest.data(), &length));
  hash.sha256 = inDigits(digest.data(), length);
  return hash;
}

}  // namespace tissue_contact
