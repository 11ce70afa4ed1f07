/// One run of a scene of tissue_contact_benchmark on a mesh of one's own: forces on the last instrument over time, in tip
/// axes, as CSV. benchmark/truth/make_truth.py makes truths of many of them. To the error stream: how far the forces are from the stored
/// truth, where there is one, and how well the simulator's own estimate (Simulator::forceErrors()) tells it.
/// usage: truth_run SCENE MESH STEP_S TOLERANCE SECONDS [BAG]
///   SCENE press-drag, grasp, partial-slip or robot (with its BAG); MESH a file in the tissue's frame, - for the scene's
///   own, refined or fine for that one with refinement: auto or fine, or CELL_MM,REACH_MM,NODES[,GROWTH] for it refined
///   so; any of these but a file with @X,Y,Z behind it for a block of that many cells; SECONDS of the motion, 0: all
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "benchmark/scenes.h"
#include "benchmark/truth_table.h"

namespace {

using namespace tissue_contact;

struct Enough : std::exception {};

ScenePlan planOf(const std::string& name, const std::string& bag) {
  SceneOptions options;
  options.robot_bag = bag;
  if (name == "press-drag") return pressDragPlan(options);
  if (name == "grasp") return graspPlan(options);
  if (name == "partial-slip") return partialSlipPlan(options);
  if (name == "robot") return robotPlan(options);
  throw std::invalid_argument("no scene '" + name + "'");
}

/// @return what stands before @X,Y,Z, and the scene's block with so many cells; all of it where it does not end so, as a file.
std::string takeCells(const std::string& mesh, Scene& scene) {
  const std::size_t at = std::min(mesh.rfind('@'), mesh.size());
  std::array<int, 3> cells{};
  int length = 0;
  std::sscanf(mesh.c_str() + at, "@%d,%d,%d%n", &cells[0], &cells[1], &cells[2], &length);
  if (length == 0 || at + static_cast<std::size_t>(length) != mesh.size()) return mesh;
  auto* const block = std::get_if<BlockDescription>(&scene.tissues[0].geometry);
  if (block == nullptr) throw std::invalid_argument(mesh + ": the scene's tissue is no block");
  block->cells = cells;
  return mesh.substr(0, at);
}

void prepare(const std::vector<std::string>& words, Scene& scene) {
  RefinementDescription& refinement = scene.tissues[0].refinement;
  const std::string mesh_word = takeCells(words[1], scene);
  double cell_mm = 0.0;
  double reach_mm = 0.0;
  if (mesh_word == "refined") {
    refinement.mode = RefinementDescription::Mode::kAuto;
  } else if (mesh_word == "fine") {
    refinement.mode = RefinementDescription::Mode::kFine;
  } else if (std::sscanf(mesh_word.c_str(), "%lf,%lf,%d,%lf", &cell_mm, &reach_mm, &refinement.nodes_at_most,
                         &refinement.growth) >= 3) {
    refinement.mode = RefinementDescription::Mode::kGiven;
    refinement.cell_m = 1e-3 * cell_mm;
    refinement.reach_m = 1e-3 * reach_mm;
  } else if (mesh_word != "-") {
    MeshDescription mesh;
    mesh.file = mesh_word;
    mesh.remove_unreferenced_nodes = true;
    scene.tissues[0].geometry = mesh;
  }
  scene.step.max_step_s = std::stod(words[2]);
  scene.solver.tolerance = std::stod(words[3]);
  scene.solver.iterations = 500;
  if (scene.step.max_step_s > 0.004) scene.solver.relaxation = RelaxationKind::kCholesky;  // as convergedSettings()
  scene.advisor.sleep = scene.advisor.adapt_rotations = false;
}

/// Forces found against true ones, and the errors that the simulator expects.
class EstimateJudge {
 public:
  explicit EstimateJudge(const std::string& table) {
    if (!table.empty()) truth_ = readTruthTable(table);
  }

  void add(double time_s, const Vector3& force, const ForceErrorEstimate& expected) {
    const auto& times = truth_.run.times_s;
    const auto same = std::find_if(times.begin(), times.end(), [&](double t) { return std::abs(t - time_s) < 1e-6; });
    if (same == times.end()) return;
    const Vector3 truth = truth_.run.wrenches[static_cast<std::size_t>(same - times.begin())].back().force;
    samples_.push_back({truth.norm(), (force - truth).norm(), expected.total_n()});
  }

  /// Of samples with a tenth of the largest force at least, since the share of next to nothing says nothing.
  void print() const {
    double largest = 0.0;
    for (const Sample& sample : samples_) largest = std::max(largest, sample.force_n);
    double force = 0.0, found = 0.0, expected = 0.0;
    std::vector<double> ratios;
    for (const Sample& sample : samples_) {
      if (sample.force_n < 0.1 * largest) continue;
      force += sample.force_n * sample.force_n;
      found += sample.found_n * sample.found_n;
      expected += sample.expected_n * sample.expected_n;
      ratios.push_back(sample.expected_n / sample.found_n);
    }
    if (ratios.empty()) return;
    std::sort(ratios.begin(), ratios.end());
    const auto within = std::count_if(ratios.begin(), ratios.end(), [](double r) { return r >= 0.5 && r <= 2.0; });
    const auto at = [&](double share) {
      return ratios[static_cast<std::size_t>(share * static_cast<double>(ratios.size() - 1))];
    };
    std::fprintf(stderr,
                 "error %.3f, expected %.3f of the force, RMS; expected over found %.2f %.2f %.2f (5th, 50th, 95th of "
                 "100), .5 to 2 in %.2f of the samples\n",
                 std::sqrt(found / force), std::sqrt(expected / force), at(0.05), at(0.5), at(0.95),
                 static_cast<double>(within) / static_cast<double>(ratios.size()));
  }

 private:
  struct Sample {
    double force_n, found_n, expected_n;
  };
  TruthTable truth_;
  std::vector<Sample> samples_;
};

void run(const std::vector<std::string>& words) {
  const ScenePlan plan = planOf(words[0], words.size() > 5 ? words[5] : "");
  Scene scene = plan.scene.scene;
  prepare(words, scene);
  const double seconds = std::stod(words[4]);
  EstimateJudge judge(plan.truth.table);
  Simulator simulator(scene, plan.scene.environment);
  const int last = static_cast<int>(simulator.instruments().size()) - 1;
  int steps = 0;
  int met = 0;
  simulator.setStepObserver([&] {
    ++steps;
    met += simulator.report().stop == StopReason::kTolerance ? 1 : 0;
  });
  std::printf("time_s,force_x_n,force_y_n,force_z_n\n");
  try {
    plan.scene.motion(simulator, [&](double time_s) {
      const Vector3 force = simulator.wrench(last).force;
      std::printf("%.9g,%.9g,%.9g,%.9g\n", time_s, force.x(), force.y(), force.z());
      judge.add(time_s, force, simulator.forceErrors()[static_cast<std::size_t>(last)]);
      if (seconds > 0.0 && time_s > seconds - 1e-9) throw Enough();
    });
  } catch (const Enough&) {
  }
  std::fprintf(stderr, "%d meshes, ", simulator.meshRevision(0));
  std::fprintf(stderr, "%d nodes, %d steps, %d of them to the tolerance\n", simulator.tissues()[0].nodeCount(), steps,
               met);
  judge.print();
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 5) {
    std::fprintf(stderr, "usage: truth_run SCENE MESH STEP_S TOLERANCE SECONDS [BAG]\n");
    return 2;
  }
  try {
    run(words);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "truth_run: %s\n", error.what());
    return 1;
  }
  return 0;
}
