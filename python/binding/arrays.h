/// @file
/// Python: numbers between NumPy and the core. Every function needs the GIL.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact::python {

namespace py = pybind11;

/// One row of Simulator.contacts(); field by field as msg/ContactPoint.msg, with indices in place of names.
struct ContactRow {
  std::int32_t instrument;
  std::int32_t link;
  std::int32_t shape;
  std::int32_t tissue;
  std::int32_t other_tissue;
  std::int32_t state;
  double point[3];
  double normal[3];
  double force[3];
  double slip[3];
  double gap;
};

/// One row of Simulator.force_errors(). `mesh_n` is NaN where it is not known.
struct ForceErrorRow {
  double total_n;
  double mesh_n;
  double step_n;
  double solver_n;
};

/// Makes the row types known to NumPy; once, when the module is loaded.
void registerRows();

/// Numbers of a flat list or array. @param what it is, for messages.
/// @throws py::type_error for what is not a list of real numbers, std::invalid_argument for another shape. Whether the numbers
///   are finite is not looked at.
VectorX toVector(const py::handle& value, const std::string& what);

/// @throws as toVector(), and where it is no rigid 4 x 4 pose.
Pose toPose(const py::handle& value, const std::string& what);

py::array_t<double> toArray(const VectorX& values);
py::array_t<double> toArray(const Pose& pose);      ///< 4 x 4
py::array_t<double> toArray(const Wrench& wrench);  ///< force, torque
py::array toArray(const std::vector<bool>& flags);  ///< of bool
py::array_t<ContactRow> toArray(const std::vector<SolvedContact>& contacts, const std::vector<Tissue>& tissues);
py::array_t<ForceErrorRow> toArray(const std::vector<ForceErrorEstimate>& errors);

/// Nobody may write to it: it is the simulator's memory.
py::array readOnly(py::array array);

/// n x K numbers that lie one row after the other in memory that `owner` keeps alive: not copied, and read-only.
template <typename Number>
py::array viewOfRows(const Number* data, std::size_t rows, std::size_t columns, const py::object& owner) {
  return readOnly(py::array_t<Number>({rows, columns}, data, owner));
}

}  // namespace tissue_contact::python
