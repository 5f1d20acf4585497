// The only file that touches VTK: ply and stl surfaces, vtu meshes and results.
#include <fmt/format.h>
#include <unistd.h>
#include <vtkCallbackCommand.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkCommand.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkExecutive.h>
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

#include "meshing/detail.h"

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

/// Tries `read` in a process of its own. False: that ended by a signal or without memory.
template <class Read>
bool survives(const Read& read) {
  const pid_t process = fork();
  if (process < 0) return true;
  if (process == 0) {
    detail::die_quietly();
    try {
      read();
    } catch (const InputError&) {  // said by the parent
    } catch (...) {
      _exit(1);
    }
    _exit(0);
  }
  return detail::ended_well(process);
}

}  // namespace

namespace detail {

TriangleSoup read_ply(const std::filesystem::path& file) {
  const auto read = [&] {
    vtkNew<vtkPLYReader> reader;
    return read_with(reader.Get(), file);
  };
  // VTK's reader believes the counts in the file: a file cut short ends the process.
  if (!survives(read))
    throw InputError({file.string()}, "the file is damaged: it does not hold what its header says",
                     "a complete ply file of triangles");
  return read();
}

TriangleSoup read_stl(const std::filesystem::path& file) {
  vtkNew<vtkSTLReader> reader;
  reader->MergingOff();  // merging would drop degenerate triangles and shift all later indices
  return read_with(reader.Get(), file);
}

}  // namespace detail

namespace {

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

}  // namespace

namespace detail {

RawVolume read_vtu(const std::filesystem::path& file, const Place& place) {
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  vtkUnstructuredGrid* grid = load(reader, file, place);
  RawVolume raw;
  raw.X.resize(3, grid->GetNumberOfPoints());
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i) {
    grid->GetPoint(i, raw.X.col(i).data());
  }
  std::vector<vtkIdType> cells;
  int nodes = 0;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c) {
    const int type = grid->GetCellType(c);
    if (type != VTK_TETRA && type != VTK_QUADRATIC_TETRA) continue;
    const int n = type == VTK_TETRA ? 4 : 10;
    if (nodes != 0 && n != nodes) {
      throw InputError(place, fmt::format("cell {} has {} nodes, earlier ones {}", c, n, nodes),
                       "tetrahedra of one order");
    }
    nodes = n;
    cells.push_back(c);
  }
  raw.elements.resize(nodes, static_cast<Eigen::Index>(cells.size()));
  vtkNew<vtkIdList> ids;
  for (size_t e = 0; e < cells.size(); ++e) {
    grid->GetCellPoints(cells[e], ids);
    for (int k = 0; k < nodes; ++k) {
      raw.elements(k, static_cast<Eigen::Index>(e)) = static_cast<int>(ids->GetId(kFromVtk[k]));
    }
    raw.element_names.push_back(std::to_string(cells[e]));
  }
  return raw;
}

}  // namespace detail

namespace {

vtkNew<vtkUnstructuredGrid> grid_of(const TetMesh& mesh) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(mesh.nodes());
  for (int i = 0; i < mesh.nodes(); ++i) points->SetPoint(i, mesh.X.col(i).data());
  grid->SetPoints(points);
  const int n = mesh.nodes_per_element();
  const int type = mesh.order == 1 ? VTK_TETRA : VTK_QUADRATIC_TETRA;
  vtkIdType ids[10];
  grid->Allocate(mesh.size());
  for (int e = 0; e < mesh.size(); ++e) {
    for (int k = 0; k < n; ++k) ids[kFromVtk[k]] = mesh.elements(k, e);
    grid->InsertNextCell(type, n, ids);
  }
  return grid;
}

}  // namespace

void write_vtu(const std::filesystem::path& file, const TetMesh& mesh,
               const std::vector<VtuArray>& arrays) {
  const vtkNew<vtkUnstructuredGrid> grid = grid_of(mesh);
  for (const VtuArray& array : arrays) {
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
  std::filesystem::path partial = file;
  partial += ".part";
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  Listener listener(writer);
  listener.listen_to(writer->GetExecutive());
  writer->SetFileName(partial.c_str());
  writer->SetInputData(grid);
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  const bool written = writer->Write() == 1 && !listener.heard();
  std::error_code failed;
  if (written) std::filesystem::rename(partial, file, failed);
  if (!written || failed) {
    std::filesystem::remove(partial, failed);
    throw cannot_write(file.string());
  }
}

Eigen::MatrixXd read_vtu_array(const std::filesystem::path& file, const std::string& name,
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

}  // namespace hookeye
