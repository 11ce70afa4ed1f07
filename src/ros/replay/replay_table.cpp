#include "ros/replay/replay_table.h"

#include "tissue_contact/core/text.h"

namespace tissue_contact {

namespace {

void addInstrument(const Simulator& simulator, int instrument, std::ostream& out) {
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
  out << tool.name() << ',' << p.x() << ',' << p.y() << ',' << p.z() << ',' << q.x() << ',' << q.y() << ',' << q.z()
      << ',' << q.w() << ',' << wrench.force.x() << ',' << wrench.force.y() << ',' << wrench.force.z() << ','
      << wrench.torque.x() << ',' << wrench.torque.y() << ',' << wrench.torque.z() << ',' << held << ',' << sliding;
}

void addForceError(const ForceErrorEstimate& error, std::ostream& out) {
  out << ',' << error.total_n() << ',';
  if (error.knows_mesh) out << error.mesh_n;
  out << ',' << error.step_n << ',' << error.solver_n;
}

}  // namespace

ReplayTable::ReplayTable(const std::string& file) : WholeFile(file) {
  stream() << "stamp_s,instrument,tip_x_m,tip_y_m,tip_z_m,tip_qx,tip_qy,tip_qz,tip_qw,force_x_n,force_y_n,force_z_n,"
              "torque_x_nm,torque_y_nm,torque_z_nm,static_contacts,kinetic_contacts,momentum_residual,penetration_m,"
              "adhesion_n,complementarity_w,cone_violation_n,static_slip_m_per_s,kinetic_angle_rad,discarded,jumped,"
              "implausible_load,inverted_elements,contact_pressure_pa,pinched_contacts,"
              "force_error_n,mesh_error_n,step_error_n,solver_error_n,simulated_s\n";
}

void ReplayTable::add(const Simulator& simulator, const PlayedSample& played, long steps) {
  const StepReport& report = simulator.report();
  const Residuals& residuals = simulator.residuals();
  std::ostream& out = stream();
  if (played.was_reset) simulated_s_ = 0.0;
  if (steps > 0) simulated_s_ += report.advanced_s;
  for (const int instrument : played.instruments) {
    out << stampText(played.stamp_ns) << ',';
    addInstrument(simulator, instrument, out);
    out << ',' << residuals.momentum << ',' << residuals.penetration_m << ',' << residuals.adhesion_n << ','
        << residuals.complementarity_w << ',' << residuals.cone_violation_n << ',' << residuals.static_slip_m_per_s
        << ',' << residuals.kinetic_angle_rad << ',' << static_cast<int>(steps > 0 && report.discarded) << ','
        << static_cast<int>(steps > 0 && report.jumped) << ',' << static_cast<int>(report.implausible_load.found) << ','
        << report.implausible_load.inverted_elements << ',' << report.implausible_load.pressure_pa << ','
        << report.pinched_contacts;
    addForceError(simulator.forceErrors()[static_cast<std::size_t>(instrument)], out);
    out << ',' << simulated_s_ << '\n';
  }
}

TimingTable::TimingTable(const std::string& file) : WholeFile(file) { stream() << "stamp_s,step_time_s,steps\n"; }

void TimingTable::add(std::int64_t stamp_ns, double elapsed_s, long steps) {
  stream() << stampText(stamp_ns) << ',' << elapsed_s / static_cast<double>(steps) << ',' << steps << '\n';
}

}  // namespace tissue_contact
