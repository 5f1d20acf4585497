// Decks of Abaqus as volumes.
#include <gmock/gmock.h>

#include <Eigen/Dense>

#include "shapes.h"

namespace hookeye {
namespace {

using test::refusal;
using test::Scratch;
using ::testing::HasSubstr;

const Place kPlace{"capture.yaml", 5, 3};

std::string inp(const std::string& last = "1, 2, 3, 4, 5, 6, 7, 8,\n 9, 10\n") {
  return "** one C3D10\n*Node, nset=all\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n5,.5,0,0\n6,.5,.5,0\n"
         "7,0,.5,0\n8,0,0,.5\n9,.5,0,.5\n10,0,.5,.5\n*ELEMENT, TYPE=C3D10, ELSET=E1\n1, " +
         last + "*NSET, NSET=FOOT\n1,2,3\n5,6,7\n*NSET,NSET=GEN,GENERATE\n1,3,1\n*END STEP\n";
}

TEST(ReadVolume, InpOrdersMidNodesAndReadsSets) {
  const Scratch scratch;
  const TetMesh mesh = read_volume(scratch.write("a.inp", inp()), kPlace);
  ASSERT_EQ(mesh.order, 2);
  EXPECT_EQ(with_order(with_order(mesh, 1), 2).nodes(), 10);
  EXPECT_EQ(Vector3d(mesh.X.col(mesh.elements(8, 0))), Vector3d(0, .5, .5)) << "mid of 23";
  EXPECT_EQ(Vector3d(mesh.X.col(mesh.elements(9, 0))), Vector3d(.5, 0, .5)) << "mid of 13";
  EXPECT_EQ(mesh.boundary_groups.at("FOOT").size(), 1u);
  EXPECT_EQ(mesh.boundary_groups.at("GEN").size(), 1u);
  EXPECT_EQ(mesh.volume_groups.at("E1").size(), 1u);
}

TEST(ReadVolume, InpFaultsHaveTheirLine) {
  const Scratch scratch;
  const auto fault = [&](const std::string& text) {
    return refusal([&] { read_volume(scratch.write("a.inp", text), kPlace); });
  };
  EXPECT_THAT(fault(inp("1, 2, 3, 4, 5, 6, 7, 8,\n 9, 99\n")),
              HasSubstr("a.inp:15: element 1 names node 99"));
  EXPECT_THAT(fault(inp("1, 2, 3, 4, 5, 6, 7, 8,\n 9\n")), HasSubstr("a.inp:16"));
  EXPECT_THAT(fault(inp("1, 2, 3, 4, 5, 6, 7, x,\n 9, 10\n")), HasSubstr("a.inp:14: 'x'"));
  EXPECT_THAT(fault(inp("1, 3, 2, 4, 7, 6, 5, 8,\n 10, 9\n")), HasSubstr("is inverted"));
  EXPECT_THAT(fault("*NODE\n1,0,0,0\n1,0,0,1\n"), HasSubstr("a.inp:3: node 1 is there twice"));
  EXPECT_THAT(fault("*NODE\n1,0,0,0\n*ELEMENT,TYPE=C3D8\n1,1,1,1,1,1,1,1,1\n"),
              HasSubstr("a.inp:3: elements of type C3D8"));
  EXPECT_THAT(fault("*NODE\n1,0,0,0\n"), HasSubstr("no tetrahedra"));
}

/// The deck of inp() as a part, and an instance of it that is placed by `lines`.
std::string assembly(const std::string& lines) {
  return "*PART, NAME=P\n" + inp() + "*END PART\n*ASSEMBLY, NAME=A\n*INSTANCE, NAME=P-1, PART=P\n" +
         lines + "*END INSTANCE\n*NODE\n11, 7, 7, 7\n*END ASSEMBLY\n";
}

TEST(ReadVolume, InpInstancesStandWhereTheyArePut) {
  const Scratch scratch;
  const auto corner = [&](const std::string& lines, int i) {
    std::vector<std::string> said;
    const TetMesh mesh = read_volume(scratch.write("a.inp", assembly(lines)), kPlace, &said);
    EXPECT_EQ(mesh.nodes(), 10);
    EXPECT_EQ(mesh.boundary_groups.at("FOOT").size(), 1u);
    return Vector3d(mesh.X.col(mesh.elements(i, 0)));
  };
  EXPECT_EQ(corner("", 1), Vector3d(1, 0, 0));
  EXPECT_EQ(corner("10., 20., 30.\n", 1), Vector3d(11, 20, 30));
  // first moved, then turned about the line through (10, 0, 0) along z
  const std::string turned = "10., 0., 5.\n10., 0., 0., 10., 0., 1., 90.\n";
  EXPECT_LT((corner(turned, 0) - Vector3d(10, 0, 5)).norm(), 1e-14);
  EXPECT_LT((corner(turned, 1) - Vector3d(10, 1, 5)).norm(), 1e-14);
  EXPECT_LT((corner(turned, 2) - Vector3d(9, 0, 5)).norm(), 1e-14);
}

TEST(ReadVolume, InpThatMakesOrMovesNodesIsRefused) {
  const Scratch scratch;
  const auto fault = [&](const std::string& text) {
    return refusal([&] { read_volume(scratch.write("a.inp", text), kPlace); });
  };
  EXPECT_THAT(fault(assembly("1., 2.\n1., 2., 3.\n")),
              HasSubstr("a.inp:27: no placement of an instance"));
  EXPECT_THAT(fault(assembly("0, 0, 0\n1, 2, 3, 1, 2, 3, 90\n")),
              HasSubstr("a.inp:27: the axis has no direction"));
  EXPECT_THAT(fault(assembly("*END INSTANCE\n*INSTANCE, NAME=P-2, PART=P\n1, 0, 0\n")),
              HasSubstr("a.inp:27: more than one instance"));
  EXPECT_THAT(fault("*PART, NAME=P\n*END PART\n*PART, NAME=Q\n"),
              HasSubstr("a.inp:3: more than one part"));
  EXPECT_THAT(fault(inp() + "*INSTANCE, NAME=P\n"), HasSubstr("*INSTANCE is not closed"));
  EXPECT_THAT(fault("*SYSTEM\n1, 0, 0\n" + inp()), HasSubstr("a.inp:1: *SYSTEM is not obeyed"));
  EXPECT_THAT(fault("*NODE, SYSTEM=C\n1, 0, 0, 0\n"), HasSubstr("a.inp:1: nodes in coordinates"));
  EXPECT_THAT(fault(inp() + "*NCOPY, CHANGE NUMBER=10, OLD SET=all\n"), HasSubstr("*NCOPY"));
  EXPECT_THAT(fault("*NODE, INPUT=nodes.txt\n"), HasSubstr("a.inp:1: INPUT= is not followed"));
}

TEST(ReadVolume, FoldedCurvedElementIsRefused) {
  const Scratch scratch;
  std::string text = inp();
  const size_t at = text.find("5,.5,0,0");
  text.replace(at, 8, "5,.5,1.9,1.9");
  EXPECT_THAT(refusal([&] { read_volume(scratch.write("a.inp", text), kPlace); }),
              HasSubstr("element 1 at (0, 0, 0) is curved so much that it folds"));
}

}  // namespace
}  // namespace hookeye
