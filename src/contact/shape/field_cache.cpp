#include "contact/shape/field_cache.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "tissue_contact/core/cache_folder.h"

namespace tissue_contact {
namespace {

constexpr std::uint64_t kFormat = 4;  // raise it when the samples or this file change
constexpr std::uintmax_t kMostFieldBytes = 256u << 20;
constexpr const char* kExtension = ".field";

/// What stands before the samples. Plain numbers without gaps, so that its bytes are its value.
struct Header {
  std::array<char, 8> magic = {'T', 'C', 'F', 'I', 'E', 'L', 'D', '\n'};
  std::uint64_t format = kFormat;
  std::array<char, ContentKey::kDigits> key{};
  std::array<std::int64_t, 3> size{};
  std::array<double, 13> numbers{};  ///< origin, spacing, low, high, deviations
  std::uint64_t checksum = 0;        ///< of all the rest
};

std::uint64_t checksumOf(Header header, const std::vector<float>& samples) {
  header.checksum = 0;
  ContentHash hash(1);
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

}  // namespace

std::string fieldKey(const TriangleMesh& mesh, double sample_count) {
  ContentKey key;
  key.add(&kFormat, sizeof kFormat);
  key.add(&sample_count, sizeof sample_count);
  const std::uint64_t vertices = static_cast<std::uint64_t>(mesh.vertices.cols());
  key.add(&vertices, sizeof vertices);
  key.add(mesh.vertices.data(), static_cast<std::size_t>(mesh.vertices.size()) * sizeof(double));
  key.add(mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle));
  return key.digits();
}

bool readField(const std::string& directory, const std::string& key, MeshField& field) {
  const std::string content = CacheFolder(directory, kExtension).read(key);
  Header header;
  if (content.size() < sizeof header) return false;
  std::memcpy(&header, content.data(), sizeof header);
  if (header.magic != Header().magic || header.format != kFormat) return false;
  if (!std::equal(header.key.begin(), header.key.end(), key.begin(), key.end())) return false;
  std::uintmax_t count = 1;
  for (const std::int64_t size : header.size) {
    if (size < 4 || size > 1 << 20 || count > kMostFieldBytes) return false;
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
  const Header header = headerOf(field, key);
  return CacheFolder(directory, kExtension)
      .write(key, {std::string(reinterpret_cast<const char*>(&header), sizeof header),
                   std::string(reinterpret_cast<const char*>(field.grid.samples.data()),
                               field.grid.samples.size() * sizeof(float))});
}

}  // namespace tissue_contact
