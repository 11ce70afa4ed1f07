/// Python module tissue_contact._core: scenes and simulators. Links the core alone, no ROS.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "python/binding/arrays.h"
#include "python/binding/loaded_scene.h"
#include "python/binding/python_simulator.h"

namespace tissue_contact::python {
namespace {

/// Text, or what os.fspath() makes of another thing.
std::string pathOf(const py::object& path) { return py::module::import("os").attr("fspath")(path).cast<std::string>(); }

const char* stopText(StopReason stop) {
  switch (stop) {
    case StopReason::kTolerance:
      return "tolerance";
    case StopReason::kIterations:
      return "iterations";
    case StopReason::kTimeBudget:
      return "time budget";
  }
  return "";
}

/// Of a class that Python cannot make: what its __new__() alone would make has no value.
void refuseNew(const py::module& module, const char* name) {
  const py::cpp_function refuse([text = std::string(name)](const py::args&, const py::kwargs&) -> py::object {
    throw py::type_error("a " + text + " is made by the functions of tissue_contact alone");
  });
  py::setattr(module.attr(name), "__new__", refuse);
}

py::object refusePickle(const py::object& self, int /*protocol*/) {
  throw py::type_error("cannot pickle " + std::string(py::str(self.attr("__class__"))) +
                       ": send Simulator.save_state()");
}

py::object remake(const LoadedScene& loaded) {
  const py::module helpers = py::module::import("tissue_contact._helpers");  // pickle knows Python's functions alone
  if (loaded.yaml)
    return py::make_tuple(helpers.attr("parse_scene_again"),
                          py::make_tuple(*loaded.yaml, loaded.file, loaded.settings));
  return py::make_tuple(helpers.attr("load_scene_again"), py::make_tuple(loaded.file, loaded.settings));
}

/// By reference, which pybind11 refuses for what Simulator.__new__() alone has made; a pointer would be null.
template <typename Result, typename... Arguments>
auto bound(Result (PythonSimulator::*function)(Arguments...)) {
  return [function](PythonSimulator& self, Arguments... arguments) -> Result {
    return (self.*function)(std::forward<Arguments>(arguments)...);
  };
}
template <typename Result, typename... Arguments>
auto bound(Result (PythonSimulator::*function)(Arguments...) const) {
  return [function](const PythonSimulator& self, Arguments... arguments) -> Result {
    return (self.*function)(std::forward<Arguments>(arguments)...);
  };
}

void bindScene(py::module& module) {
  const auto names = [](const auto& all) {
    std::vector<std::string> found;
    found.reserve(all.size());
    for (const auto& one : all) found.push_back(one.name);
    return found;
  };
  py::class_<LoadedScene>(module, "Scene",
                          "A scene that was read and checked. Immutable; pickled as its file and settings.")
      .def_property_readonly(
          "file", [](const LoadedScene& self) { return self.file; }, "Path it was read from.")
      .def_property_readonly(
          "settings", [](const LoadedScene& self) { return self.settings; }, "KEY=VALUE, as set.")
      .def_property_readonly(
          "instruments", [names](const LoadedScene& self) { return names(self.scene.instruments); },
          "Names, in the order of the file.")
      .def_property_readonly(
          "tissues", [names](const LoadedScene& self) { return names(self.scene.tissues); },
          "Names, in the order of the file.")
      .def_property_readonly(
          "world_frame", [](const LoadedScene& self) { return self.scene.world_frame; }, "Of all results.")
      .def_property_readonly(
          "max_step_s", [](const LoadedScene& self) { return self.scene.step.max_step_s; }, "Longest implicit step, s.")
      .def("__reduce__", remake);
  refuseNew(module, "Scene");
  module.def(
      "load_scene", [](const py::object& file, const py::object& set) { return loadScene(pathOf(file), set); },
      py::arg("file"), py::arg("set") = py::none(),
      "Reads and checks a scene (doc/scene.md).\n\n"
      "file: path, or a package:// or file:// URI. set: {key: value} as --set of tissue_contact_replay takes them,\n"
      "e.g. {'tissues.block.material.youngs_modulus_pa': 4000.0}. Raises ValueError '<file>:<line>: <key>: <what is "
      "wrong>'.");
  module.def(
      "parse_scene",
      [](const std::string& yaml, const py::object& file, const py::object& set) {
        return loadScene(pathOf(file), set, yaml);
      },
      py::arg("yaml"), py::arg("file") = "scene.yaml", py::arg("set") = py::none(),
      "As load_scene, from text. file: its name in messages, and where relative paths in it begin.");
}

void bindReport(py::module& module) {
  py::class_<StepReport>(module, "StepReport", "How the last advance went.")
      .def_readonly("substeps", &StepReport::substeps, "Implicit steps it took.")
      .def_readonly("advanced_s", &StepReport::advanced_s, "Its duration, s.")
      .def_readonly("jumped", &StepReport::jumped,
                    "An instrument moved too far and was put at its place without a path.")
      .def_readonly("discarded", &StepReport::discarded,
                    "A step had no finite answer: tissues were stopped where they were.")
      .def_readonly("iterations", &StepReport::iterations, "Of the solver, in the last step.")
      .def_property_readonly(
          "stop", [](const StepReport& self) { return stopText(self.stop); },
          "Why the solver stopped: 'tolerance', 'iterations' or 'time budget'.")
      .def_property_readonly(
          "converged", [](const StepReport& self) { return self.stop == StopReason::kTolerance; },
          "The last step reached solver.tolerance.")
      .def_readonly("sleeping_nodes", &StepReport::sleeping_nodes, "Left out of the last step, being at rest.")
      .def_readonly("open_contacts", &StepReport::open_contacts, "Of the last step, without force.")
      .def_readonly("static_contacts", &StepReport::static_contacts, "Of the last step, held by friction.")
      .def_readonly("kinetic_contacts", &StepReport::kinetic_contacts, "Of the last step, sliding.")
      .def_readonly("pinched_contacts", &StepReport::pinched_contacts,
                    "Left out of the last step: between shapes that touch.")
      .def_property_readonly(
          "implausible_load", [](const StepReport& self) { return self.implausible_load.found; },
          "The load is one that no tissue bears: do not trust the forces.")
      .def_property_readonly(
          "inverted_elements", [](const StepReport& self) { return self.implausible_load.inverted_elements; },
          "Turned inside out at nodes that carry contact forces.")
      .def_property_readonly(
          "contact_pressure_pa", [](const StepReport& self) { return self.implausible_load.pressure_pa; },
          "Largest mean pressure of an instrument on a tissue, Pa.")
      .def_property_readonly(
          "law_error", [](const StepReport& self) { return self.law_error.relative; },
          "Likely relative error of the force by the choice of the elastic law; negative: force too small.")
      .def_property_readonly(
          "strain", [](const StepReport& self) { return self.law_error.strain; },
          "Equivalent strain under the tool, where the law is linear or corotational.")
      .def("__reduce_ex__", refusePickle);
  refuseNew(module, "StepReport");
}

void bindMemory(py::module& module) {
  // NOLINTNEXTLINE(bugprone-unused-raii): what is left is in the module
  py::class_<NodalView, std::shared_ptr<NodalView>>(module, "_Memory", "Keeps alive what an array shows.");
  const auto rows = [](const auto& all, const std::shared_ptr<Topology>& self) {
    constexpr std::size_t kColumns = std::tuple_size_v<typename std::decay_t<decltype(all)>::value_type>;
    return viewOfRows(all.empty() ? nullptr : all.front().data(), all.size(), kColumns, py::cast(self));
  };
  py::class_<Topology, std::shared_ptr<Topology>>(module, "Topology", "A tissue's mesh, of one revision.")
      .def_readonly("revision", &Topology::revision, "How often the mesh had changed.")
      .def_property_readonly(
          "tetrahedra", [rows](const std::shared_ptr<Topology>& self) { return rows(self->tetrahedra, self); },
          "(m, 4) int32: nodes; none for a membrane.")
      .def_property_readonly(
          "triangles", [rows](const std::shared_ptr<Topology>& self) { return rows(self->triangles, self); },
          "(k, 3) int32: nodes of the surface, counter-clockwise from outside.")
      .def_property_readonly(
          "rest_positions",
          [](const std::shared_ptr<Topology>& self) {
            return viewOfRows(self->rest.data(), static_cast<std::size_t>(self->rest.cols()), 3, py::cast(self));
          },
          "(n, 3) m, world frame: undeformed.")
      .def_property_readonly(
          "fixed", [](const Topology& self) { return toArray(self.fixed); }, "(n,) bool: held in place.")
      .def("__reduce_ex__", refusePickle);
  refuseNew(module, "_Memory");
  refuseNew(module, "Topology");
}

void bindSimulator(py::module& module) {
  const auto make = [](const LoadedScene& loaded, const py::object& urdf, const py::object& frames) {
    const SceneEnvironment environment = environmentOf(loaded.scene, urdf.is_none() ? "" : pathOf(urdf), frames);
    const py::gil_scoped_release no_gil;
    return std::make_shared<PythonSimulator>(loaded.scene, environment);
  };
  using Self = PythonSimulator;
  py::class_<Self, std::shared_ptr<Self>>(module, "Simulator",
                                          "A scene that moves. SI units, world frame unless told otherwise.\n\n"
                                          "Use one from one thread at a time (another one's call raises RuntimeError "
                                          "while it advances). Arrays hold the moment\n"
                                          "they were taken at: positions() and velocities() show the simulator's "
                                          "memory without a copy, and it leaves that to them\n"
                                          "when it moves on. Names that are not in the scene raise ValueError.")
      .def(py::init(make), py::arg("scene"), py::arg("urdf") = py::none(), py::arg("frames") = py::none(),
           "urdf: file for scenes that take their URDF from a parameter. frames: {tf frame: 4 x 4 pose in the world}.")
      .def_property_readonly("instruments", bound(&Self::instruments), "Names, in the order of the scene.")
      .def_property_readonly("tissues", bound(&Self::tissues), "Names, in the order of the scene.")
      .def("joint_names", bound(&Self::jointNames), py::arg("instrument"),
           "In the order of joint positions; mimic joints are not among them.")
      .def("joint_limits", bound(&Self::jointLimits), py::arg("instrument"),
           "(n, 2) rad or m: lower, upper, as the URDF has them; not enforced.")
      .def("contact_links", bound(&Self::contactLinks), py::arg("instrument"),
           "Names of the links that touch, by the index `link` of contacts().")
      .def("place", bound(&Self::place), py::arg("instrument"), py::arg("positions"),
           "Puts an instrument somewhere without a path: no speed, no contact until the next advance. positions: (n,) "
           "rad or m.")
      .def(
          "advance", bound(&Self::advance), py::arg("duration_s"), py::arg("positions") = py::none(),
          py::arg("velocities") = py::none(),
          "Advances by duration_s > 0 while the joints move linearly to positions (rad, m): {instrument: (n,)} or a "
          "list for\n"
          "all instruments; those not named stay. With velocities (rad/s, m/s), {instrument: ((n,) at the start, (n,) "
          "at the end)},\n"
          "along the cubic through them, where they fit this way; nan: not known. Cut into implicit steps as the scene "
          "says. Other\n"
          "threads run meanwhile.")
      .def("reset", bound(&Self::reset), "Everything back to the start.")
      .def(
          "retune", [](Self& self, const LoadedScene& changed) { self.retune(changed.scene); }, py::arg("scene"),
          "Takes moduli, Poisson's ratios, damping, friction and solver limits of a scene that differs in these alone, "
          "from the\n"
          "next step on.")
      .def("save_state", bound(&Self::saveState), "All that the next advance depends on, as bytes.")
      .def("load_state", bound(&Self::loadState), py::arg("state"),
           "Goes on from saved bytes of the same scene, to the same bits. ValueError when they do not fit.")
      .def("joint_positions", bound(&Self::jointPositions), py::arg("instrument"), "(n,) rad or m, as given.")
      .def("joint_deflections", bound(&Self::jointDeflections), py::arg("instrument"),
           "(n,) rad or m: how much farther than that each compliant joint is, having given way to the tissue.")
      .def("wrench", bound(&Self::wrench), py::arg("instrument"), py::arg("frame") = "tip",
           "(6,): force (N) and torque (N m) of the tissues on the instrument at the origin of its tip link, mean over "
           "the last\n"
           "implicit step; in the axes of the tip, as published, or frame='world'.")
      .def("tip_pose", bound(&Self::tipPose), py::arg("instrument"), "(4, 4): pose of the tip link in the world, m.")
      .def("positions", bound(&Self::positions), py::arg("tissue"), "(n, 3) m: nodes. Read-only, not copied.")
      .def("velocities", bound(&Self::velocities), py::arg("tissue"), "(n, 3) m/s: nodes. Read-only, not copied.")
      .def("topology", bound(&Self::topology), py::arg("tissue"),
           "The mesh of positions(); the same object until the mesh changes.")
      .def("contacts", bound(&Self::contacts),
           "Of the last step: structured array with instrument, link, shape, tissue, other_tissue (indices; -1: none), "
           "state\n"
           "(tissue_contact.OPEN, STATIC, KINETIC), point (m), normal (into the tissue), force (N, on the tissue), "
           "slip (m), gap (m).")
      .def("force_errors", bound(&Self::forceErrors),
           "Per instrument, N: how wrong its force likely is: total_n, mesh_n (NaN: not known), step_n, solver_n.")
      .def("residuals", bound(&Self::residuals),
           "Of the last step, by name: how far its answer is from its contact problem.")
      .def("report", bound(&Self::report), "How the last advance went.")
      .def("advice", bound(&Self::advice), "Which models were chosen for the scene and why, a line each.")
      .def("__reduce_ex__", refusePickle)
      .def_property_readonly("step_count", bound(&Self::stepCount), "Implicit steps since the start or a reset.");
}

}  // namespace
}  // namespace tissue_contact::python

PYBIND11_MODULE(_core, module) {
  using namespace tissue_contact;
  module.doc() = "Simulator of tissue_contact without ROS; use it through `import tissue_contact`.";
  python::registerRows();
  module.attr("OPEN") = static_cast<int>(ContactState::kOpen);
  module.attr("STATIC") = static_cast<int>(ContactState::kStatic);
  module.attr("KINETIC") = static_cast<int>(ContactState::kKinetic);
  python::bindScene(module);
  python::bindReport(module);
  python::bindMemory(module);
  python::bindSimulator(module);
}
