#include "python/capture.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <spdlog/spdlog.h>

#include "python/arrays.h"
#include "python/errors.h"
#include "python/field_arrays.h"
#include "python/work.h"
#include "runs/bench.h"

namespace hookeye {

namespace py = pybind11;

OpenedCapture::OpenedCapture(const std::filesystem::path& path, std::vector<ToldLimit> told)
    : capture_(read_capture(path)), told_(std::move(told)) {
  for (const ToldLimit& one : told_) set_limit(limits_, one.name, one.value, one.place);
}

std::shared_ptr<const Scene> OpenedCapture::scene() {
  const std::lock_guard lock(mutex_);
  if (!scene_) {
    scene_ = load_scene(without_tests(capture_), true, limits_);
    warn_of_doubts(*scene_, [](const std::string& sentence) { spdlog::warn("{}", sentence); });
  }
  return scene_;
}

namespace {

using Shared = std::shared_ptr<OpenedCapture>;

/// Cameras are told by a capture or its importer: nothing is changed through an array.
py::array fixed(DoubleArray array) {
  array.attr("setflags")(false);
  return array;
}

Eigen::Matrix3d camera_matrix(const Camera& camera) {
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  K(0, 0) = camera.fx, K(0, 1) = camera.skew, K(0, 2) = camera.cx;
  K(1, 1) = camera.fy, K(1, 2) = camera.cy;
  return K;
}

py::object pixels_of(const Camera& camera, const py::handle& xyz) {
  const Eigen::Matrix3Xd X = points_from(xyz, "xyz");
  const bool one = py::array::ensure(xyz).ndim() == 1;
  DoubleArray out = one ? DoubleArray(2) : DoubleArray({X.cols(), Eigen::Index{2}});
  for (Eigen::Index i = 0; i < X.cols(); ++i) {
    const Eigen::Vector2d pixel = camera.project(X.col(i));
    out.mutable_data()[2 * i] = pixel.x(), out.mutable_data()[2 * i + 1] = pixel.y();
  }
  return out;
}

py::dict photo_dict(const Photo& photo, const PhotoSpec& spec) {
  const auto stacked = [&](const std::vector<SharedValue<Image>>& planes) -> py::array {
    if (planes.empty()) return py::array_t<float>(0);
    Image all{planes[0]->width, planes[0]->height, static_cast<int>(planes.size()), {}};
    all.values.resize(planes[0]->pixels() * planes.size());
    for (size_t c = 0; c < planes.size(); ++c)
      for (size_t i = 0; i < planes[c]->pixels(); ++i)
        all.values[i * planes.size() + c] = planes[c]->values[i];
    return image_array(all);
  };
  py::array_t<bool> valid({photo.planes.front()->height, photo.planes.front()->width});
  for (size_t i = 0; i < photo.valid->size(); ++i) valid.mutable_data()[i] = (*photo.valid)[i] != 0;
  py::dict out;
  out["values"] = stacked(photo.planes);
  out["sigma"] = stacked(photo.sigma);
  out["valid"] = valid;
  out["file"] = spec.file.string();
  return out;
}

py::dict photos_of(const Shared& capture) {
  Work work{py::none()};
  const auto scene = work.run([&] { return capture->scene(); });
  py::dict out;
  for (size_t e = 0; e < scene->photos.size(); ++e)
    for (size_t k = 0; k < scene->photos[e].size(); ++k) {
      const ExampleSpec& example = scene->capture.examples[e];
      out[py::make_tuple(example.name, example.photos[k].camera)] =
          photo_dict(scene->photos[e][k], example.photos[k]);
    }
  return out;
}

py::dict mesh_of(const Shared& capture) {
  Work work{py::none()};
  const auto scene = work.run([&] { return capture->scene(); });
  const TetMesh& mesh = scene->body->mesh;
  py::dict out, regions;
  out["points"] = points_array(mesh.X);
  out["elements"] = int_rows(mesh.elements);
  out["boundary"] = int_rows(mesh.boundary);
  for (const auto& [name, region] : scene->body->regions.all()) {
    py::dict one;
    one["nodes"] =
        py::array_t<int>(static_cast<py::ssize_t>(region.nodes.size()), region.nodes.data());
    one["area"] = region.area;
    one["centroid"] = array_of(Eigen::VectorXd(region.centroid));
    one["normal"] = array_of(Eigen::VectorXd(region.normal));
    regions[name.c_str()] = one;
  }
  out["regions"] = regions;
  return out;
}

py::list examples_of(const Capture& capture) {
  py::list out;
  for (const ExampleSpec& example : capture.examples) {
    py::list cameras;
    for (const PhotoSpec& photo : example.photos) cameras.append(photo.camera);
    py::dict one;
    one["name"] = example.name;
    one["use"] = example.use();
    one["photos"] = cameras;
    out.append(one);
  }
  return out;
}

py::list materials_of(const Capture& capture) {
  py::list out;
  for (const MaterialSpec& spec : capture.materials) {
    py::dict one, values;
    for (const auto& [name, value] : spec.parameters)
      values[name.c_str()] = value.numbers.size() == 1 ? py::object(py::float_(value.numbers[0]))
                                                       : py::object(py::cast(value.numbers));
    one["law"] = spec.law;
    one["region"] = spec.region;
    one["parameters"] = values;
    out.append(one);
  }
  return out;
}

std::vector<ToldLimit> told_limits(const std::map<std::string, double>& options) {
  std::vector<ToldLimit> out;
  for (const auto& [name, value] : options) out.push_back({name, value, "options"});
  return out;
}

void bind_camera(py::module_& m) {
  py::class_<Camera>(m, "Camera")
      .def_readonly("name", &Camera::name)
      .def_readonly("width", &Camera::width)
      .def_readonly("height", &Camera::height)
      .def_property_readonly("projection", [](const Camera& c) { return c.model->name(); })
      .def_property_readonly(
          "K", [](const Camera& c) { return fixed(array_of(Eigen::MatrixXd(camera_matrix(c)))); })
      .def_property_readonly(
          "D",
          [](const Camera& c) {
            return fixed(array_of(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
                c.distortion.data(), static_cast<Eigen::Index>(c.distortion.size())))));
          })
      .def_property_readonly("R",
                             [](const Camera& c) { return fixed(array_of(Eigen::MatrixXd(c.R))); })
      .def_property_readonly("t",
                             [](const Camera& c) { return fixed(array_of(Eigen::VectorXd(c.t))); })
      .def_property_readonly(
          "centre", [](const Camera& c) { return fixed(array_of(Eigen::VectorXd(c.centre()))); })
      .def("project", &pixels_of, py::arg("xyz"))
      .def("__repr__", [](const Camera& c) {
        return fmt::format("<hookeye.Camera {}: {} x {}, {}>", c.name, c.width, c.height,
                           c.model->name());
      });
}

}  // namespace

void bind_capture(py::module_& m) {
  bind_camera(m);
  py::class_<OpenedCapture, Shared>(m, "Capture")
      .def(py::init(
               [](const std::filesystem::path& path, const std::map<std::string, double>& options) {
                 return std::make_shared<OpenedCapture>(path, told_limits(options));
               }),
           py::arg("path"), py::arg("options"))
      .def_property_readonly("file", [](const Shared& c) { return c->capture().file.string(); })
      .def_property_readonly("title", [](const Shared& c) { return c->capture().title; })
      .def_property_readonly("length", [](const Shared& c) { return c->capture().units.length; })
      .def_property_readonly("force", [](const Shared& c) { return c->capture().units.force; })
      .def_property_readonly("stress", [](const Shared& c) { return c->capture().units.stress(); })
      .def("cameras", [](const Shared& c) { return c->capture().cameras; })
      .def("examples", [](const Shared& c) { return examples_of(c->capture()); })
      .def("materials", [](const Shared& c) { return materials_of(c->capture()); })
      .def("photos", &photos_of)
      .def("fields", [](const OpenedCapture& c) { return fields_told(c.capture()); })
      .def("mesh", &mesh_of);
}

}  // namespace hookeye
