#include "python/binding/arrays.h"

#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>

#include "tissue_contact/simulation/touched_point.h"

namespace tissue_contact::python {
namespace {

void copy(const Vector3& from, double (&to)[3]) {
  for (int i = 0; i < 3; ++i) to[i] = from[i];
}

constexpr py::ssize_t kMostNumbers = 1'000'000;  // a view of one number may claim to be any number of them

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// As NumPy reads it, in doubles.
Numbers toNumbers(const py::handle& value, const std::string& what) {
  const py::array any = py::array::ensure(value);
  const std::string kinds = "biuf";
  if (!any || (any.size() > 0 && kinds.find(any.dtype().kind()) == std::string::npos)) {
    throw py::type_error(what + " must be real numbers (a list of them, or an array), not " +
                         std::string(py::str(value.attr("__class__"))));
  }
  if (any.size() > kMostNumbers) {
    throw std::invalid_argument(what + " has " + std::to_string(any.size()) + " numbers; up to " +
                                std::to_string(kMostNumbers) + " are allowed");
  }
  Numbers numbers = Numbers::ensure(any);
  if (!numbers) throw std::bad_alloc();  // ensure() has taken the error away
  return numbers;
}

}  // namespace

void registerRows() {
  PYBIND11_NUMPY_DTYPE(ContactRow, instrument, link, shape, tissue, other_tissue, state, point, normal, force, slip,
                       gap);
  PYBIND11_NUMPY_DTYPE(ForceErrorRow, total_n, mesh_n, step_n, solver_n);
}

VectorX toVector(const py::handle& value, const std::string& what) {
  const Numbers numbers = toNumbers(value, what);
  if (numbers.ndim() != 1) {
    throw std::invalid_argument(what + " must be a flat list, not an array of " + std::to_string(numbers.ndim()) +
                                " dimensions");
  }
  return Eigen::Map<const VectorX>(numbers.data(), numbers.size());
}

Pose toPose(const py::handle& value, const std::string& what) {
  const Numbers numbers = toNumbers(value, what);
  if (numbers.ndim() != 2 || numbers.shape(0) != 4 || numbers.shape(1) != 4) {
    throw std::invalid_argument(what + " must be a 4 x 4 matrix");
  }
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
  const Matrix3 R = matrix.topLeftCorner<3, 3>();
  constexpr double kRounding = 1e-6;
  const bool is_rigid = (R.transpose() * R - Matrix3::Identity()).norm() < kRounding && R.determinant() > 0.0 &&
                        matrix.row(3) == Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0);
  if (!is_rigid || !matrix.allFinite()) {
    throw std::invalid_argument(what +
                                " must be rigid: a rotation, metres in the last column, and a last row of 0 0 0 1");
  }
  Pose pose;
  pose.matrix() = matrix;
  return pose;
}

py::array_t<double> toArray(const VectorX& values) { return py::array_t<double>(values.size(), values.data()); }

py::array_t<double> toArray(const Pose& pose) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
  return py::array_t<double>({4, 4}, rows.data());
}

py::array_t<double> toArray(const Wrench& wrench) {
  py::array_t<double> numbers(6);
  for (int i = 0; i < 3; ++i) {
    numbers.mutable_at(i) = wrench.force[i];
    numbers.mutable_at(i + 3) = wrench.torque[i];
  }
  return numbers;
}

py::array toArray(const std::vector<bool>& flags) {
  py::array_t<bool> array(static_cast<py::ssize_t>(flags.size()));
  for (std::size_t i = 0; i < flags.size(); ++i) array.mutable_at(static_cast<py::ssize_t>(i)) = flags[i];
  return array;
}

py::array_t<ContactRow> toArray(const std::vector<SolvedContact>& contacts, const std::vector<Tissue>& tissues) {
  py::array_t<ContactRow> rows(static_cast<py::ssize_t>(contacts.size()));
  ContactRow* row = rows.mutable_data();
  for (const SolvedContact& solved : contacts) {
    const ContactKey& key = solved.contact.key;
    row->instrument = key.instrument;
    row->link = key.link;
    row->shape = key.shape;
    row->tissue = key.tissue;
    row->other_tissue = key.other_tissue;
    row->state = static_cast<std::int32_t>(solved.state);
    copy(touchedPoint(solved.contact, tissues), row->point);
    copy(solved.contact.R_WC.col(0), row->normal);
    copy(solved.force_on_tissue_n, row->force);
    copy(solved.slip_W, row->slip);
    row->gap = solved.contact.gap_m;
    ++row;
  }
  return rows;
}

py::array_t<ForceErrorRow> toArray(const std::vector<ForceErrorEstimate>& errors) {
  py::array_t<ForceErrorRow> rows(static_cast<py::ssize_t>(errors.size()));
  ForceErrorRow* row = rows.mutable_data();
  for (const ForceErrorEstimate& error : errors) {
    row->total_n = error.total_n();
    row->mesh_n = error.knows_mesh ? error.mesh_n : std::numeric_limits<double>::quiet_NaN();
    row->step_n = error.step_n;
    row->solver_n = error.solver_n;
    ++row;
  }
  return rows;
}

py::array readOnly(py::array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

}  // namespace tissue_contact::python
