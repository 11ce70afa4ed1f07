/// @file
/// Python: Ctrl-C while the core works without the GIL.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>

namespace tissue_contact::python {

namespace py = pybind11;

/// Whether a signal came whose handler raised, as that of Ctrl-C does: then py::error_already_set() is that. Looks ten times per second,
/// since it takes the GIL.
class SignalCheck {
 public:
  bool operator()() {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return false;
    next_ = now + kInterval;
    const py::gil_scoped_acquire gil;
    return PyErr_CheckSignals() != 0;
  }

 private:
  static constexpr std::chrono::milliseconds kInterval{100};
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now() + kInterval;
};

}  // namespace tissue_contact::python
