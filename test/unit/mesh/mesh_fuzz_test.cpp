/// @file
/// Damaged mesh files, thousands of them from a fixed seed: each gives a mesh or std::invalid_argument, never a crash,
/// and never an allocation out of proportion to the file. Meant to be run under AddressSanitizer now and then as well.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>
#include <random>
#include <string>
#include <vector>

#include "mesh_writers.h"

namespace {
std::atomic<std::size_t> largest_request{0};

void* countedAllocation(std::size_t size, const std::nothrow_t&) noexcept {
  std::size_t largest = largest_request.load();
  while (size > largest && !largest_request.compare_exchange_weak(largest, size)) {
  }
  return std::malloc(size == 0 ? 1 : size);
}

void* countedAllocation(std::size_t size) {
  if (void* memory = countedAllocation(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
}  // namespace

// The whole program's, the core library's included.
void* operator new(std::size_t size) { return countedAllocation(size); }
void* operator new[](std::size_t size) { return countedAllocation(size); }
void* operator new(std::size_t size, const std::nothrow_t& how) noexcept { return countedAllocation(size, how); }
void* operator new[](std::size_t size, const std::nothrow_t& how) noexcept { return countedAllocation(size, how); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace tissue_contact {
namespace {

constexpr int kCasesPerSeed = 600;

std::vector<std::string> wholeFiles() {
  std::vector<std::string> files;
  for (const char* name :
       {"box_v22.msh", "box_v22_binary.msh", "box_v40_parametric.msh", "box_v41.msh", "box_v41_binary_parametric.msh",
        "box_v41_binary_order2.msh", "box_v2.vtk", "box_v2_binary.vtk", "box_v1.msh"}) {
    files.push_back(readBytes(fixturePath(name)));
  }
  const TetMesh mesh = makeBlockMesh({Vector3(1, 1, 1), {1, 1, 1}, {}});  // small: more damage per byte
  for (const bool big_endian : {false, true}) {
    files.push_back(msh22Binary(mesh, big_endian));
    files.push_back(msh4Binary(mesh, big_endian, false));
    files.push_back(msh4Binary(mesh, big_endian, true));
  }
  for (const char* version : {"4.2", "5.1"}) {
    for (const bool binary : {false, true}) files.push_back(VtkWriter({version, binary}).write(mesh));
  }
  return files;
}

class Damage {
 public:
  explicit Damage(unsigned seed) : random_(seed) {}

  std::string apply(std::string bytes) {
    for (int i = pick(1, 4); i > 0; --i) {
      if (!bytes.empty()) damage(bytes);
    }
    return bytes;
  }

 private:
  int pick(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  std::size_t place(const std::string& bytes) {
    return static_cast<std::size_t>(pick(0, static_cast<int>(bytes.size()) - 1));
  }

  void damage(std::string& bytes) {
    const std::size_t at = place(bytes);
    switch (pick(0, 6)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << pick(0, 7)));
        break;
      case 1:
        bytes[at] = static_cast<char>(pick(0, 255));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.erase(at, static_cast<std::size_t>(pick(1, 16)));
        break;
      case 4:
        bytes.insert(at, bytes.substr(place(bytes), static_cast<std::size_t>(pick(1, 64))));
        break;
      case 5:
        extremeNumber(bytes, at);
        break;
      default:
        extremeText(bytes);
        break;
    }
  }
  void extremeNumber(std::string& bytes, std::size_t at) {
    const std::int64_t numbers[] = {-1, 0, INT32_MAX, INT32_MIN, INT64_MAX, INT64_MIN, std::int64_t{1} << 33};
    const auto size = static_cast<unsigned>(pick(0, 1) == 0 ? 4 : 8);
    bytes.replace(at, size, ByteWriter(pick(0, 1) == 0).integer(numbers[pick(0, 6)], size).bytes());
  }
  void extremeText(std::string& bytes) {  // replaces a number that is written as text, in the headers above all
    const char* texts[] = {"-1",  "0",     "1", "4000000000", "9223372036854775807", "99999999999999999999",
                           "nan", "1e999", "x"};
    const std::size_t from = pick(0, 1) == 0 ? 0 : place(bytes);
    const std::size_t begin = std::min(bytes.find_first_of("0123456789", from), bytes.size() - 1);
    const std::size_t end = std::min(bytes.find_first_not_of("0123456789", begin), bytes.size());
    bytes.replace(begin, end - begin, texts[pick(0, 8)]);
  }

  std::mt19937 random_;
};

[[maybe_unused]] long peakMegabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

TEST(MeshFuzz, DamagedFilesAreReadOrRefused) {
  const std::vector<std::string> files = wholeFiles();
  const FileOfBytes file("");
  [[maybe_unused]] const long peak_before = peakMegabytes();
  int read = 0;
  int refused = 0;
  for (std::size_t f = 0; f < files.size(); ++f) {
    Damage damage(static_cast<unsigned>(1000 + f));
    for (int c = 0; c < kCasesPerSeed; ++c) {
      const std::string bytes = damage.apply(files[f]);
      file.write(bytes);
      largest_request = 0;
      try {
        const TetMesh mesh = loadTetMesh(meshFile(file.path(), c % 2 == 0));
        ++read;
        ASSERT_TRUE(mesh.positions.allFinite());
        for (const Tetrahedron& tet : mesh.tetrahedra) {
          for (const int node : tet) ASSERT_TRUE(node >= 0 && node < mesh.positions.cols());
        }
      } catch (const std::invalid_argument& error) {
        ++refused;
        ASSERT_NE(std::string(error.what()).find(file.path()), std::string::npos) << error.what();
        ASSERT_LT(std::string(error.what()).size(), 1000U);
      }
      // No single array may exceed ten times the file; 16 kB are the stream's and gtest's own.
      ASSERT_LE(largest_request.load(), 10 * bytes.size() + 16384) << "file " << f << ", case " << c;
    }
  }
  // A fuzz test that only ever meets one outcome tests little.
  EXPECT_GT(read, 500);
  EXPECT_GT(refused, 5000);
  RecordProperty("read", read);
  RecordProperty("refused", refused);
#ifndef __SANITIZE_ADDRESS__  // which keeps freed memory for a while
  EXPECT_LT(peakMegabytes() - peak_before, 100) << "MB more than before";
#endif
}

}  // namespace
}  // namespace tissue_contact
