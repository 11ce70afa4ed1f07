/// @file
/// Python: a Simulator as Python may use it: by names, from several threads, with arrays that outlive what they show. Every function
/// needs the GIL.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact::python {

namespace py = pybind11;

/// Numbers that arrays show: the simulator's own while it stays where it is, handed over by it before it moves on.
struct NodalView {
  std::shared_ptr<void> owner;  ///< of the memory; null once it lies in `kept`
  NodalVectors kept;
};

/// Of one revision of a tissue's mesh; copied once, and shared by all who ask.
struct Topology {
  int revision = 0;
  NodalVectors rest;
  std::vector<Tetrahedron> tetrahedra;
  std::vector<Triangle> triangles;
  std::vector<bool> fixed;
};

/// One thread at a time, since advance() lets others run: whoever else calls meanwhile gets an error.
///
/// Arrays of positions and velocities are not copied. They show one moment: before the simulator moves on it leaves the memory of those
/// that are still held to them, and goes on in a copy. So they neither change nor dangle, whatever becomes of mesh and simulator.
class PythonSimulator : public std::enable_shared_from_this<PythonSimulator> {
 public:
  /// Refuses. make_shared() does not come here, but pybind11 does, for room where the constructor should have been, when
  /// something is asked of what Simulator.__new__() alone has made.
  static void* operator new(std::size_t) { throw std::runtime_error("Simulator.__init__() has not been called"); }

  PythonSimulator(const Scene& scene, const SceneEnvironment& environment);

  std::vector<std::string> instruments() const;
  std::vector<std::string> tissues() const;
  std::vector<std::string> jointNames(const std::string& instrument) const;
  std::vector<std::string> contactLinks(const std::string& instrument) const;
  py::array jointLimits(const std::string& instrument) const;

  void place(const std::string& instrument, const py::object& joint_positions);
  /// Without the GIL. Ctrl-C ends it between two steps, with KeyboardInterrupt.
  void advance(double duration_s, const py::object& joint_positions, const py::object& joint_velocities);
  void reset();
  void retune(const Scene& changed);
  py::bytes saveState();
  void loadState(const py::bytes& state);

  py::array jointPositions(const std::string& instrument) const;
  py::array jointDeflections(const std::string& instrument) const;
  py::array wrench(const std::string& instrument, const std::string& frame) const;
  py::array tipPose(const std::string& instrument) const;
  py::array positions(const std::string& tissue);
  py::array velocities(const std::string& tissue);
  std::shared_ptr<Topology> topology(const std::string& tissue);
  py::array contacts() const;
  py::array forceErrors() const;
  py::dict residuals() const;
  StepReport report() const;
  std::vector<std::string> advice() const;
  long stepCount() const;

 private:
  class Use;
  struct Views {
    std::weak_ptr<NodalView> positions;
    std::weak_ptr<NodalView> velocities;
    std::shared_ptr<Topology> topology;
  };

  int instrumentOf(const std::string& name) const;
  int tissueOf(const std::string& name) const;
  const Pose& tip(int instrument) const;
  std::vector<VectorX> targets(const py::object& joint_positions) const;
  JointVelocities velocitiesOf(const py::object& joint_velocities) const;
  VectorX target(int instrument, const py::handle& joint_positions) const;
  void leaveMemoryToViews();
  py::array view(const NodalVectors& values, std::weak_ptr<NodalView>& held);

  Simulator simulator_;
  std::vector<Views> views_;  ///< per tissue
  mutable std::atomic<bool> in_use_{false};
};

}  // namespace tissue_contact::python
