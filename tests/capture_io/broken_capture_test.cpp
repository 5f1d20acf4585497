// Captures broken in one place each: the whole message is the contract. Bodies and materials have a
// table of their own, broken_body_test.cpp; cameras, light and photos broken_camera_test.cpp.
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
     "  write a map with the keys hookeye, title, units, body, model, cameras, camera_covariance, "
     "light, photos, regions, examples"},
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
     "  known here: hookeye, title, units, body, model, cameras, camera_covariance, light, photos, "
     "regions, examples"},
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
    {"SupportRigidOfNoKind", swap("{region: base, fix: [z]}", "{region: base, rigid: fitted}"),
     "capture.yaml:65:31: rigid is `fitted`\n"
     "  `fit` is expected, or a map of `rotate` and `move`"},
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
    {"GaugeOfOnePoint",
     swap("{force_on: grip, value: [0, 0, 2.5]", "{strain_of: [1, 2, 3], value: 0.01"),
     "capture.yaml:59:21: `strain_of` has 3 entries\n"
     "  two points of the body at rest: `strain_of: [[0, 0, 10], [0, 0, 30]]`"},
    {"GaugeWithoutLength",
     swap("{force_on: grip, value: [0, 0, 2.5]", "{strain_of: [[1, 2, 3], [1, 2, 3]], value: 0.01"),
     "capture.yaml:59:21: the two points of `strain_of` are one: nothing lies between them\n"
     "  two points of the body at rest: `strain_of: [[0, 0, 10], [0, 0, 30]]`"},
    {"GaugeWithADirection",
     swap("{force_on: grip, value: [0, 0, 2.5]",
          "{strain_of: [[1, 2, 3], [1, 2, 4]], along: [0, 0, 1], value: 0.01"),
     "capture.yaml:59:45: `along` has no meaning for `strain_of`\n"
     "  only travel_of has `along`: remove it"},
    {"CalibrationAsAMeasurement",
     swap("{force_on: grip, value: [0, 0, 2.5]", "{calibration: front, value: 0"),
     "capture.yaml:59:10: a measurement of example `pull` has no key `calibration`\n"
     "  known here: value, sigma, covariance, about, along, axis, force_on, moment_on, "
     "position_of, travel_of, rotation_of, strain_of, field, sensor"},
    {"CovarianceThatIsNone", swap("sigma: 0.02", "covariance: [[1, 2, 0], [2, 1, 0], [0, 0, 1]]"),
     "capture.yaml:59:58: `covariance` is none\n"
     "  3 lists of 3 numbers, symmetric and positive definite"},
    {"SigmaAndCovariance",
     swap("sigma: 0.02", "sigma: 0.02, covariance: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]"),
     "capture.yaml:59:71: `sigma` and `covariance` tell the same\n"
     "  leave one of them out"},
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
