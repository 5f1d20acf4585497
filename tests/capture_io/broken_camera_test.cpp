// Captures with one camera, light or photo broken each: the whole message is the contract.
#include <gtest/gtest.h>

#include "capture_io/broken_case.h"

namespace hookeye::test {
namespace {

const BrokenCase broken_cameras[] = {
    {"SizeZero",
     swap("size: [8, 6]\n    projection: perspective", "size: [0, 6]\n    projection: perspective"),
     "capture.yaml:16:12: size of camera `front` is `0`\n"
     "  1 to 100000 pixels are expected"},
    {"SizeFraction",
     swap("size: [8, 6]\n    projection: perspective",
          "size: [8.5, 6]\n    projection: perspective"),
     "capture.yaml:16:12: size of camera `front` is `8.5`\n"
     "  a whole number is expected"},
    {"SingularFocal", swap("fx: 11", "fx: 0"),
     "capture.yaml:18:22: fx of camera `front` is `0`\n"
     "  a number above zero is expected"},
    {"UnknownProjection", swap("orthographic", "cylindrical"),
     "capture.yaml:23:17: projection of camera `top` is `cylindrical`\n"
     "  one of perspective, fisheye, orthographic is expected"},
    {"FisheyeWithTangentialTerms", swap("projection: perspective", "projection: fisheye"),
     "capture.yaml:18:64: distortion of camera `front` has 5 numbers\n"
     "  0 or 4 are expected: k1, k2, k3, k4 of cv::fisheye, which has no tangential terms"},
    {"FisheyeTooWide",
     swap("perspective\n    intrinsics: {fx: 11, fy: 12, cx: 3.5, cy: 2.5, distortion: [0.1, 0, 0, "
          "0, 0]}",
          "fisheye\n    intrinsics: {fx: 2, fy: 2, cx: 3.5, cy: 2.5}"),
     "capture.yaml:15:3: the distortion of camera `front` cannot be undone at pixel (0, 0)\n"
     "  rays are followed up to 89 degrees off the axis, where k1 .. k4 let the radius grow: look "
     "at them and at fx, or crop the photos (and `size`, `cx`, `cy` with them)"},
    {"FisheyeFolds",
     swap("perspective\n    intrinsics: {fx: 11, fy: 12, cx: 3.5, cy: 2.5, distortion: [0.1, 0, 0, "
          "0, 0]}",
          "fisheye\n    intrinsics: {fx: 11, fy: 12, cx: 3.5, cy: 2.5, distortion: [-3, 0, 0, 0]}"),
     "capture.yaml:15:3: the distortion of camera `front` cannot be undone at pixel (0, 0)\n"
     "  rays are followed up to 89 degrees off the axis, where k1 .. k4 let the radius grow: look "
     "at them and at fx, or crop the photos (and `size`, `cx`, `cy` with them)"},
    {"OrthographicTilt", swap("scale: 2,", "scale: 2, distortion: [0,0,0,0,0,0,0,0,0,0,0,0,1,0],"),
     "capture.yaml:24:40: distortion of camera `top` has 14 numbers\n"
     "  0, 4, 5, 8 or 12 are expected, in OpenCV's order, for lengths in place of x/z (k1 in "
     "1/length^2)"},
    {"VignettingOfParallelRays",
     swap("projection: orthographic", "vignetting: fit\n    projection: orthographic"),
     "capture.yaml:23:5: vignetting of camera `top` goes by the angle to the axis\n"
     "  leave it out: all rays of this camera are parallel"},
    {"VignettingBrightens", swap("left: {calibration", "left: {vignetting: -0.2, calibration"),
     "capture.yaml:20:22: vignetting of camera `left` is `-0.2`\n"
     "  zero or a number above it is expected, or `fit`"},
    {"VignettingIsNoNumber", swap("left: {calibration", "left: {vignetting: fitted, calibration"),
     "capture.yaml:20:22: vignetting of camera `left` is `fitted`\n"
     "  a number is expected, or `fit`"},
    {"ColoursOfGreyPhotos", swap("left: {calibration", "left: {chromatic_shift: fit, calibration"),
     "capture.yaml:20:10: no photo by camera `left` is compared by its colours, which "
     "`chromatic_shift` tells apart\n"
     "  write `channels: rgb` for its photos, or leave the shift out"},
    {"ColourFarOff", swap("left: {calibration", "left: {chromatic_shift: {red: 1.5}, calibration"),
     "capture.yaml:20:33: red of chromatic_shift of camera `left` is `1.5`\n"
     "  the size of that colour's picture over the green one's is expected, near 1"},
    {"LensInTheTexture",
     [](CaptureFixture& c) {
       c.replace("{image: albedo.png, encoding: srgb}", "{from: rest}");
       c.replace("left: {calibration", "left: {vignetting: fit, calibration");
     },
     "capture.yaml:20:10: the lens of camera `left` is in the photos of the texture\n"
     "  leave it out, or give `texture: {image: FILE}`"},
    {"SkewIsNoNumber", swap("fx: 11,", "skew: leaning, fx: 11,"),
     "capture.yaml:18:24: skew of camera `front` is `leaning`\n"
     "  a number is expected"},
    {"CalibrationOfAFisheye",
     [](CaptureFixture& c) {
       c.replace("left: {calibration", "left: {projection: perspective, calibration");
       c.write_file("left.yml",
                    "%YAML:1.0\n---\nK: [20., 0., 3., 0., 20., 2., 0., 0., 1.]\n"
                    "fisheye_model: 1\n");
     },
     "capture.yaml:20:22: projection of camera `left` is `perspective`, its calibration is of a "
     "fisheye camera\n"
     "  leave `projection` out, or give another file"},
    {"CalibrationOfNoFisheye",
     swap("left: {calibration", "left: {projection: fisheye, calibration"),
     "capture.yaml:20:22: projection of camera `left` is `fisheye`, its calibration has 5 "
     "coefficients\n"
     "  0 or 4 are expected: k1, k2, k3, k4 of cv::fisheye, which has no tangential terms"},
    {"CalibrationOfParallelRays",
     swap("left: {calibration", "left: {projection: orthographic, calibration"),
     "capture.yaml:20:22: an OpenCV calibration describes a camera whose rays meet in a point\n"
     "  give `intrinsics: {scale: ...}` for an orthographic one"},
    {"DistortionThree", swap("distortion: [0.1, 0, 0, 0, 0]", "distortion: [0.1, 0, 0]"),
     "capture.yaml:18:64: distortion of camera `front` has 3 numbers\n"
     "  0, 4, 5, 8, 12 or 14 are expected, in OpenCV's order"},
    {"DistortionFolds", swap("distortion: [0.1, 0, 0, 0, 0]", "distortion: [-80, 0, 0, 0, 0]"),
     "capture.yaml:15:3: the distortion of camera `front` cannot be undone at pixel (0, 0)\n"
     "  look at its coefficients (OpenCV's order: k1, k2, p1, p2, k3 ...) and at fx"},
    {"RotationReflected", swap("[[1,0,0],[0,0,-1],[0,1,0]]", "[[1,0,0],[0,0,1],[0,1,0]]"),
     "capture.yaml:19:22: rotation of camera `front` is a reflection\n"
     "  a rotation has orthonormal rows and determinant +1 (within 1e-4)"},
    {"RotationSkewed", swap("[[1,0,0],[0,0,-1],[0,1,0]]", "[[1,0.1,0],[0,0,-1],[0,1,0]]"),
     "capture.yaml:19:22: rotation of camera `front` is not orthonormal\n"
     "  a rotation has orthonormal rows and determinant +1 (within 1e-4)"},
    {"RotationRows", swap("[[1,0,0],[0,0,-1],[0,1,0]]", "[1,0,0,0,0,-1,0,1,0]"),
     "capture.yaml:19:22: rotation of camera `front` is a list of 9\n"
     "  three rows of three numbers are expected"},
    {"NoPose",
     swap("    pose: {rotation: [[1,0,0],[0,0,-1],[0,1,0]], translation: [0, 40, 300]}\n", ""),
     "capture.yaml:16:5: camera `front` lacks `pose`\n"
     "  write `pose: {rotation: [...], translation: [...]}` (world to camera)"},
    {"CalibrationAndIntrinsics",
     swap("{calibration: left.yml}",
          "{calibration: left.yml, intrinsics: {fx: 1, fy: 1, cx: 0, cy: 0}}"),
     "capture.yaml:20:33: camera `left` has both `calibration` and `intrinsics`\n"
     "  keep one of the two"},
    {"CalibrationNotOpenCv", [](CaptureFixture& c) { c.write_file("left.yml", "hello\n"); },
     "capture.yaml:20:23: left.yml: this is not an OpenCV file\n"
     "  write it with cv::FileStorage (yml, xml or json)"},
    {"CalibrationWithoutMatrix",
     [](CaptureFixture& c) { c.write_file("left.yml", "%YAML:1.0\n---\nimage_width: 8\n"); },
     "capture.yaml:20:23: left.yml: there is no camera matrix\n"
     "  the key `camera_matrix` or `K` is read"},
    {"LightDark",
     swap("  ambient: 0.4\n  sun: {toward: [-0.3, -0.5, 0.8], strength: 0.6}", "  ambient: 0"),
     "capture.yaml:29:3: the light is dark\n"
     "  give ambient or sun a strength above zero"},
    {"SunNowhere", swap("toward: [-0.3, -0.5, 0.8]", "toward: [0, 0, 0]"),
     "capture.yaml:30:17: toward has no direction\n"
     "  a vector of finite length above zero is expected"},
    {"AmbientNegative", swap("ambient: 0.4", "ambient: -0.4"),
     "capture.yaml:29:12: ambient is `-0.4`\n"
     "  zero or a number above it is expected"},
    {"LightWithoutSky", swap("  ambient: 0.4\n", ""),
     "capture.yaml:29:3: light lacks `ambient`\n"
     "  write `ambient: 0.4`, or `harmonics: fit`"},
    {"HarmonicsBesideAmbient", swap("ambient: 0.4", "ambient: 0.4\n  harmonics: fit"),
     "capture.yaml:30:3: light has both `ambient` and `harmonics`\n"
     "  keep one of the two: an even sky is the first of the harmonics"},
    {"HarmonicsOfFirstOrder", swap("ambient: 0.4", "harmonics: [1, 0.2, 0, 0]"),
     "capture.yaml:29:14: harmonics of the light are 4 numbers\n"
     "  give nine: L00 L1-1 L10 L11 L2-2 L2-1 L20 L21 L22"},
    {"HarmonicsDarkerThanNothing", swap("ambient: 0.4", "harmonics: [-1, 0, 0, 0, 0, 0, 0, 0, 0]"),
     "capture.yaml:29:15: L00 of the light, its mean over all directions, is `-1`\n"
     "  a number above zero is expected"},
    {"HarmonicsOfAWord", swap("ambient: 0.4", "harmonics: fitted"),
     "capture.yaml:29:14: harmonics of the light is `fitted`\n"
     "  `fit` is expected, or nine numbers: L00 L1-1 L10 L11 L2-2 L2-1 L20 L21 L22"},
    {"HarmonicNotFinite", swap("ambient: 0.4", "harmonics: [1, .nan, 0, 0, 0, 0, 0, 0, 0]"),
     "capture.yaml:29:18: a number of harmonics of the light is `.nan`\n"
     "  a finite number is expected"},
    {"FullWellNegative", swap("full_well: 20000", "full_well: -20000"),
     "capture.yaml:33:22: full_well is `-20000`\n"
     "  a number above zero is expected"},
    {"NoiseZero", swap("noise: 0.004", "noise: 0"),
     "capture.yaml:56:67: noise is `0`\n"
     "  a number above zero is expected"},
    {"EncodingUnknown", swap("encoding: 2.2", "encoding: log"),
     "capture.yaml:56:84: encoding is `log`\n"
     "  linear, srgb or a gamma number above zero is expected"},
    {"BackgroundUnknown", swap("background: black", "background: white"),
     "capture.yaml:34:15: background is `white`\n"
     "  ignore, black, fit, a number from zero or {photo: FILE} is expected"},
    {"ChannelsUnknown", swap("kind: silhouette}", "channels: colour}"),
     "capture.yaml:57:45: channels is `colour`\n"
     "  one of luminance, rgb is expected"},
    {"RgbOfGrey", swap("kind: silhouette}", "channels: rgb}"),
     "capture.yaml:57:19: photo `top` of example `pull` is grey but `channels: rgb` is asked for\n"
     "  write `channels: luminance` or hand over a colour picture"},
    {"KindUnknown", swap("kind: silhouette}", "kind: siluette}"),
     "capture.yaml:57:41: kind is `siluette`\n"
     "  did you mean `silhouette`? one of image, silhouette is expected"},
    {"ReflectedCalibration",
     [](CaptureFixture& c) {
       c.write_file("left.yml",
                    "%YAML:1.0\n---\nK: [20., 0., 3., 0., 21., 2., 0., 0., 1.]\nimage_size: [8, "
                    "6]\nR: [1., 0., 0., 0., 1., 0., 0., 0., -1.]\nT: [0., 0., 1.]\n");
     },
     "capture.yaml:20:23: left.yml: `R` is a reflection\n"
     "  a rotation has orthonormal rows and determinant +1 (within 1e-4)"},
    {"HugePhotoClaim", [](CaptureFixture& c) { c.write_file("photos/pull.png", huge_png()); },
     "capture.yaml:55:14: photos/pull.png: the header claims 60000 x 60000 pixels with 3 channels\n"
     "  at most 2 GiB of decoded pixels are read: use a smaller picture"},
    {"CalibrationOfOtherSize", swap("calibration: left.yml", "calibration: left.yml, size: [6, 8]"),
     "capture.yaml:43:44: photo `left` of example `rest` has 8 x 6 pixels, camera `left` has 6 x "
     "8\n"
     "  photos are compared at the size that the camera was calibrated for"},
    {"CameraNull", swap("  left: {calibration: left.yml}", "  left:"),
     "capture.yaml:21:3: camera `left` is empty\n"
     "  write a map with the keys size, projection, intrinsics, pose, calibration, vignetting, "
     "chromatic_shift"},
    {"PhotoUnknownCamera", swap("      front: photos/pull.png", "      fornt: photos/pull.png"),
     "capture.yaml:55:7: example `pull` has a photo of the unknown camera `fornt`\n"
     "  did you mean `front`?"},
    {"PhotoMissing", swap("front: photos/pull.png", "front: photos/pul.png"),
     "capture.yaml:55:14: photo `front` of example `pull` is `photos/pul.png`\n"
     "  there is no such file; did you mean `pull.png`?"},
    {"PhotoOfASeriesMissing", swap("front: photos/pull.png", "front: photos/pull2.png"),
     "capture.yaml:55:14: photo `front` of example `pull` is `photos/pull2.png`\n"
     "  there is no such file; its folder has pull.png"},
    {"PhotoTwiceACamera", swap("      front: photos/pull.png", "      left: photos/pull.png"),
     "capture.yaml:56:7: `left` is given twice\n"
     "  it already stands in line 55; keep one of the two"},
    {"PhotoWrongSize", [](CaptureFixture& c) { c.write_grey("photos/pull.png", 6, 8); },
     "capture.yaml:55:14: photo `front` of example `pull` has 6 x 8 pixels, camera `front` has 8 x "
     "6\n"
     "  photos are compared at the size that the camera was calibrated for"},
    {"MaskWrongSize", [](CaptureFixture& c) { c.write_grey("photos/mask.png", 4, 4); },
     "capture.yaml:56:43: mask of photo `left` of example `pull` has 4 x 4 pixels, camera `left` "
     "has 8 x 6\n"
     "  photos are compared at the size that the camera was calibrated for"},
    {"PhotoTruncatedHeader", [](CaptureFixture& c) { c.write_file("photos/pull.png", "\x89PNG"); },
     "capture.yaml:55:14: photos/pull.png: the file cannot be read as a picture\n"
     "  hand over a complete PNG, TIFF, JPEG or EXR picture"},
    {"MaskMissing", swap("mask: photos/mask.png", "mask: mask.png"),
     "capture.yaml:56:43: mask is `mask.png`\n"
     "  there is no such file"},
};

INSTANTIATE_TEST_SUITE_P(Camera, BrokenCapture, testing::ValuesIn(broken_cameras), case_name);

}  // namespace
}  // namespace hookeye::test
