#include "python/arrays.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "python/errors.h"

namespace hookeye {

namespace py = pybind11;

namespace {

/// "3 x 4".
std::string shape_text(const py::array& array) {
  std::vector<py::ssize_t> sides(array.shape(), array.shape() + array.ndim());
  return sides.empty() ? "one number" : fmt::format("{}", fmt::join(sides, " x "));
}

py::array real_array(const py::handle& given, const std::string& what) {
  const py::array array = py::array::ensure(given);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(what + ": a numpy array is expected");
  }
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u')
    throw py::type_error(fmt::format("{}: real numbers are expected, not dtype {}", what,
                                     py::str(array.dtype()).cast<std::string>()));
  return array;
}

template <class T>
py::array_t<T, py::array::c_style | py::array::forcecast> as(const py::array& array) {
  return py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(array);
}

}  // namespace

DoubleArray array_of(const Eigen::VectorXd& v) {
  DoubleArray out(v.size());
  std::copy(v.data(), v.data() + v.size(), out.mutable_data());
  return out;
}

DoubleArray array_of(const Eigen::MatrixXd& m) {
  DoubleArray out({m.rows(), m.cols()});
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      out.mutable_data(), m.rows(), m.cols()) = m;
  return out;
}

DoubleArray points_array(const Eigen::Matrix3Xd& X) {
  DoubleArray out({X.cols(), Eigen::Index{3}});
  std::copy(X.data(), X.data() + X.size(), out.mutable_data());
  return out;
}

py::array int_rows(const Eigen::MatrixXi& m) {
  py::array_t<int, py::array::c_style> out({m.cols(), m.rows()});
  std::copy(m.data(), m.data() + m.size(), out.mutable_data());
  return out;
}

py::array image_array(const Image& image) {
  std::vector<py::ssize_t> shape = {image.height, image.width};
  if (image.channels > 1) shape.push_back(image.channels);
  py::array_t<float, py::array::c_style> out(shape);
  std::copy(image.values.begin(), image.values.end(), out.mutable_data());
  return out;
}

Eigen::Matrix3Xd points_from(const py::handle& given, const std::string& what) {
  const py::array array = real_array(given, what);
  const bool one = array.ndim() == 1 && array.shape(0) == 3;
  if (!one && (array.ndim() != 2 || array.shape(1) != 3))
    bad_argument(fmt::format("{}: the array is {}", what, shape_text(array)),
                 "points are n x 3, a row each");
  const auto numbers = as<double>(array);
  const Eigen::Index n = one ? 1 : array.shape(0);
  const Eigen::Matrix3Xd out = Eigen::Map<const Eigen::Matrix3Xd>(numbers.data(), 3, n);
  for (Eigen::Index i = 0; i < n; ++i)
    if (!out.col(i).allFinite())
      bad_argument(fmt::format("{}: row {} is not finite", what, i), "numbers alone, no NaN");
  return out;
}

Eigen::MatrixXi indices_from(const py::handle& given, const std::string& what, int least, int most,
                             int n) {
  const py::array array = real_array(given, what);
  if (array.dtype().kind() == 'f')
    throw py::type_error(what + ": whole numbers are expected, not dtype float");
  if (array.ndim() != 2 || (array.shape(1) != least && array.shape(1) != most))
    bad_argument(fmt::format("{}: the array is {}", what, shape_text(array)),
                 least == most ? fmt::format("rows of {} indices", least)
                               : fmt::format("rows of {} or {} indices", least, most));
  const auto numbers = as<long>(array);
  Eigen::MatrixXi out(array.shape(1), array.shape(0));
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const long index = numbers.data()[i];
    if (index < 0 || index >= n)
      bad_argument(fmt::format("{}: row {} has the index {}", what, i / out.rows(), index),
                   fmt::format("indices from 0 to {}", n - 1));
    out.data()[i] = static_cast<int>(index);
  }
  return out;
}

Image image_from(const py::handle& given, const std::string& what) {
  const py::array array = real_array(given, what);
  const bool grey = array.ndim() == 2, rgb = array.ndim() == 3 && array.shape(2) == 3;
  if ((!grey && !rgb) || array.size() == 0)
    bad_argument(fmt::format("{}: the array is {}", what, shape_text(array)),
                 "a photo is height x width, or height x width x 3");
  const char kind = array.dtype().kind();
  const auto bytes = array.itemsize();
  float full = 1.0F;
  if (kind == 'u' && bytes == 1) full = 255.0F;
  if (kind == 'u' && bytes == 2) full = 65535.0F;
  if (kind != 'f' && full == 1.0F)
    throw py::type_error(fmt::format("{}: a photo is uint8, uint16, float32 or float64, not {}",
                                     what, py::str(array.dtype()).cast<std::string>()));
  const auto numbers = as<float>(array);
  Image image{static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)), grey ? 1 : 3, {}};
  image.values.assign(numbers.data(), numbers.data() + numbers.size());
  for (size_t i = 0; i < image.values.size(); ++i) {
    if (!std::isfinite(image.values[i])) {
      const size_t pixel = i / static_cast<size_t>(image.channels);
      bad_argument(fmt::format("{}: pixel ({}, {}) is not finite", what, pixel % image.width,
                               pixel / image.width),
                   "numbers alone, no NaN; a mask tells which pixels count");
    }
    image.values[i] /= full;
  }
  return image;
}

py::object python_of(const nlohmann::json& document) {
  const std::string text = document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return py::module_::import("json").attr("loads")(text);
}

}  // namespace hookeye
