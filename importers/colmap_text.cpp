// cameras.txt, images.txt and points3D.txt.
#include <fmt/format.h>

#include <charconv>

#include "importers/colmap_model.h"
#include "meshing/file_cursor.h"

namespace hookeye::detail {
namespace {

namespace fs = std::filesystem;

/// The words of one line.
class Words {
 public:
  Words(std::string_view line, const FileCursor& file) : line_(line), file_(file) {}
  std::string_view next() {
    const size_t begin = std::min(line_.find_first_not_of(" \t"), line_.size());
    const size_t end = std::min(line_.find_first_of(" \t", begin), line_.size());
    const std::string_view word = line_.substr(begin, end - begin);
    line_.remove_prefix(end);
    return word;
  }
  /// All that is left: a name may hold blanks.
  std::string rest() const {
    const size_t begin = std::min(line_.find_first_not_of(" \t"), line_.size());
    return std::string(line_.substr(begin));
  }
  bool more() const { return line_.find_first_not_of(" \t") != std::string_view::npos; }
  double real(const char* what) {
    double value = 0;
    const std::string_view word = next();
    if (!is_real(word, value)) none(what, word);
    return value;
  }
  template <class T>
  T whole(const char* what) {
    T value = 0;
    const std::string_view word = next();
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc() || stop != word.data() + word.size()) none(what, word);
    return value;
  }

 private:
  [[noreturn]] void none(const char* what, std::string_view word) const {
    file_.fault(word.empty() ? fmt::format("the line ends before {}", what)
                             : fmt::format("`{}` is no {}", word, what),
                "the files as COLMAP wrote them (colmap model_converter --output_type TXT)");
  }
  std::string_view line_;
  const FileCursor& file_;
};

/// The next line that is no comment; false at the end of the file.
bool next_line(FileCursor& file, std::string_view& line) {
  while (!file.rest().empty()) {
    line = file.line();
    const size_t first = line.find_first_not_of(" \t");
    if (first != std::string_view::npos && line[first] != '#') return true;
  }
  return false;
}

void read_cameras_txt(const fs::path& path, ColmapModel& model) {
  FileCursor file(path);
  int number = 0;
  for (std::string_view line; next_line(file, line);) {
    Words words(line, file);
    const auto id = words.whole<uint32_t>("number of a camera");
    const std::string kind(words.next());
    const int width = words.whole<int>("width"), height = words.whole<int>("height");
    std::vector<double> parameters;
    while (words.more()) parameters.push_back(words.real("parameter"));
    try {
      Camera camera = colmap_camera(kind, parameters, {});
      camera.width = width, camera.height = height;
      model.cameras[id] = std::move(camera);
    } catch (const InputError& error) {
      file.fault(error.wrong(), error.right());
    }
    ++number;
  }
  if (number == 0) file.ends();
}

void read_images_txt(const fs::path& path, ColmapModel& model) {
  FileCursor file(path);
  for (std::string_view line; next_line(file, line);) {
    Words words(line, file);
    ColmapImage image;
    words.whole<uint32_t>("number of an image");
    for (int i = 0; i < 4; ++i) image.q[i] = words.real("number of a quaternion");
    for (int i = 0; i < 3; ++i) image.t[i] = words.real("number of a translation");
    image.camera = words.whole<uint32_t>("number of a camera");
    image.name = words.rest();
    if (image.name.empty())
      file.fault("the image has no name", "ID QW QX QY QZ TX TY TZ CAMERA NAME");
    if (!model.cameras.contains(image.camera))
      file.fault(fmt::format("cameras.txt has no camera {}", image.camera), "files of one model");
    Words points(file.line(), file);  // may be empty
    while (points.more()) {
      const double x = points.real("x of a point"), y = points.real("y of a point");
      const auto point = points.whole<int64_t>("number of a point");
      if (point >= 0) image.seen.push_back({{x, y}, static_cast<uint64_t>(point)});
    }
    model.images.push_back(std::move(image));
  }
}

void read_points_txt(const fs::path& path, ColmapModel& model) {
  FileCursor file(path);
  for (std::string_view line; next_line(file, line);) {
    Words words(line, file);
    const auto id = words.whole<uint64_t>("number of a point");
    Eigen::Vector3d& x = model.points[id];
    for (int i = 0; i < 3; ++i) x[i] = words.real("coordinate");
  }
}

}  // namespace

ColmapModel read_colmap_text(const fs::path& folder) {
  ColmapModel model;
  read_cameras_txt(folder / "cameras.txt", model);
  read_images_txt(folder / "images.txt", model);
  if (std::error_code error; fs::is_regular_file(folder / "points3D.txt", error))
    read_points_txt(folder / "points3D.txt", model);
  return model;
}

}  // namespace hookeye::detail
