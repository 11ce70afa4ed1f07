/// Python module tissue_contact._replay: tissue_contact_replay in this process. Links what reads bags, and so ROS libraries; needs
/// no roscore.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "python/binding/signal_check.h"
#include "ros/replay/replay.h"

namespace tissue_contact::python {
namespace {

/// One line of the CSV file of tissue_contact_replay, as far as it tells of an instrument.
struct ReplayRow {
  std::int64_t stamp_ns;
  std::int32_t instrument;
  std::int32_t static_contacts;
  std::int32_t kinetic_contacts;
  std::uint8_t discarded;
  std::uint8_t jumped;
  std::uint8_t implausible_load;
  double tip[7];
  double wrench[6];
  double force_error_n;
};

ReplayRow rowOf(const Simulator& simulator, int instrument, std::int64_t stamp_ns, long steps) {
  const StepReport& report = simulator.report();
  ReplayRow row{};
  row.stamp_ns = stamp_ns;
  row.instrument = instrument;
  row.discarded = static_cast<std::uint8_t>(steps > 0 && report.discarded);
  row.jumped = static_cast<std::uint8_t>(steps > 0 && report.jumped);
  row.implausible_load = static_cast<std::uint8_t>(report.implausible_load.found);
  for (const SolvedContact& contact : simulator.contacts()) {
    if (contact.contact.key.instrument != instrument) continue;
    row.static_contacts += static_cast<std::int32_t>(contact.state == ContactState::kStatic);
    row.kinetic_contacts += static_cast<std::int32_t>(contact.state == ContactState::kKinetic);
  }
  const auto index = static_cast<std::size_t>(instrument);
  const Pose& X_WTip =
      simulator.linkPoses(instrument)[static_cast<std::size_t>(simulator.instruments()[index].tipLink())];
  const Quaternion q(X_WTip.linear());
  const Wrench wrench = simulator.wrench(instrument);
  for (int i = 0; i < 3; ++i) {
    row.tip[i] = X_WTip.translation()[i];
    row.wrench[i] = wrench.force[i];
    row.wrench[i + 3] = wrench.torque[i];
  }
  for (int i = 0; i < 4; ++i) row.tip[i + 3] = q.coeffs()[i];
  row.force_error_n = simulator.forceErrors()[index].total_n();
  return row;
}

/// @return rows, names of the instruments, what the replay says.
py::tuple replayed(const ReplayOptions& options) {
  std::vector<ReplayRow> rows;
  std::vector<std::string> names;
  std::ostringstream log;
  SignalCheck interrupted;
  {
    const py::gil_scoped_release no_gil;
    replay(options, log, [&](const Simulator& simulator, const PlayedSample& played, long steps) {
      if (interrupted()) {
        const py::gil_scoped_acquire gil;
        throw py::error_already_set();
      }
      if (names.empty()) {
        for (const Instrument& one : simulator.instruments()) names.push_back(one.name());
      }
      for (const int instrument : played.instruments) {
        rows.push_back(rowOf(simulator, instrument, played.stamp_ns, steps));
      }
    });
  }
  return py::make_tuple(py::array_t<ReplayRow>(static_cast<py::ssize_t>(rows.size()), rows.data()), names, log.str());
}

}  // namespace
}  // namespace tissue_contact::python

PYBIND11_MODULE(_replay, module) {
  namespace py = pybind11;
  using namespace tissue_contact;
  using python::ReplayRow;
  PYBIND11_NUMPY_DTYPE(ReplayRow, stamp_ns, instrument, static_contacts, kinetic_contacts, discarded, jumped,
                       implausible_load, tip, wrench, force_error_n);
  module.def(
      "replay",
      [](const std::string& scene, const std::string& bag, const std::vector<std::string>& settings,
         const std::string& csv, const std::string& urdf, double from_s, double duration_s,
         const std::string& changes) {
        ReplayOptions options;
        options.scene_file = scene;
        options.bag_file = bag;
        options.settings = settings;
        options.csv_file = csv;
        options.urdf_file = urdf;
        options.from_s = from_s;
        options.duration_s = duration_s;
        options.changes_topic = changes;
        return python::replayed(options);
      },
      py::arg("scene"), py::arg("bag"), py::arg("settings"), py::arg("csv"), py::arg("urdf"), py::arg("from_s"),
      py::arg("duration_s"), py::arg("changes"), "As tissue_contact_replay; see tissue_contact.replay().");
}
