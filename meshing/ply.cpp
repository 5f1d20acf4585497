// Triangles of a ply file with their texture coordinates, text or binary. CGAL 5.5 reads no texture
// coordinates, and passes over a property of a type that it does not know, so that all numbers
// behind it are taken for others.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "meshing/detail.h"
#include "meshing/file_cursor.h"

namespace hookeye::detail {
namespace {

constexpr const char* kRight = "a complete ply file of triangles";

struct Type {
  const char *name, *other;
  size_t bytes;
  bool whole;
};
constexpr Type kTypes[] = {{"char", "int8", 1, true},      {"uchar", "uint8", 1, true},
                           {"short", "int16", 2, true},    {"ushort", "uint16", 2, true},
                           {"int", "int32", 4, true},      {"uint", "uint32", 4, true},
                           {"float", "float32", 4, false}, {"double", "float64", 8, false}};

struct Property {
  std::string name;
  int type = 0;    ///< of kTypes
  int count = -1;  ///< a list: the type of its length
};
struct Element {
  std::string name;
  uint64_t items = 0;
  std::vector<Property> properties;

  int find(std::string_view property) const {
    const auto at = std::ranges::find(properties, property, &Property::name);
    return at == properties.end() ? -1 : static_cast<int>(at - properties.begin());
  }
};

class PlyReader {
 public:
  explicit PlyReader(const std::filesystem::path& file) : in_(file) { read_header(); }

  TriangleSoup read() {
    for (const Element& element : elements_) {
      expect_room(element);
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (element.name == "face") {
        read_faces(element);
      } else {
        for (uint64_t i = 0; i < element.items; ++i)
          for (const Property& p : element.properties) read_values(p);
      }
    }
    if (with_uv_ > 0 && with_uv_ * 3 != corners_.size())
      fault(fmt::format("{} of {} faces have texture coordinates", with_uv_, corners_.size() / 3),
            "texture coordinates on all triangles or on none");
    TriangleSoup soup;
    soup.corners.resize(3, static_cast<Eigen::Index>(corners_.size()));
    for (size_t i = 0; i < corners_.size(); ++i)
      soup.corners.col(static_cast<Eigen::Index>(i)) = corners_[i];
    if (with_uv_ > 0) soup.uv = std::move(uv_);
    return soup;
  }

 private:
  enum class Format { text, little, big };

  [[noreturn]] void fault(const std::string& wrong, const std::string& right = kRight) const {
    in_.fault(wrong, right, format_ != Format::text);
  }

  void read_header() {
    if (in_.line() != "ply") in_.fault("does not begin with 'ply'", kRight);
    bool told = false;
    while (true) {
      if (in_.rest().empty()) in_.ends();
      std::vector<std::string> words = words_of(in_.line());
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format" && words.size() == 3) {
        told = true;
        format_ = format_of(words[1]);
      } else if (words[0] == "element" && words.size() == 3) {
        elements_.push_back({words[1], count_of(words[2]), {}});
      } else if (words[0] == "property" && !elements_.empty()) {
        elements_.back().properties.push_back(property_of(words));
      } else {
        in_.fault(fmt::format("'{}' is no statement of a ply header", fmt::join(words, " ")),
                  "format, element, property, comment or end_header");
      }
    }
    if (!told) in_.fault("tells no format", "format ascii 1.0, or a binary one");
  }

  static std::vector<std::string> words_of(std::string_view line) {
    std::vector<std::string> words;
    for (size_t at = 0; (at = line.find_first_not_of(" \t", at)) != std::string_view::npos;) {
      const size_t end = std::min(line.find_first_of(" \t", at), line.size());
      words.emplace_back(line.substr(at, end - at));
      at = end;
    }
    return words;
  }

  Format format_of(const std::string& word) const {
    if (word == "ascii") return Format::text;
    if (word == "binary_little_endian") return Format::little;
    if (word == "binary_big_endian") return Format::big;
    in_.fault(fmt::format("'{}' is no format", word),
              "ascii, binary_little_endian or binary_big_endian");
  }

  uint64_t count_of(const std::string& word) const {
    uint64_t count = 0;
    const char* const end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, count);
    if (error != std::errc() || stop != end)
      in_.fault(fmt::format("'{}' counts nothing that a file can hold", word), "a whole number");
    return count;
  }

  /// "property TYPE NAME" or "property list TYPE TYPE NAME"
  Property property_of(const std::vector<std::string>& words) const {
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3)
      in_.fault(fmt::format("'{}' tells no property", fmt::join(words, " ")),
                "property TYPE NAME, or property list TYPE TYPE NAME");
    Property out{words.back(), type_of(words[words.size() - 2]), list ? type_of(words[2]) : -1};
    if (list && !kTypes[out.count].whole)
      in_.fault(fmt::format("the length of a list is a {}", words[2]), "a whole number");
    return out;
  }

  int type_of(const std::string& word) const {
    for (int i = 0; i < static_cast<int>(std::size(kTypes)); ++i)
      if (word == kTypes[i].name || word == kTypes[i].other) return i;
    in_.fault(fmt::format("'{}' is no type of a number", word),
              "char, uchar, short, ushort, int, uint, float or double");
  }

  /// Before anything is allocated, or read for ever.
  void expect_room(const Element& element) const {
    size_t least = 0;
    for (const Property& p : element.properties)
      least += format_ == Format::text ? 2 : kTypes[p.count >= 0 ? p.count : p.type].bytes;
    if (element.items == 0) return;
    if (least == 0) fault(fmt::format("element {} has no properties", element.name));
    const uint64_t room = (in_.rest().size() + 1) / least;  // the last has no blank behind it
    if (element.items > room)
      fault(fmt::format("the header tells {} of element {}, the file has room for {}",
                        element.items, element.name, room));
  }

  double value(int type) {
    if (format_ == Format::text) return text_value(kTypes[type]);
    const bool swap = format_ == Format::big;
    switch (type) {
      case 0:
        return in_.number<int8_t>(swap);
      case 1:
        return in_.number<uint8_t>(swap);
      case 2:
        return in_.number<int16_t>(swap);
      case 3:
        return in_.number<uint16_t>(swap);
      case 4:
        return in_.number<int32_t>(swap);
      case 5:
        return in_.number<uint32_t>(swap);
      case 6:
        return in_.number<float>(swap);
      default:
        return in_.number<double>(swap);
    }
  }

  /// With the precision that the header tells, so that text and binary files are the same surface.
  double text_value(const Type& type) {
    const double value = in_.real();
    if (type.whole && value != std::floor(value))
      fault(fmt::format("{} is no whole number", value),
            fmt::format("a number of type {}", type.name));
    if (type.whole || type.bytes == sizeof(double)) return value;
    if (std::abs(value) > std::numeric_limits<float>::max())
      fault(fmt::format("{} is beyond single precision", value), "numbers below 3e38");
    return static_cast<float>(value);
  }

  /// The values of one property of one item: one, or a list.
  const std::vector<double>& read_values(const Property& p) {
    values_.clear();
    const double length = p.count < 0 ? 1.0 : value(p.count);
    if (!(length >= 0.0) || length > static_cast<double>(in_.rest().size()))
      fault(fmt::format("a list of {} {} is longer than the file", length, p.name));
    for (double i = 0; i < length; ++i) values_.push_back(value(p.type));
    return values_;
  }

  /// The columns of a pair of texture coordinates, {-1, -1}: none.
  static std::array<int, 2> uv_columns(const Element& element) {
    constexpr std::array<const char*, 2> kNames[] = {
        {"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}};
    for (const auto& [u, v] : kNames)
      if (element.find(u) >= 0 && element.find(v) >= 0) return {element.find(u), element.find(v)};
    return {-1, -1};
  }

  void read_vertices(const Element& element) {
    const std::array<int, 3> xyz = {element.find("x"), element.find("y"), element.find("z")};
    if (*std::ranges::min_element(xyz) < 0) fault("its vertices have no x, y and z");
    const std::array<int, 2> uv = uv_columns(element);
    points_have_uv_ = uv[0] >= 0;
    std::vector<double> row(element.properties.size());
    for (uint64_t i = 0; i < element.items; ++i) {
      for (size_t p = 0; p < row.size(); ++p) {
        const std::vector<double>& values = read_values(element.properties[p]);
        row[p] = values.empty() ? 0.0 : values[0];
      }
      points_.emplace_back(row[xyz[0]], row[xyz[1]], row[xyz[2]]);
      if (points_have_uv_) point_uv_.emplace_back(row[uv[0]], row[uv[1]]);
    }
  }

  void read_faces(const Element& element) {
    int corners = element.find("vertex_indices");
    if (corners < 0) corners = element.find("vertex_index");
    if (corners < 0 || element.properties[corners].count < 0)
      fault("its faces have no list vertex_indices");
    const int texture = element.find("texcoord");
    // Those of a face, which allow for seams, stand above those of its vertices.
    if (texture >= 0) points_have_uv_ = false;
    for (uint64_t i = 0; i < element.items; ++i) {
      uv_.emplace_back();
      for (int p = 0; p < static_cast<int>(element.properties.size()); ++p) {
        const std::vector<double>& values = read_values(element.properties[p]);
        if (p == corners) add_face(values);
        if (p == texture && values.size() == 6) add_uv(values);
      }
    }
  }

  void add_face(const std::vector<double>& corners) {
    const size_t face = uv_.size() - 1;
    if (corners.size() != 3)
      fault(fmt::format("face {} has {} corners", face, corners.size()),
            "triangles only: triangulate the surface");
    for (size_t k = 0; k < 3; ++k) {
      if (!(corners[k] >= 0 && corners[k] < static_cast<double>(points_.size()) &&
            corners[k] == std::floor(corners[k])))
        fault(fmt::format("face {} names vertex {}", face, corners[k]),
              fmt::format("an index below {}", points_.size()));
      const auto at = static_cast<size_t>(corners[k]);
      corners_.push_back(points_[at]);
      if (points_have_uv_) uv_.back()[k] = point_uv_[at];
    }
    with_uv_ += points_have_uv_;
  }

  void add_uv(const std::vector<double>& uv) {
    ++with_uv_;
    for (size_t k = 0; k < 3; ++k) uv_.back()[k] = {uv[2 * k], uv[2 * k + 1]};
  }

  FileCursor in_;
  Format format_ = Format::text;
  std::vector<Element> elements_;
  std::vector<Vector3d> points_, corners_;
  std::vector<Vector2d> point_uv_;
  std::vector<std::array<Vector2d, 3>> uv_;
  std::vector<double> values_;
  bool points_have_uv_ = false;
  size_t with_uv_ = 0;
};

}  // namespace

TriangleSoup read_ply(const std::filesystem::path& file) { return PlyReader(file).read(); }

}  // namespace hookeye::detail
