// vtu files held against VTK's own reader and writer, in every way in which VTK writes them.
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

#include "meshing/tet_mesh.h"
#include "shapes.h"
#ifdef HOOKEYE_TEST_VTK
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPLYWriter.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkSTLWriter.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>
#include <vtkXMLUnstructuredGridWriter.h>
#endif

namespace hookeye {
namespace {

using test::refusal;
using test::Scratch;
using ::testing::HasSubstr;

const Place kPlace{"capture.yaml", 5, 3};

/// Names of examples are the user's.
const std::string kOddName = "stress <xx> & \"yy\" of é";

TetMesh body(int order) {
  return with_order(fill(test::box_surface({3, 2, 1}, 2), {.edge = 0.7, .order = 1}, kPlace),
                    order);
}

std::vector<VtuArray> arrays_of(const TetMesh& mesh) {
  return {{"displacement", Eigen::MatrixXd::Random(3, mesh.nodes()), true},
          {"stress xx", Eigen::MatrixXd::Random(6, mesh.size()), false},
          {"energy", Eigen::MatrixXd::Random(1, mesh.size()) * 1e-300, false}};
}

TEST(WrittenVtu, IsXmlWithArraysInBase64) {
  const Scratch scratch;
  const TetMesh mesh = body(2);
  write_vtu(scratch / "a.vtu", mesh, {{kOddName, Eigen::MatrixXd::Random(6, mesh.size()), false}});
  std::ifstream in(scratch / "a.vtu");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  for (const std::string part :
       {"type=\"UnstructuredGrid\"", "byte_order=\"LittleEndian\"", "header_type=\"UInt64\"",
        "Name=\"connectivity\"", "Name=\"offsets\"", "Name=\"types\"",
        "Name=\"stress &lt;xx&gt; &amp; &quot;yy&quot; of é\" NumberOfComponents=\"6\" "
        "format=\"binary\""})
    EXPECT_NE(text.find(part), std::string::npos) << part;
  for (const char c : text) ASSERT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= ' ');
}

#ifdef HOOKEYE_TEST_VTK

Eigen::MatrixXd values_of(vtkDataSetAttributes* from, const std::string& name) {
  vtkDataArray* data = from->GetArray(name.c_str());
  if (data == nullptr) return {};
  Eigen::MatrixXd out(data->GetNumberOfComponents(), data->GetNumberOfTuples());
  for (vtkIdType i = 0; i < data->GetNumberOfTuples(); ++i) data->GetTuple(i, out.col(i).data());
  return out;
}

class HeldAgainstVtk : public testing::TestWithParam<int> {
 protected:
  HeldAgainstVtk() : mesh_(body(GetParam())), arrays_(arrays_of(mesh_)) {
    write_vtu(file(), mesh_, arrays_);
    reader_->SetFileName(file().c_str());
    reader_->Update();
  }
  std::filesystem::path file() const { return scratch_ / "a.vtu"; }
  vtkUnstructuredGrid* grid() { return reader_->GetOutput(); }
  void expect_the_same() const {
    const TetMesh back = read_volume(scratch_ / "b.vtu", kPlace);
    EXPECT_EQ(back.X, mesh_.X);
    EXPECT_EQ(back.elements, mesh_.elements);
    for (const VtuArray& array : arrays_)
      EXPECT_EQ(read_vtu_array(scratch_ / "b.vtu", array.name, array.on_points), array.values);
  }
  Scratch scratch_;
  TetMesh mesh_;
  std::vector<VtuArray> arrays_;
  vtkNew<vtkXMLUnstructuredGridReader> reader_;
};

TEST_P(HeldAgainstVtk, WhatIsWrittenIsReadInEveryBit) {
  ASSERT_EQ(grid()->GetNumberOfPoints(), mesh_.nodes());
  ASSERT_EQ(grid()->GetNumberOfCells(), mesh_.size());
  for (int i = 0; i < mesh_.nodes(); ++i)
    EXPECT_EQ(Vector3d(grid()->GetPoint(i)), Vector3d(mesh_.X.col(i)));
  const int per = mesh_.nodes_per_element();
  for (int e = 0; e < mesh_.size(); ++e) {
    ASSERT_EQ(grid()->GetCellType(e), per == 4 ? 10 : 24);
    vtkIdType count = 0;
    const vtkIdType* ids = nullptr;
    grid()->GetCellPoints(e, count, ids);
    ASSERT_EQ(count, per);
    for (int k = 0; k < per; ++k) {
      const int ours = k == 8 ? 9 : k == 9 ? 8 : k;  // VTK ends with the mids of 13 and 23
      EXPECT_EQ(ids[k], mesh_.elements(ours, e));
    }
  }
  for (const VtuArray& array : arrays_) {
    vtkDataSetAttributes* from = array.on_points
                                     ? static_cast<vtkDataSetAttributes*>(grid()->GetPointData())
                                     : grid()->GetCellData();
    EXPECT_EQ(values_of(from, array.name), array.values) << array.name;
  }
}

TEST_P(HeldAgainstVtk, WhatVtkWritesIsReadInEveryBit) {
  using Writer = vtkXMLUnstructuredGridWriter;
  for (const int mode : {Writer::Ascii, Writer::Binary, Writer::Appended})
    for (const bool zlib : {false, true})
      for (const bool encoded : {false, true})
        for (const bool long_heads : {false, true}) {
          vtkNew<Writer> writer;
          writer->SetFileName((scratch_ / "b.vtu").c_str());
          writer->SetInputData(grid());
          writer->SetDataMode(mode);
          writer->SetCompressorType(zlib ? Writer::ZLIB : Writer::NONE);
          writer->SetBlockSize(4096);  // several blocks, the last of them shorter
          writer->SetEncodeAppendedData(encoded);
          if (long_heads)
            writer->SetHeaderTypeToUInt64();
          else
            writer->SetHeaderTypeToUInt32();
          ASSERT_EQ(writer->Write(), 1);
          SCOPED_TRACE(testing::Message() << mode << zlib << encoded << long_heads);
          expect_the_same();
        }
}

TEST_P(HeldAgainstVtk, NamesMayHoldAnything) {
  arrays_[1].name = kOddName;
  write_vtu(scratch_ / "b.vtu", mesh_, arrays_);
  expect_the_same();
  reader_->SetFileName((scratch_ / "b.vtu").c_str());
  reader_->Update();
  EXPECT_EQ(values_of(grid()->GetCellData(), kOddName), arrays_[1].values);
}

TEST_P(HeldAgainstVtk, WhatIsNotReadIsNamed) {
  vtkNew<vtkXMLUnstructuredGridWriter> writer;
  writer->SetFileName((scratch_ / "b.vtu").c_str());
  writer->SetInputData(grid());
  writer->SetCompressorTypeToLZ4();
  ASSERT_EQ(writer->Write(), 1);
  EXPECT_THAT(refusal([&] { read_volume(scratch_ / "b.vtu", kPlace); }),
              testing::AllOf(HasSubstr("vtkLZ4DataCompressor"), HasSubstr("zlib")));
}

INSTANTIATE_TEST_SUITE_P(Orders, HeldAgainstVtk, testing::Values(1, 2));

/// A body of rounded triangles with seams, as VTK holds it.
vtkNew<vtkPolyData> poly_data(const SurfaceMesh& s) {
  vtkNew<vtkPolyData> out;
  vtkNew<vtkPoints> points;
  for (const auto& x : s.X.colwise()) points->InsertNextPoint(x[0] / 3, x[1] / 7, x[2] / 11);
  vtkNew<vtkCellArray> cells;
  for (const auto& [a, b, c] : s.triangles) cells->InsertNextCell({a, b, c});
  out->SetPoints(points);
  out->SetPolys(cells);
  return out;
}

TEST(ScansHeldAgainstVtk, AreTheSameSurface) {
  const Scratch scratch;
  const vtkNew<vtkPolyData> data = poly_data(test::box_surface({3, 2, 1}, 3));
  const auto expect_corners = [&](const std::filesystem::path& file) {
    const SurfaceMesh s = read_surface(file);
    ASSERT_EQ(static_cast<vtkIdType>(s.triangles.size()), data->GetNumberOfPolys());
    vtkNew<vtkIdList> ids;
    for (vtkIdType t = 0; t < data->GetNumberOfPolys(); ++t) {
      data->GetPolys()->GetCellAtId(t, ids);
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(Vector3d(s.X.col(s.triangles[static_cast<size_t>(t)][k])),
                  Vector3d(data->GetPoint(ids->GetId(k))))
            << file;
    }
  };
  for (const bool binary : {false, true}) {
    vtkNew<vtkPLYWriter> ply;
    ply->SetFileName((scratch / "a.ply").c_str());
    ply->SetInputData(data);
    if (binary)
      ply->SetFileTypeToBinary();
    else
      ply->SetFileTypeToASCII();
    ply->Write();
    if (binary) expect_corners(scratch / "a.ply");  // its text has six digits
    EXPECT_EQ(read_surface(scratch / "a.ply").triangles.size(), 108u);
    vtkNew<vtkSTLWriter> stl;
    stl->SetFileName((scratch / "a.stl").c_str());
    stl->SetInputData(data);
    if (binary)
      stl->SetFileTypeToBinary();
    else
      stl->SetFileTypeToASCII();
    stl->Write();
    if (binary) expect_corners(scratch / "a.stl");
    vtkNew<vtkSTLReader> theirs;
    theirs->MergingOff();
    theirs->SetFileName((scratch / "a.stl").c_str());
    theirs->Update();
    const SurfaceMesh ours = read_surface(scratch / "a.stl");
    ASSERT_EQ(theirs->GetOutput()->GetNumberOfPoints(), 3 * std::ssize(ours.triangles));
    for (vtkIdType i = 0; i < theirs->GetOutput()->GetNumberOfPoints(); ++i)
      EXPECT_EQ(Vector3d(theirs->GetOutput()->GetPoint(i)),
                Vector3d(ours.X.col(ours.triangles[static_cast<size_t>(i / 3)][i % 3])));
  }
}

#else

TEST(HeldAgainstVtk, AllOfIt) {
  GTEST_SKIP() << "NOT RUN: VTK is not there to hold vtu, ply and stl against (libvtk9-dev)";
}

#endif

}  // namespace
}  // namespace hookeye
