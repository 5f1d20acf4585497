// Cameras that photographed boards in known poses come back, within what their errors say.
#include "calibration/calibrate.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <opencv2/calib3d.hpp>

#include "calibration/detection.h"
#include "calibration/drawn_board.h"
#include "calibration/output.h"
#include "calibration/photographed.h"
#include "calibration/turns.h"
#include "capture_io/camera_covariance.h"
#include "core/text_file.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

DrawnBoard chessboard(int columns, int rows) {
  DrawnBoard drawn;
  drawn.board.kind = Board::Kind::chessboard;
  drawn.board.columns = columns, drawn.board.rows = rows, drawn.board.pitch = 18;
  return drawn;
}

DrawnBoard dots(Board::Kind kind, int columns, int rows, double pitch, double diameter) {
  DrawnBoard drawn;
  drawn.board.kind = kind;
  drawn.board.columns = columns, drawn.board.rows = rows;
  drawn.board.pitch = pitch, drawn.board.diameter = diameter;
  return drawn;
}

/// What was found minus what is true, as BundleCovariance has its numbers.
Eigen::VectorXd errors_of(const Bundle& bundle, const std::vector<Camera>& truth) {
  std::vector<double> out;
  for (size_t c = 0; c < truth.size(); ++c) {
    const Camera& found = bundle.cameras[c];
    const auto ours = found.intrinsics(), theirs = truth[c].intrinsics();
    for (size_t i = 0; i < ours.size(); ++i)
      if (ours[i].name != "skew") out.push_back(ours[i].value - theirs[i].value);
    const Eigen::Matrix3d turn = found.R * truth[c].R.transpose();
    const Eigen::Vector3d w = detail::rotation_vector(turn), v = found.t - turn * truth[c].t;
    for (const Eigen::Vector3d& part : {w, v}) out.insert(out.end(), part.begin(), part.end());
  }
  return Eigen::Map<Eigen::VectorXd>(out.data(), static_cast<Eigen::Index>(out.size()));
}

/// Of the numbers that are not given by the choice of the world.
std::vector<int> free_numbers(const BundleCovariance& errors) {
  std::vector<int> out;
  for (Eigen::Index i = 0; i < errors.covariance.rows(); ++i)
    if (errors.covariance(i, i) > 0) out.push_back(static_cast<int>(i));
  return out;
}

/// e' C^-1 e over its count; 1 on average.
double chi_square(const BundleCovariance& errors, const Eigen::VectorXd& e) {
  const auto free = free_numbers(errors);
  Eigen::VectorXd part(static_cast<Eigen::Index>(free.size()));
  Eigen::MatrixXd C(part.size(), part.size());
  for (size_t i = 0; i < free.size(); ++i) {
    part[Eigen::Index(i)] = e[free[i]];
    for (size_t k = 0; k < free.size(); ++k)
      C(Eigen::Index(i), Eigen::Index(k)) = errors.covariance(free[i], free[k]);
  }
  // Of numbers of one size, whatever their units.
  const Eigen::VectorXd scale = C.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd R = scale.asDiagonal() * C * scale.asDiagonal();
  const Eigen::VectorXd z = scale.cwiseProduct(part);
  return z.dot(R.ldlt().solve(z)) / static_cast<double>(z.size());
}

void expect_near_truth(const BundleCovariance& errors, const Eigen::VectorXd& e, double most) {
  ASSERT_EQ(errors.parameters.size(), static_cast<size_t>(e.size()));
  for (const int i : free_numbers(errors)) {
    const auto& p = errors.parameters[static_cast<size_t>(i)];
    EXPECT_LT(std::abs(e[i]), most * errors.error(static_cast<size_t>(i)))
        << p.camera << " " << p.name << " off by " << e[i];
  }
}

TEST(Calibrate, TwoCamerasOfACharucoBoardComeBackWithinTheirErrors) {
  std::mt19937 random(7);
  const TemporaryFolder folder;
  const DrawnBoard drawn = charuco(7, 5);
  const std::vector<Camera> truth{true_camera("left"), second_camera("right", 3)};
  const auto poses = spread_poses(truth[0], drawn.board, 12, 330, 35, random);
  const auto photos = photograph(folder, drawn, truth, poses, random);
  const Calibration found = calibrate(drawn.board, photos, {});
  const Eigen::VectorXd e = errors_of(found.bundle, truth);
  expect_near_truth(found.errors, e, 3.0);
  const double chi2 = chi_square(found.errors, e);
  RecordProperty("chi_square", std::to_string(chi2));
  EXPECT_GT(chi2, 0.3);  // 24 numbers: 0.36 .. 1.97 are the 99.8 % limits
  EXPECT_LT(chi2, 2.5);
  EXPECT_LT(found.rms_px[0], 0.15);
  EXPECT_GT(found.corners, 400u);
  EXPECT_LT(found.dropped, found.corners / 50);
  EXPECT_THAT(found.warnings, testing::IsEmpty());
  const std::string map = corner_map(found, 1);
  EXPECT_THAT(map, HasSubstr("right: 640 x 480 px"));

  // The same in the frame of a board.
  CalibrateOptions options;
  options.frame = "left_03.png";
  const Calibration on_board = calibrate(drawn.board, photos, options);
  std::vector<Camera> moved = truth;
  for (Camera& camera : moved) {
    camera.t += camera.R * poses[2].t;
    camera.R = camera.R * poses[2].R;
  }
  expect_near_truth(on_board.errors, errors_of(on_board.bundle, moved), 3.0);
  EXPECT_EQ(free_numbers(on_board.errors).size(), 30u);
  EXPECT_THAT(calibrated_cameras_yaml(on_board, ""), HasSubstr("right:"));
}

TEST(Calibrate, AChessboardThatLooksAlikeTurnedIsOneBoardForBothCameras) {
  std::mt19937 random(3);
  const TemporaryFolder folder;
  const DrawnBoard drawn = chessboard(8, 6);  // the same turned by half a turn
  const std::vector<Camera> truth{true_camera("left"), second_camera("right", 175)};
  const auto poses = spread_poses(truth[0], drawn.board, 9, 340, 30, random);
  const Calibration found =
      calibrate(drawn.board, photograph(folder, drawn, truth, poses, random), {});
  expect_near_truth(found.errors, errors_of(found.bundle, truth), 3.5);
  EXPECT_LT(found.rms_px[1], 0.15);
}

TEST(Calibrate, DotsAreSeenWhereTheMiddleOfTheirAreaIs) {
  std::mt19937 random(5);
  const std::vector<Camera> truth{true_camera("left")};
  for (const DrawnBoard& drawn : {dots(Board::Kind::circles, 5, 4, 34, 20),
                                  dots(Board::Kind::asymmetric_circles, 3, 7, 18, 18)}) {
    const TemporaryFolder folder;
    const auto poses = spread_poses(truth[0], drawn.board, 9, 340, 40, random);
    const auto photos = photograph(folder, drawn, truth, poses, random);
    const Calibration found = calibrate(drawn.board, photos, {});
    expect_near_truth(found.errors, errors_of(found.bundle, truth), 3.5);
    Board unknown = drawn.board;
    unknown.diameter = 0;
    const Calibration centres = calibrate(unknown, photos, {});
    // Tilted centres are seen some tenths of a pixel off, much alike all over a board: its pose
    // takes up most of that, the camera the rest, and the residuals tell little of it.
    constexpr double kLimit = 3.1;  // 99.9 % of chi-square of 9 numbers, over 9
    EXPECT_LT(chi_square(found.errors, errors_of(found.bundle, truth)), kLimit);
    EXPECT_GT(chi_square(centres.errors, errors_of(centres.bundle, truth)), kLimit);
    EXPECT_THAT(centres.warnings, testing::Contains(HasSubstr("give --diameter")));
  }
}

/// Corners as the cameras see them, with white noise, and `wrong` of them anywhere.
Bundle seen_bundle(const Board& board, const std::vector<Camera>& truth,
                   const std::vector<BoardPose>& poses, double sigma, int wrong,
                   std::mt19937& random) {
  Bundle bundle;
  bundle.board = board;
  bundle.cameras = truth;
  bundle.boards = poses;
  std::normal_distribution<double> noise(0.0, sigma);
  for (size_t c = 0; c < truth.size(); ++c)
    for (size_t b = 0; b < poses.size(); ++b) {
      BoardView view{c, b, {}, {}, {}, {}};
      Eigen::Matrix2Xd pixels(2, board.corner_count());
      for (int id = 0; id < board.corner_count(); ++id) {
        view.ids.push_back(id);
        pixels.col(id) =
            seen_corner(bundle, view, id) + Eigen::Vector2d(noise(random), noise(random));
      }
      view.pixels = pixels;
      view.used.assign(view.ids.size(), 1);
      bundle.views.push_back(view);
    }
  for (int i = 0; i < wrong; ++i) {
    BoardView& view = bundle.views[random() % bundle.views.size()];
    view.pixels.col(static_cast<Eigen::Index>(random() % view.ids.size())) +=
        Eigen::Vector2d(5.0 + 0.1 * i, -7.0);
  }
  // Not from the truth.
  for (Camera& camera : bundle.cameras) camera = camera.zoomed(0.02);
  for (BoardPose& pose : bundle.boards) pose.t.z() *= 1.02;
  bundle.cameras.back().t.x() += truth.size() > 1 ? 1.0 : 0.0;
  return bundle;
}

TEST(Bundle, ErrorsAreAsLargeAsTheySay) {
  const Board board = chessboard(8, 6).board;
  const std::vector<Camera> truth{true_camera("left"), second_camera("right", 3)};
  double sum = 0.0;
  constexpr int kSeeds = 12;
  for (int seed = 0; seed < kSeeds; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    const auto poses = spread_poses(truth[0], board, 10, 340, 35, random);
    Bundle bundle = seen_bundle(board, truth, poses, 0.1, seed % 2 ? 20 : 0, random);
    ASSERT_TRUE(settle(bundle));
    const auto errors = covariance(bundle);
    ASSERT_TRUE(errors);
    sum += chi_square(*errors, errors_of(bundle, truth));
    for (const double sigma : bundle.sigma) EXPECT_NEAR(sigma, 0.1, 0.008);
  }
  // 12 times 24 numbers: the mean has a standard deviation of 0.083.
  EXPECT_NEAR(sum / kSeeds, 1.0, 0.3);
}

/// What is written beside cameras.yaml, a capture of these cameras takes: all but the pose that is
/// the world, to the last bit.
TEST(Bundle, ACaptureTakesItsCovariance) {
  const Board board = chessboard(8, 6).board;
  const std::vector<Camera> truth{true_camera("left"), second_camera("right", 3)};
  std::mt19937 random(3);
  const auto poses = spread_poses(truth[0], board, 10, 340, 35, random);
  Calibration calibration;
  calibration.bundle = seen_bundle(board, truth, poses, 0.1, 0, random);
  ASSERT_TRUE(settle(calibration.bundle));
  calibration.errors = covariance(calibration.bundle).value();
  const TemporaryFolder folder;
  write_text(folder / kCovarianceFile, calibrated_covariance_yaml(calibration, "cm", "# one\n"));
  Capture capture;
  capture.units = {"mm", "N"};
  capture.cameras = calibration.bundle.cameras;
  YamlNode name;
  name.kind = YamlNode::Kind::scalar;
  name.text = kCovarianceFile;
  read_camera_covariance(name, {folder.path(), std::filesystem::canonical(folder.path())}, capture);
  ASSERT_TRUE(capture.camera_covariance);
  const CameraCovariance& known = *capture.camera_covariance;
  ASSERT_EQ(known.numbers.size(), calibration.errors.parameters.size() - 6);
  std::vector<Eigen::Index> own;
  std::vector<double> factor;
  for (size_t i = 0; i < calibration.errors.parameters.size(); ++i) {
    const auto& one = calibration.errors.parameters[i];
    if (calibration.errors.error(i) == 0.0) continue;
    EXPECT_EQ(known.numbers[own.size()].name, one.name);
    EXPECT_EQ(known.numbers[own.size()].camera, one.camera == 0 ? "left" : "right");
    own.push_back(static_cast<Eigen::Index>(i));
    factor.push_back(one.name.starts_with("shift_") ? 10.0 : 1.0);
  }
  const Eigen::Map<const Eigen::VectorXd> to_mm(factor.data(), known.values.rows());
  const Eigen::MatrixXd told =
      to_mm.asDiagonal() * calibration.errors.covariance(own, own) * to_mm.asDiagonal();
  EXPECT_TRUE(known.values.isApprox(told, 1e-12));
}

TEST(Bundle, WrongCornersAreDroppedAndNoOthers) {
  std::mt19937 random(1);
  const Board board = chessboard(8, 6).board;
  const std::vector<Camera> truth{true_camera("left")};
  const auto poses = spread_poses(truth[0], board, 10, 340, 35, random);
  Bundle bundle = seen_bundle(board, truth, poses, 0.1, 15, random);
  ASSERT_TRUE(settle(bundle));
  int dropped_well = 0;
  for (const BoardView& view : bundle.views)
    for (size_t i = 0; i < view.ids.size(); ++i) {
      const double off = view.residuals.col(static_cast<Eigen::Index>(i)).norm();
      EXPECT_FALSE(view.used[i] && off > 0.5) << off;
      dropped_well += !view.used[i] && off < 1.0;
    }
  EXPECT_LE(dropped_well, 1);  // one in three thousand is beyond 4 sigma
}

TEST(Bundle, OneCameraIsThatOfOpenCv) {
  std::mt19937 random(4);
  const Board board = chessboard(8, 6).board;
  const std::vector<Camera> truth{true_camera("left")};
  const auto poses = spread_poses(truth[0], board, 10, 340, 35, random);
  Bundle bundle = seen_bundle(board, truth, poses, 0.1, 0, random);
  ASSERT_TRUE(settle(bundle));
  std::vector<std::vector<cv::Point3f>> on_board;
  std::vector<std::vector<cv::Point2f>> in_photo;
  for (const BoardView& view : bundle.views) {
    on_board.emplace_back();
    in_photo.emplace_back();
    for (size_t i = 0; i < view.ids.size(); ++i) {
      if (!view.used[i]) continue;
      const Eigen::Vector3f x = board.corner(view.ids[i]).cast<float>();
      const Eigen::Vector2f p = view.pixels.col(Eigen::Index(i)).cast<float>();
      on_board.back().emplace_back(x.x(), x.y(), x.z());
      in_photo.back().emplace_back(p.x(), p.y());
    }
  }
  cv::Mat K, lens, deviations, others, views;
  std::vector<cv::Mat> rotations, shifts;
  cv::calibrateCamera(on_board, in_photo, {640, 480}, K, lens, rotations, shifts, deviations,
                      others, views, 0,
                      {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 200, 1e-14});
  const auto errors = covariance(bundle);
  ASSERT_TRUE(errors);
  const Camera& ours = bundle.cameras[0];
  const double theirs[] = {K.at<double>(0, 0), K.at<double>(1, 1), K.at<double>(0, 2),
                           K.at<double>(1, 2), lens.at<double>(0), lens.at<double>(1),
                           lens.at<double>(2), lens.at<double>(3), lens.at<double>(4)};
  std::vector<double> own{ours.fx, ours.fy, ours.cx, ours.cy};
  own.insert(own.end(), ours.distortion.begin(), ours.distortion.end());
  // OpenCV 4.6 divides the squared sum by points - parameters, where each point has two residuals;
  // later ones by 2 points - parameters.
  const double parameters = 9.0 + 6.0 * static_cast<double>(bundle.views.size());
  double points = 0.0;
  for (const auto& view : in_photo) points += static_cast<double>(view.size());
  const double early = std::sqrt((2 * points - parameters) / (points - parameters));
  const bool is_early = deviations.at<double>(0) > std::sqrt(early) * errors->error(0);
  for (size_t i = 0; i < 9; ++i) {
    EXPECT_NEAR(own[i], theirs[i], 0.02 * errors->error(i)) << errors->parameters[i].name;
    EXPECT_NEAR(errors->error(i), deviations.at<double>(int(i)) / (is_early ? early : 1.0),
                0.03 * errors->error(i))
        << errors->parameters[i].name;
  }
}

TEST(Calibrate, SaysWhatIsInThePhotosInstead) {
  std::mt19937 random(9);
  const TemporaryFolder folder;
  const DrawnBoard drawn = charuco(7, 5, "5X5_100");
  const std::vector<Camera> truth{true_camera("a")};
  const auto poses = spread_poses(truth[0], drawn.board, 3, 330, 20, random);
  const auto photos = photograph(folder, drawn, truth, poses, random);
  Board told = drawn.board;
  told.dictionary = "6X6_50";
  EXPECT_THAT(refused(told, photos), HasSubstr("--dictionary 5X5_"));
  told = drawn.board;
  std::swap(told.columns, told.rows);
  EXPECT_THAT(refused(told, photos), HasSubstr("--squares 7x5"));
  told.columns = 4, told.rows = 3;
  EXPECT_THAT(refused(told, photos), HasSubstr("the board has 0 to 5"));
  Board other = chessboard(8, 6).board;
  EXPECT_THAT(refused(other, photos), HasSubstr("no chessboard of 8x6 squares"));
}

TEST(Calibrate, CornersCountedForSquaresAreTold) {
  std::mt19937 random(9);
  const TemporaryFolder folder;
  const DrawnBoard drawn = chessboard(10, 7);
  const std::vector<Camera> truth{true_camera("a")};
  const auto poses = spread_poses(truth[0], drawn.board, 2, 330, 20, random);
  Board told = drawn.board;
  told.columns = 9, told.rows = 6;
  EXPECT_THAT(refused(told, photograph(folder, drawn, truth, poses, random)),
              HasSubstr("--squares 10x7"));
}

TEST(Calibrate, BothKindsOfEvenCharucoBoardsAreRead) {
  std::mt19937 random(2);
  for (const bool white_first : {false, true}) {
    DrawnBoard drawn = charuco(7, 6);
    drawn.white_first = white_first;
    const Camera camera = true_camera("a");
    const auto pose = spread_poses(camera, drawn.board, 1, 330, 20, random).front();
    const Image photo = BoardPhotographer(camera).photo(drawn, pose, {}, random);
    const Detection found = detect(photo, drawn.board, "drawn");
    EXPECT_EQ(found.ids.size(), 30u) << found.why;
    double worst = 0.0;
    for (size_t i = 0; i < found.ids.size(); ++i)
      worst = std::max(worst, (camera.project(pose.R * drawn.board.corner(found.ids[i]) + pose.t) -
                               found.pixels.col(Eigen::Index(i)))
                                  .norm());
    EXPECT_LT(worst, 0.3);
  }
}

}  // namespace
}  // namespace hookeye::test
