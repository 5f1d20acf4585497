// The Python side of an effect, asked from any thread of the work.
#pragma once

#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <memory>
#include <utility>

#include "core/interrupted.h"
#include "python/arrays.h"
#include "python/work.h"

namespace hookeye {

/// What a method of a Python effect threw, on its way out of the work: nothing takes it for an
/// equilibrium that is not there, and nothing half-done is written, as where Ctrl-C ends it.
struct EffectFailed : Interrupted {
  explicit EffectFailed(pybind11::error_already_set thrown) : error(std::move(thrown)) {}
  pybind11::error_already_set error;
};

/// An object of hookeye._bridge.Bridge (whose methods are what C++ calls). Whoever holds it may let
/// it go on any thread.
class Bridge {
 public:
  explicit Bridge(pybind11::object object);

  /// `use(object)` with the interpreter's lock, which the calling thread has released. Returns no
  /// Python object. Throws EffectFailed for what Python throws.
  template <class Use>
  auto ask(const Use& use) const {
    const pybind11::gil_scoped_acquire lock;
    const InCallback mark;
    try {
      return use(pybind11::handle(object_.get()));
    } catch (pybind11::error_already_set& error) {
      throw EffectFailed(std::move(error));
    }
  }

  /// The numbers of a float64 array that a method of the object returned, as rows x columns in C
  /// order.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  static Rows rows_of(const pybind11::object& array, Eigen::Index rows, Eigen::Index columns);

 private:
  std::shared_ptr<PyObject> object_;
};

}  // namespace hookeye
