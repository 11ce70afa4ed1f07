#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <stdexcept>

#include "benchmark/benchmark.h"

namespace tissue_contact {
namespace {

double seconds(const std::string& key, const std::string& text, bool may_be_zero) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  const bool number = !text.empty() && *end == '\0' && std::isfinite(value);
  if (!number || value < 0.0 || (value == 0.0 && !may_be_zero)) {
    throw std::invalid_argument(key + " is '" + text + "'; it must be a number of seconds, " +
                                (may_be_zero ? "0 or more" : "more than 0"));
  }
  return value;
}

void requireTogether(const BenchmarkOptions& options, const std::set<std::string>& given) {
  const bool own = given.count("--scene") > 0;
  if (own != (given.count("--bag") > 0)) throw std::invalid_argument("--scene and --bag belong together; give both");
  for (const char* const key : {"--urdf", "--from", "--duration"}) {
    if (!own && given.count(key) > 0) throw std::invalid_argument(std::string(key) + " needs --scene and --bag");
  }
  for (const char* const key : {"--out", "--only", "--robot-bag", "--quick", "--no-plot"}) {
    if (own && given.count(key) > 0) throw std::invalid_argument(std::string(key) + " does not go with --scene");
  }
  const std::set<std::string> scenes = {"press-drag", "grasp", "partial-slip", "robot"};
  if (!options.only.empty() && scenes.count(options.only) == 0) {
    throw std::invalid_argument("--only '" + options.only +
                                "' is unknown; there are: press-drag, grasp, partial-slip, robot");
  }
  if (options.only == "robot" && options.scenes.robot_bag.empty()) {
    throw std::invalid_argument("--only robot needs --robot-bag FILE, the recording of a dVRK PSM");
  }
}

}  // namespace

BenchmarkOptions parseBenchmarkOptions(const std::vector<std::string>& arguments) {
  BenchmarkOptions options;
  std::string from;
  std::string duration;
  const std::map<std::string, std::string*> values = {{"--out", &options.out_directory},
                                                      {"--only", &options.only},
                                                      {"--robot-bag", &options.scenes.robot_bag},
                                                      {"--scene", &options.own.scene_file},
                                                      {"--bag", &options.own.bag_file},
                                                      {"--urdf", &options.own.urdf_file},
                                                      {"--from", &from},
                                                      {"--duration", &duration}};
  const std::map<std::string, bool*> switches = {
      {"--quick", &options.scenes.quick}, {"--help", &options.help}, {"-h", &options.help}};
  std::set<std::string> given;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::size_t equals = arguments[i].find('=');
    const std::string key = arguments[i].substr(0, equals);
    if (!given.insert(key).second) throw std::invalid_argument(key + " is given twice");
    if (const auto found = switches.find(key); found != switches.end() && equals == std::string::npos) {
      *found->second = true;
      continue;
    }
    if (key == "--no-plot" && equals == std::string::npos) {
      options.plot = false;
      continue;
    }
    const auto found = values.find(key);
    if (found == values.end()) throw std::invalid_argument("unknown argument '" + arguments[i] + "'");
    const bool in_next = equals == std::string::npos;
    if (in_next && i + 1 < arguments.size() && arguments[i + 1].rfind("--", 0) != 0)
      *found->second = arguments[++i];
    else
      *found->second = in_next ? "" : arguments[i].substr(equals + 1);
    if (found->second->empty()) throw std::invalid_argument(key + " needs a value");
  }
  if (options.help) return options;
  requireTogether(options, given);
  if (given.count("--from") > 0) options.own.window.from_s = seconds("--from", from, true);
  if (given.count("--duration") > 0) options.own.window.duration_s = seconds("--duration", duration, false);
  return options;
}

}  // namespace tissue_contact
