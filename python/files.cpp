#include "python/files.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "capture_io/image.h"
#include "estimation/effects/catalogue.h"
#include "estimation/model/declaration.h"
#include "estimation/model/limits.h"
#include "importers/importer.h"
#include "meshing/surface_mesh.h"
#include "meshing/tet_mesh.h"
#include "python/arrays.h"
#include "python/errors.h"
#include "python/work.h"

namespace hookeye {

namespace py = pybind11;

namespace {

using std::filesystem::path;

py::dict import_them(const std::string& kind, const std::vector<path>& sources, double scale,
                     std::pair<int, int> size, bool lens_as_opencv) {
  if (!(scale > 0.0) || !std::isfinite(scale))
    bad_argument("scale: not a number above zero", "length units of the capture in one of theirs");
  Work work{py::none()};
  const auto [imported, seen, text] = work.run([&] {
    const Importer* importer = kind.empty() ? &recognise(sources) : find_importer(kind);
    if (!importer)
      bad_argument("there is no importer " + kind, "hookeye.importers has a function each");
    ImportOptions options;
    options.width = size.first, options.height = size.second;
    options.scale = scale;
    options.lens_as_opencv = lens_as_opencv;
    const Imported found = import_cameras(*importer, sources, options);
    const std::string head =
        "# hookeye.importers." + importer->name() + "\n# the world is " + found.world + "\n";
    return std::make_tuple(found, reproject(found), cameras_yaml(found, head));
  });
  py::list rms;
  for (const Reprojection& one : seen)
    rms.append(one.points ? py::object(py::float_(one.rms_px)) : py::none());
  py::dict out;
  out["cameras"] = py::cast(imported.cameras);
  out["rms_px"] = rms;
  out["world"] = imported.world;
  out["said"] = py::cast(imported.said);
  out["yaml"] = text;
  return out;
}

void write_volume(const path& file, const py::object& points, const py::object& elements) {
  TetMesh mesh;
  mesh.X = points_from(points, "points");
  mesh.elements = indices_from(elements, "elements", 4, 10, mesh.nodes());
  mesh.order = mesh.elements.rows() == 4 ? 1 : 2;
  write_vtu(file, mesh, {});
}

void write_surface(const path& file, const py::object& points, const py::object& triangles) {
  SurfaceMesh surface;
  surface.X = points_from(points, "points");
  const Eigen::MatrixXi all =
      indices_from(triangles, "triangles", 3, 3, static_cast<int>(surface.X.cols()));
  for (Eigen::Index i = 0; i < all.cols(); ++i)
    surface.triangles.push_back({all(0, i), all(1, i), all(2, i)});
  write_surface_obj(file, surface);
}

/// As EXR in float; 8 bit as PNG, which a capture takes for sRGB.
std::string write_photo(const path& stem, const py::object& array, const std::string& what) {
  const Image image = image_from(array, what);
  const bool bytes = py::array::ensure(array).dtype().itemsize() == 1;
  const path file = stem.string() + (bytes ? ".png" : ".exr");
  write_image(file, image, Encoding{Encoding::Kind::linear});
  return file.filename().string();
}

py::list known_effects() {
  py::list out;
  for (const Effect* effect : catalogue()) {
    py::dict one;
    one["name"] = effect->name();
    one["group"] = group_name(effect->group());
    one["title"] = effect->title();
    one["manual"] = effect->manual();
    out.append(one);
  }
  return out;
}

py::list known_options() {
  py::list out;
  for (const LimitSpec& spec : specs({})) {
    py::dict one;
    one["name"] = spec.name;
    one["standard"] = spec.standard;
    one["low"] = spec.low;
    one["high"] = spec.high;
    one["unit"] = spec.unit;
    one["what"] = spec.what;
    one["source"] = spec.source;
    out.append(one);
  }
  return out;
}

}  // namespace

void bind_files(py::module_& m) {
  m.def("import_cameras", &import_them, py::arg("kind"), py::arg("sources"), py::arg("scale"),
        py::arg("size"), py::arg("lens_as_opencv"));
  m.def("importers", [] {
    std::vector<std::pair<std::string, std::string>> out;
    for (const Importer* importer : importers())
      out.emplace_back(importer->name(), importer->title());
    return out;
  });
  m.def("write_volume", &write_volume, py::arg("file"), py::arg("points"), py::arg("elements"));
  m.def("write_surface", &write_surface, py::arg("file"), py::arg("points"), py::arg("triangles"));
  m.def("write_photo", &write_photo, py::arg("stem"), py::arg("array"), py::arg("what"));
  m.def("effects", &known_effects);
  m.def("options", &known_options);
}

}  // namespace hookeye
