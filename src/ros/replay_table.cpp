/// @file
/// Room `ros`: see replay_table.h.
#include "tissue_contact/ros/replay_table.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include "tissue_contact/ros/conversions.h"

namespace tissue_contact {
namespace {

[[noreturn]] void throwUnwritable(const std::string& file) {
  throw std::runtime_error("cannot write '" + file + "': " + std::strerror(errno));
}

}  // namespace

ReplayTable::ReplayTable(std::string file) : file_(std::move(file)), part_(file_ + ".part"), stream_(part_) {
  if (!stream_) throwUnwritable(part_);
  stream_.precision(std::numeric_limits<double>::max_digits10);
  stream_ << "stamp_s,instrument,tip_x_m,tip_y_m,tip_z_m,tip_qx,tip_qy,tip_qz,tip_qw,force_x_n,force_y_n,force_z_n,"
             "torque_x_nm,torque_y_nm,torque_z_nm,static_contacts,kinetic_contacts,momentum_residual,penetration_m,"
             "adhesion_n,complementarity_w,cone_violation_n,static_slip_m_per_s,kinetic_angle_rad,discarded,jumped,"
             "step_time_s\n";
}

ReplayTable::~ReplayTable() {
  if (committed_) return;
  stream_.close();
  std::remove(part_.c_str());
}

void ReplayTable::add(const Simulator& simulator, const PlayedSample& played, double step_time_s) {
  const StepReport& report = simulator.report();
  const Residuals& residuals = report.residuals;
  for (const int instrument : played.instruments) {
    stream_ << toTime(played.stamp_ns) << ',';
    addInstrument(simulator, instrument);
    stream_ << ',' << residuals.momentum << ',' << residuals.penetration_m << ',' << residuals.adhesion_n << ','
            << residuals.complementarity_w << ',' << residuals.cone_violation_n << ',' << residuals.static_slip_m_per_s
            << ',' << residuals.kinetic_angle_rad << ',' << static_cast<int>(report.discarded) << ','
            << static_cast<int>(report.jumped) << ',' << step_time_s << '\n';
  }
}

void ReplayTable::addInstrument(const Simulator& simulator, int instrument) {
  const Instrument& tool = simulator.instruments()[static_cast<std::size_t>(instrument)];
  const Pose& X_WTip = simulator.linkPoses(instrument)[static_cast<std::size_t>(tool.tipLink())];
  const Vector3 p = X_WTip.translation();
  const Quaternion q(X_WTip.linear());
  const Wrench wrench = simulator.wrench(instrument);
  int held = 0;
  int sliding = 0;
  for (const SolvedContact& contact : simulator.contacts()) {
    if (contact.contact.key.instrument != instrument) continue;
    held += static_cast<int>(contact.state == ContactState::kStatic);
    sliding += static_cast<int>(contact.state == ContactState::kKinetic);
  }
  stream_ << tool.name() << ',' << p.x() << ',' << p.y() << ',' << p.z() << ',' << q.x() << ',' << q.y() << ',' << q.z()
          << ',' << q.w() << ',' << wrench.force.x() << ',' << wrench.force.y() << ',' << wrench.force.z() << ','
          << wrench.torque.x() << ',' << wrench.torque.y() << ',' << wrench.torque.z() << ',' << held << ',' << sliding;
}

void ReplayTable::commit() {
  stream_.close();
  if (!stream_) throwUnwritable(part_);
  if (std::rename(part_.c_str(), file_.c_str()) != 0) throwUnwritable(file_);
  committed_ = true;
}

}  // namespace tissue_contact
