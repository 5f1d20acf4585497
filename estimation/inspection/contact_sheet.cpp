#include "estimation/inspection/contact_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "estimation/evaluation/evaluation.h"
#include "meshing/extent.h"

namespace hookeye::inspection {

namespace {

const cv::Scalar kModel(255, 140, 0), kRest(90, 170, 255), kHeld(60, 200, 90), kMoved(230, 60, 200),
    kPaper(246, 246, 246), kInk(30, 30, 30);

/// One picture: the photo in grey, 8 bits, RGB.
cv::Mat grey(const Image& image) {
  std::vector<float> sorted = image.values;
  const size_t high = sorted.size() - 1 - sorted.size() / 200;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(high), sorted.end());
  const float white = std::max(sorted[high], 1e-4f);
  cv::Mat out(image.height, image.width, CV_8UC3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float v = std::sqrt(std::clamp(image.at(x, y) / white, 0.0f, 1.0f));
      const auto code = static_cast<unsigned char>(20.0f + 235.0f * v);
      out.at<cv::Vec3b>(y, x) = {code, code, code};
    }
  return out;
}

void label(cv::Mat& picture, const std::string& text, cv::Point at, double scale) {
  const int width = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, nullptr).width;
  scale *= std::min(1.0, double(picture.cols - at.x - 4) / std::max(width, 1));
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(0, 0, 0), 3,
              cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(255, 255, 255), 1,
              cv::LINE_AA);
}

/// Vertices of the render surface that lie on a region.
std::vector<unsigned char> on_region(const Scene& scene, const std::string& name) {
  VectorXd node = VectorXd::Zero(scene.body->mesh.nodes());
  for (const int a : scene.body->regions.at(name).nodes) node[a] = 1.0;
  const VectorXd vertex = scene.body->surface.W * node;
  std::vector<unsigned char> out;
  for (const double v : vertex) out.push_back(v > 0.999);
  return out;
}

/// A region of an example with its colour and where it is drawn to go (zero: nowhere).
struct Drawn {
  std::vector<unsigned char> vertices;
  cv::Scalar colour;
  Vector3d direction = Vector3d::Zero();
};

std::vector<Drawn> drawn_regions(const Scene& scene, const ExampleSpec& example) {
  std::vector<Drawn> out;
  for (const SupportSpec& support : example.supports) {
    Vector3d move = support.rigid.move;
    bool moves = support.kind != SupportSpec::Kind::components && support.rigid.degrees != 0.0;
    if (support.kind == SupportSpec::Kind::components)
      for (int i = 0; i < 3; ++i)
        move[i] = support.displacement[static_cast<size_t>(i)].value_or(0.0);
    moves = moves || !move.isZero(0.0) || support.kind == SupportSpec::Kind::rigid_fit;
    out.push_back({on_region(scene, support.region), moves ? kMoved : kHeld, move});
  }
  for (const LoadSpec& load : example.loads) {
    const Region& region = scene.body->regions.at(load.region);
    const double inwards = load.pressure.value_or(0.0) < 0.0 ? 1.0 : -1.0;
    out.push_back({on_region(scene, load.region), kMoved,
                   load.force ? *load.force : Vector3d(inwards * region.normal)});
  }
  return out;
}

class Canvas {
 public:
  Canvas(Sight& sight, PhotoIndex photo)
      : sight_(sight),
        photo_(photo),
        camera_(camera_at_level(sight.camera(photo), sight.small(photo).level)) {
    const Image& I = sight.small(photo).I;
    times_ = std::max(1, int(std::lround(480.0 / std::max(I.width, I.height))));
    cv::resize(grey(I), picture_, {}, times_, times_, cv::INTER_NEAREST);
  }

  /// Colours what is seen of the regions, in the state `x`.
  void tint(const std::vector<Drawn>& regions, const Matrix3Xd& x) {
    const BodyPicture look = sight_.plain_look(camera_, x);
    const auto& triangles = sight_.scene().body->surface.mesh.triangles;
    const int width = sight_.small(photo_).I->width;
    for (int y = 0; y < picture_.rows; ++y)
      for (int c = 0; c < picture_.cols; ++c) {
        const int t = look.triangle[static_cast<size_t>(y / times_) * width + c / times_];
        if (t < 0) continue;
        const auto& corners = triangles[static_cast<size_t>(t)];
        for (const Drawn& region : regions) {
          if (!std::all_of(corners.begin(), corners.end(),
                           [&](int v) { return region.vertices[v]; }))
            continue;
          cv::Vec3b& pixel = picture_.at<cv::Vec3b>(y, c);
          for (int k = 0; k < 3; ++k)
            pixel[k] = cv::saturate_cast<unsigned char>(0.6 * pixel[k] + 0.4 * region.colour[k]);
        }
      }
  }

  void outline(const Matrix3Xd& x, const cv::Scalar& colour, int thick) {
    auto covered = sight_.outline(photo_, x);
    const Image& I = sight_.small(photo_).I;
    cv::Mat mask(I.height, I.width, CV_8U, covered.data()), large;
    cv::resize(mask, large, {}, times_, times_, cv::INTER_NEAREST);
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(large, contours, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
    cv::drawContours(picture_, contours, -1, colour, thick, cv::LINE_AA);
  }

  /// An arrow a quarter of the body long from the middle of the region.
  void arrow(const Drawn& region, const Matrix3Xd& x) {
    if (region.direction.isZero(0.0)) return;
    Vector3d middle = Vector3d::Zero();
    double count = 0.0;
    for (Eigen::Index v = 0; v < x.cols(); ++v)
      if (region.vertices[static_cast<size_t>(v)]) middle += x.col(v), count += 1.0;
    if (count == 0.0) return;
    middle /= count;
    const double size = extent(x);
    const Vector2d from = camera_.project(middle),
                   to = camera_.project(middle + 0.25 * size * region.direction.normalized());
    if (!from.allFinite() || !to.allFinite() || (to - from).norm() > 4.0 * picture_.cols) return;
    cv::arrowedLine(picture_, point(from), point(to), region.colour, 2, cv::LINE_AA, 0, 0.2);
  }

  void say(const std::string& title, const std::string& numbers) {
    label(picture_, title, {6, 18}, 0.55);
    label(picture_, numbers, {6, picture_.rows - 8}, 0.5);
  }

  cv::Mat picture_;

 private:
  cv::Point point(const Vector2d& px) const {
    return {int(std::lround(times_ * (px.x() + 0.5))), int(std::lround(times_ * (px.y() + 0.5)))};
  }
  Sight& sight_;
  PhotoIndex photo_;
  Camera camera_;
  int times_ = 1;
};

std::string numbers_of(const PhotoLook& look) {
  std::string text;
  const auto add = [&](const std::string& word) { text += (text.empty() ? "" : ", ") + word; };
  if (!std::isnan(look.overlap)) add(fmt::format("overlap {:.2f}", look.overlap));
  if (!std::isnan(look.share)) add(fmt::format("texture found {:.0f} %", 100.0 * look.share));
  if (!std::isnan(look.shift_px)) add(fmt::format("off {:.1f} px", look.shift_px));
  return text;
}

cv::Mat draw(Sight& sight, const PhotoLook& look) {
  const PhotoIndex photo{look.example, look.photo};
  const ExampleSpec& example = sight.example(look.example);
  const Matrix3Xd& rest = sight.scene().body->surface.mesh.X;
  const Matrix3Xd& x = sight.shown(look.example);
  const auto regions = drawn_regions(sight.scene(), example);
  Canvas canvas(sight, photo);
  canvas.tint(regions, x);
  if (!look.at_rest) canvas.outline(rest, kRest, 1);
  canvas.outline(x, kModel, 2);
  for (const Drawn& region : regions) canvas.arrow(region, x);
  canvas.say(example.name + "  " + sight.spec(photo).camera, numbers_of(look));
  return canvas.picture_;
}

void write(const std::filesystem::path& png, const cv::Mat& picture) {
  Image out{picture.cols, picture.rows, 3, {}};
  out.values.resize(out.pixels() * 3);
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      for (int c = 0; c < 3; ++c) out.at(x, y, c) = float(picture.at<cv::Vec3b>(y, x)[c]) / 255.0f;
  write_image(png, out, Encoding{Encoding::Kind::linear, 1.0});
}

/// Small pictures in a grid: cameras below one another, examples side by side, in blocks.
class Sheet {
 public:
  Sheet(const Scene& scene, int examples) {
    double tallest = 0.0;  // height over width
    for (const Camera& camera : scene.capture.cameras) {
      row_of_[camera.name] = static_cast<int>(row_of_.size());
      tallest = std::max(tallest, double(camera.height) / camera.width);
    }
    columns_ = std::min(examples, kMostColumns);
    const int rows = (examples + columns_ - 1) / columns_ * static_cast<int>(row_of_.size());
    width_ = std::clamp(1900 / columns_, 200, 420);
    height_ = static_cast<int>(std::lround(width_ * std::min(tallest, 1.5)));
    sheet_ = cv::Mat(rows * (height_ + kGap) + kLegend, columns_ * (width_ + kGap) + kGap, CV_8UC3,
                     kPaper);
  }
  void put(const cv::Mat& picture, int example, const std::string& camera) {
    const double scale = std::min(double(width_) / picture.cols, double(height_) / picture.rows);
    cv::Mat small;
    cv::resize(
        picture, small,
        {std::min(width_, int(scale * picture.cols)), std::min(height_, int(scale * picture.rows))},
        0, 0, cv::INTER_AREA);
    const int row = example / columns_ * static_cast<int>(row_of_.size()) + row_of_.at(camera);
    small.copyTo(sheet_(cv::Rect(kGap + example % columns_ * (width_ + kGap),
                                 kGap + row * (height_ + kGap), small.cols, small.rows)));
  }
  const cv::Mat& finished() {
    int x = kGap;
    const int y = sheet_.rows - 10;
    const std::pair<cv::Scalar, const char*> words[] = {
        {kModel, "model"}, {kRest, "model at rest"}, {kHeld, "held"}, {kMoved, "loaded or moved"}};
    for (const auto& [colour, word] : words) {
      cv::line(sheet_, {x, y - 5}, {x + 24, y - 5}, colour, 5);
      cv::putText(sheet_, word, {x + 34, y}, cv::FONT_HERSHEY_SIMPLEX, 0.5, kInk, 1, cv::LINE_AA);
      x += 60 + cv::getTextSize(word, cv::FONT_HERSHEY_SIMPLEX, 0.5, 1, nullptr).width;
    }
    return sheet_;
  }

 private:
  static constexpr int kMostColumns = 8, kGap = 6, kLegend = 34;
  std::map<std::string, int> row_of_;
  int columns_ = 1, width_ = 200, height_ = 150;
  cv::Mat sheet_;
};

}  // namespace

std::filesystem::path draw_pictures(Sight& sight, const std::filesystem::path& folder,
                                    std::vector<PhotoLook>* photos) {
  if (photos->empty()) return {};
  std::filesystem::create_directories(folder);
  std::map<int, int> column;  // examples that have photos
  for (const PhotoLook& look : *photos) column.emplace(look.example, int(column.size()));
  Sheet sheet(sight.scene(), int(column.size()));
  for (PhotoLook& look : *photos) {
    const std::string& camera = sight.spec({look.example, look.photo}).camera;
    const cv::Mat picture = draw(sight, look);
    look.picture = folder / (sight.example(look.example).name + "_" + camera + ".png");
    write(look.picture, picture);
    sheet.put(picture, column.at(look.example), camera);
  }
  const auto file = folder / "contact_sheet.png";
  write(file, sheet.finished());
  return file;
}

}  // namespace hookeye::inspection
