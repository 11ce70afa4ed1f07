#include "benchmark/benchmark.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <exception>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "benchmark/progress.h"
#include "benchmark/sweep.h"
#include "benchmark/table.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/whole_file.h"
#include "tissue_contact/ros/environment.h"
#include "validation/package_directory.h"

namespace tissue_contact {
namespace {

constexpr const char* kUsage =
    "usage: tissue_contact_benchmark [--out DIR] [--only SCENE] [--quick] [--robot-bag FILE] [--no-plot]\n"
    "       tissue_contact_benchmark --scene SCENE.yaml --bag IN.bag [--urdf ROBOT.urdf] [--from S] [--duration S]\n"
    "\n"
    "The first runs press-drag, grasp, partial-slip, robot and robot-sweep over solvers, relaxations, iterations, "
    "steps\n"
    "and meshes on one core, and writes a CSV file and a picture per scene: time per step against solver error (same\n"
    "scene, solved to convergence) and against total error (stored truth, or finer mesh).\n"
    "  --out DIR         where to (default: benchmark)\n"
    "  --only SCENE      press-drag, grasp, partial-slip, robot or robot-sweep\n"
    "  --quick           a coarse grid, about a minute\n"
    "  --robot-bag FILE  recorded joint states of a dVRK PSM for config/psm_palpation.yaml (robot) and\n"
    "                    config/psm_dvrk.yaml (robot-sweep); without it neither of these\n"
    "  --no-plot         no pictures\n"
    "The second tells the wrench error of your own scene on your own recording, what dominates it (solver, step or "
    "mesh)\n"
    "and which setting to change.\n"
    "  --urdf FILE       text for the robot_description parameter that the scene takes its URDF from\n"
    "  --from S, --duration S  this part of the bag, s from its first joint state\n"
    "Exit code: 0 done, 1 failed or no contact, 2 wrong arguments.\n";

std::vector<ScenePlan> plansFor(const BenchmarkOptions& options, std::ostream& out) {
  const auto wanted = [&](const char* name) { return options.only.empty() || options.only == name; };
  std::vector<ScenePlan> plans;
  if (wanted("press-drag")) plans.push_back(pressDragPlan(options.scenes));
  if (wanted("grasp")) plans.push_back(graspPlan(options.scenes));
  if (wanted("partial-slip")) plans.push_back(partialSlipPlan(options.scenes));
  if (options.scenes.robot_bag.empty()) {
    if (options.only.empty()) out << "robot, robot-sweep: skipped, since no recording is given (--robot-bag FILE)\n";
    return plans;
  }
  if (wanted("robot")) plans.push_back(robotPlan(options.scenes));
  if (wanted("robot-sweep")) plans.push_back(robotSweepPlan(options.scenes));
  return plans;
}

/// Beside the program where it is installed, in scripts/ where it is built.
std::string plotScript() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path beside = fs::read_symlink("/proc/self/exe", error).parent_path() / "plot_benchmark.py";
  return !error && fs::exists(beside, error) ? beside.string() : packageDirectory() + "/scripts/plot_benchmark.py";
}

void plot(const std::string& directory, std::ostream& out) {
  const std::string script = plotScript();
  std::string arguments[] = {"/usr/bin/python3", script, directory};
  char* argv[] = {arguments[0].data(), arguments[1].data(), arguments[2].data(), nullptr};
  pid_t child = 0;
  int status = -1;
  out << std::flush;
  const bool ran =
      posix_spawn(&child, argv[0], nullptr, nullptr, argv, environ) == 0 && waitpid(child, &status, 0) == child;
  if (ran && WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
  out << "no pictures; to make them: python3 " << script << " " << directory << "\n";
}

std::string summaryFile(const BenchmarkOptions& options) { return options.out_directory + "/summary.txt"; }

std::string tableFile(const BenchmarkOptions& options, const std::string& scene) {
  return options.out_directory + "/" + scene + ".csv";
}

/// What would otherwise show after half an hour.
void prepareFolder(const BenchmarkOptions& options, const std::vector<ScenePlan>& plans) {
  std::error_code error;
  std::filesystem::create_directories(options.out_directory, error);
  if (error) throw std::runtime_error("--out: cannot make '" + options.out_directory + "': " + error.message());
  std::vector<NamedFile> outputs = {{"summary", summaryFile(options)}};
  for (const ScenePlan& plan : plans) outputs.push_back({"table", tableFile(options, plan.scene.name)});
  requireFreeOutputs(outputs, {{"--robot-bag", options.scenes.robot_bag}});
}

void runScenes(const BenchmarkOptions& options, std::ostream& out, std::ostream* bar) {
  if (!options.scenes.robot_bag.empty()) requireRegularFile(options.scenes.robot_bag, "bag");
  const std::vector<ScenePlan> plans = plansFor(options, out);
  prepareFolder(options, plans);
  double work = 0.0;
  for (const ScenePlan& plan : plans) work += sweepWork(plan, options.scenes);
  Progress progress(bar, work);
  std::ostringstream summary;
  for (const ScenePlan& plan : plans) {
    const SceneResult result = sweep(plan, options.scenes, progress);
    WholeFile table(tableFile(options, result.scene));
    writeCsv(result, table.stream());
    table.commit();
    progress.clear();
    printSummary(result, out);
    requireWritten(out);
    printSummary(result, summary);
    WholeFile text(summaryFile(options));  // after every scene: the next may take long, or fail
    text.stream() << summary.str();
    text.commit();
  }
  out << "\ntables: " << options.out_directory << "\n";
  if (options.plot) plot(options.out_directory, out);
}

}  // namespace

int runBenchmark(const std::vector<std::string>& arguments, std::ostream& out, std::ostream& messages, bool show_bar) {
  BenchmarkOptions options;
  try {
    options = parseBenchmarkOptions(arguments);
  } catch (const std::invalid_argument& error) {
    messages << "tissue_contact_benchmark: " << error.what() << '\n' << kUsage;
    return 2;
  }
  std::ostream* const bar = show_bar ? &messages : nullptr;
  try {
    int code = 0;
    if (options.help) {
      out << kUsage;
    } else if (!options.own.scene_file.empty()) {
      code = reportOwnScene(options.own, out, bar) ? 0 : 1;
    } else {
      runScenes(options, out, bar);
    }
    requireWritten(out);
    return code;
  } catch (const UnusedUrdf& error) {
    messages << "tissue_contact_benchmark: " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    messages << "tissue_contact_benchmark: " << error.what() << '\n';
    return 1;
  }
}

}  // namespace tissue_contact
