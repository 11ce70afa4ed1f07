#include "benchmark/table.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace tissue_contact {
namespace {

std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));

std::string text(const char* format, ...) {
  char buffer[400];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

std::string number(double value) { return std::isfinite(value) ? text("%.6g", value) : ""; }

std::string settingsText(const BenchmarkRow& row) {
  if (row.peer) return row.method;
  const std::string follows = row.refined_cell_m > 0.0 ? text("mesh follows, %.2g mm: ", 1e3 * row.refined_cell_m) : "";
  const std::string method = follows + row.method + (row.relaxation.empty() ? "" : " " + row.relaxation);
  return row.tolerance > 0.0
             ? text("%s, %.0e (at most %dx%d)", method.c_str(), row.tolerance, row.iterations, row.contact_passes)
             : text("%s, %d iterations", method.c_str(), row.iterations);
}

std::string percent(double share) { return std::isfinite(share) ? text("%.3f", 100.0 * share) : "-"; }

void printRow(const BenchmarkRow& row, std::ostream& out) {
  out << text("    %-62s %6d %6.1f %9.3f %9.3f %8.1f  %9s %9s\n", settingsText(row).c_str(), row.nodes, 1e3 * row.dt_s,
              1e3 * row.times.median, 1e3 * row.times.p99, row.realtime_factor, percent(row.solver_error).c_str(),
              percent(row.total_error).c_str());
}

void printHeader(std::ostream& out) {
  out << text("    %-62s %6s %6s %9s %9s %8s  %9s %9s\n", "settings (at most: iterations x passes)", "nodes", "dt ms",
              "median ms", "p99 ms", "x real", "solver %", "total %");
}

std::vector<std::size_t> atShippedSize(const SceneResult& result) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    if (result.rows[i].at_shipped_size && !result.rows[i].peer) indices.push_back(i);
  }
  return indices;
}

double wallPerSecond(const BenchmarkRow& row) { return row.times.median / row.dt_s; }

void printPeer(const SceneResult& result, const BenchmarkRow& peer, std::ostream& out) {
  out << text(
      "  %s, %d nodes, %.1f ms: %.3f ms per step (median), total error %.1f %%, against our converged run of "
      "the same mesh and step %.1f %%\n",
      peer.method.c_str(), peer.nodes, 1e3 * peer.dt_s, 1e3 * peer.times.median, 100.0 * peer.total_error,
      100.0 * peer.same_mesh_error);
  for (const bool same_mesh : {true, false}) {
    const PeerVerdict verdict = judgePeer(result, peer, same_mesh);
    const char* const where = same_mesh ? "on the same mesh and step" : "total error, any mesh and step";
    if (!verdict.found) {
      out << text("    at equal or better error (%s): none of ours\n", where);
      continue;
    }
    const BenchmarkRow& ours = result.rows[verdict.ours];
    out << text(
        "    at equal or better error (%s): ours is %.1f times as fast (%s, %d nodes, %.1f ms; error %.2f %%)\n", where,
        verdict.times_faster, settingsText(ours).c_str(), ours.nodes, 1e3 * ours.dt_s,
        100.0 * (same_mesh ? ours.same_mesh_error : ours.total_error));
  }
}

void printShippedAgainst(const SceneResult& result, const BenchmarkRow& peer, std::ostream& out) {
  for (const BenchmarkRow& row : result.rows) {
    if (row.peer || !row.shipped_solver || row.nodes != peer.nodes || row.dt_s != peer.dt_s) continue;
    out << text("    as shipped, same mesh and step: %.1f times as fast, error %.2f %% (total %s %%)\n",
                wallPerSecond(peer) / wallPerSecond(row), 100.0 * row.solver_error, percent(row.total_error).c_str());
  }
}

void printFront(const SceneResult& result, std::ostream& out) {
  const std::vector<std::size_t> runs = atShippedSize(result);
  std::vector<double> times;
  std::vector<double> errors;
  for (const std::size_t i : runs) {
    times.push_back(result.rows[i].times.median);
    errors.push_back(result.rows[i].solver_error);
  }
  for (const std::size_t i : runs) {
    if (!result.rows[i].shipped) continue;
    out << text(
        "  solver error against: the same scene solved to convergence (tolerance met in %.0f %% of the steps)\n",
        100.0 * result.rows[i].reference_met);
  }
  out << "  Pareto front, time against solver error, at the shipped mesh and step:\n";
  printHeader(out);
  for (const std::size_t i : paretoFront(times, errors)) printRow(result.rows[runs[i]], out);
}

}  // namespace

FrontVerdict judgeShipped(const SceneResult& result) {
  FrontVerdict verdict;
  const std::vector<std::size_t> runs = atShippedSize(result);
  const BenchmarkRow* shipped = nullptr;
  for (const std::size_t i : runs) {
    if (result.rows[i].shipped) shipped = &result.rows[i];
  }
  if (shipped == nullptr) return verdict;
  std::vector<double> times;
  std::vector<double> errors;
  for (const std::size_t i : runs) {
    times.push_back(result.rows[i].times.median);
    errors.push_back(result.rows[i].solver_error);
  }
  verdict.on_front = onFront(shipped->times.median, shipped->solver_error, times, errors, kTimeNoise);
  double fastest = shipped->times.median;
  for (const std::size_t i : runs) {
    const BenchmarkRow& row = result.rows[i];
    if (row.solver_error > shipped->solver_error || row.times.median >= fastest) continue;
    fastest = row.times.median;
    verdict.better = i;
    verdict.found_better = true;
  }
  return verdict;
}

PeerVerdict judgePeer(const SceneResult& result, const BenchmarkRow& peer, bool same_mesh) {
  PeerVerdict verdict;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    const BenchmarkRow& row = result.rows[i];
    if (row.peer || (same_mesh && (row.nodes != peer.nodes || row.dt_s != peer.dt_s))) continue;
    const bool better = same_mesh ? row.same_mesh_error <= peer.same_mesh_error : row.total_error <= peer.total_error;
    // A peer that gave no numbers is beaten by any answer that is finite.
    const bool beats_nothing = !std::isfinite(peer.total_error) && std::isfinite(row.total_error);
    if (!(better || beats_nothing) || wallPerSecond(row) >= least) continue;
    least = wallPerSecond(row);
    verdict = {true, i, wallPerSecond(peer) / least};
  }
  return verdict;
}

void writeCsv(const SceneResult& result, std::ostream& out) {
  out << "scene,method,relaxation,iterations,contact_passes,tolerance,dt_s,nodes,refined_cell_m,median_ms,p99_ms,max_"
         "ms,steps_per_s,"
         "realtime_factor,"
         "solver_error,total_error,same_mesh_error,mean_iterations,met_tolerance,reference_met,discarded,shipped,at_"
         "shipped_size,"
         "shipped_solver,truth_error,error_of\n";
  for (const BenchmarkRow& row : result.rows) {
    out << result.scene << ',' << row.method << ',' << row.relaxation << ','
        << (row.peer ? "" : std::to_string(row.iterations)) << ','
        << (row.peer ? "" : std::to_string(row.contact_passes)) << ',' << number(row.tolerance) << ','
        << number(row.dt_s) << ',' << row.nodes << ',' << number(row.refined_cell_m) << ','
        << number(1e3 * row.times.median) << ',' << number(1e3 * row.times.p99) << ',' << number(1e3 * row.times.max)
        << ',' << number(row.steps_per_s) << ',' << number(row.realtime_factor) << ',' << number(row.solver_error)
        << ',' << number(row.total_error) << ',' << number(row.same_mesh_error) << ',' << number(row.mean_iterations)
        << ',' << number(row.met_tolerance) << ',' << number(row.reference_met) << ',' << row.discarded << ','
        << row.shipped << ',' << row.at_shipped_size << ',' << row.shipped_solver << ',' << number(result.truth_error)
        << ',' << result.of << '\n';
  }
}

void printSummary(const SceneResult& result, std::ostream& out) {
  out << "\n" << result.scene << ": " << result.rows.size() << " runs, errors of the " << result.of << "\n";
  out << "  total error against: " << result.truth << text("; its own error about %.1f %%", 100.0 * result.truth_error);
  if (std::isfinite(result.step_error)) {
    out << text("; half the shipped step changes the answer by %.2f %%", 100.0 * result.step_error);
  }
  out << "\n";
  printFront(result, out);
  const FrontVerdict verdict = judgeShipped(result);
  for (const BenchmarkRow& row : result.rows) {
    if (row.shipped) {
      out << "  shipped settings: " << (verdict.on_front ? "on the front" : "NOT on the front; as good and faster:")
          << "\n";
      printRow(row, out);
    }
  }
  if (!verdict.on_front && verdict.found_better) printRow(result.rows[verdict.better], out);
  out << "  shipped solver over meshes and steps:\n";
  for (const BenchmarkRow& row : result.rows) {
    if (row.shipped_solver || row.refined_cell_m > 0.0) printRow(row, out);
  }
  for (const BenchmarkRow& row : result.rows) {
    if (!row.peer) continue;
    printPeer(result, row, out);
    printShippedAgainst(result, row, out);
  }
  for (const std::string& note : result.notes) out << "  " << note << "\n";
}

}  // namespace tissue_contact
