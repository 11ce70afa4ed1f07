// Prepares mesh files as shapes and prints what it takes: benchmark/drivers/mesh_shapes FILE... [--cache DIRECTORY]
//   one line per file: triangles, grid, deviation from the mesh, seconds; or why it is refused
//   then a closest-point query per triangle of a 10 mm surface around the shape, in microseconds
#include <chrono>
#include <cstdio>
#include <exception>
#include <random>
#include <string>
#include <vector>

#include "contact/shape/shape_distance.h"
#include "tissue_contact/core/command_line.h"
#include "tissue_contact/instrument/collision_shape.h"
#include "tissue_contact/instrument/instrument_description.h"

namespace tc = tissue_contact;

namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Triangles of half the shape's size with their middles within its box.
double queryMicroseconds(const tc::ShapeDistance& shape) {
  std::mt19937 random(1);
  const auto number = [&] { return static_cast<double>(random()) / 4294967295.0 * 2.0 - 1.0; };
  const tc::Vector3 half = shape.halfExtents(tc::Matrix3::Identity());
  std::vector<tc::TrianglePoints> triangles;
  for (int i = 0; i < 1000; ++i) {
    const tc::Vector3 middle = shape.boxCentre() + tc::Vector3(number(), number(), number()).cwiseProduct(half);
    const auto corner = [&]() -> tc::Vector3 {
      return middle + half.maxCoeff() * tc::Vector3(number(), number(), number());
    };
    const tc::Vector3 a = corner();
    const tc::Vector3 b = corner();
    triangles.emplace_back(a, b, corner());
  }
  const double start = now();
  tc::ClosestPoint closest;
  int found = 0;
  for (int round = 0; round < 20; ++round) {
    for (const tc::TrianglePoints& t : triangles) found += shape.closest(t, 0.05 * shape.size(), closest) ? 1 : 0;
  }
  return found == 0 ? 0.0 : 1e6 * (now() - start) / (20.0 * static_cast<double>(triangles.size()));
}

}  // namespace

int main(int argc, char** argv) {
  tc::MeshPreparation preparation;
  preparation.clock = now;
  preparation.say = [](const std::string& line) {
    if (line.find("prepared") == std::string::npos) std::printf("%s\n", line.c_str());
  };
  const tc::CommandLine line({argv + 1, argv + argc}, {{"--cache"}, {}, {}, true});
  const std::vector<std::string>& files = line.words();
  preparation.cache_directory = line.value("--cache");
  const double start = now();
  tc::ShapeDistances distances(preparation);
  std::vector<std::pair<std::string, std::unique_ptr<tc::ShapeDistance>>> shapes;
  for (const std::string& file : files) {
    try {
      shapes.emplace_back(
          file,
          distances.make(tc::makeCollisionShape({tc::MeshGeometry{file, tc::Vector3::Ones()}, tc::Pose::Identity()})));
    } catch (const std::exception& error) {
      std::printf("refused: %s\n", error.what());
    }
  }
  std::printf("%zu shapes of %zu files in %.2f s\n", shapes.size(), files.size(), now() - start);
  for (const auto& [file, shape] : shapes)
    std::printf("%6.2f us per query: %s\n", queryMicroseconds(*shape), file.c_str());
  return 0;
}
