#include "benchmark/truth_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

constexpr std::uintmax_t kMaxBytes = 1 << 20;
constexpr const char* kColumns = "time_s,force_x_n,force_y_n,force_z_n";

[[noreturn]] void fail(const std::string& file, int line, const std::string& why) {
  throw std::invalid_argument(file + ":" + std::to_string(line) + ": " + why);
}

std::array<double, 4> readRow(const std::string& file, int line, const std::string& text) {
  std::array<double, 4> row{};
  std::size_t from = 0;
  for (std::size_t column = 0; column < row.size(); ++column) {
    const std::size_t to = column + 1 < row.size() ? text.find(',', from) : text.size();
    const std::optional<double> value =
        to == std::string::npos ? std::nullopt : toDouble(std::string_view(text).substr(from, to - from));
    if (!value || !std::isfinite(*value)) fail(file, line, "four finite numbers are needed: " + std::string(kColumns));
    row[column] = *value;
    from = to + 1;
  }
  return row;
}

}  // namespace

TruthTable readTruthTable(const std::string& file) {
  std::istringstream stream(readFile(file, "truth table", kMaxBytes));
  std::map<std::string, std::string> keys;
  TruthTable table;
  bool named = false;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::size_t colon = line.find(": ");
    if (line.rfind("# ", 0) == 0) {
      if (colon != std::string::npos) keys[line.substr(2, colon - 2)] = line.substr(colon + 2);
    } else if (!named) {
      if (line != kColumns) fail(file, number, "the columns must be " + std::string(kColumns));
      named = true;
    } else {
      const std::array<double, 4> row = readRow(file, number, line);
      std::vector<double>& times = table.run.times_s;
      if (!times.empty() && !(row[0] > times.back())) fail(file, number, "times must ascend");
      Wrench wrench;
      wrench.force = Vector3(row[1], row[2], row[3]);
      times.push_back(row[0]);
      table.run.wrenches.push_back({wrench});
    }
  }
  const std::optional<double> uncertainty = toDouble(keys["uncertainty"]);
  const bool is_known = uncertainty && *uncertainty > 0.0 && std::isfinite(*uncertainty);
  if (!is_known || keys["how"].empty() || table.run.times_s.empty()) {
    fail(file, number, "the lines '# uncertainty: <share of the force, > 0>', '# how: <words>' and rows are needed");
  }
  table.uncertainty = *uncertainty;
  table.how = keys["how"];
  return table;
}

Run truthAt(const TruthTable& truth, const Run& like) {
  Run run;
  run.times_s = like.times_s;
  const std::vector<double>& times = truth.run.times_s;
  for (std::size_t k = 0; k < like.times_s.size(); ++k) {
    constexpr double kSameTime = 1e-6;  // s
    const double time = like.times_s[k];
    const auto found = std::lower_bound(times.begin(), times.end(), time - kSameTime);
    if (found == times.end() || *found > time + kSameTime) {
      throw std::invalid_argument("the truth table has no row at " + std::to_string(time) + " s");
    }
    run.wrenches.emplace_back(like.wrenches[k].size());
    run.wrenches.back().back() = truth.run.wrenches[static_cast<std::size_t>(found - times.begin())][0];
  }
  return run;
}

}  // namespace tissue_contact
