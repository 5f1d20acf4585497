// Names to cameras and numbers; photos to rows, by clock, by column, by count.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proposal/lab_folder.h"
#include "proposal/photo_motion.h"

namespace hookeye::test {
namespace {

using testing::ElementsAre;

std::vector<std::string> cameras_of(const std::vector<std::string>& names) {
  std::vector<std::filesystem::path> left;
  std::vector<std::string> out;
  for (const PhotoSeries& one : photo_series({names.begin(), names.end()}, left)) {
    std::string numbers;
    for (const auto& [number, file] : one.photos) numbers += fmt::format(" {}", number);
    out.push_back(one.camera + numbers);
  }
  for (const auto& file : left) out.push_back("left " + file.string());
  return out;
}

TEST(PhotoSeries, SchemesOfNumbering) {
  EXPECT_THAT(cameras_of({"p/cam0_0001.tif", "p/cam0_0002.tif", "p/cam0_0003.tif",
                          "p/cam1_0001.tif", "p/cam1_0002.tif", "p/cam1_0003.tif"}),
              ElementsAre("cam0 1 2 3", "cam1 1 2 3"));
  EXPECT_THAT(cameras_of({"t-0001_0.tif", "t-0001_1.tif", "t-0002_0.tif", "t-0002_1.tif",
                          "t-0003_0.tif", "t-0003_1.tif"}),
              ElementsAre("t_0 1 2 3", "t_1 1 2 3"));
  EXPECT_THAT(cameras_of({"left/img7.png", "left/img8.png", "right/img7.png", "right/img8.png"}),
              ElementsAre("left 7 8", "right 7 8"));
  EXPECT_THAT(cameras_of({"L_01.tif", "L_02.tif", "R_01.tif", "R_02.tif"}),
              ElementsAre("L 1 2", "R 1 2"));
  // The time of the day runs too, and tells no cameras apart.
  EXPECT_THAT(cameras_of({"a_120001_1.tif", "a_120002_2.tif", "a_120004_3.tif"}),
              ElementsAre("a 1 2 3"));
  EXPECT_THAT(cameras_of({"a_1.tif", "a_2.tif", "a_3.tif", "a_4.tif", "setup.tif", "view_1.jpg"}),
              ElementsAre("a 1 2 3 4", "left setup.tif", "left view_1.jpg"));
}

TEST(PhotoSeries, ANumberTwiceIsRefused) {
  EXPECT_THROW(cameras_of({"a_1.tif", "a_01.tif", "a_2.tif"}), InputError);
}

/// Photos each `pace` seconds from `ahead` seconds before the table begins; the picture moves 2 px
/// a mm.
void photograph(const LabFolder& lab, const std::vector<RampRow>& rows, double ahead, double pace,
                size_t count) {
  for (size_t k = 0; k < count; ++k) {
    const double t = pace * static_cast<double>(k) - ahead;
    double travel = 0;
    for (size_t i = 1; i < rows.size(); ++i)
      if (t > rows[i - 1].time)
        travel = rows[i - 1].travel +
                 std::min(1.0, (t - rows[i - 1].time) / (rows[i].time - rows[i - 1].time)) *
                     (rows[i].travel - rows[i - 1].travel);
    const double second = pace * static_cast<double>(k);
    const auto whole = static_cast<int>(second);
    for (const char* camera : {"cam0", "cam1"})
      lab.photo(fmt::format("photos/{}_{:04}.tif", camera, k + 1), 2 * travel,
                fmt::format("2024:05:01 12:{:02}:{:02}", whole / 60, whole % 60),
                fmt::format("{:03.0f}", 1000 * (second - whole)));
  }
}

TEST(Pairing, TheClocksAreTiedByTheFirstMotion) {
  const LabFolder lab;
  const auto rows = ramp(20, 40, 0.7);  // moves from 9.5 s on
  lab.write("machine.csv", plain_table(rows));
  photograph(lab, rows, 3.3, 1.7, 18);
  const Proposal proposal = lab.proposal();
  EXPECT_TRUE(proposal.needed.empty());
  EXPECT_THAT(proposal.pairing, testing::HasSubstr("begin to move together"));
  // Photo k was taken at 1.7 (k - 1) - 3.3 s; no pairing by half a photo's pace would pass.
  for (const LoadCase& one : proposal.cases.loads) {
    const double truth = 1.7 * static_cast<double>(one.photo.number - 1) - 3.3;
    EXPECT_NEAR(one.photo.time, truth, 0.3) << one.photo.number;
    EXPECT_NEAR(one.photo.travel, 0.4 * (truth - 9.5), 0.12) << one.photo.number;
    EXPECT_NEAR(one.photo.force, 0.8 * (truth - 9.5), 0.25) << one.photo.number;
  }
  EXPECT_EQ(proposal.cases.rest.number, 8);  // 8.6 s; the ninth is from 10.3 s
}

/// The first photo is from -3.3 s, by the photos' own clock or as told with their pace.
TEST(Pairing, AToldClockIsHeldAgainstTheFirstMotion) {
  const LabFolder lab;
  const auto rows = ramp(20, 40, 0.7);
  lab.write("machine.csv", plain_table(rows));
  photograph(lab, rows, 3.3, 1.7, 18);
  const std::string doubt = "photos and machine begin to move together where it is at -3.";
  const Proposal wrong = lab.proposal({{"clock", "2"}});
  EXPECT_TRUE(any_says(wrong.said, doubt));
  EXPECT_THAT(wrong.yaml, testing::HasSubstr("# the first photo is told to be at 2 s"));
  EXPECT_FALSE(any_says(lab.proposal({{"clock", "-3.3"}}).said, doubt));
}

TEST(Pairing, ToldTimesAreHeldAgainstTheFirstMotion) {
  const LabFolder lab;
  const auto rows = ramp(20, 40, 0.7);
  lab.write("machine.csv", plain_table(rows));
  for (int k = 0; k < 18; ++k)
    for (const char* camera : {"cam0", "cam1"})
      lab.photo(fmt::format("photos/{}_{:04}.tif", camera, k + 1),
                0.8 * std::max(0.0, 1.7 * k - 3.3 - 9.5));
  const std::string doubt = "photos and machine begin to move together where it is at -3.";
  EXPECT_TRUE(any_says(lab.proposal({{"photo_times", "-1,1.7"}}).said, doubt));
  EXPECT_FALSE(any_says(lab.proposal({{"photo_times", "-3.3,1.7"}}).said, doubt));
}

TEST(Pairing, TheFirstMotionIsFoundOrNone) {
  const LabFolder lab;
  for (int k = 0; k < 12; ++k)
    lab.photo(fmt::format("a_{:02}.tif", k), k < 5 ? 0.0 : 0.4 * (k - 4));
  for (int k = 0; k < 6; ++k) lab.photo(fmt::format("b_{:02}.tif", k), 1.0 * k);
  for (int k = 0; k < 6; ++k) lab.photo(fmt::format("c_{:02}.tif", k), 0.0);
  const auto series = look_at(lab.path()).series;
  ASSERT_EQ(series.size(), 3u);
  const PhotoMotion motion = photo_motion(series[0]);
  EXPECT_EQ(motion.moved, 5u);
  ASSERT_EQ(motion.gone.size(), 7u);
  for (size_t i = 0; i < 7; ++i) EXPECT_NEAR(motion.gone[i], 0.4 * static_cast<double>(i), 0.15);
  EXPECT_EQ(photo_motion(series[1]).moved, 0u);
  EXPECT_EQ(photo_motion(series[2]).moved, 0u);
}

TEST(Pairing, WholeSecondsAreEvenedOut) {
  const LabFolder lab;
  for (int k = 0; k < 8; ++k)
    lab.photo(fmt::format("a_{}.tif", k), 0, fmt::format("2024:05:01 12:00:{:02}", (k * 7) / 10));
  const PhotoClock clock = photo_clock(look_at(lab.path()).series.front());
  ASSERT_EQ(clock.seconds.size(), 8u);
  EXPECT_TRUE(clock.whole_seconds);
  EXPECT_NEAR(clock.seconds[7] - clock.seconds[0], 4.9, 0.5);
  for (int k = 1; k < 8; ++k)
    EXPECT_NEAR(clock.seconds[static_cast<size_t>(k)] - clock.seconds[static_cast<size_t>(k - 1)],
                0.7, 0.07);
}

TEST(Pairing, ByPulsesOfTheCamera) {
  const LabFolder lab;
  std::string table = "Time [s],Stroke [mm],Force [N],Camera trigger\n";
  for (const RampRow& row : ramp(10, 40)) {
    const int n = static_cast<int>(std::lround(2 * row.time));
    table += fmt::format("{},{},{},{}\n", row.time, row.travel, row.force, n % 7 == 3 ? 5 : 0);
  }
  lab.write("machine.csv", table);
  lab.photos(std::vector<double>(7, 0.0));
  const Proposal proposal = lab.proposal();
  EXPECT_EQ(proposal.pairing, "by the camera's 7 pulses in the table");
  EXPECT_EQ(proposal.cases.rest.number, 1);
  EXPECT_EQ(proposal.cases.loads.back().photo.number, 7);
  EXPECT_EQ(proposal.cases.loads.back().photo.line, 2 + 45);
  lab.photo("photos/cam0_0008.tif", 0);
  EXPECT_THAT(lab.complaint(), testing::StartsWith("machine.csv: its photo column has 7 pulses"));
}

TEST(Pairing, ByNumbersInTheTable) {
  const LabFolder lab;
  std::string table = "Image;Kraft in N;Weg in mm\n";
  for (int k = 0; k < 7; ++k) table += fmt::format("{};{},5;{},25\n", 107 - k, 7 - k, 7 - k);
  lab.write("machine.csv", table);
  for (int k = 101; k <= 107; ++k)
    for (const char* camera : {"cam0", "cam1"}) lab.photo(fmt::format("{}_{}.tif", camera, k), 0);
  const Proposal proposal = lab.proposal();
  EXPECT_EQ(proposal.pairing, "by the photo's number in the table");
  EXPECT_EQ(proposal.cases.rest.number, 101);  // the last row has the least force
  EXPECT_EQ(proposal.cases.rest.line, 8);
  EXPECT_EQ(proposal.cases.loads.back().photo.line, 2);
}

TEST(Pairing, WhatCannotBeToldIsAskedWithoutADefault) {
  const LabFolder lab;
  lab.write("machine.csv", plain_table(ramp(10, 40)));
  lab.photos(std::vector<double>(9, 0.0));
  const Proposal proposal = lab.proposal();
  ASSERT_EQ(proposal.needed.size(), 1u);
  EXPECT_EQ(proposal.needed[0].name, "photo_times");
  EXPECT_TRUE(proposal.yaml.empty());
  const Proposal told = lab.proposal({{"photo_times", "2,2.5"}});
  EXPECT_TRUE(told.needed.empty());
  EXPECT_NEAR(told.cases.loads.back().photo.time, 2 + 8 * 2.5, 1e-9);
  EXPECT_THAT(lab.complaint({{"photo_times", "2"}}), testing::HasSubstr("two numbers as 12.5,2"));
}

}  // namespace
}  // namespace hookeye::test
