// Damaged and hostile files: each is refused with its name and what is wrong, and nothing ends the
// program or fills the memory.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cstring>

#include "meshing/surface_mesh.h"
#include "meshing/tet_mesh.h"
#include "shapes.h"
#include "support/needs_helper.h"

namespace hookeye {
namespace {

using test::refusal;
using test::Scratch;
using ::testing::AllOf;
using ::testing::HasSubstr;

const Place kPlace{"capture.yaml", 5, 3};

struct Vtu {
  std::string points = "0 0 0 1 0 0 0 1 0 0 0 1";
  std::string count = "4", cells = "1";
  std::string connectivity = "0 1 2 3", offsets = "4", types = "10";
  std::string str() const {
    return fmt::format(
        R"(<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<UnstructuredGrid><Piece NumberOfPoints="{}" NumberOfCells="{}">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{}</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">{}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{}</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">{}</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>
)",
        count, cells, points, connectivity, offsets, types);
  }
};

class DamagedVtu : public testing::Test {
 protected:
  std::string told(const Vtu& vtu) const {
    return refusal([&] { read_volume(scratch_.write("a.vtu", vtu.str()), kPlace); });
  }
  Scratch scratch_;
};

TEST_F(DamagedVtu, TheWholeOneIsRead) {
  const TetMesh mesh = read_volume(scratch_.write("a.vtu", Vtu().str()), kPlace);
  EXPECT_EQ(mesh.nodes(), 4);
  EXPECT_EQ(mesh.size(), 1);
}

TEST_F(DamagedVtu, FacesOfTheMeshArePassedOverAndOtherBodiesAreNot) {
  const TetMesh mesh = read_volume(scratch_.write("a.vtu", Vtu{.cells = "3",
                                                               .connectivity = "0 1 2 0 1 2 3 0 1",
                                                               .offsets = "3 7 9",
                                                               .types = "5 10 3"}
                                                               .str()),
                                   kPlace);
  EXPECT_EQ(mesh.size(), 1);
  const std::string wedge = told({.points = "0 0 0 1 0 0 0 1 0 0 0 1 1 0 1 0 1 1",
                                  .count = "6",
                                  .cells = "2",
                                  .connectivity = "0 1 2 3 0 1 2 3 4 5",
                                  .offsets = "4 10",
                                  .types = "10 13"});
  EXPECT_THAT(wedge, AllOf(HasSubstr("cell 1 is no tetrahedron"), HasSubstr("kind 13, vtkWedge")));
  EXPECT_THAT(told({.types = "200"}), HasSubstr("kind 200"));
}

TEST_F(DamagedVtu, IndicesAreNotCutToThirtyTwoBits) {
  EXPECT_THAT(told({.connectivity = "0 1 2 4294967299"}),
              AllOf(HasSubstr("cell 0 names node 4294967299"), HasSubstr("0 to 3")));
  EXPECT_THAT(told({.connectivity = "0 1 2 -1"}), HasSubstr("cell 0 names node -1"));
}

TEST_F(DamagedVtu, CountsThatTheFileDoesNotHoldAreRefused) {
  for (const std::string count : {"5", "1000", "2000000000", "9000000000000000000", "-1", "-1e308"})
    EXPECT_THAT(told({.count = count}), HasSubstr("a.vtu")) << count;
  for (const std::string cells : {"2", "1000000000", "4000000000000000000", "-7"})
    EXPECT_THAT(told({.cells = cells}), HasSubstr("a.vtu")) << cells;
  for (const std::string offsets : {"3", "40", "2000000000", "-5", "9000000000000000000"})
    EXPECT_THAT(told({.offsets = offsets}), HasSubstr("a.vtu")) << offsets;
}

TEST_F(DamagedVtu, FilesCutAnywhereAreRefused) {
  const std::string whole = Vtu().str();
  for (size_t length = 0; length < whole.size() - 20; length += 53)
    EXPECT_THAT(
        refusal([&] { read_volume(scratch_.write("a.vtu", whole.substr(0, length)), kPlace); }),
        HasSubstr("a.vtu"))
        << length;
}

class DamagedMsh : public testing::Test {
 protected:
  void SetUp() override { HOOKEYE_NEEDS_GMSH(); }
  std::string told(const std::string& text) const {
    return refusal([&] { read_volume(scratch_.write("a.msh", text), kPlace); });
  }
  Scratch scratch_;
};

TEST_F(DamagedMsh, DimensionsOfGroupsThatAreNone) {
  for (const int dimension : {-1, 4, 7, 1000000})
    EXPECT_THAT(told(fmt::format("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n"
                                 "{} 1 \"a\"\n$EndPhysicalNames\n",
                                 dimension)),
                HasSubstr("a.msh"))
        << dimension;
}

TEST_F(DamagedMsh, ElementsWithOtherNumbersThanTheirKindHas) {
  const std::string head =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
      "$EndNodes\n$Elements\n";
  for (const std::string elements :
       {"2\n1 4 2 1 1 1 2 3 4 1 2 3 4 1 2 3 4\n2 4 2 1 1 1 2 3 4\n", "1\n1 4 2 1 1 1 2\n",
        "1\n1 4 2000000000 1 1 1 2 3 4\n", "1\n1 4 -3 1 1 1 2 3 4\n", "1\n1 999 2 1 1 1 2 3 4\n",
        "2000000000\n1 4 2 1 1 1 2 3 4\n", "-1\n1 4 2 1 1 1 2 3 4\n"})
    EXPECT_THAT(told(head + elements + "$EndElements\n"), HasSubstr("a.msh")) << elements;
}

TEST_F(DamagedMsh, CountsOfNodesThatTheFileDoesNotHold) {
  for (const std::string count : {"4000000000", "2000000000", "-4", "5"})
    EXPECT_THAT(told("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + count +
                     "\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n1\n"
                     "1 4 2 1 1 1 2 3 4\n$EndElements\n"),
                HasSubstr("a.msh"))
        << count;
}

TEST(DamagedInp, RangesTakeNoMemoryThatTheFileDoesNotJustify) {
  const Scratch scratch;
  const std::string body =
      "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n"
      "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n*NSET, NSET=A, GENERATE\n";
  const auto told = [&](const std::string& ranges) {
    return refusal([&] { read_volume(scratch.write("a.inp", body + ranges), kPlace); });
  };
  const TetMesh mesh =
      read_volume(scratch.write("a.inp", body + "1, 3, 1\n3, 3\n4, 1, 1\n"), kPlace);
  EXPECT_EQ(mesh.boundary_groups.at("A").size(), 1u);
  EXPECT_THAT(told("-2147483648, 100000000, 1\n"), HasSubstr("a.inp:9: no such range"));
  EXPECT_THAT(told("1, 2147483647, 1\n"), HasSubstr("a.inp:9: the ranges"));
  EXPECT_THAT(told("1, 9000000, 1\n1, 9000000, 1\n1, 9000000, 1\n"), HasSubstr("a.inp:11"));
  EXPECT_THAT(told("1, 4, 0\n"), HasSubstr("a.inp:9"));
  // The last step passes the end of what an int holds.
  read_volume(scratch.write("a.inp", body + "1, 2147483647, 2147483646\n"), kPlace);
}

/// A binary stl of one triangle that tells another count.
std::string stl(uint32_t count, const std::string& head = "binary") {
  std::string text = head;
  text.resize(80, ' ');
  text.append(reinterpret_cast<const char*>(&count), sizeof count);
  const float corners[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  text.append(reinterpret_cast<const char*>(corners), sizeof corners);
  return text.append(2, '\0');
}

TEST(DamagedStl, CountsThatTheFileDoesNotHold) {
  const Scratch scratch;
  EXPECT_EQ(read_surface(scratch.write("a.stl", stl(1))).triangles.size(), 1u);
  EXPECT_EQ(read_surface(scratch.write("a.stl", stl(1, "solid of a binary"))).triangles.size(), 1u);
  for (const uint32_t count : {2u, 1000000u, 2147483647u, 4294967295u})
    for (const char* head : {"binary", "solid"})
      EXPECT_THAT(
          refusal([&] { read_surface(scratch.write("a.stl", stl(count, head))); }),
          AllOf(HasSubstr("a.stl"),
                HasSubstr(fmt::format("tells {} triangles, the file has room for 1", count))));
}

TEST(DamagedPly, CountsThatTheFileDoesNotHold) {
  const Scratch scratch;
  const auto ply = [](const std::string& vertices, const std::string& faces,
                      const std::string& format) {
    return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
           "\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  };
  EXPECT_EQ(read_surface(scratch.write("a.ply", ply("3", "1", "ascii"))).triangles.size(), 1u);
  for (const char* format : {"ascii", "binary_little_endian"})
    for (const char* count : {"1000", "2000000000", "-1", "99999999999999999999"}) {
      EXPECT_THAT(refusal([&] { read_surface(scratch.write("a.ply", ply(count, "1", format))); }),
                  HasSubstr("a.ply"))
          << format << " " << count;
      EXPECT_THAT(refusal([&] { read_surface(scratch.write("a.ply", ply("3", count, format))); }),
                  HasSubstr("a.ply"))
          << format << " " << count;
    }
}

/// 2^32 + 2 is no node 2.
TEST(DamagedText, IndicesAreNotCutToThirtyTwoBits) {
  const Scratch scratch;
  const std::string far = "4294967298";
  const std::pair<const char*, std::string> surfaces[] = {
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 " + far + " 3\n"},
      {"b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/" + far + " 3/1\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
       "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
       "0 0 0\n1 0 0\n0 1 0\n3 0 1 " +
           far + "\n"}};
  for (const auto& [name, text] : surfaces)
    EXPECT_THAT(refusal([&] { read_surface(scratch.write(name, text)); }),
                AllOf(HasSubstr(name), HasSubstr(far)));
  const std::pair<const char*, std::string> volumes[] = {
      {"a.inp",
       "*NODE\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT,TYPE=C3D4\n1,1," + far + ",3,4\n"},
      {"b.mesh", "4 1 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 1 " + far + " 3\n"}};
  for (const auto& [name, text] : volumes)
    EXPECT_THAT(refusal([&] { read_volume(scratch.write(name, text), kPlace); }),
                AllOf(HasSubstr(name), HasSubstr(far)));
}

TEST_F(DamagedMsh, IndicesAreNotCutToThirtyTwoBits) {
  const std::string far = "4294967298";
  const std::pair<const char*, std::string> volumes[] = {
      {"a.msh",
       "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
       "$EndNodes\n$Elements\n1\n1 4 2 1 1 1 " +
           far + " 3 4\n$EndElements\n"},
      {"a.mesh",
       "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n"
       "Tetrahedra\n1\n1 " +
           far + " 3 4 1\nEnd\n"}};
  for (const auto& [name, text] : volumes)
    EXPECT_THAT(refusal([&] { read_volume(scratch_.write(name, text), kPlace); }),
                AllOf(HasSubstr(name), HasSubstr(far)));
}

}  // namespace
}  // namespace hookeye
