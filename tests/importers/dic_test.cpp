// DICe, VIC-3D, MatchID and pyvale, written as their documents and sources say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/text_file.h"
#include "importers/published.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

/// DICe's matrix of its three Euler angles [degrees], entry by entry as its source has it.
Matrix3d euler(double alpha, double beta, double gamma) {
  const double d = std::acos(-1.0) / 180;
  const double cx = std::cos(alpha * d), sx = std::sin(alpha * d), cy = std::cos(beta * d),
               sy = std::sin(beta * d), cz = std::cos(gamma * d), sz = std::sin(gamma * d);
  Matrix3d R;
  R << cy * cz, sx * sy * cz - cx * sz, cx * sy * cz + sx * sz,  //
      cy * sz, sx * sy * sz + cx * cz, cx * sy * sz - sx * cz,   //
      -sy, sx * cy, cx * cy;
  return R;
}

std::string parameter(const std::string& name, const std::string& value) {
  return fmt::format("<Parameter name=\"{}\" type=\"double\" value=\"{}\" />\n", name, value);
}

std::string dice_camera(int n, const std::string& model, const std::string& more) {
  return fmt::format("<ParameterList name=\"CAMERA {}\">\n", n) + parameter("CX", "322") +
         parameter("CY", "243") + parameter("FX", "1200") + parameter("FY", "1190") +
         parameter("LENS_DISTORTION_MODEL", model) +
         parameter("IMAGE_HEIGHT_WIDTH", "{ 480, 640 }") + more + "</ParameterList>\n";
}

std::string dice_file(bool relative, const std::string& cameras) {
  return "<!-- DICe formatted camera system file -->\n<ParameterList>\n" +
         parameter("xml_file_format", "DICe_xml_camera_system_file") +
         parameter("system_type_3D", "OPENCV") +
         parameter("extrinsics_relative_camera_to_camera", relative ? "true" : "false") + cameras +
         "</ParameterList>\n";
}

std::string dice_pose(double tx, double alpha, double beta, double gamma) {
  return parameter("TX", fmt::format("{}", tx)) + parameter("TZ", "17.6") +
         parameter("ALPHA", fmt::format("{}", alpha)) + parameter("BETA", fmt::format("{}", beta)) +
         parameter("GAMMA", fmt::format("{}", gamma));
}

const std::string kLens =
    parameter("K1", "-0.1") + parameter("K2", "0.04") + parameter("K3", "0.02");

TEST(DiceImport, ProjectsAsItsSourceDoes) {
  const TemporaryFolder folder;
  const auto file = folder / "cal.xml";
  for (const bool relative : {false, true}) {
    write_text(
        file,
        dice_file(relative,
                  dice_camera(0, "OPENCV_LENS_DISTORTION",
                              kLens + parameter("P1", "0.001") + parameter("P2", "-0.002") +
                                  parameter("K4", "0.05") + dice_pose(3, 2, -5, 30)) +
                      dice_camera(1, "K1R3_K2R5_K3R7", kLens + dice_pose(122, 0.13, -19, 0.28))));
    EXPECT_EQ(recognise({file}).name(), "dice");
    const Imported imported = import_from("dice", {file});
    const Pose first{euler(2, -5, 30), {3, 0, 17.6}};
    Pose second{euler(0.13, -19, 0.28), {122, 0, 17.6}};
    if (relative) second = {second.R * first.R, second.R * first.t + second.t};
    expect_projects(imported, "CAMERA_0", first, [](const Vector3d& x) {
      const Vector2d p = brown(x, {-0.1, 0.04, 0.001, -0.002, 0.02, 0.05});
      return Vector2d(1200 * p.x() + 322, 1190 * p.y() + 243);
    });
    expect_projects(imported, "CAMERA_1", second, [](const Vector3d& x) {
      const double u = x.x() / x.z(), v = x.y() / x.z(), r = std::hypot(u, v);
      const double out = r - 0.1 * std::pow(r, 3) + 0.04 * std::pow(r, 5) + 0.02 * std::pow(r, 7);
      return Vector2d(1200 * out * u / r + 322, 1190 * out * v / r + 243);
    });
  }
}

TEST(DiceImport, FaultsHaveTheirLine) {
  const TemporaryFolder folder;
  const auto told = [&](const std::string& text) {
    write_text(folder / "a.xml", text);
    return complaint(folder.path(), [&] { import_from("dice", {folder / "a.xml"}); });
  };
  const auto one = [&](const std::string& model, const std::string& more) {
    return told(dice_file(false, dice_camera(0, model, more)));
  };
  EXPECT_EQ(one("K1R1_K2R2_K3R3", ""), "");
  EXPECT_EQ(one("K1R1_K2R2_K3R3", kLens),
            "a.xml:11: CAMERA 0: a capture has no lens like K1R1_K2R2_K3R3\n"
            "  OPENCV_LENS_DISTORTION or K1R3_K2R5_K3R7, or undistorted photos");
  EXPECT_EQ(one("OPENCV_LENS_DISTORTION", parameter("T1", "0.1")),
            "a.xml:13: CAMERA 0: T1 is not zero\n  a lens without tilt");
  // DICe does not use it with this lens.
  EXPECT_EQ(one("OPENCV_LENS_DISTORTION", parameter("FS", "0.1")), "");
  EXPECT_EQ(import_from("dice", {folder / "a.xml"}).cameras[0].skew, 0);
  EXPECT_EQ(import_from("dice", {folder / "a.xml"}).said.size(), 1u);
  EXPECT_EQ(one("OPENCV_LENS_DISTORTION", parameter("K1", "much")),
            "a.xml:13: CAMERA 0: K1 is `much`\n  a finite number");
  EXPECT_EQ(
      told("<ParameterList>\n<Parameter name=\"cal_file_ID\" value=\"x\"/>\n</ParameterList>"),
      "a.xml:1: this is no DICe_xml_camera_system_file\n  a camera system as DICe writes it");
  EXPECT_THAT(told("<ParameterList>\n<Param"), testing::StartsWith("a.xml:2: cannot be read: "));
}

std::string vic_file(const std::string& cameras, const std::string& more = "") {
  return "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\n<!DOCTYPE vpml>\n<project>\n"
         "<calibration lri=\"calibration\">\n" +
         cameras + "</calibration>\n" + more + "</project>\n";
}

const std::string kMask = "<polygonmask width=\"640\" height=\"480\"/>\n";

TEST(Vic3dImport, OlderAndNewerFilesProjectAsDiceReadsThem) {
  const TemporaryFolder folder;
  const std::string orientation = "<orientation>179.9 9.01 0.03 -63.2 -0.34 18.7</orientation>";
  const std::string files[] = {
      vic_file("<camera id=\"0\">322 243 1200 1190 -0.17 0 0 0" + orientation + "</camera>\n",
               kMask),
      vic_file("<camera id=\"0\"><intrinsics>322 243 1200 1190 -0.17</intrinsics>\n"
               "<distortion>0 0 0 0 0 0 0 0 0</distortion>" +
                   orientation + "</camera>\n",
               kMask)};
  const auto pixel = [](const Vector2d& p) {
    return Vector2d(1200 * p.x() - 0.17 * p.y() + 322, 1190 * p.y() + 243);
  };
  const Pose pose{euler(179.9, 9.01, 0.03), {-63.2, -0.34, 18.7}};
  for (const std::string& text : files) {
    write_text(folder / "cal.xml", text);
    EXPECT_EQ(recognise({folder / "cal.xml"}).name(), "vic3d");
    expect_projects(import_from("vic3d", {folder / "cal.xml"}), "cam0", pose,
                    [&](const Vector3d& x) { return pixel(brown(x, {})); });
  }
  // Its coefficients count as the user says, and are not guessed.
  write_text(folder / "cal.xml", vic_file("<camera id=\"0\">322 243 1200 1190 -0.17 0.06 0.01 0" +
                                              orientation + "</camera>\n",
                                          kMask));
  EXPECT_EQ(complaint(folder.path(), [&] { import_from("vic3d", {folder / "cal.xml"}); }),
            "cal.xml:5: the lens has distortion, and VIC-3D does not publish its formula\n"
            "  undistort the photos, or say that its coefficients are those of OpenCV (k1 r^2 + k2 "
            "r^4 + k3 r^6 of x/z): --lens opencv");
  expect_projects(import_from("vic3d", {folder / "cal.xml"}, {0, 0, 1.0, true}), "cam0", pose,
                  [&](const Vector3d& x) {
                    return pixel(brown(x, {0.06, 0.01}));
                  });
}

TEST(Vic3dImport, FaultsHaveTheirLine) {
  const TemporaryFolder folder;
  const auto told = [&](const std::string& camera, const std::string& more = kMask) {
    write_text(folder / "a.xml", vic_file(camera, more));
    return complaint(folder.path(), [&] { import_from("vic3d", {folder / "a.xml"}); });
  };
  const std::string pose = "<orientation>180 9 0 -63 0 18</orientation></camera>\n";
  const std::string whole = "\n  a calibration or project as VIC-3D writes it";
  EXPECT_EQ(told("<camera id=\"0\">322 243 1200 1190 0 0 0 0" + pose), "");
  EXPECT_EQ(told("<camera id=\"0\">322 243 1200" + pose),
            "a.xml:5: <camera> has 3 numbers\n  8 of them");
  EXPECT_EQ(told("<camera id=\"0\">322 243 1200 1190 0 0 0 0</camera>\n"),
            "a.xml:5: a <camera> has no <orientation>" + whole);
  EXPECT_EQ(told("<camera id=\"0\">322 243 1200 wide 0 0 0 0" + pose),
            "a.xml:5: `wide` is no number" + whole);
  EXPECT_EQ(told(""), "a.xml:4: there is no <calibration> with cameras" + whole);
  EXPECT_EQ(told("<camera id=\"0\">322 243 1200 1190 0 0 0 0" + pose, ""),
            "a.xml: the picture size of `cam0` is not in it\n"
            "  give the size of its photos: --size 1280x1024");
  EXPECT_EQ(told("<camera id=\"0\">322 243 1200 1190 0 0 0 0" + pose,
                 kMask + "<polygonmask width=\"800\" height=\"600\"/>\n"),
            "a.xml:8: pictures of 640 x 480 and of 800 x 600 px\n"
            "  export the calibration alone, and give --size");
}

/// Lines of a caldat; `first`: how its first camera is counted.
std::string caldat(int first, const std::string& kappa) {
  std::string text;
  for (const int n : {first, first + 1})
    text += fmt::format(
        "Cam{0}_Fx [pixels];1200\nCam{0}_Fy [pixels];1190\nCam{0}_Fs [pixels];0.6\n"
        "Cam{0}_Kappa 1;{1}\nCam{0}_Kappa 2;0\nCam{0}_Kappa 3;0\nCam{0}_P1;0\nCam{0}_P2;0\n"
        "Cam{0}_Cx [pixels]; 322\nCam{0}_Cy [pixels]; 243\n",
        n, kappa);
  return text +
         "Tx [mm];-128.5\nTy [mm];0.65\nTz [mm];34.4\nTheta [deg];0.7\nPhi [deg];15\nPsi "
         "[deg];-2\n";
}

TEST(MatchIdImport, CaldatAndPyvaleProjectAsPyvaleReadsThem) {
  const TemporaryFolder folder;
  std::string yaml = caldat(0, "0.0");
  for (size_t at = 0; (at = yaml.find(';', at)) != std::string::npos;) yaml.replace(at, 1, ": ");
  const std::pair<std::string, std::string> files[] = {
      {"a.caldat", caldat(0, "0")}, {"b.caldat", caldat(1, "0")}, {"c.yaml", yaml}};
  const auto pixel = [](const Vector3d& x) {
    return Vector2d((1200 * x.x() + 0.6 * x.y()) / x.z() + 322, 1190 * x.y() / x.z() + 243);
  };
  // Extrinsic turns about x, y, z in this order.
  const double d = std::acos(-1.0) / 180;
  const Pose pose{turn({0, 0, 1}, -2 * d) * turn({0, 1, 0}, 15 * d) * turn({1, 0, 0}, 0.7 * d),
                  {-128.5, 0.65, 34.4}};
  for (const auto& [name, text] : files) {
    write_text(folder / name, text);
    EXPECT_EQ(recognise({folder / name}).name(), "matchid") << name;
    const Imported imported = import_from("matchid", {folder / name}, {640, 480});
    expect_projects(imported, name == "b.caldat" ? "Cam1" : "Cam0", {}, pixel);
    expect_projects(imported, name == "b.caldat" ? "Cam2" : "Cam1", pose, pixel);
  }
  // The second stands to the right of the first and looks to the left, as a pair does.
  const Imported pair = import_from("matchid", {folder / "a.caldat"}, {640, 480});
  EXPECT_GT(camera_of(pair, "Cam1").centre().x(), 100);
  EXPECT_LT(camera_of(pair, "Cam1").R(2, 0), -0.2);
}

TEST(MatchIdImport, FaultsHaveTheirLine) {
  const TemporaryFolder folder;
  const auto told = [&](const std::string& from, const std::string& to) {
    std::string text = caldat(0, "0");
    text.replace(text.find(from), from.size(), to);
    write_text(folder / "a.caldat", text);
    return complaint(folder.path(), [&] {
      import_from("matchid", {folder / "a.caldat"}, {640, 480});
    });
  };
  EXPECT_EQ(told("Cam1_Kappa 1;0", "Cam1_Kappa 1;0.05"),
            "a.caldat:14: the lens has distortion, and MatchID does not publish its formula\n"
            "  undistort the photos, or say that its coefficients are those of OpenCV (k1 r^2 + k2 "
            "r^4 + k3 r^6 of x/z): --lens opencv");
  EXPECT_EQ(told("Theta [deg];0.7", "Theta [rad];0.7"),
            "a.caldat:24: `Theta [rad]` is an angle of another unit\n  degrees");
  EXPECT_EQ(told("Tz [mm];34.4\n", ""),
            "a.caldat: `Tz` is not there\n  the whole calibration as MatchID or pyvale wrote it");
  EXPECT_EQ(told("Ty [mm];0.65", "Ty [mm];0,65"),
            "a.caldat:22: `Ty [mm]` is `0,65`\n  a finite number");
  EXPECT_EQ(told("Ty [mm];0.65", "Ty [mm] 0.65"),
            "a.caldat:22: there is no semicolon\n  lines like `Cam0_Fx [pixels];1000`");
}

}  // namespace
}  // namespace hookeye::test
