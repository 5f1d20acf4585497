// The whole way: a folder, its questions, the capture that the project's reader takes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "capture_io/camera_covariance.h"
#include "capture_io/camera_text.h"
#include "capture_io/capture.h"
#include "core/input_error.h"
#include "core/text_file.h"
#include "proposal/lab_folder.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

/// 15 rows, a photo each: four at rest, then the ramp to 2.2 mm and 4.4 N.
void fill(const LabFolder& lab, double zero = 0.3) {
  lab.write("machine.csv", plain_table(ramp(4, 11, zero)));
  std::vector<double> moved;
  for (const RampRow& row : ramp(4, 11)) moved.push_back(4 * row.travel);
  lab.photos(moved);
}

TEST(Proposal, WritesACaptureThatIsRead) {
  const LabFolder lab;
  fill(lab);
  const Proposal proposal = lab.proposal();
  EXPECT_EQ(proposal.pairing, "a row a photo: 15 of each");
  const Capture capture = lab.stored(proposal);
  EXPECT_EQ(capture.units.length, "mm");
  ASSERT_EQ(capture.cameras.size(), 2u);
  EXPECT_EQ(capture.cameras[0].name, "cam0");
  EXPECT_LT((capture.cameras[1].centre() - Vector3d(5, -200, 15)).norm(), 1e-9);
  ASSERT_EQ(capture.examples.size(), 7u);
  EXPECT_EQ(capture.examples[0].name, "rest");
  EXPECT_EQ(capture.body.texture_example, "rest");
  std::string uses;
  for (const ExampleSpec& one : capture.examples) uses += std::string(one.use()) + " ";
  EXPECT_EQ(uses, "fit fit validate fit fit validate fit ");
  const ExampleSpec& last = capture.examples.back();
  EXPECT_EQ(last.photos[0].file.filename(), "cam0_0015.tif");
  EXPECT_EQ(last.photos[1].file.filename(), "cam1_0015.tif");
  ASSERT_EQ(last.supports.size(), 2u);
  EXPECT_LT((last.supports[1].rigid.move - Vector3d(0, 0, 2.2)).norm(), 1e-6);
  ASSERT_EQ(last.measured.size(), 2u);
  EXPECT_EQ(last.measured[0].kind, MeasuredSpec::Kind::travel_of);
  EXPECT_NEAR(last.measured[0].value[0], 2.2, 1e-6);
  EXPECT_GE(last.measured[0].sigma[0], 0.0015) << "an extensometer's class at least";
  EXPECT_LT(last.measured[0].sigma[0], 0.05);
  const MeasuredSpec& force = last.measured[1];
  EXPECT_NEAR(force.value[2], 4.4, 0.01);  // the zero of 0.3 N is off
  EXPECT_EQ(force.value[0], 0);
  EXPECT_NEAR(force.sigma[2], 0.022, 0.004);
  EXPECT_GT(force.sigma[0], 4);
}

/// Cameras of `hookeye calibrate` come with how well they are known, in their own lengths.
TEST(Proposal, KeepsTheCovarianceOfACalibration) {
  const LabFolder lab;
  fill(lab);
  std::string cameras = "# hookeye calibrate a board\ncameras:\n";
  for (const Camera& camera : lab.stored(lab.proposal()).cameras) cameras += camera_text(camera);
  lab.write("calib/cameras.yaml", cameras);
  lab.write("calib/camera_covariance.yaml",
            "# hookeye calibrate a board\nunit: mm\nframe: camera\nnumbers: {cam1: [fx, shift_x]}\n"
            "covariance: [[0.04, 0.001], [0.001, 0.01]]\n");
  for (const char* file : {"cam0.yml", "cam1.yml", "capture.yaml"})
    std::filesystem::remove(lab.path() / file);
  const Proposal plain = lab.proposal();
  EXPECT_THAT(plain.yaml, HasSubstr("camera_covariance: calib/camera_covariance.yaml\n"));
  const Capture capture = lab.stored(plain);
  ASSERT_TRUE(capture.camera_covariance);
  EXPECT_EQ(capture.camera_covariance->deviation(1), 0.1);
  std::filesystem::remove(lab.path() / "capture.yaml");
  // The body is larger than the board's print says: so are the camera's shifts.
  const Proposal scaled = lab.proposal({{"camera_scale", "2"}});
  EXPECT_THAT(scaled.yaml,
              HasSubstr("camera_covariance: {from: calib/camera_covariance.yaml, scale: 2}\n"));
  EXPECT_NEAR(lab.stored(scaled).camera_covariance->deviation(1), 0.2, 1e-12);
}

/// The bar as a deck of six tetrahedra, with its material from line 18 on.
const char* const kDeck = R"(*NODE
1, -5, -5, 0
2, 5, -5, 0
3, 5, 5, 0
4, -5, 5, 0
5, -5, -5, 30
6, 5, -5, 30
7, 5, 5, 30
8, -5, 5, 30
*ELEMENT, TYPE=C3D4, ELSET=BAR
1, 1, 2, 3, 7
2, 1, 3, 4, 7
3, 1, 4, 8, 7
4, 1, 8, 5, 7
5, 1, 5, 6, 7
6, 1, 6, 2, 7
*SOLID SECTION, ELSET=BAR, MATERIAL=GEL
*MATERIAL, NAME=GEL
*HYPERELASTIC, YEOH
0.02, 0.003, 0.0001, 4
*DENSITY
1.2E-9
)";

TEST(Proposal, StartsFromTheMaterialOfADeck) {
  const LabFolder lab;
  fill(lab);
  lab.write("bar.inp", kDeck);
  const Proposal proposal = lab.proposal({{"body", "bar.inp"}});
  EXPECT_THAT(proposal.yaml, HasSubstr("material: {law: yeoh, c1: 0.02, c2: 0.003, c3: 0.0001, "
                                       "kappa: 0.5}  # of bar.inp, line 18\n"));
  EXPECT_THAT(proposal.yaml, HasSubstr("# density: 1.2e-09  # of the deck"));
  EXPECT_TRUE(any_says(proposal.said, "the material is that of bar.inp, line 18"));
  const Capture capture = lab.stored(proposal);
  EXPECT_EQ(capture.fit, (std::vector<std::string>{"c1", "c2", "c3"}));
  std::filesystem::remove(lab.path() / "capture.yaml");
  // Of the other mesh it is the same body; and the user may want a guess.
  EXPECT_THAT(lab.proposal({{"body", "bar.stl"}}).yaml, HasSubstr("law: yeoh"));
  EXPECT_THAT(lab.proposal({{"body", "bar.stl"}, {"material", "guess"}}).yaml,
              HasSubstr("law: neo-hookean"));
}

/// A deck whose material cannot be taken keeps nobody from a capture.
TEST(Proposal, SaysWhyTheMaterialOfADeckIsNotTaken) {
  const LabFolder lab;
  fill(lab);
  std::string deck = kDeck;
  deck += "*MATERIAL, NAME=OTHER\n*HYPERELASTIC, NEO HOOKE\n0.5, 0.1\n";
  lab.write("bar.inp", deck);
  const Proposal proposal = lab.proposal({{"body", "bar.inp"}});
  EXPECT_THAT(proposal.yaml, HasSubstr("law: neo-hookean"));
  EXPECT_TRUE(any_says(proposal.said, "the material of bar.inp is not taken"));
  EXPECT_TRUE(any_says(proposal.said, "second law"));
}

TEST(Proposal, LoadsAreSpreadEvenly) {
  const LabFolder lab;
  fill(lab);
  const Proposal proposal = lab.proposal({{"cases", "4"}});
  ASSERT_EQ(proposal.cases.loads.size(), 4u);
  for (size_t j = 0; j < 4; ++j)
    EXPECT_NEAR(proposal.cases.loads[j].photo.force, 1.1 * static_cast<double>(j + 1), 0.21) << j;
  EXPECT_TRUE(proposal.cases.loads[1].held_out);
  EXPECT_EQ(proposal.cases.rest.number, 4);
}

TEST(Proposal, AsksAtMostTenThings) {
  const LabFolder lab;
  // Nothing is told: units of table and mesh, two meshes, two calibrations, cameras of other names.
  lab.write("machine.csv", "time,stroke,force\n0,0,0\n1,1,1\n2,2,2\n3,3,3\n");
  lab.write("calib2/cam0.yml", read_text(lab.path() / "cam0.yml"));
  lab.write("calib2/cam1.yml", read_text(lab.path() / "cam1.yml"));
  lab.write("copy.stl", read_text(lab.path() / "bar.stl"));
  lab.write("second.csv", plain_table(ramp(4, 11)));
  for (int k = 1; k <= 4; ++k)
    for (const char* camera : {"left", "right"}) lab.photo(fmt::format("{}_{}.tif", camera, k), 0);
  const Proposal proposal = lab.proposal();
  EXPECT_EQ(proposal.open.size(), Questions::kMost);
  const LabFolder usual;
  fill(usual);
  std::vector<std::string> names;
  for (const CaptureQuestion& one : usual.proposal().open) names.push_back(one.name);
  EXPECT_THAT(names, testing::ElementsAre("held", "pulled", "pull", "drive", "texture", "mu"));
}

TEST(Proposal, AnswersHold) {
  const LabFolder lab;
  fill(lab);
  const Capture capture = lab.stored(lab.proposal({{"held", "+z"},
                                                   {"pull", "-z"},
                                                   {"drive", "force"},
                                                   {"mu", "0.2"},
                                                   {"texture", "uniform"},
                                                   {"light", "0.4,0,-1,1,0.5"}}));
  const ExampleSpec& last = capture.examples.back();
  ASSERT_EQ(last.loads.size(), 1u);
  EXPECT_NEAR(last.loads[0].force->z(), -4.4, 0.01);
  EXPECT_EQ(last.supports[1].displacement[0], 0.0);
  EXPECT_FALSE(last.supports[1].displacement[2]);
  EXPECT_EQ(capture.materials[0].parameters.at("mu").numbers[0], 0.2);
  EXPECT_EQ(capture.light.ambient, 0.4);
  const auto& held = std::get<RegionSpec::Halfspace>(capture.region("held")->shape);
  EXPECT_EQ(held.normal, Vector3d(0, 0, 1));
}

TEST(Proposal, StartsNearTheModulusOfForceAndStrain) {
  const LabFolder lab;
  fill(lab);
  // 0.4 N a 0.2 mm on 100 mm^2 and 30 mm: E 0.6 MPa, mu 0.2.
  EXPECT_NEAR(lab.stored(lab.proposal()).materials[0].parameters.at("mu").numbers[0], 0.2, 0.011);
}

TEST(Proposal, CompressionPushesTowardsTheHeldEnd) {
  const LabFolder lab;
  fill(lab);
  std::string table = plain_table(ramp(4, 11, 0.3));
  table.replace(table.find("Force"), 5, "Compressive load");
  lab.write("machine.csv", table);
  const Capture capture = lab.stored(lab.proposal());
  EXPECT_LT(capture.examples.back().supports[1].rigid.move.z(), -2);
}

TEST(Proposal, CalibrationInMetresIsSeen) {
  const LabFolder lab;
  fill(lab);
  for (const std::string name : {"cam0.yml", "cam1.yml"}) {
    std::string text = read_text(lab.path() / name);
    const size_t at = text.rfind("[ ");
    const double side = name == "cam0.yml" ? 0.005 : -0.005;
    text.replace(at, std::string::npos, fmt::format("[ {}, 0.015, 0.2 ]\n", side));
    lab.write(name, text);
  }
  const Proposal proposal = lab.proposal();
  EXPECT_EQ(proposal.open.front().name, "camera_scale");
  EXPECT_EQ(proposal.open.front().standard, "1000");
  EXPECT_LT((lab.stored(proposal).cameras[1].centre() - Vector3d(5, -200, 15)).norm(), 1e-9);
}

TEST(Proposal, PhotosOfOtherNamesAreAssignedByOrderAndAsked) {
  const LabFolder lab;
  lab.write("machine.csv", plain_table(ramp(4, 11)));
  for (int k = 1; k <= 15; ++k)
    for (const char* camera : {"left", "right"}) lab.photo(fmt::format("{}/{}.tif", camera, k), k);
  const Proposal proposal = lab.proposal();
  EXPECT_EQ(proposal.open.front().name, "cameras");
  EXPECT_EQ(proposal.open.front().standard, "left:cam0,right:cam1");
  const Capture capture = lab.stored(lab.proposal({{"cameras", "left:cam1,right:cam0"}}));
  for (const PhotoSpec& photo : capture.examples[0].photos)
    EXPECT_EQ(photo.file.parent_path().filename(), photo.camera == "cam1" ? "left" : "right");
  EXPECT_THAT(lab.complaint({{"cameras", "left:cam1,right:cam1"}}),
              HasSubstr("photos are of left, right; calibrated are cam0, cam1"));
}

TEST(Proposal, WhatIsMissingIsNamed) {
  const LabFolder lab;
  EXPECT_THAT(lab.complaint(), HasSubstr("there are no photos with numbers in it"));
  lab.write("pull.mp4", "");
  EXPECT_THAT(lab.complaint(), HasSubstr("by `hookeye import pull.mp4 -o "));
  lab.photos({0, 0, 1, 2});
  EXPECT_THAT(lab.complaint(), HasSubstr("there is no table of a test machine in it"));
  lab.write("machine.csv", "Strain [%],Stress [MPa]\n0,0\n1,0.1\n2,0.2\n");
  EXPECT_THAT(lab.complaint(), HasSubstr("the columns of machine.csv are `Strain [%]`, `Stress"));
  fill(lab);
  EXPECT_EQ(lab.complaint(), "");
  EXPECT_EQ(lab.complaint({{"helt", "+z"}}),
            "--set helt=+z: nothing of this name is asked\n  did you mean `held`?");
  EXPECT_EQ(lab.complaint({{"texture", "unifrom"}}),
            "--set texture=unifrom: this is no answer\n  did you mean `uniform`?");
  EXPECT_THAT(lab.complaint({{"pull", "up"}}), HasSubstr("a vector x,y,z"));
  EXPECT_THAT(lab.complaint({{"pulled", "-z"}}), HasSubstr("another end than the one"));
  std::filesystem::remove(lab.path() / "cam1.yml");
  EXPECT_THAT(lab.complaint(), HasSubstr("photos of 2 cameras and a calibration of 1 camera"));
}

TEST(Proposal, CamerasThatWereImportedGoBeforeTheirSource) {
  const LabFolder lab;
  fill(lab);
  lab.write("imported/cameras.yaml", "# hookeye import opencv\ncameras: {}\n");
  const Inventory inventory = look_at(lab.path());
  ASSERT_EQ(inventory.calibrations.size(), 2u);
  EXPECT_EQ(inventory.calibrations[0].name(lab.path()), "imported/cameras.yaml");
  EXPECT_EQ(inventory.calibrations[1].name(lab.path()), "cam0.yml,cam1.yml");
}

TEST(Proposal, PhotosOfOneCameraAloneAreTold) {
  const LabFolder lab;
  fill(lab);
  EXPECT_FALSE(any_says(lab.proposal().said, "are missing"));
  for (const char* name : {"cam0_0009", "cam1_0006", "cam1_0007"})
    ASSERT_TRUE(std::filesystem::remove(lab.path() / "photos" / (std::string(name) + ".tif")));
  const Proposal proposal = lab.proposal();
  EXPECT_TRUE(any_says(proposal.said, "of `cam0` photos are missing that another camera has: 9"));
  EXPECT_TRUE(
      any_says(proposal.said, "of `cam1` photos are missing that another camera has: 6, 7"));
}

TEST(Proposal, AnExistingCaptureStaysAndNothingHalfWrittenIsLeft) {
  const LabFolder lab;
  fill(lab);
  Proposal proposal = lab.proposal();
  lab.write("capture.yaml", "mine\n");
  EXPECT_THROW(store(proposal, lab.path() / "capture.yaml", false), InputError);
  EXPECT_EQ(read_text(lab.path() / "capture.yaml"), "mine\n");
  proposal.yaml += "nonsense: 1\n";
  EXPECT_THROW(store(proposal, lab.path() / "capture.yaml", true), InputError);
  EXPECT_EQ(read_text(lab.path() / "capture.yaml"), "mine\n");
  for (const auto& entry : std::filesystem::directory_iterator(lab.path()))
    EXPECT_NE(entry.path().filename().string()[0], '.') << entry.path();
}

TEST(Proposal, PhotosOutsideOfTheCapturesFolderAreRefused) {
  const LabFolder lab;
  fill(lab);
  std::filesystem::create_directories(lab.path() / "elsewhere");
  const Inventory inventory = look_at(lab.path());
  EXPECT_THROW(propose(inventory, {}, lab.path() / "elsewhere" / "capture.yaml"), InputError);
}

}  // namespace
}  // namespace hookeye::test
