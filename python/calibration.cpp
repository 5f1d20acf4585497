#include "python/calibration.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <memory>
#include <regex>
#include <utility>

#include "calibration/board_options.h"
#include "calibration/detection.h"
#include "calibration/files.h"
#include "calibration/output.h"
#include "python/arrays.h"
#include "python/errors.h"
#include "python/work.h"

namespace hookeye {

namespace py = pybind11;

namespace {

struct FoundCameras {
  Calibration calibration;
  std::string unit;
};
using SharedCameras = std::shared_ptr<FoundCameras>;

/// Options of the command line are arguments here: "--lens 8" is "lens 8".
std::string as_arguments(const std::string& sentence) {
  static const std::regex option("--([a-z]+)");
  return std::regex_replace(sentence, option, "$1");
}

/// `body()`, whose errors speak of arguments.
template <class Body>
auto in_arguments(const Body& body) {
  try {
    return body();
  } catch (const InputError& error) {
    const Place place = error.place().file == kCalibrate ? Place{} : error.place();
    throw InputError(place, as_arguments(error.wrong()), as_arguments(error.right()));
  }
}

/// `told`: the board in words ("" where the arguments tell it), then what they tell.
Board board_from(const std::string& words, ToldBoard told) {
  if (!words.empty()) {
    const ToldBoard in_words = told_board(words);
    const auto fill = [&](auto ToldBoard::*member, const char* name) {
      if (in_words.*member == ToldBoard{}.*member) return;
      if (told.*member != ToldBoard{}.*member)
        throw bad_calibration(std::string(name) + " is told twice", "in `board` or beside it");
      told.*member = in_words.*member;
    };
    told.kind = in_words.kind;
    fill(&ToldBoard::squares, "squares"), fill(&ToldBoard::dots, "dots");
    fill(&ToldBoard::dictionary, "dictionary");
    fill(&ToldBoard::square, "square"), fill(&ToldBoard::spacing, "spacing");
    fill(&ToldBoard::marker, "marker"), fill(&ToldBoard::diameter, "diameter");
  }
  return board_of(told);
}

ToldBoard told_from(const py::dict& given) {
  ToldBoard told;
  told.squares = given["squares"].cast<std::string>();
  told.dots = given["dots"].cast<std::string>();
  told.dictionary = given["dictionary"].cast<std::string>();
  told.square = given["square"].cast<double>(), told.marker = given["marker"].cast<double>();
  told.spacing = given["spacing"].cast<double>(), told.diameter = given["diameter"].cast<double>();
  return told;
}

std::vector<CameraPhotos> cameras_from(
    const std::vector<std::pair<std::string, std::vector<std::string>>>& photos) {
  std::vector<CameraPhotos> out;
  for (const auto& [name, sources] : photos) {
    if (!is_camera_name(name))
      throw bad_calibration("a camera cannot have the name '" + name + "'",
                            "letters, digits, - and _");
    if (sources.empty())
      throw bad_calibration("there are no photos of `" + name + "`",
                            "files, a folder, or a pattern as 'calib/left_*.png'");
    out.push_back({name, sources});
  }
  if (out.empty())
    throw bad_calibration("there are no photos", "files, a folder, a pattern, or a dict of them");
  return out;
}

void check_unit(const std::string& unit) {
  if (std::ranges::count(board_units(), unit) == 0)
    throw bad_calibration("unit: there is no '" + unit + "'", "mm, cm, m or um");
}

SharedCameras calibrate_them(
    const std::vector<std::pair<std::string, std::vector<std::string>>>& photos,
    const std::string& words, const py::dict& given, int lens, const std::string& frame,
    const std::string& unit, py::object on_step, py::object cancel) {
  const ToldBoard told = told_from(given);
  Work work(std::move(cancel));
  CalibrateOptions options;
  options.lens = lens, options.frame = frame, options.cancel = work.cancelled();
  if (!on_step.is_none())
    options.progress = [&](size_t done, size_t of) {
      work.tell([&] { on_step("calibrate", "looking for the board", done, of, 0.0); });
    };
  return work.run([&] {
    return in_arguments([&] {
      demand_board_finder();
      check_unit(unit);
      const Board board = board_from(words, told);
      auto out = std::make_shared<FoundCameras>();
      out->unit = unit;
      out->calibration = calibrate(board, cameras_from(photos), options);
      for (auto* sentences : {&out->calibration.said, &out->calibration.warnings})
        for (std::string& sentence : *sentences) sentence = as_arguments(sentence);
      return SharedCameras(std::move(out));
    });
  });
}

py::list map_list(const FoundCameras& found) {
  py::list out;
  for (size_t c = 0; c < found.calibration.bundle.cameras.size(); ++c)
    out.append(corner_map(found.calibration, c));
  return out;
}

std::string save_to(const SharedCameras& found, const std::filesystem::path& folder) {
  Work work{py::none()};
  return work
      .run([&] {
        return in_arguments(
            [&] { return write_calibration(found->calibration, found->unit, folder); });
      })
      .cameras.string();
}

}  // namespace

void bind_calibration(py::module_& m) {
  py::class_<FoundCameras, std::shared_ptr<FoundCameras>>(m, "Calibration")
      .def("cameras", [](const FoundCameras& f) { return f.calibration.bundle.cameras; })
      .def("told",
           [](const FoundCameras& f) { return python_of(calibration_json(f.calibration, f.unit)); })
      .def("said", [](const FoundCameras& f) { return f.calibration.said; })
      .def("covariance",
           [](const FoundCameras& f) {
             return array_of(Eigen::MatrixXd(f.calibration.errors.covariance));
           })
      .def("yaml",
           [](const FoundCameras& f) {
             return in_arguments([&] { return calibration_yaml(f.calibration, f.unit); });
           })
      .def("corner_maps", &map_list)
      .def("save", &save_to, py::arg("folder"));
  m.def("calibrate", &calibrate_them, py::arg("photos"), py::arg("board"), py::arg("told"),
        py::arg("lens"), py::arg("frame"), py::arg("unit"), py::arg("on_step"), py::arg("cancel"));
}

}  // namespace hookeye
