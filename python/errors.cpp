#include "python/errors.h"

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <new>

#include "core/input_error.h"
#include "core/interrupted.h"
#include "core/memory_left.h"
#include "core/scope.h"
#include "python/bridge.h"
#include "python/work.h"
#include "runs/failed.h"
#include "runs/printable.h"

namespace hookeye {

namespace py = pybind11;

namespace {

py::object error_class(const char* name) {
  return py::module_::import("hookeye.errors").attr(name);
}

void raise(const py::object& made) { PyErr_SetObject(py::type::of(made).ptr(), made.ptr()); }

void raise_input(const std::string& what, const Place& place, const std::string& wrong,
                 const std::string& right) {
  raise(error_class("InputError")(printable(what), place.file, place.line, place.column, wrong,
                                  right));
}

void raise_failure(const NumericalFailure& failure) {
  const std::string where =
      failure.example.empty() ? "" : fmt::format("example {}: ", failure.example);
  const std::string reached =
      failure.load_fraction < 1.0
          ? fmt::format("\n  reached {:.4g} of the load", failure.load_fraction)
          : std::string();
  raise(error_class("NumericalError")(printable(where + failure.reason + reached), failure.example,
                                      failure.load_fraction, failure.reason));
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    raise_input(error.what(), error.place(), error.wrong(), error.right());
  } catch (const Failed& failed) {
    if (out_of_memory(failed.failure))
      PyErr_SetString(PyExc_MemoryError, failed.failure.reason.c_str());
    else
      raise_failure(failed.failure);
  } catch (const Stopped&) {
    raise(error_class("Cancelled")("stopped: `cancel` was set"));
  } catch (EffectFailed& failed) {
    failed.error.restore();
  } catch (const Interrupted&) {  // a helper program had Ctrl-C
    PyErr_SetString(PyExc_KeyboardInterrupt, "stopped");
  } catch (const std::filesystem::filesystem_error& error) {
    const std::string file = error.path1().string();
    raise_input(fmt::format("{}: {}", file, error.code().message()), {file}, error.code().message(),
                "a place that is there and open to you");
  } catch (const std::bad_alloc&) {
    const std::string context = Scope::take_context();
    PyErr_SetString(PyExc_MemoryError,
                    (context.empty() ? "out of memory" : "out of memory at: " + context).c_str());
  }
}

}  // namespace

void translate_errors() { py::register_exception_translator(&translate); }

void bad_argument(const std::string& wrong, const std::string& right) {
  throw InputError({}, wrong, right);
}

}  // namespace hookeye
