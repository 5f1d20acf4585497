// Captures broken in one place each: the whole message is the contract. Those whose body or
// material is broken have a table of their own, broken_body_test.cpp.
#include <gtest/gtest.h>

#include "capture_io/broken_case.h"

namespace hookeye::test {
namespace {

/// ASCII in UTF-16, with its mark.
std::string utf16(const std::string& text, bool big_endian) {
  std::string out = big_endian ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) out += big_endian ? std::string{'\0', c} : std::string{c, '\0'};
  return out;
}

const BrokenCase broken_cases[] = {
    {"EmptyFile", [](CaptureFixture& c) { c.yaml = ""; },
     "capture.yaml: the file is empty\n"
     "  a capture begins with `hookeye: 1`"},
    {"OnlyComments", [](CaptureFixture& c) { c.yaml = "# nothing yet\n"; },
     "capture.yaml: the file is empty\n"
     "  a capture begins with `hookeye: 1`"},
    {"Utf16", [](CaptureFixture& c) { c.yaml = utf16(c.yaml, false); },
     "capture.yaml: the file is in UTF-16\n"
     "  save it in UTF-8"},
    {"Utf16BigEndian", [](CaptureFixture& c) { c.yaml = utf16(c.yaml, true); },
     "capture.yaml: the file is in UTF-16\n"
     "  save it in UTF-8"},
    {"Utf16WithoutMark", [](CaptureFixture& c) { c.yaml = utf16(c.yaml, false).substr(2); },
     "capture.yaml: the file is in UTF-16\n"
     "  save it in UTF-8"},
    {"ZeroByte", [](CaptureFixture& c) { c.yaml[c.yaml.find("silicone")] = '\0'; },
     "capture.yaml:2: there is a zero byte: this is no text\n"
     "  the file as it was written, in UTF-8"},
    {"NotAMap", [](CaptureFixture& c) { c.yaml = "- 1\n- 2\n"; },
     "capture.yaml:1:1: the capture is a list of 2\n"
     "  write a map with the keys hookeye, title, units, body, model, cameras, light, photos, "
     "regions, examples"},
    {"TwoDocuments", [](CaptureFixture& c) { c.yaml += "---\nhookeye: 1\n"; },
     "capture.yaml:67:1: a second yaml document begins here\n"
     "  one file holds one capture: remove the line `---` and what follows"},
    {"BrokenSyntax", swap("units: {length: mm, force: N}", "units: {length: mm, force: N"),
     "capture.yaml:4:5: not yaml: end of map flow not found\n"
     "  look at the indentation, brackets and quotes here and just before"},
    {"TabIndent", swap("  density:", "\tdensity:"),
     "capture.yaml:7:1: not yaml: a tab stands in the indentation\n"
     "  indent with blanks only"},
    {"DuplicateKey", swap("  density: 1.07e-9", "  density: 1.07e-9\n  density: 1.2e-9"),
     "capture.yaml:8:3: `density` is given twice\n"
     "  it already stands in line 7; keep one of the two"},
    {"DuplicateExample", swap("  held_out:", "  rest:"),
     "capture.yaml:62:3: `rest` is given twice\n"
     "  it already stands in line 42; keep one of the two"},
    {"WrongVersion", swap("hookeye: 1", "hookeye: 2"),
     "capture.yaml:1:10: the capture has format `2`\n"
     "  this program reads format 1: write `hookeye: 1`"},
    {"NoVersion", swap("hookeye: 1\n", ""),
     "capture.yaml:1:1: the capture lacks `hookeye`\n"
     "  a capture begins with `hookeye: 1`"},
    {"UnknownTopKey", swap("light:\n", "lights:\n"),
     "capture.yaml:28:1: the capture has no key `lights`\n"
     "  did you mean `light`?"},
    {"UnknownCameraKey", swap("    projection: perspective", "    projektion: perspective"),
     "capture.yaml:17:5: camera `front` has no key `projektion`\n"
     "  did you mean `projection`?"},
    {"UnknownFarKey", swap("title:", "author:"),
     "capture.yaml:2:1: the capture has no key `author`\n"
     "  known here: hookeye, title, units, body, model, cameras, light, photos, regions, examples"},
    {"WrongLengthUnit", swap("length: mm", "length: millimetre"),
     "capture.yaml:3:17: the unit of length is `millimetre`\n"
     "  one of mm, cm, m, um is expected"},
    {"WrongForceUnit", swap("force: N}", "force: kg}"),
     "capture.yaml:3:28: the unit of force is `kg`\n"
     "  one of N, mN, kN, uN is expected"},
    {"NoBody",
     [](CaptureFixture& c) {
       c.yaml.erase(c.yaml.find("body:"), c.yaml.find("model:") - c.yaml.find("body:"));
     },
     "capture.yaml:1:1: the capture lacks `body`\n"
     "  write `body: {surface: rest.obj}`"},
    {"NoUnits", swap("units: {length: mm, force: N}\n", ""),
     "capture.yaml:1:1: the capture lacks `units`\n"
     "  write `units: {length: mm, force: N}`"},
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
    {"BoxInsideOut", swap("[50, 50, 0.1]]", "[50, -60, 0.1]]"),
     "capture.yaml:36:15: box of region `base` is empty: its y runs from -50 to -60\n"
     "  the first corner holds the smaller coordinates"},
    {"BoxOneCorner",
     swap("box: [[-50, -50, -0.1], [50, 50, 0.1]]", "box: [-50, -50, -0.1, 50, 50, 0.1]"),
     "capture.yaml:36:15: box of region `base` is a list of 6\n"
     "  two corners are expected: [[x, y, z], [x, y, z]]"},
    {"RadiusZero", swap("radius: 5", "radius: 0"),
     "capture.yaml:38:47: radius of region `ball` is `0`\n"
     "  a number above zero is expected"},
    {"NormalZero", swap("normal: [2, 0, 0]", "normal: [0, 0, 0]"),
     "capture.yaml:39:49: normal of region `side` has no direction\n"
     "  a vector of finite length above zero is expected"},
    {"TwoShapes", swap("{group: cavity}", "{group: cavity, faces: grip.txt}"),
     "capture.yaml:40:11: region `inner` has both `faces` and `group`\n"
     "  keep one of the two"},
    {"FacesNegative", [](CaptureFixture& c) { c.write_file("grip.txt", "0 1\n2 -3\n"); },
     "grip.txt:2:3: `-3` is no triangle of the surface\n"
     "  0-based indices of triangles are expected, separated by blanks"},
    {"FacesEmpty", [](CaptureFixture& c) { c.write_file("grip.txt", "\n"); },
     "capture.yaml:37:17: grip.txt: the list of triangles is empty\n"
     "  0-based indices of triangles are expected, separated by blanks"},
    {"NameWithSlash", swap("  held_out:", "  ../held_out:"),
     "capture.yaml:62:3: `../held_out` cannot be a name in examples\n"
     "  names become file names: up to 100 characters, no slash, no leading dot"},
    {"SupportUnknownRegion", swap("{region: base, fix: [z]}", "{region: bse, fix: [z]}"),
     "capture.yaml:65:18: a support of example `held_out` names the unknown region `bse`\n"
     "  did you mean `base`?"},
    {"SupportNothing", swap("{region: base, fix: [z]}", "{region: base}"),
     "capture.yaml:65:9: a support of example `held_out` lacks one of fix, move, rigid\n"
     "  give exactly one of them"},
    {"SupportTwice", swap("{region: base, fix: [z]}", "{region: base, fix: [z], move: {z: 1}}"),
     "capture.yaml:65:41: the supports of example `held_out` prescribe component z of region "
     "`base` twice\n"
     "  prescribe every component of a region once"},
    {"SupportRigidAndFix", swap("{region: base, fix: [z]}", "{region: base, fix: [z], rigid: fit}"),
     "capture.yaml:65:24: a support of example `held_out` has both `rigid` and `fix`\n"
     "  keep one of the two"},
    {"FixUnknownAxis", swap("fix: [z]", "fix: [w]"),
     "capture.yaml:65:30: a component of fix is `w`\n"
     "  x, y or z is expected"},
    {"AxisZero", swap("axis: [0, 0, 1]", "axis: [0, 0, 0]"),
     "capture.yaml:49:47: axis has no direction\n"
     "  a vector of finite length above zero is expected"},
    {"LoadBoth", swap("pressure: 0.002}", "pressure: 0.002, force: [0, 0, 1]}"),
     "capture.yaml:53:25: a load of example `pull` has both `force` and `pressure`\n"
     "  keep one of the two"},
    {"LoadsNotAList",
     swap("- {region: grip, force: [0, 0, 2.5]}\n      - {region: inner, pressure: 0.002}",
          "{region: grip, force: [0, 0, 2.5]}"),
     "capture.yaml:52:7: loads of example `pull` is a map\n"
     "  write `- {region: grip, force: [0, 0, 2.5]}`"},
    {"UseUnknown", swap("use: validate", "use: tests"),
     "capture.yaml:63:10: use of example `held_out` is `tests`\n"
     "  did you mean `test`? one of fit, validate, test is expected"},
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
    {"SigmaZero", swap("sigma: 0.02", "sigma: 0"),
     "capture.yaml:59:53: sigma is `0`\n"
     "  a number above zero is expected"},
    {"SigmaMissing", swap(", sigma: 0.02", ""),
     "capture.yaml:59:9: a measurement of example `pull` lacks `sigma`\n"
     "  give the measurement's standard deviation: `sigma: 0.02`"},
    {"MomentWithoutPoint", swap("about: [0, 0, 80], value", "value"),
     "capture.yaml:60:9: a measurement of example `pull` lacks `about`\n"
     "  a moment refers to a point: write `about: [0, 0, 80]`"},
    {"ForceOnUnknown", swap("force_on: grip", "force_on: grap"),
     "capture.yaml:59:20: a measurement of example `pull` names the unknown region `grap`\n"
     "  did you mean `grip`?"},
    {"ForceWithoutSupport",
     [](CaptureFixture& c) {
       c.replace("    photos: {front: photos/rest.png, left: photos/rest.png}",
                 "    measured: [{force_on: grip, value: [0, 0, 1], sigma: 1}]");
     },
     "capture.yaml:43:16: example `rest` measures a support's force but has no supports\n"
     "  forces are measured where a support holds the body"},
    {"NoExamples",
     [](CaptureFixture& c) {
       c.yaml.erase(c.yaml.find("examples:"));
       c.yaml += "examples: {}\n";
     },
     "capture.yaml:41:11: there are no examples\n"
     "  write `examples: {rest: {photos: {CAMERA: FILE}}}`"},
    {"AliasBomb",
     [](CaptureFixture& c) {
       c.yaml =
           "a: &a [1,1,1,1,1,1,1,1,1,1]\nb: &b [*a,*a,*a,*a,*a,*a,*a,*a,*a,*a]\nc: &c "
           "[*b,*b,*b,*b,*b,*b,*b,*b,*b,*b]\nd: &d [*c,*c,*c,*c,*c,*c,*c,*c,*c,*c]\ne: "
           "[*d,*d,*d,*d,*d,*d,*d,*d,*d,*d]\n";
     },
     "capture.yaml:4:29: aliases blow this file up to more than 10000 values\n"
     "  write the values out instead of nesting aliases"},
    {"DeepNesting",
     [](CaptureFixture& c) { c.yaml = "a: " + std::string(5000, '[') + std::string(5000, ']'); },
     "capture.yaml:1:35: values are nested deeper than 32\n"
     "  a capture needs fewer than ten levels"},
    {"HugeYaml", [](CaptureFixture& c) { c.yaml = "#" + std::string(17 << 20, 'x'); },
     "capture.yaml: 17825793 bytes of yaml are too many\n"
     "  at most 16 MiB are read"},
    {"KeyIsAList", swap("title:", "[1, 2]:"),
     "capture.yaml:2:1: a list or map stands where a key is expected\n"
     "  write `key: value`"},
    {"NullBody",
     [](CaptureFixture& c) {
       c.yaml.erase(c.yaml.find("  surface"), c.yaml.find("model:") - c.yaml.find("  surface"));
     },
     "capture.yaml:5:1: body is empty\n"
     "  write a map with the keys surface, mesh, volume, density, texture, placement, shading"},
    {"PlacementOfTwoRows",
     swap("placement: fit",
          "placement: {rotation: [[1, 0, 0], [0, 1, 0]], translation: [0, 0, 1]}"),
     "capture.yaml:9:25: rotation of the placement is a list of 2\n"
     "  three rows of three numbers are expected"},
    {"PlacementOfNoRotation",
     swap("placement: fit",
          "placement: {rotation: [[1, 0, 0], [0, 1, 0], [0, 1, 1]], translation: [0, 0, 1]}"),
     "capture.yaml:9:25: rotation of the placement is not orthonormal\n"
     "  a rotation has orthonormal rows and determinant +1 (within 1e-4)"},
    {"PlacementWithoutTranslation",
     swap("placement: fit", "placement: {rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}"),
     "capture.yaml:9:14: the placement lacks `translation`\n"
     "  write `placement: {rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], translation: [0, 0, "
     "300]}`; "
     "`hookeye place` finds it"},
    {"MaskMissing", swap("mask: photos/mask.png", "mask: mask.png"),
     "capture.yaml:56:43: mask is `mask.png`\n"
     "  there is no such file"},
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
    {"MoveUnknownAxis", swap("move: {x: 0, y: 0.5}", "move: {x: 0, u: 0.5}"),
     "capture.yaml:48:37: move has no key `u`\n"
     "  known here: x, y, z"},
    {"ForceTooShort", swap("force: [0, 0, 2.5]}", "force: 2.5}"),
     "capture.yaml:52:31: force is `2.5`\n"
     "  three numbers are expected: [x, y, z]"},
    {"PressureOfUnknownRegion", swap("{region: inner, pressure", "{region: iner, pressure"),
     "capture.yaml:53:18: a load of example `pull` names the unknown region `iner`\n"
     "  did you mean `inner`?"},
    {"DegreesMissing", swap("degrees: 20, ", ""),
     "capture.yaml:49:40: rotate lacks `degrees`\n"
     "  write `rotate: {axis: [0, 0, 1], degrees: 20, center: [0, 0, 80]}`"},
    {"AboutOfForce", swap("{force_on: grip, value", "{force_on: grip, about: [0, 0, 0], value"),
     "capture.yaml:59:26: `about` has no meaning for `force_on`\n"
     "  only moment_on has `about`: remove it"},
    {"TravelWithoutDirection",
     swap("{force_on: grip, value: [0, 0, 2.5]", "{travel_of: grip, value: 2.5"),
     "capture.yaml:59:9: a measurement of example `pull` lacks `along`\n"
     "  tell the direction: write `along: [0, 0, 1]`"},
    {"TravelOfThreeNumbers",
     swap("{force_on: grip, value: [0, 0, 2.5]",
          "{travel_of: grip, along: [0, 0, 1], value: [0, 0, 2.5]"),
     "capture.yaml:59:52: `value` has 3 numbers\n"
     "  1 of them"},
    {"CovarianceThatIsNone", swap("sigma: 0.02", "covariance: [[1, 2, 0], [2, 1, 0], [0, 0, 1]]"),
     "capture.yaml:59:58: `covariance` is none\n"
     "  3 lists of 3 numbers, symmetric and positive definite"},
    {"SigmaAndCovariance",
     swap("sigma: 0.02", "sigma: 0.02, covariance: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]"),
     "capture.yaml:59:71: `sigma` and `covariance` tell the same\n"
     "  leave one of them out"},
    {"CameraNull", swap("  left: {calibration: left.yml}", "  left:"),
     "capture.yaml:21:3: camera `left` is empty\n"
     "  write a map with the keys size, projection, intrinsics, pose, calibration"},
};

TEST_P(BrokenCapture, IsRefusedWithTheWholeMessage) {
  CaptureFixture capture;
  GetParam().damage(capture);
  capture.write();
  EXPECT_EQ(capture.complaint(), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(Format1, BrokenCapture, testing::ValuesIn(broken_cases), case_name);

TEST(BrokenCaptureTest, TheUnbrokenCaptureIsAccepted) {
  CaptureFixture capture;
  capture.write();
  EXPECT_EQ(capture.complaint(), "");
}

}  // namespace
}  // namespace hookeye::test
