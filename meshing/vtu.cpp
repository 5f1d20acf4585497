// VTK's format for unstructured grids (vtu), version 1.0.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <vector>

#include "core/base64.h"
#include "core/input_error.h"
#include "core/text_file.h"
#include "core/xml_file.h"
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
  explicit VtuFile(const fs::path& file)
      : file_(file), document_(parted(read_text(file)), file.string(), "a complete vtu file") {
    read_head(document_.child("VTKFile"));
  }

  [[noreturn]] void fault(const std::string& wrong,
                          const std::string& right = "a complete vtu file") const {
    throw InputError({file_.string()}, wrong, right);
  }

  XmlNode piece() const { return piece_; }
  int64_t count(const char* name) const {
    const std::string text(piece_.attribute(name));
    int64_t value = -1;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || stop != text.data() + text.size() || value < 0)
      fault(fmt::format("{}=\"{}\" counts nothing that a file can hold", name, text));
    return value;
  }

  VtuNumbers numbers(const XmlNode& array) const {
    const std::string type(array.attribute("type"));
    const std::string name(array.attribute("Name"));
    if (!detail::is_vtu_type(type)) fault(fmt::format("array '{}' is of type '{}'", name, type));
    try {
      if (array.attribute("format") == "ascii")
        return detail::vtu_numbers_of_text(array.text(), type);
      return detail::vtu_numbers(detail::vtu_bytes(stored(array), format_), type);
    } catch (const InputError&) {
      throw;
    } catch (const std::runtime_error& error) {
      fault(fmt::format("array '{}': {}", name, error.what()));
    }
  }

  /// A child of <Cells>.
  std::vector<int64_t> cells(const char* name) const {
    const VtuNumbers all = numbers(piece_.child("Cells").child("DataArray", "Name", name));
    if (!all.whole && all.size() > 0) fault(fmt::format("the {} of its cells are not whole", name));
    return all.integers;
  }

 private:
  /// Bytes as they are stand behind the XML, which a parser cannot pass: they go to raw_.
  std::string parted(std::string bytes) {
    const size_t begin = bytes.find("<AppendedData");
    const size_t end = std::min(bytes.find('>', begin), bytes.size());
    if (begin == std::string::npos) return bytes;
    const std::string_view tag = std::string_view(bytes).substr(begin, end - begin);
    if (tag.find("\"raw\"") == std::string_view::npos) return bytes;
    const size_t mark = bytes.find('_', end);
    if (mark == std::string::npos) fault("ends before its appended data");
    raw_ = bytes.substr(mark + 1);
    bytes.resize(begin);
    bytes += "</VTKFile>";
    has_raw_ = true;
    return bytes;
  }

  void read_head(const XmlNode& root) {
    const auto told = [&](const char* name) { return std::string(root.attribute(name)); };
    if (told("type") != "UnstructuredGrid")
      fault(fmt::format("is a file of type '{}'", told("type")), "an UnstructuredGrid");
    if (told("byte_order") == "BigEndian")
      fault("its bytes are BigEndian", "a file written on, or for, an ordinary machine");
    if (!told("compressor").empty() && told("compressor") != "vtkZLibDataCompressor")
      fault(fmt::format("is compressed by {}", told("compressor")),
            "a file that is written uncompressed or with zlib");
    format_ = {told("header_type") == "UInt64", !told("compressor").empty()};
    const XmlNode grid = root.child("UnstructuredGrid");
    piece_ = grid.child("Piece");
    if (!piece_) fault("holds no piece of a grid");
    if (piece_.next("Piece"))
      fault("holds several pieces, which share no nodes", "a file of one piece");
    appended_ = root.child("AppendedData").text();
    appended_.remove_prefix(std::min(appended_.find('_'), appended_.size()));
    appended_.remove_prefix(std::min<size_t>(1, appended_.size()));
    for (const XmlNode& array : grid.all("DataArray"))
      if (array.has("offset")) offsets_.push_back(offset(array));
    std::ranges::sort(offsets_);
  }

  std::string stored(const XmlNode& array) const {
    const std::string_view format = array.attribute("format");
    if (format == "appended" && has_raw_) return raw_.substr(checked(offset(array), raw_.size()));
    if (format != "appended" && format != "binary")
      fault(fmt::format("an array's format is '{}'", format), "ascii, binary or appended");
    std::string_view text = array.text();
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

  /// 0 where none is told.
  static unsigned long long offset(const XmlNode& array) {
    const std::string_view text = array.attribute("offset");
    unsigned long long value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  }
  size_t checked(unsigned long long offset, size_t size) const {
    if (offset > size) fault(fmt::format("an array begins at byte {} of {}", offset, size));
    return offset;
  }

  fs::path file_;
  std::string raw_;
  bool has_raw_ = false;
  XmlFile document_;
  XmlNode piece_;
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
  const XmlNode array = vtu.piece().child("Points").child("DataArray");
  const VtuNumbers numbers = vtu.numbers(array);
  const auto points = static_cast<uint64_t>(vtu.count("NumberOfPoints"));
  if (numbers.size() % 3 != 0 || numbers.size() / 3 != points)
    vtu.fault(fmt::format("announces {} points, and holds {} coordinates", points, numbers.size()));
  if (numbers.whole) vtu.fault("its points are whole numbers", "points of type Float32 or Float64");
  return Eigen::Map<const Matrix3Xd>(numbers.reals.data(), 3, static_cast<Eigen::Index>(points));
}

/// `more`: further attributes.
void add_array(std::string& to, const char* type, const std::string& name, Eigen::Index components,
               const void* values, size_t bytes, const std::string& more = "") {
  const auto head = static_cast<uint64_t>(bytes);
  std::string stored(reinterpret_cast<const char*>(&head), sizeof head);
  stored.append(static_cast<const char*>(values), bytes);
  to += fmt::format(
      "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\"{}>{}"
      "</DataArray>\n",
      type, xml_escaped(name), components, more, base64(stored.data(), stored.size()));
}

void add_array(std::string& to, const std::string& name, const Eigen::MatrixXd& values) {
  std::string range;
  if (values.size() > 0) {  // as VTK tells it: of vectors the range of their lengths
    const Eigen::RowVectorXd of =
        values.rows() == 1 ? Eigen::RowVectorXd(values.row(0)) : values.colwise().norm();
    range = fmt::format(" RangeMin=\"{}\" RangeMax=\"{}\"", of.minCoeff(), of.maxCoeff());
  }
  add_array(to, "Float64", name, values.rows(), values.data(),
            sizeof(double) * static_cast<size_t>(values.size()), range);
}

void add_cells(std::string& to, const Eigen::MatrixXi& elements) {
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
  std::string points, cells, nodes, elements;
  for (const VtuArray& array : arrays)
    add_array(array.on_points ? points : cells, array.name, array.values);
  add_array(nodes, "Points", mesh.X);
  add_cells(elements, mesh.elements);
  write_text(file,
             fmt::format("<?xml version=\"1.0\"?>\n"
                         "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                         "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
                         "  <UnstructuredGrid>\n"
                         "    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n"
                         "      <PointData>\n{}      </PointData>\n"
                         "      <CellData>\n{}      </CellData>\n"
                         "      <Points>\n{}      </Points>\n"
                         "      <Cells>\n{}      </Cells>\n"
                         "    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n",
                         mesh.X.cols(), mesh.elements.cols(), points, cells, nodes, elements));
}

Eigen::MatrixXd read_vtu_array(const fs::path& file, const std::string& name, bool on_points) {
  const VtuFile vtu(file);
  const XmlNode from = vtu.piece().child(on_points ? "PointData" : "CellData");
  const XmlNode array = from.child("DataArray", "Name", name);
  if (!array) {
    std::string names;
    for (const XmlNode& one : from.children())
      if (one.name() == "DataArray")
        names += (names.empty() ? "" : ", ") + std::string(one.attribute("Name"));
    vtu.fault(fmt::format("has no array '{}'", name),
              names.empty() ? "a file with results" : "one of " + names);
  }
  const VtuNumbers numbers = vtu.numbers(array);
  const int64_t count = vtu.count(on_points ? "NumberOfPoints" : "NumberOfCells");
  int64_t components = 1;
  const std::string_view told = array.attribute("NumberOfComponents");
  std::from_chars(told.data(), told.data() + told.size(), components);
  if (numbers.whole || components < 1 || std::ssize(numbers.reals) % components != 0 ||
      std::ssize(numbers.reals) / components != count)
    vtu.fault(
        fmt::format("array '{}' is not of {} times {} real numbers", name, count, components));
  return Eigen::Map<const Eigen::MatrixXd>(numbers.reals.data(), components, count);
}

}  // namespace hookeye
