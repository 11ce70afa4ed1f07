/// Prints what an implicit step costs: press and drag (a 5 mm ball, 4 mm deep, 20 mm/s) on a block or on a Gmsh mesh of the
/// same block, with the median and the 99th percentile of the processor time of a step in contact. `--trace FILE` writes
/// every step, with its page faults: why was this one slow?
/// usage: step_costs CELLS_X,CELLS_Y,CELLS_Z|MESH.msh [--refinement never|auto|fine|MAP] [--tolerance T] [--relaxation NAME] [--iterations N]
/// [--step S] [--drag M] [--youngs-modulus PA] [--poissons-ratio NU] [--trace FILE]
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "step_times.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/simulation/simulator.h"

namespace {

using namespace tissue_contact;

constexpr double kSpeed = 0.02;   // m/s
constexpr double kDown = 0.0041;  // m, of which .1 mm through air

struct Arguments {
  std::string mesh;
  std::map<std::string, std::string> values = {{"--tolerance", "0.001"},     {"--relaxation", "gauss_seidel"},
                                               {"--iterations", "30"},       {"--youngs-modulus", "5000"},
                                               {"--poissons-ratio", "0.45"}, {"--step", "0.001"},
                                               {"--drag", "0.01"},           {"--trace", ""},
                                               {"--refinement", "never"}};
};

bool parse(int argc, char** argv, Arguments& arguments) {
  if (argc < 2 || argc % 2 != 0) return false;
  arguments.mesh = argv[1];
  for (int i = 2; i < argc; i += 2) {
    const auto value = arguments.values.find(argv[i]);
    if (value == arguments.values.end()) return false;
    value->second = argv[i + 1];
  }
  return true;
}

Simulator makeScene(const Arguments& arguments) {
  const bool file = arguments.mesh.find(".msh") != std::string::npos;
  const std::string geometry = file ? "mesh: {file: " + arguments.mesh + "}\n"
                                    : "block: {size_m: [0.10, 0.10, 0.04], cells: [" + arguments.mesh + "]}\n";
  const std::string yaml =
      "tissues:\n  - name: block\n    " + geometry +
      "    material: {model: corotational, youngs_modulus_pa: " + arguments.values.at("--youngs-modulus") +
      ", poissons_ratio: " + arguments.values.at("--poissons-ratio") +
      ", density_kg_per_m3: 1000}\n"
      "    damping: {stiffness_s: 0.003}\n"
      "    refinement: " +
      arguments.values.at("--refinement") +
      "\n"
      "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
      "instruments:\n  - name: probe\n    urdf: package://tissue_contact/urdf/probe.urdf\n    tip_link: tip\n"
      "    joint_state_topics: [/probe/joint_states]\n    base_pose: {position_m: [-0.01, 0, 0.0451]}\n"
      "    contact_links: [tip]\n"
      "step: {max_step_s: " +
      arguments.values.at("--step") + "}\nsolver: {relaxation: " + arguments.values.at("--relaxation") +
      ", tolerance: " + arguments.values.at("--tolerance") + ", iterations: " + arguments.values.at("--iterations") +
      "}\nfriction: [{instrument: probe, tissue: block, static: 0.5}]\n";
  SceneEnvironment environment;
  environment.package_path = [](const std::string&) { return std::string(TISSUE_CONTACT_SOURCE_DIR); };
  return Simulator(parseScene(yaml, "step_costs", environment.package_path), environment);
}

void run(Simulator& simulator, const Arguments& arguments) {
  const double dt = std::stod(arguments.values.at("--step"));
  const std::optional<double> drag_m = toDouble(arguments.values.at("--drag"));
  if (!drag_m) throw std::invalid_argument("--drag: '" + arguments.values.at("--drag") + "' is no number of metres");
  const double way = kDown + *drag_m;
  const std::string& trace = arguments.values.at("--trace");
  std::FILE* const file = trace.empty() ? nullptr : std::fopen(trace.c_str(), "w");
  if (!trace.empty() && file == nullptr) throw std::invalid_argument("--trace: cannot write '" + trace + "'");
  if (file != nullptr)
    std::fprintf(file, "step,ms,iterations,contacts,static,kinetic,fx,fz,minor_faults,major_faults\n");
  std::vector<double> ms;
  double iterations = 0.0;
  for (int k = 1; kSpeed * dt * k <= way; ++k) {
    const double path = kSpeed * dt * k;
    const std::vector<VectorX> joints = {Vector3(std::max(path - kDown, 0.0), 0.0, -std::min(path, kDown))};
    const PageFaults faults_before = pageFaults();
    const double before = processorSeconds();
    simulator.advance(dt, joints);
    const double took = 1e3 * (processorSeconds() - before);
    const PageFaults faults = pageFaults();
    const StepReport& report = simulator.report();
    const int contacts = report.open_contacts + report.static_contacts + report.kinetic_contacts;
    const Vector3 force = simulator.wrench(0).force;
    if (file != nullptr) {
      std::fprintf(file, "%d,%.4f,%d,%d,%d,%d,%.9g,%.9g,%ld,%ld\n", k, took, report.iterations, contacts,
                   report.static_contacts, report.kinetic_contacts, force.x(), force.z(),
                   faults.minor - faults_before.minor, faults.major - faults_before.major);
    }
    if (force.isZero(0.0)) continue;
    ms.push_back(took);
    iterations += report.iterations;
  }
  if (file != nullptr) std::fclose(file);
  std::printf("%s meshes %d nodes %d median_ms %.4f p99_ms %.4f max_ms %.4f iterations %.1f steps %zu\n",
              arguments.mesh.c_str(), simulator.meshRevision(0), simulator.tissues()[0].nodeCount(), quantile(ms, 0.5),
              quantile(ms, 0.99), quantile(ms, 1.0), ms.empty() ? 0.0 : iterations / static_cast<double>(ms.size()),
              ms.size());
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  if (!parse(argc, argv, arguments)) {
    std::fprintf(
        stderr,
        "usage: step_costs CELLS_X,CELLS_Y,CELLS_Z|MESH.msh [--refinement never|auto|fine|MAP] [--tolerance T] "
        "[--relaxation NAME] "
        "[--iterations N] [--step S] [--drag M] [--youngs-modulus PA] [--poissons-ratio NU] [--trace FILE]\n");
    return 2;
  }
  try {
    Simulator simulator = makeScene(arguments);
    run(simulator, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "step_costs: %s\n", error.what());
    return 2;
  }
  return 0;
}
