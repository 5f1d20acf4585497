// Dictionaries that nobody has told, boards in words, photos that do not go together or face alike,
// and a calibration that is stopped.
#include "calibration/dictionary.h"

#include <gmock/gmock.h>

#include <atomic>
#include <fstream>
#include <map>

#include "calibration/board_options.h"
#include "calibration/photographed.h"
#include "core/interrupted.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

TEST(Calibrate, ADictionaryThatIsNotToldIsSeenInThePhotos) {
  std::mt19937 random(4);
  const std::vector<Camera> truth{true_camera("a")};
  for (const auto& [printed, found_as] : std::map<std::string, std::string>{
           {"5X5_250", "5X5_50"},  // the same first markers: the smallest that has them all
           {"APRILTAG_36h11", "APRILTAG_36h11"}}) {
    const TemporaryFolder folder;
    const DrawnBoard drawn = charuco(7, 5, printed);
    const auto poses = spread_poses(truth[0], drawn.board, 6, 330, 25, random);
    const auto photos = photograph(folder, drawn, truth, poses, random);
    Board told = drawn.board;
    told.dictionary.clear();
    const Calibration by_photos = calibrate(told, photos, {});
    EXPECT_EQ(by_photos.bundle.board.dictionary, found_as);
    EXPECT_THAT(by_photos.said,
                testing::Contains(HasSubstr(found_as + ", found in 5 of 5 photos")));
    told.dictionary = found_as;
    const Calibration as_told = calibrate(told, photos, {});
    EXPECT_EQ(by_photos.corners, as_told.corners);
    EXPECT_EQ(by_photos.bundle.cameras[0].fx, as_told.bundle.cameras[0].fx);
  }
}

TEST(Calibrate, ADictionaryOfALargeBoardHasAllItsMarkers) {
  std::mt19937 random(5);
  const TemporaryFolder folder;
  const DrawnBoard drawn = charuco(12, 9, "4X4_1000");  // 54 markers: more than 4X4_50 has
  const std::vector<Camera> truth{true_camera("a")};
  const auto poses = spread_poses(truth[0], drawn.board, 3, 420, 20, random);
  const auto photos = photograph(folder, drawn, truth, poses, random);
  Board told = drawn.board;
  told.dictionary.clear();
  EXPECT_EQ(calibrate(told, photos, {}).bundle.board.dictionary, "4X4_100");
}

TEST(Calibrate, TwoDictionariesThatFitAlikeAndNoneAreTold) {
  std::mt19937 random(9);
  const TemporaryFolder folder;
  const std::vector<Camera> truth{true_camera("a")}, other{true_camera("b")};
  const DrawnBoard drawn = charuco(7, 5, "5X5_100"), second = charuco(7, 5, "6X6_50");
  const auto poses = spread_poses(truth[0], drawn.board, 2, 330, 10, random);
  auto photos = photograph(folder, drawn, truth, poses, random);
  photograph(folder, second, other, poses, random);
  Board told = drawn.board;
  told.dictionary.clear();
  photos[0].sources.push_back((folder / "b_*.png").string());
  EXPECT_THAT(refused(told, photos), HasSubstr("--dictionary 5X5_50 or --dictionary 6X6_50"));
  photos[0].sources.pop_back();
  Board turned = told;
  std::swap(turned.columns, turned.rows);
  EXPECT_THAT(refused(turned, photos), HasSubstr("--squares 7x5"));
  told.columns = 9, told.rows = 8;
  EXPECT_THAT(refused(told, photos), HasSubstr("not in the places of this board"));
}

TEST(Calibrate, ACalibrationStopsBetweenPhotos) {
  std::mt19937 random(9);
  const TemporaryFolder folder;
  const DrawnBoard drawn = charuco(7, 5);
  const std::vector<Camera> truth{true_camera("a")};
  const auto poses = spread_poses(truth[0], drawn.board, 3, 330, 20, random);
  const auto photos = photograph(folder, drawn, truth, poses, random);
  std::atomic<bool> cancel{false};
  CalibrateOptions options;
  options.cancel = &cancel;
  size_t seen = 0;
  options.progress = [&](size_t done, size_t) { seen = done, cancel = true; };
  EXPECT_THROW(calibrate(drawn.board, photos, options), Interrupted);
  EXPECT_EQ(seen, 1u);
}

TEST(BoardOptions, WordsAndOptionsAreOneBoard) {
  const Board board = board_of(told_board("charuco 7x5 20 15 dict_4x4_50"));
  EXPECT_EQ(board.columns, 7);
  EXPECT_EQ(board.marker, 15.0);
  EXPECT_EQ(board.dictionary, "4X4_50");
  EXPECT_EQ(board_of(told_board("charuco 7x5 20 15")).dictionary, "");
  EXPECT_EQ(board_of(told_board("circles 11x8 5 3")).diameter, 3.0);
  EXPECT_EQ(board_of(told_board("chessboard 10x7 25")).pitch, 25.0);
  const auto wrong = [](const std::string& words) {
    try {
      (void)board_of(told_board(words));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("it was taken");
  };
  EXPECT_THAT(wrong("chess 10x7 25"), HasSubstr("no kind of board 'chess'"));
  EXPECT_THAT(wrong("chessboard 10x7"), HasSubstr("needs --square"));
  EXPECT_THAT(wrong("chessboard 10x7 25 3"), HasSubstr("another kind of board"));
  EXPECT_THAT(wrong("charuco 7x5 20 4X4_50"), HasSubstr("'4X4_50' for a length"));
  EXPECT_THAT(wrong("charuco 7x5 20 15 4X4_50 more"), HasSubstr("'more' too many"));
  EXPECT_THAT(wrong("charuco 7x5 -20 15"), HasSubstr("'-20' for a length"));
}

TEST(Calibrate, PhotosThatDoNotGoTogetherAreRefused) {
  std::mt19937 random(9);
  const TemporaryFolder folder;
  const DrawnBoard drawn = charuco(7, 5);
  Camera small = true_camera("a");
  const auto poses = spread_poses(small, drawn.board, 3, 330, 20, random);
  auto photos = photograph(folder, drawn, {small}, poses, random);
  small = small.resized(0.5);
  small.width = 320, small.height = 240;
  write_image(folder / "a_04.png", BoardPhotographer(small).photo(drawn, poses[0], {}, random));
  EXPECT_THAT(refused(drawn.board, photos), HasSubstr("a_04.png: this photo has 320 x 240 px"));
  std::filesystem::remove(folder / "a_04.png");
  std::ofstream(folder / "a_04.png") << "no picture";
  EXPECT_THAT(refused(drawn.board, photos), HasSubstr("a_04.png"));
  std::filesystem::remove(folder / "a_04.png");
  std::filesystem::copy(folder / "a_01.png", folder / "b_x.png");
  std::filesystem::copy(folder / "a_01.png", folder / "b_y.png");
  EXPECT_THAT(refused(drawn.board, {photos[0], {"b", {(folder / "b_*.png").string()}}}),
              HasSubstr("`a` has 3 photos and `b` has 2"));
  EXPECT_THAT(refused(drawn.board, {{"a", {(folder / "none_*.png").string()}}}),
              HasSubstr("no photo is found there"));
  Image grey;
  grey.width = 64, grey.height = 48, grey.channels = 1;
  grey.values.assign(grey.pixels(), 0.5F);
  write_image(folder / "grey_1.png", grey);
  EXPECT_THAT(refused(drawn.board, {{"grey", {(folder / "grey_1.png").string()}}}),
              HasSubstr("no marker of 4X4_50 seen"));
}

TEST(Calibrate, FewPosesThatFaceAlikeInTheMiddleAreDoubted) {
  std::mt19937 random(6);
  const TemporaryFolder folder;
  const DrawnBoard drawn = charuco(7, 5);
  const Camera camera = true_camera("a");
  auto poses = spread_poses(camera, drawn.board, 4, 450, 8, random);
  for (BoardPose& pose : poses) pose.t.head<2>() *= 0.3;
  const auto photos = photograph(folder, drawn, {camera}, poses, random);
  CalibrateOptions options;
  options.lens = 0;
  const Calibration found = calibrate(drawn.board, photos, options);
  EXPECT_THAT(found.warnings, testing::Contains(HasSubstr("4 poses of the board")));
  EXPECT_THAT(found.warnings, testing::Contains(HasSubstr("face alike")));
  EXPECT_THAT(found.warnings, testing::Contains(HasSubstr("of the way to a corner")));
}

}  // namespace
}  // namespace hookeye::test
