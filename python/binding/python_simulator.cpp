#include "python/binding/python_simulator.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "python/binding/arrays.h"
#include "python/binding/signal_check.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact::python {
namespace {

template <typename Things>
std::vector<std::string> namesOf(const Things& things) {
  std::vector<std::string> names;
  names.reserve(things.size());
  for (const auto& one : things) names.push_back(one.name());
  return names;
}

/// @throws std::invalid_argument naming what there is.
template <typename Things>
int indexOf(const Things& things, const std::string& name, const std::string& what) {
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (things[i].name() == name) return static_cast<int>(i);
  }
  const std::vector<std::string> names = namesOf(things);
  throw std::invalid_argument("the scene has no " + what + " " + printable(name) + "; " + suggestion(name, names) +
                              "it has: " + listOf(names));
}

}  // namespace

/// As long as it lives nobody else may use the simulator.
class PythonSimulator::Use {
 public:
  explicit Use(const PythonSimulator& simulator) : in_use_(simulator.in_use_) {
    if (in_use_.exchange(true)) {
      throw std::runtime_error(
          "this simulator is in use by another thread; make one per thread, or hold a lock around its calls");
    }
  }
  ~Use() { in_use_ = false; }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;

 private:
  std::atomic<bool>& in_use_;
};

PythonSimulator::PythonSimulator(const Scene& scene, const SceneEnvironment& environment)
    : simulator_(scene, environment), views_(simulator_.tissues().size()) {}

std::vector<std::string> PythonSimulator::instruments() const { return namesOf(simulator_.instruments()); }

std::vector<std::string> PythonSimulator::tissues() const {
  const Use use(*this);
  return namesOf(simulator_.tissues());
}

int PythonSimulator::instrumentOf(const std::string& name) const {
  return indexOf(simulator_.instruments(), name, "instrument");
}

int PythonSimulator::tissueOf(const std::string& name) const { return indexOf(simulator_.tissues(), name, "tissue"); }

std::vector<std::string> PythonSimulator::jointNames(const std::string& instrument) const {
  std::vector<std::string> names;
  for (const IndependentJoint& joint : simulator_.instruments()[instrumentOf(instrument)].model().joints()) {
    names.push_back(joint.name);
  }
  return names;
}

std::vector<std::string> PythonSimulator::contactLinks(const std::string& instrument) const {
  std::vector<std::string> names;
  for (const ContactLink& link : simulator_.instruments()[instrumentOf(instrument)].contactLinks()) {
    names.push_back(link.name);
  }
  return names;
}

py::array PythonSimulator::jointLimits(const std::string& instrument) const {
  const auto& joints = simulator_.instruments()[instrumentOf(instrument)].model().joints();
  py::array_t<double> limits({joints.size(), std::size_t{2}});
  for (std::size_t j = 0; j < joints.size(); ++j) {
    limits.mutable_at(j, 0) = joints[j].lower;
    limits.mutable_at(j, 1) = joints[j].upper;
  }
  return limits;
}

VectorX PythonSimulator::target(int instrument, const py::handle& joint_positions) const {
  return toVector(joint_positions, "joint positions of '" + simulator_.instruments()[instrument].name() + "'");
}

std::vector<VectorX> PythonSimulator::targets(const py::object& joint_positions) const {
  const std::size_t count = simulator_.instruments().size();
  std::vector<VectorX> targets;
  for (std::size_t i = 0; i < count; ++i) targets.push_back(simulator_.jointPositions(static_cast<int>(i)));
  if (joint_positions.is_none()) return targets;
  if (py::isinstance<py::dict>(joint_positions)) {
    for (const auto& [name, positions] : py::reinterpret_borrow<py::dict>(joint_positions)) {
      if (!py::isinstance<py::str>(name)) throw py::type_error("the name of an instrument must be text");
      const int instrument = instrumentOf(py::str(name));
      targets[instrument] = target(instrument, positions);
    }
    return targets;
  }
  if (!py::isinstance<py::sequence>(joint_positions) || py::isinstance<py::str>(joint_positions)) {
    throw py::type_error(
        "joint positions must be a dict {instrument: positions}, or a list with those of each instrument");
  }
  const auto list = py::reinterpret_borrow<py::sequence>(joint_positions);
  if (list.size() != count) {
    throw std::invalid_argument("joint positions for " + std::to_string(list.size()) +
                                " instruments, and the scene has " + std::to_string(count) + ": " +
                                listOf(namesOf(simulator_.instruments())));
  }
  for (std::size_t i = 0; i < count; ++i) targets[i] = target(static_cast<int>(i), list[i]);
  return targets;
}

JointVelocities PythonSimulator::velocitiesOf(const py::object& joint_velocities) const {
  JointVelocities velocities;
  for (std::size_t i = 0; i < simulator_.instruments().size(); ++i) {
    const Eigen::Index joints = simulator_.jointPositions(static_cast<int>(i)).size();
    velocities.start.push_back(VectorX::Constant(joints, std::numeric_limits<double>::quiet_NaN()));
  }
  velocities.end = velocities.start;
  if (joint_velocities.is_none()) return velocities;
  if (!py::isinstance<py::dict>(joint_velocities)) {
    throw py::type_error("joint velocities must be a dict {instrument: (at the start, at the end)}");
  }
  for (const auto& [name, values] : py::reinterpret_borrow<py::dict>(joint_velocities)) {
    if (!py::isinstance<py::str>(name)) throw py::type_error("the name of an instrument must be text");
    const int instrument = instrumentOf(py::str(name));
    const std::string what = "joint velocities of '" + simulator_.instruments()[instrument].name() + "'";
    if (!py::isinstance<py::sequence>(values) || py::len(values) != 2) {
      throw py::type_error(what + " must be two: at the start and at the end, one for each joint");
    }
    const auto both = py::reinterpret_borrow<py::sequence>(values);
    velocities.start[instrument] = toVector(both[0], what);
    velocities.end[instrument] = toVector(both[1], what);
  }
  return velocities;
}

void PythonSimulator::place(const std::string& instrument, const py::object& joint_positions) {
  const Use use(*this);
  const int index = instrumentOf(instrument);
  simulator_.placeInstrument(index, target(index, joint_positions));
}

void PythonSimulator::advance(double duration_s, const py::object& joint_positions,
                              const py::object& joint_velocities) {
  const Use use(*this);
  // Stamps have no less. What a contact carried over a step is lost in round-off where the next is of so little.
  constexpr double kShortest_s = 1e-9;
  if (duration_s > 0.0 && duration_s < kShortest_s) throwBadValue("duration", duration_s, "s", ">= 1e-9");
  const std::vector<VectorX> to = targets(joint_positions);
  const JointVelocities velocities = velocitiesOf(joint_velocities);
  leaveMemoryToViews();
  AdvanceLimits limits;
  bool interrupted = false;
  limits.interrupted = [&interrupted, check = SignalCheck()]() mutable { return interrupted = check(); };
  {
    const py::gil_scoped_release no_gil;
    simulator_.advance(duration_s, to, limits, &velocities);
  }
  if (interrupted) throw py::error_already_set();
}

void PythonSimulator::reset() {
  const Use use(*this);
  leaveMemoryToViews();
  simulator_.reset();
}

void PythonSimulator::retune(const Scene& changed) {
  const Use use(*this);
  simulator_.retune(changed);
}

py::bytes PythonSimulator::saveState() {
  const Use use(*this);
  return simulator_.saveState();
}

void PythonSimulator::loadState(const py::bytes& state) {
  const Use use(*this);
  const std::string bytes = state;
  leaveMemoryToViews();
  simulator_.restoreState(bytes);
}

py::array PythonSimulator::jointPositions(const std::string& instrument) const {
  const Use use(*this);
  return toArray(simulator_.jointPositions(instrumentOf(instrument)));
}

py::array PythonSimulator::jointDeflections(const std::string& instrument) const {
  const Use use(*this);
  const int index = instrumentOf(instrument);
  const VectorX& deflections = simulator_.jointDeflections(index);
  if (deflections.size() > 0) return toArray(deflections);
  return toArray(VectorX::Zero(simulator_.jointPositions(index).size()));
}

const Pose& PythonSimulator::tip(int instrument) const {
  return simulator_.linkPoses(instrument)[simulator_.instruments()[instrument].tipLink()];
}

py::array PythonSimulator::wrench(const std::string& instrument, const std::string& frame) const {
  const Use use(*this);
  const int index = instrumentOf(instrument);
  Wrench wrench = simulator_.wrench(index);
  if (frame == "world") {
    wrench = {tip(index).linear() * wrench.force, tip(index).linear() * wrench.torque};
  } else if (frame != "tip") {
    throw std::invalid_argument("frame of a wrench is " + printable(frame) + "; it may be tip or world");
  }
  return toArray(wrench);
}

py::array PythonSimulator::tipPose(const std::string& instrument) const {
  const Use use(*this);
  return toArray(tip(instrumentOf(instrument)));
}

/// Of what is shown of it now.
void PythonSimulator::leaveMemoryToViews() {
  for (std::size_t t = 0; t < views_.size(); ++t) {
    if (const auto held = views_[t].positions.lock()) {
      held->kept = simulator_.handOverPositions(static_cast<int>(t));
      held->owner.reset();
    }
    if (const auto held = views_[t].velocities.lock()) {
      held->kept = simulator_.handOverVelocities(static_cast<int>(t));
      held->owner.reset();
    }
    views_[t].positions.reset();
    views_[t].velocities.reset();
  }
}

py::array PythonSimulator::view(const NodalVectors& values, std::weak_ptr<NodalView>& held) {
  std::shared_ptr<NodalView> memory = held.lock();
  if (!memory) {
    memory = std::make_shared<NodalView>();
    memory->owner = shared_from_this();
    held = memory;
  }
  return viewOfRows(values.data(), static_cast<std::size_t>(values.cols()), 3, py::cast(memory));
}

py::array PythonSimulator::positions(const std::string& tissue) {
  const Use use(*this);
  const int index = tissueOf(tissue);
  return view(simulator_.positions(index), views_[index].positions);
}

py::array PythonSimulator::velocities(const std::string& tissue) {
  const Use use(*this);
  const int index = tissueOf(tissue);
  return view(simulator_.velocities(index), views_[index].velocities);
}

std::shared_ptr<Topology> PythonSimulator::topology(const std::string& tissue) {
  const Use use(*this);
  const int index = tissueOf(tissue);
  const int revision = simulator_.meshRevision(index);
  std::shared_ptr<Topology>& known = views_[index].topology;
  if (!known || known->revision != revision) {
    const Tissue& now = simulator_.tissues()[index];
    known = std::make_shared<Topology>(
        Topology{revision, now.restPositions(), now.tetrahedra(), now.surface(), now.fixed()});
  }
  return known;
}

py::array PythonSimulator::contacts() const {
  const Use use(*this);
  return toArray(simulator_.contacts(), simulator_.tissues());
}

py::array PythonSimulator::forceErrors() const {
  const Use use(*this);
  return toArray(simulator_.forceErrors());
}

py::dict PythonSimulator::residuals() const {
  const Use use(*this);
  const Residuals& all = simulator_.residuals();
  py::dict named;
  named["momentum"] = all.momentum;
  named["net_defect_n_s"] = all.net_defect_n_s;
  named["penetration_m"] = all.penetration_m;
  named["adhesion_n"] = all.adhesion_n;
  named["complementarity_w"] = all.complementarity_w;
  named["cone_violation_n"] = all.cone_violation_n;
  named["static_slip_m_per_s"] = all.static_slip_m_per_s;
  named["kinetic_angle_rad"] = all.kinetic_angle_rad;
  return named;
}

StepReport PythonSimulator::report() const {
  const Use use(*this);
  return simulator_.report();
}

std::vector<std::string> PythonSimulator::advice() const {
  const Use use(*this);
  std::vector<std::string> lines;
  for (Advice& advice : simulator_.advice()) lines.push_back(std::move(advice.text));
  return lines;
}

long PythonSimulator::stepCount() const {
  const Use use(*this);
  return simulator_.stepCount();
}

}  // namespace tissue_contact::python
