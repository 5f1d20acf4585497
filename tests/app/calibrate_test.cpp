// hookeye calibrate from outside; what it finds is tested in tests/calibration.
#include <gmock/gmock.h>

#include "app/cli.h"
#include "support/needs_helper.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

class CalibrateCli : public Cli {
 protected:
  /// A grey photo.
  void write_grey(const std::string& name, int width, int height) const {
    write(name, "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" +
                    std::string(static_cast<size_t>(width) * static_cast<size_t>(height), 'p'));
  }
  std::string refused(const std::string& arguments) const {
    const Result got = hookeye("calibrate " + arguments + " -o out");
    EXPECT_EQ(got.status, 2) << arguments << got.out << got.err;
    EXPECT_FALSE(fs::exists(folder_ / "out")) << arguments;
    EXPECT_TRUE(too_long(got.out).empty());
    return got.err;
  }
};

TEST_F(CalibrateCli, SaysWhatTheBoardNeeds) {
  HOOKEYE_NEEDS_HELPER("boards", "libopencv-contrib-dev");
  write_grey("a_1.pgm", 64, 48);
  const std::string charuco = "--squares 7x5 --square 20 --marker 15 --dictionary ";
  EXPECT_THAT(refused("a_1.pgm"), HasSubstr("needs --squares"));
  EXPECT_THAT(refused("a_1.pgm --squares 7x5 --square 20"), HasSubstr("needs --marker"));
  EXPECT_THAT(refused("a_1.pgm --squares 7 --square 20"), HasSubstr("no count of columns"));
  EXPECT_THAT(refused("a_1.pgm " + charuco + "4X4_5"), HasSubstr("did you mean 4X4_50?"));
  EXPECT_THAT(refused("a_1.pgm --board circles --dots 8x6"), HasSubstr("needs --spacing"));
  EXPECT_THAT(refused("a_1.pgm --board circles --dots 8x6 --spacing 5 --diameter 6"),
              HasSubstr("overlap"));
  EXPECT_THAT(refused("a_1.pgm --board chessboard --dots 8x6 --squares 7x5 --square 2"),
              HasSubstr("another kind of board"));
  EXPECT_THAT(refused("a_1.pgm --board chess"), HasSubstr("--board"));
  EXPECT_THAT(refused("--camera left --squares 7x5 --square 20 --board chessboard"),
              HasSubstr("--camera left='calib/left_*.png'"));
  EXPECT_THAT(refused("--squares 7x5 --square 20 --board chessboard"),
              HasSubstr("there are no photos"));
}

TEST_F(CalibrateCli, WritesNothingWherePhotosShowNoBoard) {
  HOOKEYE_NEEDS_HELPER("boards", "libopencv-contrib-dev");
  const std::string board = " --squares 7x5 --square 20 --marker 15 --dictionary dict_4x4_50";
  write_grey("a_1.pgm", 64, 48);
  EXPECT_THAT(refused("'a_*.pgm'" + board), HasSubstr("no ChArUco board of 7x5 squares"));
  EXPECT_THAT(refused("'b_*.pgm'" + board), HasSubstr("no photo is found there"));
  write_grey("a_2.pgm", 60, 48);
  EXPECT_THAT(refused("'a_*.pgm'" + board), HasSubstr("a_2.pgm: this photo has 60 x 48 px"));
  write("a_2.pgm", "no picture");
  EXPECT_THAT(refused("'a_*.pgm'" + board), HasSubstr("a_2.pgm"));
  fs::create_directory(folder_ / "kept");
  write("kept/cameras.yaml", "cameras: {}\n");
  const Result got = hookeye("calibrate a_1.pgm -o kept" + board);
  EXPECT_EQ(got.status, 2);
  EXPECT_THAT(got.err, HasSubstr("another file of this name"));
}

}  // namespace
}  // namespace hookeye::test
