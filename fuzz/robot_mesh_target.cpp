/// @file
/// Mesh files of robot models: STL, OBJ, DAE. The first byte says which; the rest is the file. Whatever the library that
/// reads them does, ours must answer: so the stored inputs, some of which crash it, are read as a simulation reads them, in
/// a process of their own. With FUZZ_UNPROTECTED in the environment the library runs in this process, hundreds of times
/// faster, and its faults end it.
#include <stdexcept>

#include "fuzz/fuzz_support.h"
#include "mesh/reader/assimp_reader.h"
#include "tissue_contact/mesh/triangle_mesh.h"

using namespace tissue_contact;

namespace {

template <typename Vertices>
void checkIndices(const std::vector<Triangle>& triangles, const Vertices& count) {
  for (const Triangle& triangle : triangles) {
    for (const int v : triangle) fuzz::require(v >= 0 && v < static_cast<int>(count), "indices in range");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const bool unprotected = std::getenv("FUZZ_UNPROTECTED") != nullptr;
  static fuzz::InputFile file;
  constexpr const char* kNames[] = {"input.stl", "input.obj", "input.dae"};
  const std::string& path = file.hold(kNames[data[0] % 3], fuzz::textOf(data + 1, size - 1));
  try {
    if (unprotected) {
      const TriangleSoup soup = readTriangleSoupUnprotected(path);
      checkIndices(soup.triangles, soup.vertices.size());
    } else {
      const TriangleMesh mesh = loadTriangleMesh(path, Vector3::Ones());
      fuzz::require(!mesh.triangles.empty() && mesh.vertices.allFinite(), "a mesh that was read has finite triangles");
      checkIndices(mesh.triangles, mesh.vertices.cols());
    }
  } catch (const std::invalid_argument&) {
  } catch (const std::bad_alloc&) {
    fuzz::require(unprotected, "too much memory is an error that names the file");
  }
  return 0;
}
