// numpy arrays from the program's numbers and back: float64 or float32, C order, never a view.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "capture_io/image.h"

namespace hookeye {

using DoubleArray = pybind11::array_t<double, pybind11::array::c_style>;

DoubleArray array_of(const Eigen::VectorXd& v);
DoubleArray array_of(const Eigen::MatrixXd& m);       ///< rows, columns
DoubleArray points_array(const Eigen::Matrix3Xd& X);  ///< n x 3
pybind11::array int_rows(const Eigen::MatrixXi& m);   ///< a row a column of `m`
pybind11::array image_array(const Image& image);      ///< float32, h x w or h x w x channels

/// Points as columns. `what`: its name for messages. Throws TypeError for what holds no real
/// numbers, InputError for another shape than n x 3 and for what is not finite.
Eigen::Matrix3Xd points_from(const pybind11::handle& given, const std::string& what);
/// Node or vertex indices, a row each of `least` .. `most` numbers, as columns; within 0 .. n - 1.
Eigen::MatrixXi indices_from(const pybind11::handle& given, const std::string& what, int least,
                             int most, int n);
/// h x w or h x w x 3; uint8 and uint16 as shares of full scale.
Image image_from(const pybind11::handle& given, const std::string& what);

/// What json.loads makes of the document: every double in all its bits.
pybind11::object python_of(const nlohmann::json& document);

}  // namespace hookeye
