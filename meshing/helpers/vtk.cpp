// The only file that touches VTK: ply and stl surfaces, vtu meshes and results. A program of its
// own.
#include <fmt/format.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCellTypes.h>
#include <vtkCommand.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkExecutive.h>
#include <vtkGenericCell.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPLYReader.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <fstream>

#include "capture_io/helper_main.h"
#include "meshing/detail.h"
#include "meshing/parcels.h"
#include "meshing/whole_numbers.h"

namespace hookeye {
namespace {

/// VTK's order of the mid nodes of a quadratic tetrahedron: 01 12 02 03 13 23; ours ends 23 13.
constexpr int kFromVtk[10] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

/// Collects what an algorithm reports instead of letting VTK print it.
class Listener {
 public:
  explicit Listener(vtkObject* object) {
    command_->SetClientData(&message_);
    command_->SetCallback([](vtkObject*, unsigned long, void* message, void* text) {
      auto& all = *static_cast<std::string*>(message);
      if (all.empty() && text != nullptr) all = static_cast<const char*>(text);
      if (all.empty()) all = "unknown fault";
    });
    listen_to(object);
  }
  void listen_to(vtkObject* object) {
    object->AddObserver(vtkCommand::ErrorEvent, command_);
    object->AddObserver(vtkCommand::WarningEvent, command_);
  }
  /// Last sentence of VTK's message, on one line.
  std::string message() const {
    std::string text = message_;
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    const size_t colon = text.rfind("): ");
    if (colon != std::string::npos) text = text.substr(colon + 3);
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  }
  bool heard() const { return !message_.empty(); }
  vtkCommand* command() { return command_; }

 private:
  vtkNew<vtkCallbackCommand> command_;
  std::string message_;
};

detail::TriangleSoup soup_of(vtkPolyData* data, const std::filesystem::path& file) {
  detail::TriangleSoup soup;
  const vtkIdType faces = data->GetNumberOfPolys();
  soup.corners.resize(3, 3 * faces);
  vtkDataArray* uv = data->GetPointData()->GetTCoords();
  vtkNew<vtkIdList> corners;
  vtkCellArray* polys = data->GetPolys();
  for (vtkIdType f = 0; f < faces; ++f) {
    polys->GetCellAtId(f, corners);
    if (corners->GetNumberOfIds() != 3) {
      throw InputError({file.string()},
                       fmt::format("face {} has {} corners", f, corners->GetNumberOfIds()),
                       "triangles only: triangulate the surface");
    }
    std::array<Vector2d, 3> corner_uv;
    for (int k = 0; k < 3; ++k) {
      const vtkIdType i = corners->GetId(k);
      if (i < 0 || i >= data->GetNumberOfPoints()) {
        throw InputError({file.string()}, fmt::format("face {} names vertex {}", f, i),
                         fmt::format("an index below {}", data->GetNumberOfPoints()));
      }
      data->GetPoint(i, soup.corners.col(3 * f + k).data());
      if (uv != nullptr) corner_uv[k] = {uv->GetComponent(i, 0), uv->GetComponent(i, 1)};
    }
    if (uv != nullptr) soup.uv.push_back(corner_uv);
  }
  return soup;
}

template <class Reader>
detail::TriangleSoup read_with(Reader* reader, const std::filesystem::path& file) {
  Listener listener(reader);
  listener.listen_to(reader->GetExecutive());
  reader->SetFileName(file.c_str());
  reader->Update();
  if (listener.heard()) {
    throw InputError({file.string()}, "cannot be read: " + listener.message(),
                     "a complete file of triangles");
  }
  return soup_of(reader->GetOutput(), file);
}

/// Faces of a text ply: "3 0 1 2".
void check_ply_numbers(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  bool text = false, faces = false;
  for (int number = 1; std::getline(in, line); ++number) {
    text = text || line.starts_with("format ascii");
    if (line.starts_with("end_header") && !text) return;
    faces = faces || line.starts_with("end_header");
    if (faces) detail::check_whole_numbers(line, {file.string(), number});
  }
}

detail::TriangleSoup read_ply(const std::filesystem::path& file) {
  check_ply_numbers(file);
  vtkNew<vtkPLYReader> reader;
  return read_with(reader.Get(), file);
}

/// A binary file believes its count: it would be allocated. "solid" begins a text, or a binary
/// file whose author did not know that.
void check_stl_count(const std::filesystem::path& file) {
  constexpr std::streamsize kHead = 80;
  constexpr double kTriangle = 50.0;
  char head[kHead + 64] = {};
  uint32_t count = 0;
  std::ifstream in(file, std::ios::binary);
  in.read(head, sizeof head);
  const std::string_view all(head, static_cast<size_t>(in.gcount()));
  if (all.size() < kHead + sizeof count) return;
  const bool text = all.starts_with("solid") && all.find('\0') == std::string_view::npos;
  std::memcpy(&count, head + kHead, sizeof count);
  const double room =
      (static_cast<double>(std::filesystem::file_size(file)) - kHead - sizeof count) / kTriangle;
  if (text || count <= room) return;
  throw InputError({file.string()},
                   fmt::format("the header tells {} triangles, the file has room for {:.0f}", count,
                               std::floor(room)),
                   "a complete stl file of triangles");
}

detail::TriangleSoup read_stl(const std::filesystem::path& file) {
  check_stl_count(file);
  vtkNew<vtkSTLReader> reader;
  reader->MergingOff();  // merging would drop degenerate triangles and shift all later indices
  return read_with(reader.Get(), file);
}

vtkUnstructuredGrid* load(vtkXMLUnstructuredGridReader* reader, const std::filesystem::path& file,
                          const Place& place) {
  if (!std::filesystem::is_regular_file(file)) {
    throw InputError(place, fmt::format("{}: there is no such file", file.string()), "a vtu file");
  }
  Listener listener(reader);
  listener.listen_to(reader->GetExecutive());
  reader->SetReaderErrorObserver(listener.command());
  reader->SetParserErrorObserver(listener.command());
  reader->SetFileName(file.c_str());
  reader->Update();
  const std::string fault = listener.heard() ? listener.message() : std::string();
  reader->RemoveObserver(listener.command());
  reader->SetReaderErrorObserver(nullptr);
  reader->SetParserErrorObserver(nullptr);
  if (!fault.empty()) {
    throw InputError(place, fmt::format("{} cannot be read: {}", file.string(), fault),
                     "a complete vtu file");
  }
  return reader->GetOutput();
}

/// Tetrahedra of one order; whatever else has a volume would leave a hole. Faces, edges and points
/// of the mesh are passed over.
std::vector<vtkIdType> tetrahedra_of(vtkUnstructuredGrid* grid, const Place& file) {
  std::vector<vtkIdType> cells;
  std::map<int, int> dimension_of;
  int order = 0;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    const int type = grid->GetCellType(c);
    const auto [dimension, fresh] = dimension_of.try_emplace(type, 3);
    if (fresh) {
      vtkSmartPointer<vtkCell> cell;
      cell.TakeReference(vtkGenericCell::InstantiateCell(type));
      if (cell) dimension->second = cell->GetCellDimension();
    }
    if (dimension->second < 3) continue;
    if (type != VTK_TETRA && type != VTK_QUADRATIC_TETRA) {
      throw InputError(file,
                       fmt::format("cell {} is no tetrahedron with 4 or 10 nodes (kind {}, {})", c,
                                   type, vtkCellTypes::GetClassNameFromTypeId(type)),
                       "only tetrahedra of order 1 or 2 in the volume");
    }
    if (order != 0 && type != order)
      throw InputError(file, fmt::format("cell {} is of another order than earlier ones", c),
                       "tetrahedra of one order");
    order = type;
    cells.push_back(c);
  }
  return cells;
}

detail::RawVolume read_vtu(const std::filesystem::path& file, const Place& place) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  vtkUnstructuredGrid* grid = load(reader, file, place);
  const Place at{file.string()};
  const vtkIdType points = grid->GetNumberOfPoints();
  detail::RawVolume raw;
  raw.X.resize(3, points);
  for (vtkIdType i = 0; i < points; ++i) grid->GetPoint(i, raw.X.col(i).data());
  const std::vector<vtkIdType> cells = tetrahedra_of(grid, at);
  const int nodes = cells.empty() || grid->GetCellType(cells[0]) == VTK_TETRA ? 4 : 10;
  raw.elements.resize(nodes, static_cast<Eigen::Index>(cells.size()));
  vtkNew<vtkIdList> ids;
  for (size_t e = 0; e < cells.size(); ++e) {
    grid->GetCellPoints(cells[e], ids);
    if (ids->GetNumberOfIds() != nodes)
      throw InputError(at, fmt::format("cell {} has {} nodes", cells[e], ids->GetNumberOfIds()),
                       fmt::format("{} nodes, as earlier ones", nodes));
    for (int k = 0; k < nodes; ++k) {
      const vtkIdType node = ids->GetId(kFromVtk[k]);
      if (node < 0 || node >= points)
        throw InputError(at, fmt::format("cell {} names node {}", cells[e], node),
                         fmt::format("0 to {}: the nodes of the file", points - 1));
      raw.elements(k, static_cast<Eigen::Index>(e)) = static_cast<int>(node);
    }
    raw.element_names.push_back(std::to_string(cells[e]));
  }
  return raw;
}

/// What write_vtu hands over.
struct Results {
  Eigen::Matrix3Xd X;
  Eigen::MatrixXi elements;
  struct Array {
    std::string name;
    Eigen::MatrixXd values;
    bool on_points = true;
  };
  std::vector<Array> arrays;
};

Results unpack_results(Unpacker& from) {
  Results out;
  from.get(out.X);
  from.get(out.elements);
  for (auto n = from.take<uint64_t>(); n > 0; --n) {
    Results::Array array;
    from.get(array.name);
    from.get(array.values);
    from.get(array.on_points);
    out.arrays.push_back(std::move(array));
  }
  return out;
}

vtkNew<vtkUnstructuredGrid> grid_of(const Results& results) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(results.X.cols());
  for (Eigen::Index i = 0; i < results.X.cols(); ++i) points->SetPoint(i, results.X.col(i).data());
  grid->SetPoints(points);
  const auto n = static_cast<int>(results.elements.rows());
  const int type = n == 4 ? VTK_TETRA : VTK_QUADRATIC_TETRA;
  vtkIdType ids[10];
  grid->Allocate(results.elements.cols());
  for (Eigen::Index e = 0; e < results.elements.cols(); ++e) {
    for (int k = 0; k < n; ++k) ids[kFromVtk[k]] = results.elements(k, e);
    grid->InsertNextCell(type, n, ids);
  }
  return grid;
}

bool write(const std::filesystem::path& file, const Results& results) {
  const vtkNew<vtkUnstructuredGrid> grid = grid_of(results);
  for (const Results::Array& array : results.arrays) {
    vtkNew<vtkDoubleArray> data;
    data->SetName(array.name.c_str());
    data->SetNumberOfComponents(static_cast<int>(array.values.rows()));
    data->SetNumberOfTuples(array.values.cols());
    std::copy(array.values.data(), array.values.data() + array.values.size(), data->GetPointer(0));
    vtkDataSetAttributes* to = array.on_points
                                   ? static_cast<vtkDataSetAttributes*>(grid->GetPointData())
                                   : grid->GetCellData();
    to->AddArray(data);
  }
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  Listener listener(writer);
  listener.listen_to(writer->GetExecutive());
  writer->SetFileName(file.c_str());
  writer->SetInputData(grid);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  return writer->Write() == 1 && !listener.heard();
}

Eigen::MatrixXd read_array(const std::filesystem::path& file, const std::string& name,
                           bool on_points) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  vtkUnstructuredGrid* grid = load(reader, file, {file.string()});
  vtkDataSetAttributes* from =
      on_points ? static_cast<vtkDataSetAttributes*>(grid->GetPointData()) : grid->GetCellData();
  vtkDataArray* data = from->GetArray(name.c_str());
  if (data == nullptr) {
    std::string names;
    for (int i = 0; i < from->GetNumberOfArrays(); ++i) {
      names += fmt::format("{}{}", i ? ", " : "", from->GetArrayName(i));
    }
    throw InputError({file.string()}, fmt::format("has no array '{}'", name),
                     names.empty() ? "a file with results" : "one of " + names);
  }
  Eigen::MatrixXd values(data->GetNumberOfComponents(), data->GetNumberOfTuples());
  for (vtkIdType i = 0; i < data->GetNumberOfTuples(); ++i) data->GetTuple(i, values.col(i).data());
  return values;
}

std::string answer(Unpacker& request) {
  const auto task = request.take<std::string>();
  const std::filesystem::path file = request.take<std::string>();
  Packer out;
  if (task == "ply") detail::pack(out, read_ply(file));
  if (task == "stl") detail::pack(out, read_stl(file));
  if (task == "volume") detail::pack(out, read_vtu(file, detail::unpack_place(request)));
  if (task == "array") {
    const auto name = request.take<std::string>();
    out.put(read_array(file, name, request.take<bool>()));
  }
  if (task == "write") {
    const Results results = unpack_results(request);
    out.put(write(file, results));
  }
  return out.take();
}

}  // namespace
}  // namespace hookeye

int main() { return hookeye::serve(hookeye::answer); }
