#include "python/bridge.h"

#include <stdexcept>

namespace hookeye {

namespace py = pybind11;

Bridge::Bridge(py::object object)
    : object_(object.release().ptr(), [](PyObject* own) {
        if (!Py_IsInitialized()) return;  // the interpreter has gone, and the object with it
        const py::gil_scoped_acquire lock;
        Py_DECREF(own);
      }) {}

Bridge::Rows Bridge::rows_of(const py::object& array, Eigen::Index rows, Eigen::Index columns) {
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>(array);
  if (numbers.size() != rows * columns)
    throw std::logic_error("hookeye._bridge returned another number of values than it was asked");
  return Eigen::Map<const Rows>(numbers.data(), rows, columns);
}

}  // namespace hookeye
