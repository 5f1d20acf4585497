// VTK's format for unstructured grids (vtu), version 1.0. The only file that touches pugixml.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <pugixml.hpp>
#include <sstream>

#include "capture_io/base64.h"
#include "capture_io/run.h"
#include "meshing/detail.h"
#include "meshing/tet_mesh.h"
#include "meshing/vtu_numbers.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using detail::VtuNumbers;

/// VTK's order of the mid nodes of a quadratic tetrahedron: 01 12 02 03 13 23; ours ends 23 13.
constexpr int kFromVtk[10] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
constexpr int kTetra = 10, kQuadraticTetra = 24;

/// Cells without a volume: points, edges, faces.
bool is_flat(int64_t type) {
  constexpr int kFlat[] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  21, 22, 23, 28, 30, 34,
                           35, 36, 51, 52, 53, 54, 60, 61, 62, 63, 68, 69, 70, 75, 76, 77};
  return std::ranges::find(kFlat, type) != std::end(kFlat);
}

std::string class_of(int64_t type) {
  static const std::map<int64_t, const char*> names = {{11, "vtkVoxel"},
                                                       {12, "vtkHexahedron"},
                                                       {13, "vtkWedge"},
                                                       {14, "vtkPyramid"},
                                                       {25, "vtkQuadraticHexahedron"},
                                                       {26, "vtkQuadraticWedge"},
                                                       {27, "vtkQuadraticPyramid"},
                                                       {29, "vtkTriQuadraticHexahedron"},
                                                       {42, "vtkPolyhedron"}};
  const auto found = names.find(type);
  return found == names.end() ? "" : fmt::format(", {}", found->second);
}

/// A file with one piece, its arrays read when they are asked for.
class VtuFile {
 public:
  explicit VtuFile(const fs::path& file) : file_(file), bytes_(read_text(file)) {
    part_raw();
    const pugi::xml_parse_result parsed = document_.load_string(bytes_.c_str());
    if (!parsed) {
      const auto upto =
          bytes_.begin() + std::min<std::ptrdiff_t>(parsed.offset, std::ssize(bytes_));
      throw InputError(
          {file.string(), 1 + static_cast<int>(std::count(bytes_.begin(), upto, '\n'))},
          fmt::format("cannot be read: {}", parsed.description()), "a complete vtu file");
    }
    read_head(document_.child("VTKFile"));
  }

  [[noreturn]] void fault(const std::string& wrong,
                          const std::string& right = "a complete vtu file") const {
    throw InputError({file_.string()}, wrong, right);
  }

  pugi::xml_node piece() const { return piece_; }
  int64_t count(const char* name) const {
    const std::string text = piece_.attribute(name).value();
    int64_t value = -1;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || stop != text.data() + text.size() || value < 0)
      fault(fmt::format("{}=\"{}\" counts nothing that a file can hold", name, text));
    return value;
  }

  VtuNumbers numbers(const pugi::xml_node& array) const {
    const std::string type = array.attribute("type").value();
    const std::string name = array.attribute("Name").value();
    if (!detail::is_vtu_type(type)) fault(fmt::format("array '{}' is of type '{}'", name, type));
    try {
      if (std::string_view(array.attribute("format").value()) == "ascii")
        return detail::vtu_numbers_of_text(array.text().get(), type);
      return detail::vtu_numbers(detail::vtu_bytes(stored(array), format_), type);
    } catch (const InputError&) {
      throw;
    } catch (const std::runtime_error& error) {
      fault(fmt::format("array '{}': {}", name, error.what()));
    }
  }

  /// A child of <Cells>.
  std::vector<int64_t> cells(const char* name) const {
    const VtuNumbers all =
        numbers(piece_.child("Cells").find_child_by_attribute("DataArray", "Name", name));
    if (!all.whole && all.size() > 0) fault(fmt::format("the {} of its cells are not whole", name));
    return all.integers;
  }

 private:
  /// Bytes as they are stand behind the XML, which a parser cannot pass.
  void part_raw() {
    const size_t begin = bytes_.find("<AppendedData");
    const size_t end = std::min(bytes_.find('>', begin), bytes_.size());
    if (begin == std::string::npos) return;
    const std::string_view tag = std::string_view(bytes_).substr(begin, end - begin);
    if (tag.find("\"raw\"") == std::string_view::npos) return;
    const size_t mark = bytes_.find('_', end);
    if (mark == std::string::npos) fault("ends before its appended data");
    raw_ = bytes_.substr(mark + 1);
    bytes_.resize(begin);
    bytes_ += "</VTKFile>";
    has_raw_ = true;
  }

  void read_head(const pugi::xml_node& root) {
    const auto told = [&](const char* name) { return std::string(root.attribute(name).value()); };
    if (told("type") != "UnstructuredGrid")
      fault(fmt::format("is a file of type '{}'", told("type")), "an UnstructuredGrid");
    if (told("byte_order") == "BigEndian")
      fault("its bytes are BigEndian", "a file written on, or for, an ordinary machine");
    if (!told("compressor").empty() && told("compressor") != "vtkZLibDataCompressor")
      fault(fmt::format("is compressed by {}", told("compressor")),
            "a file that is written uncompressed or with zlib");
    format_ = {told("header_type") == "UInt64", !told("compressor").empty()};
    const pugi::xml_node grid = root.child("UnstructuredGrid");
    piece_ = grid.child("Piece");
    if (!piece_) fault("holds no piece of a grid");
    if (piece_.next_sibling("Piece"))
      fault("holds several pieces, which share no nodes", "a file of one piece");
    appended_ = root.child("AppendedData").text().get();
    appended_.remove_prefix(std::min(appended_.find('_'), appended_.size()));
    appended_.remove_prefix(std::min<size_t>(1, appended_.size()));
    for (const auto& array : grid.select_nodes(".//DataArray[@offset]"))
      offsets_.push_back(array.node().attribute("offset").as_ullong());
    std::ranges::sort(offsets_);
  }

  std::string stored(const pugi::xml_node& array) const {
    const std::string_view format = array.attribute("format").value();
    if (format == "appended" && has_raw_) return raw_.substr(checked(offset(array), raw_.size()));
    if (format != "appended" && format != "binary")
      fault(fmt::format("an array's format is '{}'", format), "ascii, binary or appended");
    std::string_view text = array.text().get();
    if (format == "appended") {
      const unsigned long long begin = offset(array);
      const auto next = std::ranges::upper_bound(offsets_, begin);
      text = appended_.substr(checked(begin, appended_.size()),
                              next == offsets_.end() ? std::string::npos : *next - begin);
    }
    std::optional<std::string> bytes = from_base64(text);
    if (!bytes) fault("an array's base64 is damaged");
    return std::move(*bytes);
  }

  static unsigned long long offset(const pugi::xml_node& array) {
    return array.attribute("offset").as_ullong();
  }
  size_t checked(unsigned long long offset, size_t size) const {
    if (offset > size) fault(fmt::format("an array begins at byte {} of {}", offset, size));
    return offset;
  }

  fs::path file_;
  std::string bytes_, raw_;
  bool has_raw_ = false;
  pugi::xml_document document_;
  pugi::xml_node piece_;
  detail::VtuFormat format_;
  std::string_view appended_;  ///< in base64
  std::vector<unsigned long long> offsets_;
};

/// Tetrahedra of one order; whatever else has a volume would leave a hole. Faces, edges and points
/// of the mesh are passed over.
std::vector<int64_t> tetrahedra_of(const VtuFile& vtu, const std::vector<int64_t>& types) {
  std::vector<int64_t> cells;
  int64_t order = 0;
  for (int64_t c = 0; c < std::ssize(types); ++c) {
    const int64_t type = types[static_cast<size_t>(c)];
    if (is_flat(type)) continue;
    if (type != kTetra && type != kQuadraticTetra)
      vtu.fault(fmt::format("cell {} is no tetrahedron with 4 or 10 nodes (kind {}{})", c, type,
                            class_of(type)),
                "only tetrahedra of order 1 or 2 in the volume");
    if (order != 0 && type != order)
      vtu.fault(fmt::format("cell {} is of another order than earlier ones", c),
                "tetrahedra of one order");
    order = type;
    cells.push_back(c);
  }
  return cells;
}

Matrix3Xd points_of(const VtuFile& vtu) {
  const pugi::xml_node array = vtu.piece().child("Points").child("DataArray");
  const VtuNumbers numbers = vtu.numbers(array);
  const auto points = static_cast<uint64_t>(vtu.count("NumberOfPoints"));
  if (numbers.size() % 3 != 0 || numbers.size() / 3 != points)
    vtu.fault(fmt::format("announces {} points, and holds {} coordinates", points, numbers.size()));
  if (numbers.whole) vtu.fault("its points are whole numbers", "points of type Float32 or Float64");
  return Eigen::Map<const Matrix3Xd>(numbers.reals.data(), 3, static_cast<Eigen::Index>(points));
}

pugi::xml_node add_array(pugi::xml_node to, const char* type, const std::string& name,
                         Eigen::Index components, const void* values, size_t bytes) {
  pugi::xml_node array = to.append_child("DataArray");
  array.append_attribute("type") = type;
  array.append_attribute("Name") = name.c_str();
  array.append_attribute("NumberOfComponents") = static_cast<long long>(components);
  array.append_attribute("format") = "binary";
  const auto head = static_cast<uint64_t>(bytes);
  std::string stored(reinterpret_cast<const char*>(&head), sizeof head);
  stored.append(static_cast<const char*>(values), bytes);
  array.text() = base64(stored.data(), stored.size()).c_str();
  return array;
}

void add_array(pugi::xml_node to, const std::string& name, const Eigen::MatrixXd& values) {
  pugi::xml_node array = add_array(to, "Float64", name, values.rows(), values.data(),
                                   sizeof(double) * static_cast<size_t>(values.size()));
  if (values.size() == 0) return;
  // As VTK tells it: of vectors the range of their lengths.
  const Eigen::RowVectorXd of =
      values.rows() == 1 ? Eigen::RowVectorXd(values.row(0)) : values.colwise().norm();
  array.append_attribute("RangeMin") = fmt::format("{}", of.minCoeff()).c_str();
  array.append_attribute("RangeMax") = fmt::format("{}", of.maxCoeff()).c_str();
}

/// A tag ends for VTK at the first '>', in quotes too; pugixml leaves it there, as XML does.
std::string with_escaped_names(const std::string& xml) {
  std::string out;
  bool quoted = false;
  for (const char c : xml) {
    if (c == '"') quoted = !quoted;
    if (quoted && c == '>') {
      out += "&gt;";
    } else {
      out += c;
    }
  }
  return out;
}

void add_cells(pugi::xml_node to, const Eigen::MatrixXi& elements) {
  std::vector<int64_t> connectivity, offsets;
  for (Eigen::Index e = 0; e < elements.cols(); ++e) {
    for (Eigen::Index k = 0; k < elements.rows(); ++k)
      connectivity.push_back(elements(kFromVtk[k], e));
    offsets.push_back(std::ssize(connectivity));
  }
  const std::vector<uint8_t> types(offsets.size(), elements.rows() == 4 ? kTetra : kQuadraticTetra);
  add_array(to, "Int64", "connectivity", 1, connectivity.data(),
            sizeof(int64_t) * connectivity.size());
  add_array(to, "Int64", "offsets", 1, offsets.data(), sizeof(int64_t) * offsets.size());
  add_array(to, "UInt8", "types", 1, types.data(), types.size());
}

}  // namespace

detail::RawVolume detail::read_vtu(const fs::path& file) {
  const VtuFile vtu(file);
  RawVolume raw;
  raw.X = points_of(vtu);
  const std::vector<int64_t> types = vtu.cells("types"), ends = vtu.cells("offsets"),
                             nodes = vtu.cells("connectivity");
  const int64_t announced = vtu.count("NumberOfCells");
  if (std::ssize(types) != announced || std::ssize(ends) != announced)
    vtu.fault(fmt::format("announces {} cells, and holds {} types and {} offsets", announced,
                          types.size(), ends.size()));
  const std::vector<int64_t> cells = tetrahedra_of(vtu, types);
  const bool linear = cells.empty() || types[static_cast<size_t>(cells[0])] == kTetra;
  const int per = linear ? 4 : 10;
  raw.elements.resize(per, std::ssize(cells));
  for (int64_t e = 0; e < std::ssize(cells); ++e) {
    const auto c = static_cast<size_t>(cells[static_cast<size_t>(e)]);
    const int64_t begin = c == 0 ? 0 : ends[c - 1];
    if (begin < 0 || ends[c] < begin || ends[c] > std::ssize(nodes))
      vtu.fault(
          fmt::format("cell {} has the nodes {} to {} of {}", c, begin, ends[c], nodes.size()));
    if (ends[c] - begin != per)
      vtu.fault(fmt::format("cell {} has {} nodes", c, ends[c] - begin),
                fmt::format("{} nodes", per));
    for (int k = 0; k < per; ++k) {
      const int64_t node = nodes[static_cast<size_t>(begin + kFromVtk[k])];
      if (node < 0 || node >= raw.X.cols())
        vtu.fault(fmt::format("cell {} names node {}", c, node),
                  fmt::format("0 to {}: the nodes of the file", raw.X.cols() - 1));
      raw.elements(k, e) = static_cast<int>(node);
    }
    raw.element_names.push_back(std::to_string(c));
  }
  return raw;
}

void write_vtu(const fs::path& file, const TetMesh& mesh, const std::vector<VtuArray>& arrays) {
  pugi::xml_document document;
  pugi::xml_node root = document.append_child("VTKFile");
  root.append_attribute("type") = "UnstructuredGrid";
  root.append_attribute("version") = "1.0";
  root.append_attribute("byte_order") = "LittleEndian";
  root.append_attribute("header_type") = "UInt64";
  pugi::xml_node piece = root.append_child("UnstructuredGrid").append_child("Piece");
  piece.append_attribute("NumberOfPoints") = static_cast<long long>(mesh.X.cols());
  piece.append_attribute("NumberOfCells") = static_cast<long long>(mesh.elements.cols());
  pugi::xml_node on_points = piece.append_child("PointData"),
                 on_cells = piece.append_child("CellData");
  for (const VtuArray& array : arrays)
    add_array(array.on_points ? on_points : on_cells, array.name, array.values);
  add_array(piece.append_child("Points"), "Points", mesh.X);
  add_cells(piece.append_child("Cells"), mesh.elements);
  std::ostringstream text;
  document.save(text, "  ");
  write_text(file, with_escaped_names(text.str()));
}

Eigen::MatrixXd read_vtu_array(const fs::path& file, const std::string& name, bool on_points) {
  const VtuFile vtu(file);
  const pugi::xml_node from = vtu.piece().child(on_points ? "PointData" : "CellData");
  const pugi::xml_node array = from.find_child_by_attribute("DataArray", "Name", name.c_str());
  if (!array) {
    std::string names;
    for (const pugi::xml_node& one : from.children("DataArray"))
      names += (names.empty() ? "" : ", ") + std::string(one.attribute("Name").value());
    vtu.fault(fmt::format("has no array '{}'", name),
              names.empty() ? "a file with results" : "one of " + names);
  }
  const VtuNumbers numbers = vtu.numbers(array);
  const int64_t count = vtu.count(on_points ? "NumberOfPoints" : "NumberOfCells");
  const auto components = static_cast<int64_t>(array.attribute("NumberOfComponents").as_llong(1));
  if (numbers.whole || components < 1 || std::ssize(numbers.reals) % components != 0 ||
      std::ssize(numbers.reals) / components != count)
    vtu.fault(
        fmt::format("array '{}' is not of {} times {} real numbers", name, count, components));
  return Eigen::Map<const Eigen::MatrixXd>(numbers.reals.data(), components, count);
}

}  // namespace hookeye
