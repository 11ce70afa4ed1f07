#include "contact/shape/field_cache.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/whole_file.h"

namespace tissue_contact {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kFormat = 2;  // raise it when the samples or this file change
constexpr std::uintmax_t kMostBytes = 256u << 20;
constexpr const char* kExtension = ".field";
constexpr std::size_t kKeyDigits = 32;

/// Fowler, Noll and Vo's hash over 64-bit words.
class Hash {
 public:
  explicit Hash(std::uint64_t seed) : value_(0xcbf29ce484222325u ^ seed) {}
  void add(const void* data, std::size_t bytes) {
    const char* from = static_cast<const char*>(data);
    while (bytes > 0) {
      std::uint64_t word = 0;
      const std::size_t part = std::min(bytes, sizeof word);
      std::memcpy(&word, from, part);
      value_ = (value_ ^ word) * 0x100000001b3u;
      value_ ^= value_ >> 29;
      from += part;
      bytes -= part;
    }
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_;
};

/// What stands before the samples. Plain numbers without gaps, so that its bytes are its value.
struct Header {
  std::array<char, 8> magic = {'T', 'C', 'F', 'I', 'E', 'L', 'D', '\n'};
  std::uint64_t format = kFormat;
  std::array<char, kKeyDigits> key{};
  std::array<std::int64_t, 3> size{};
  std::array<double, 13> numbers{};  ///< origin, spacing, low, high, deviations
  std::uint64_t checksum = 0;        ///< of all the rest
};

std::uint64_t checksumOf(Header header, const std::vector<float>& samples) {
  header.checksum = 0;
  Hash hash(1);
  hash.add(&header, sizeof header);
  hash.add(samples.data(), samples.size() * sizeof(float));
  return hash.value();
}

/// Where the numbers of a header stand in the field.
template <typename Field>
auto numbersOf(Field& field) {
  auto& o = field.grid.origin;
  auto& low = field.low;
  auto& high = field.high;
  return std::array{&o.x(),
                    &o.y(),
                    &o.z(),
                    &field.grid.spacing,
                    &low.x(),
                    &low.y(),
                    &low.z(),
                    &high.x(),
                    &high.y(),
                    &high.z(),
                    &field.largest_deviation,
                    &field.rms_deviation,
                    &field.median_deviation};
}

Header headerOf(const MeshField& field, const std::string& key) {
  Header header;
  std::copy_n(key.begin(), header.key.size(), header.key.begin());
  std::copy_n(field.grid.size.begin(), 3, header.size.begin());
  const auto numbers = numbersOf(field);
  for (std::size_t i = 0; i < numbers.size(); ++i) header.numbers[i] = *numbers[i];
  header.checksum = checksumOf(header, field.grid.samples);
  return header;
}

MeshField fieldOf(const Header& header, std::vector<float> samples) {
  MeshField field;
  for (int a = 0; a < 3; ++a) field.grid.size[a] = static_cast<int>(header.size[a]);
  const auto numbers = numbersOf(field);
  for (std::size_t i = 0; i < numbers.size(); ++i) *numbers[i] = header.numbers[i];
  field.grid.samples = std::move(samples);
  return field;
}

/// Whether a file in the directory is one of ours: the key's digits, the extension and what follows it.
bool isOurs(const std::string& name, const std::string& ending) {
  return name.size() >= kKeyDigits + ending.size() && name.compare(kKeyDigits, ending.size(), ending) == 0 &&
         name.find_first_not_of("0123456789abcdef") == kKeyDigits;
}

/// What a run that was killed has left where files cannot be without a name; one that still writes is done in minutes.
bool isLeft(const fs::directory_entry& entry) {
  std::error_code error;
  return isOurs(entry.path().filename().string(), std::string(kExtension) + ".partial-") &&
         entry.last_write_time(error) < fs::file_time_type::clock::now() - std::chrono::hours(1) && !error;
}

void removeOldest(const fs::path& directory) {
  std::vector<std::pair<fs::file_time_type, fs::path>> files;
  std::uintmax_t bytes = 0;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, error)) {
    if (isLeft(entry)) fs::remove(entry.path(), error);
    const std::string name = entry.path().filename().string();
    if (!isOurs(name, kExtension) || name.size() != kKeyDigits + std::strlen(kExtension)) continue;
    files.emplace_back(entry.last_write_time(error), entry.path());
    const std::uintmax_t size = entry.file_size(error);
    if (!error) bytes += size;
  }
  std::sort(files.begin(), files.end());
  for (const auto& [time, path] : files) {
    if (bytes <= kMostBytes) return;
    const std::uintmax_t size = fs::file_size(path, error);
    if (!error && fs::remove(path, error)) bytes -= std::min(bytes, size);
  }
}

/// Only the last one is private to us; those above it belong to all programs.
void makeDirectory(const std::string& directory) {
  std::error_code error;
  fs::create_directories(fs::path(directory).parent_path(), error);
  mkdir(directory.c_str(), S_IRWXU);  // where it fails, writing says why
}

/// Why files there are not to be believed; empty when they are. The check sum finds damage, not forgery.
std::string distrust(const std::string& directory) {
  struct stat status {};
  if (stat(directory.c_str(), &status) != 0 || (status.st_mode & S_IWOTH) == 0) return "";
  return "everybody may write there; chmod o-w it";
}

}  // namespace

std::string fieldKey(const TriangleMesh& mesh, double sample_count) {
  std::string key;
  for (const std::uint64_t seed : {0x51ed2701u, 0x9e3779b9u}) {
    Hash hash(seed);
    hash.add(&kFormat, sizeof kFormat);
    hash.add(&sample_count, sizeof sample_count);
    const std::uint64_t vertices = static_cast<std::uint64_t>(mesh.vertices.cols());
    hash.add(&vertices, sizeof vertices);
    hash.add(mesh.vertices.data(), static_cast<std::size_t>(mesh.vertices.size()) * sizeof(double));
    hash.add(mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle));
    for (int digit = 60; digit >= 0; digit -= 4) key += "0123456789abcdef"[(hash.value() >> digit) & 15u];
  }
  return key;
}

bool readField(const std::string& directory, const std::string& key, MeshField& field) {
  if (directory.empty() || !distrust(directory).empty()) return false;
  std::string content;
  try {
    content = readFile((fs::path(directory) / (key + kExtension)).string(), "prepared mesh", kMostBytes);
  } catch (const std::exception&) {
    return false;
  }
  Header header;
  if (content.size() < sizeof header) return false;
  std::memcpy(&header, content.data(), sizeof header);
  if (header.magic != Header().magic || header.format != kFormat) return false;
  if (!std::equal(header.key.begin(), header.key.end(), key.begin(), key.end())) return false;
  std::uintmax_t count = 1;
  for (const std::int64_t size : header.size) {
    if (size < 4 || size > 1 << 20 || count > kMostBytes) return false;
    count *= static_cast<std::uintmax_t>(size);
  }
  if (content.size() != sizeof header + count * sizeof(float)) return false;
  std::vector<float> samples(count);
  std::memcpy(samples.data(), content.data() + sizeof header, count * sizeof(float));
  if (checksumOf(header, samples) != header.checksum) return false;
  field = fieldOf(header, std::move(samples));
  return true;
}

std::string writeField(const std::string& directory, const std::string& key, const MeshField& field) {
  if (directory.empty()) return "";
  makeDirectory(directory);
  if (const std::string why = distrust(directory); !why.empty())
    return "cannot write to '" + directory + "' (" + why + ")";
  try {
    WholeFile file((fs::path(directory) / (key + kExtension)).string());
    const Header header = headerOf(field, key);
    file.stream().write(reinterpret_cast<const char*>(&header), sizeof header);
    file.stream().write(reinterpret_cast<const char*>(field.grid.samples.data()),
                        static_cast<std::streamsize>(field.grid.samples.size() * sizeof(float)));
    file.commit();
  } catch (const std::exception& error) {
    return error.what();
  }
  removeOldest(directory);
  return "";
}

}  // namespace tissue_contact
