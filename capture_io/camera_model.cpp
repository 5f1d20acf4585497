// The list of cameras; catalogue.def is the only place that names them.
#include "capture_io/camera_model.h"

#include <stdexcept>

namespace hookeye {

#define HOOKEYE_CAMERA(NAME) const CameraModel& camera_model_##NAME();
#include "capture_io/cameras/catalogue.def"
#undef HOOKEYE_CAMERA

const std::vector<const CameraModel*>& camera_models() {
  static const std::vector<const CameraModel*> all = {
#define HOOKEYE_CAMERA(NAME) &camera_model_##NAME(),
#include "capture_io/cameras/catalogue.def"
#undef HOOKEYE_CAMERA
  };
  return all;
}

const CameraModel* find_camera_model(const std::string& name) {
  for (const CameraModel* model : camera_models())
    if (model->name() == name) return model;
  return nullptr;
}

const CameraModel& camera_model(const std::string& name) {
  const CameraModel* model = find_camera_model(name);
  if (!model) throw std::invalid_argument("no camera model " + name);
  return *model;
}

}  // namespace hookeye
