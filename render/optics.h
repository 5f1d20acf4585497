// What a photo is made of besides the body: texture, light, camera, sensor.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "capture_io/camera.h"
#include "capture_io/image.h"
#include "capture_io/light_harmonics.h"
#include "meshing/surface_mesh.h"

namespace hookeye {

/// The numbers of one photo with which its intensities change at fixed geometry.
///   I = gain * V * blur_v[ albedo * (sky(n) * visibility + max(0, n.sun) * lit)
///                      + specular * lit * |sun| * max(0, n.h)^shininess ]  on the body,
///   I = background elsewhere (before blur; background is not multiplied by gain).
/// V: Camera::vignetting at the pixel, 1 where the body is not shaded. h: half vector between the
/// directions to the sun and to the camera. sky(n): irradiance over pi of the even and the uneven
/// light (capture_io/light_harmonics.h), not below zero.
struct PhotoState {
  Camera camera;
  double gain = 1.0;
  double ambient = 1.0;
  UnevenLight uneven = UnevenLight::Zero();       ///< of the sky; `ambient` is its even part
  Eigen::Vector3d sun = Eigen::Vector3d::Zero();  ///< strength times unit vector to the sun
  double specular = 0.0;
  double shininess = 30.0;
  double blur_variance = 0.0;  ///< added to the pixel filter [px^2], >= 0
  double background = 0.0;     ///< linear intensity where the body does not cover
  /// The same by pixel: a picture of the camera's size that takes the place of `background`.
  std::shared_ptr<const Image> backdrop;
  double behind(size_t pixel) const { return backdrop ? backdrop->values[pixel] : background; }
  bool shaded = true;  ///< false: texture is the picture itself (sampled from photos)
};

/// Order of the photo-side derivative columns.
enum PhotoColumn {
  kRotate = 0,   ///< 3: w of Camera::moved [1/rad]
  kMove = 3,     ///< 3: v of Camera::moved [1/length]
  kZoom = 6,     ///< log focal length
  kLogGain = 7,  ///< log gain
  kAmbient = 8,
  kSun = 9,  ///< 3
  kSpecular = 12,
  kBlur = 13,  ///< blur variance [1/px^2]
  kBackground = 14,
  kVignetting = 15,  ///< of the camera
  kUneven = 16,      ///< 8
  kPhotoColumns = kUneven + kUnevenNumbers
};

/// Where colour comes from.
struct Texture {
  enum class Source { image, photo, uniform } source = Source::uniform;
  /// image: albedo, v up (v = 0 bottom row), bilinear, uv of the surface mesh; 1 channel.
  std::shared_ptr<const Image> image;
  double albedo = 1.0;  ///< uniform
  /// photo: the picture of the reference state by the same camera; the hit's reference position is
  /// projected with `reference_camera`; cubic B-spline interpolation (prefiltered). Points that
  /// the reference camera does not see (turned away, hidden, out of frame, masked) are not covered.
  std::shared_ptr<const Image> photo;
  std::shared_ptr<const std::vector<unsigned char>> photo_valid;
  Camera reference_camera;
  double reference_gain = 1.0;  ///< the sample is divided by it
};

}  // namespace hookeye
