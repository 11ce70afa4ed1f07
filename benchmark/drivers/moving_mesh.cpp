/// A ball wanders over a block whose mesh follows it: prints what the steps cost in which the mesh moves and the others, and how
/// much the force turns in either; of the stepping thread, and by the clock on the wall, which also has in it what steps wait for the
/// worker that prepares meshes. The ball is pressed .4 of its radius deep and slides along a figure of eight.
/// usage: moving_mesh [--speed M_PER_S] [--length M] [--radius M] [--block X_M,Y_M,Z_M,CELLS_X,CELLS_Y,CELLS_Z] [--mesh FILE]
///                    [--refinement never|auto|fine|MAP] [--tolerance T] [--trace FILE] [--surfaces FILE]
///   --mesh: the same block from a Gmsh file (roam.py); --trace: every step as CSV; --surfaces: the surface at six moments, for
///   plot_moving_mesh.py
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "step_times.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/simulation/simulator.h"

namespace {

using namespace tissue_contact;

constexpr double kStep = 0.001;    // s
constexpr double kAir = 0.0001;    // m, between ball and block at the start
constexpr double kDownTime = 0.1;  // s
constexpr double kRest = 0.1;      // s
constexpr int kMoments = 6;

using Arguments = std::map<std::string, std::string>;
using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

Arguments parse(int argc, char** argv) {
  Arguments arguments = {
      {"--speed", "0.02"}, {"--length", "0.2"},      {"--radius", "0.005"},   {"--block", "0.1,0.1,0.04,10,10,4"},
      {"--mesh", ""},      {"--refinement", "auto"}, {"--tolerance", "1e-4"}, {"--trace", ""},
      {"--surfaces", ""}};
  for (int i = 1; i < argc; i += 2) {
    const auto value = arguments.find(argv[i]);
    if (value == arguments.end() || i + 1 == argc) {
      throw std::invalid_argument(
          "usage: moving_mesh [--speed M_PER_S] [--length M] [--radius M] [--block "
          "X_M,Y_M,Z_M,CELLS_X,CELLS_Y,CELLS_Z] "
          "[--mesh FILE] [--refinement never|auto|fine|MAP] [--tolerance T] [--trace FILE] [--surfaces FILE]");
    }
    value->second = argv[i + 1];
  }
  return arguments;
}

double positive(const Arguments& arguments, const std::string& name) {
  const auto value = toDouble(arguments.at(name));
  if (!value || !(*value > 0.0))
    throw std::invalid_argument(name + ": '" + arguments.at(name) + "'; give a number > 0");
  return *value;
}

File open(const Arguments& arguments, const std::string& name) {
  if (arguments.at(name).empty()) return {nullptr, std::fclose};
  File file(std::fopen(arguments.at(name).c_str(), "w"), std::fclose);
  if (!file) throw std::invalid_argument(name + ": cannot write '" + arguments.at(name) + "'");
  return file;
}

Simulator makeScene(const Arguments& arguments) {
  double x, y, z;
  int cells[3];
  if (std::sscanf(arguments.at("--block").c_str(), "%lf,%lf,%lf,%d,%d,%d", &x, &y, &z, cells, cells + 1, cells + 2) !=
      6)
    throw std::invalid_argument("--block: '" + arguments.at("--block") +
                                "'; give three lengths and three numbers of cells");
  const std::string geometry = arguments.at("--mesh").empty()
                                   ? "block: {size_m: [" + std::to_string(x) + ", " + std::to_string(y) + ", " +
                                         std::to_string(z) + "], cells: [" + std::to_string(cells[0]) + ", " +
                                         std::to_string(cells[1]) + ", " + std::to_string(cells[2]) + "]}"
                                   : "mesh: {file: " + arguments.at("--mesh") + ", remove_unreferenced_nodes: true}";
  const double radius = positive(arguments, "--radius");
  const std::string yaml =
      "tissues:\n  - name: block\n    " + geometry + "\n    refinement: " + arguments.at("--refinement") +
      "\n    material: {model: corotational, youngs_modulus_pa: 5000, poissons_ratio: 0.45, density_kg_per_m3: 1000}\n"
      "    damping: {stiffness_s: 0.003}\n    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
      "instruments:\n  - name: probe\n    urdf: package://tissue_contact/urdf/probe.urdf\n    tip_link: tip\n"
      "    joint_state_topics: [/probe/joint_states]\n    base_pose: {position_m: [0, 0, " +
      std::to_string(z + radius + kAir) +
      "]}\n    contact_links: [{link: tip, shapes: [{sphere: {radius_m: " + std::to_string(radius) +
      "}}]}]\n"
      "solver: {tolerance: " +
      arguments.at("--tolerance") +
      ", iterations: 100}\n"
      "friction: [{instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}]\n";
  SceneEnvironment environment;
  environment.package_path = [](const std::string&) { return std::string(TISSUE_CONTACT_SOURCE_DIR); };
  return Simulator(parseScene(yaml, "moving_mesh", environment.package_path), environment);
}

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Of the figure of eight, by an angle; its length is some 0.3 m.
Vector3 eight(double angle) { return {0.033 * std::sin(angle), 0.033 * std::sin(2.0 * angle), 0.0}; }

/// Joint positions of every step.
std::vector<Vector3> pathOf(double speed, double length, double depth) {
  std::vector<Vector3> path;
  for (int k = 1; kStep * k <= kDownTime + kRest; ++k) {
    path.emplace_back(0.0, 0.0, -depth * std::min(1.0, kStep * k / kDownTime));
  }
  const auto steps = static_cast<long>(length / (speed * kStep));
  double angle = 0.0;
  for (long k = 0; k < steps; ++k) {
    constexpr double kSmall = 1e-6;  // for the derivative of the path
    angle += speed * kStep * kSmall / (eight(angle + kSmall) - eight(angle)).norm();
    path.emplace_back(eight(angle) - Vector3(0.0, 0.0, depth));
  }
  return path;
}

void writeSurface(const Simulator& simulator, const Vector3& ball, std::FILE* file) {
  const NodalVectors& x = simulator.positions(0);
  std::fprintf(file, "ball,%g,%g,%d\n", ball.x(), ball.y(), simulator.tissues()[0].nodeCount());
  for (const Triangle& triangle : simulator.tissues()[0].surface()) {
    for (const int node : triangle) std::fprintf(file, "%.6g,%.6g,%.6g,", x(0, node), x(1, node), x(2, node));
    std::fprintf(file, "\n");
  }
}

/// Steps of one kind: in which the mesh moved, or not.
struct Steps {
  std::vector<double> ms;
  std::vector<double> wall_ms;
  std::vector<double> turns;  ///< what the force is off from going on as before, over its size
};

void print(const char* name, const Steps& steps) {
  std::printf(
      "%s: %zu steps, median_ms %.3f p99_ms %.3f max_ms %.3f, wall median_ms %.3f p99_ms %.3f max_ms %.3f, force turns "
      "by "
      "median %.3f %% p99 %.3f %% max %.3f %%\n",
      name, steps.ms.size(), quantile(steps.ms, 0.5), quantile(steps.ms, 0.99), quantile(steps.ms, 1.0),
      quantile(steps.wall_ms, 0.5), quantile(steps.wall_ms, 0.99), quantile(steps.wall_ms, 1.0),
      100.0 * quantile(steps.turns, 0.5), 100.0 * quantile(steps.turns, 0.99), 100.0 * quantile(steps.turns, 1.0));
}

void run(const Arguments& arguments) {
  const std::vector<Vector3> path = pathOf(positive(arguments, "--speed"), positive(arguments, "--length"),
                                           0.4 * positive(arguments, "--radius") + kAir);
  const File trace = open(arguments, "--trace");
  const File surfaces = open(arguments, "--surfaces");
  Simulator simulator = makeScene(arguments);
  if (trace) std::fprintf(trace.get(), "step,ms,nodes,revision,iterations,fx,fy,fz\n");
  const auto slides_from = static_cast<std::size_t>((kDownTime + kRest) / kStep);
  Steps all, moved, stayed;
  std::vector<Vector3> forces(2, Vector3::Zero());
  for (std::size_t k = 0; k < path.size(); ++k) {
    const int before = simulator.meshRevision(0);
    const double start = processorSeconds();
    const double wall_start = wallSeconds();
    simulator.advance(kStep, {path[k]});
    const double ms = 1e3 * (processorSeconds() - start);
    const double wall_ms = 1e3 * (wallSeconds() - wall_start);
    forces.push_back(simulator.wrench(0).force);
    const Vector3& force = forces.back();
    const double turn = (force - 2.0 * forces[k + 1] + forces[k]).norm() / force.norm();
    if (k > slides_from + 10) {
      for (Steps* const steps : {&all, simulator.meshRevision(0) != before ? &moved : &stayed}) {
        steps->ms.push_back(ms);
        steps->wall_ms.push_back(wall_ms);
        steps->turns.push_back(turn);
      }
    }
    if (trace) {
      std::fprintf(trace.get(), "%zu,%.4f,%d,%d,%d,%.9g,%.9g,%.9g\n", k + 1, ms, simulator.tissues()[0].nodeCount(),
                   simulator.meshRevision(0), simulator.report().iterations, force.x(), force.y(), force.z());
    }
    if (surfaces && (k + 1) % (path.size() / kMoments) == 0) writeSurface(simulator, path[k], surfaces.get());
  }
  print("all", all);
  print("mesh moves", moved);
  print("mesh stays", stayed);
  const MeshMoves moves = simulator.meshMoves(0);
  std::printf("moves: %d prepared, of which steps waited for %d; %d at once\n", moves.prepared, moves.waited,
              moves.at_once);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(parse(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "moving_mesh: %s\n", error.what());
    return 2;
  }
  return 0;
}
