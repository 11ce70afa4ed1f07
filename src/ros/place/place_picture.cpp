#include <cmath>
#include <cstdio>
#include <memory>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "ros/place/place.h"
#include "ros/place/placed_scene.h"
#include "ros/place/recorded_motion.h"
#include "ros/run_script.h"
#include "tissue_contact/core/whole_file.h"

namespace tissue_contact {
namespace {

using Points = std::vector<Vector3>;

void write(std::ostream& out, const Vector3& p) { out << '[' << p.x() << ',' << p.y() << ',' << p.z() << ']'; }
void write(std::ostream& out, int number) { out << number; }
void write(std::ostream& out, const Triangle& t) { out << '[' << t[0] << ',' << t[1] << ',' << t[2] << ']'; }

/// As JSON has it.
template <typename Items>
void writeList(std::ostream& out, const Items& items) {
  out << '[';
  bool first = true;
  for (const auto& item : items) {
    if (!std::exchange(first, false)) out << ',';
    write(out, item);
  }
  out << ']';
}

Points columns(const NodalVectors& matrix) {
  Points points;
  for (Eigen::Index i = 0; i < matrix.cols(); ++i) points.emplace_back(matrix.col(i));
  return points;
}

/// Points whose convex hull is the shape, as near as a picture tells; of a mesh, which need not be convex, its vertices.
Points outline(const CollisionShape& shape) {
  if (shape.mesh) return columns(shape.mesh->vertices);
  Points points;
  constexpr int kAround = 24;
  const auto around = [](int i) { return 2.0 * M_PI * i / kAround; };
  if (const auto* box = std::get_if<BoxGeometry>(&shape.geometry)) {
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        for (const double z : {-0.5, 0.5}) points.push_back(Vector3(x, y, z).cwiseProduct(box->size_m));
      }
    }
  } else if (const auto* cylinder = std::get_if<CylinderGeometry>(&shape.geometry)) {
    for (int i = 0; i < kAround; ++i) {
      const Vector2 p = cylinder->radius_m * Vector2(std::cos(around(i)), std::sin(around(i)));
      for (const double z : {-0.5, 0.5}) points.emplace_back(p.x(), p.y(), z * cylinder->length_m);
    }
  } else if (const auto* sphere = std::get_if<SphereGeometry>(&shape.geometry)) {
    for (int i = 0; i < kAround; ++i) {
      for (int j = 0; j <= kAround / 2; ++j) {
        const double polar = around(j);
        points.push_back(sphere->radius_m * Vector3(std::sin(polar) * std::cos(around(i)),
                                                    std::sin(polar) * std::sin(around(i)), std::cos(polar)));
      }
    }
  }
  return points;
}

void writeTissues(const Simulator& simulator, std::ostream& out) {
  out << "\"tissues\":[";
  for (std::size_t t = 0; t < simulator.tissues().size(); ++t) {
    const Tissue& tissue = simulator.tissues()[t];
    std::vector<int> fixed;
    for (std::size_t node = 0; node < tissue.fixed().size(); ++node) {
      if (tissue.fixed()[node]) fixed.push_back(static_cast<int>(node));
    }
    out << (t == 0 ? "" : ",") << "{\"name\":\"" << tissue.name() << "\",\"points\":";
    writeList(out, columns(simulator.positions(static_cast<int>(t))));
    out << ",\"triangles\":";
    writeList(out, tissue.surface());
    out << ",\"fixed\":";
    writeList(out, fixed);
    out << '}';
  }
  out << ']';
}

/// @param ways of the tips, one per instrument.
void writeInstruments(const Simulator& simulator, const std::vector<Points>& ways, std::ostream& out) {
  out << "\"instruments\":[";
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) {
    const Instrument& instrument = simulator.instruments()[i];
    const std::vector<Pose>& X_WL = simulator.linkPoses(static_cast<int>(i));
    out << (i == 0 ? "" : ",") << "{\"name\":\"" << instrument.name() << "\",\"tip\":";
    write(out, X_WL[static_cast<std::size_t>(instrument.tipLink())].translation());
    out << ",\"way\":";
    writeList(out, ways[i]);
    out << ",\"shapes\":[";
    bool first = true;
    for (const ContactLink& link : instrument.contactLinks()) {
      for (const CollisionShape& shape : link.shapes) {
        Points points = outline(shape);
        for (Vector3& p : points) p = X_WL[static_cast<std::size_t>(link.link)] * shape.X_LS * p;
        if (!std::exchange(first, false)) out << ',';
        writeList(out, points);
      }
    }
    out << "]}";
  }
  out << ']';
}

/// Where the tips go, and the instruments where the recording begins.
std::vector<Points> followBag(const PlaceOptions& options, const PlacedScene& placed, Simulator& simulator) {
  constexpr std::size_t kMost = 100000;  // of a picture's points
  std::vector<Points> ways(simulator.instruments().size());
  const auto take = [&](std::int64_t /*stamp_ns*/, const Simulator& moved) {
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const auto index = static_cast<int>(i);
      if (ways[i].empty()) simulator.placeInstrument(index, moved.jointPositions(index));
      if (ways[i].size() == kMost) continue;
      const auto tip = static_cast<std::size_t>(moved.instruments()[i].tipLink());
      ways[i].emplace_back(moved.linkPoses(index)[tip].translation());
    }
  };
  if (!options.bag_file.empty()) playMotion(placed.scene, placed.environment, options.bag_file, take);
  return ways;
}

}  // namespace

void placePicture(const PlaceOptions& options) {
  requireFreeOutputs({{"--out", options.out_file}}, {{"--scene", options.scene_file}, {"--bag", options.bag_file}});
  const PlacedScene placed(options);
  Simulator simulator(placed.scene, placed.environment);
  const std::vector<Points> ways = followBag(options, placed, simulator);
  std::ostringstream json;
  json << '{';
  writeTissues(simulator, json);
  json << ',';
  writeInstruments(simulator, ways, json);
  json << '}';
  const std::string text = json.str();
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), std::fclose);
  if (!file || std::fwrite(text.data(), 1, text.size(), file.get()) != text.size() || std::fflush(file.get()) != 0) {
    throw std::runtime_error("no room for a temporary file; set TMPDIR or free some");
  }
  std::rewind(file.get());
  runScript("draw_scene.py", {"--out", options.out_file, "--frame", placed.scene.world_frame}, fileno(file.get()));
}

}  // namespace tissue_contact
