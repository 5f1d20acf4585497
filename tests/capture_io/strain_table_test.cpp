// Tables of strains: columns by the names of their programs, units, measures, and what is refused.
#include <gmock/gmock.h>

#include <fstream>

#include "capture_io/field_table.h"
#include "capture_io/strain_field.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using Columns = std::map<std::string, std::string>;

FieldTable strains_of(const std::string& text, const Columns& columns = {}) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "e.csv", std::ios::binary) << text;
  return read_field_table(folder.path() / "e.csv", "e.csv", columns, FieldHolds::strains);
}

std::string complaint(const std::string& text, const Columns& columns = {}) {
  try {
    strains_of(text, columns);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(StrainTable, VicTellsUnitAndMeasureAndMarksWhatIsLost) {
  const FieldTable table = strains_of(
      "\"X [mm]\",\"Y [mm]\",\"Z [mm]\",\"U [mm]\",\"V [mm]\",\"W [mm]\",\"exx [1] - Lagrange\","
      "\"eyy [1] - Lagrange\",\"exy [1] - Lagrange\",\"e1\",\"gamma\",\"x\",\"y\",\"sigma\"\n"
      "1,2,3,0.1,0.2,0.3,0.01,-0.02,0.005,0.02,0.7,100,200,0.01\n"
      "4,2,3,0,0,0,0,0,0,0,0,110,200,-1\n"
      "5,2,3,nan,0,0,0.01,0.02,0.03,0,0,110,200,0.01\n");
  ASSERT_EQ(table.X.cols(), 2);
  EXPECT_EQ(table.strain.col(0), Eigen::Vector3d(0.01, -0.02, 0.005));
  EXPECT_EQ(table.u.col(0), Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_FALSE(table.u.col(1).allFinite()) << "a strain counts without its displacement";
  EXPECT_TRUE(table.has_u && table.has_w && table.has_exy);
  EXPECT_EQ(table.measure, "green");
  EXPECT_EQ(table.unit, "mm");
  EXPECT_EQ(table.strain_unit, "1");
  EXPECT_EQ(table.dropped_lines.size(), 1u);
}

TEST(StrainTable, MatchIdHasLongNames) {
  const FieldTable table = strains_of(
      "Coordinates.Image X [Pixel],coor.X [mm],coor.Y [mm],coor.Z [mm],"
      "disp.Horizontal Displacement U [mm],disp.Vertical Displacement V [mm],"
      "disp.Out-Of-Plane: W [mm],strain.Strain-global frame: Exx [ ],"
      "strain.Strain-global frame: Eyy [ ],strain.Strain-global frame: Exy [ ]\n"
      "7,1,2,3,0.1,0.2,0.3,0.01,0.02,0.03\n");
  EXPECT_EQ(table.X.col(0), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(table.u.col(0), Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(table.strain.col(0), Eigen::Vector3d(0.01, 0.02, 0.03));
  EXPECT_EQ(table.measure, "") << "its users choose";
}

/// GAMMA is how well a subset matched, and no shear.
TEST(StrainTable, DiceMayHaveNoShear) {
  const FieldTable table = strains_of(
      "***\nCOORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,VSG_STRAIN_XX,VSG_STRAIN_YY,"
      "GAMMA,MATCH\n61,971,-0.17,-1.7,-9.2e-4,2.1e-3,3.2e-3,0\n");
  EXPECT_EQ(table.strain.col(0), Eigen::Vector3d(-9.2e-4, 2.1e-3, 0));
  EXPECT_FALSE(table.has_exy);
  EXPECT_EQ(table.unit, "px");
  EXPECT_EQ(table.measure, "green");
}

TEST(StrainTable, PyvaleHasATensor) {
  const FieldTable flat = strains_of(
      "window_x,window_y,def_grad_00,def_grad_01,def_grad_10,def_grad_11,eps_00,eps_01,eps_10,"
      "eps_11\n10,20,1.01,0,0,1.02,0.01,0.003,0.003,0.02\n");
  EXPECT_EQ(flat.strain.col(0), Eigen::Vector3d(0.01, 0.02, 0.003));
  EXPECT_EQ(flat.unit, "px");
  const FieldTable stereo = strains_of(
      "\"window_x\",\"window_y\",\"x_mm\",\"y_mm\",\"z_mm\",\"eps_00\",\"eps_01\",\"eps_11\"\n"
      "10,20,1,2,3,0.01,0.003,0.02\n");
  EXPECT_EQ(stereo.X.col(0), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(stereo.unit, "mm");
}

TEST(StrainTable, UnitsBecomeFractionsAndGammaIsHalved) {
  const FieldTable table = strains_of("x;y;exx [%];eyy [%];gxy [%]\n1;2;1,5;-0,5;0,4\n");
  EXPECT_NEAR(table.strain(0, 0), 0.015, 1e-15);
  EXPECT_NEAR(table.strain(1, 0), -0.005, 1e-15);
  EXPECT_NEAR(table.strain(2, 0), 0.002, 1e-15);
  EXPECT_NEAR(strains_of("x,y,exx [um/m],eyy [um/m]\n1,2,1500,-500\n").strain(0, 0), 1.5e-3, 1e-15);
  EXPECT_NEAR(strains_of("x,y,exx (mstrain),eyy (mstrain)\n1,2,1.5,-5\n").strain(0, 0), 1.5e-3,
              1e-15);
  EXPECT_NEAR(
      strains_of("x,y,exx [\xC2\xB5\xCE\xB5],eyy [\xC2\xB5\xCE\xB5]\n1,2,1500,0\n").strain(0, 0),
      1.5e-3, 1e-15);
  const FieldTable named =
      strains_of("a,b,across,along,angle\n1,2,0.1,0.2,0.3\n",
                 {{"X", "a"}, {"Y", "b"}, {"EXX", "across"}, {"EYY", "along"}, {"GXY", "angle"}});
  EXPECT_TRUE(named.strain.col(0).isApprox(Eigen::Vector3d(0.1, 0.2, 0.15)));
}

TEST(StrainTable, DisplacementsInAnotherUnitAreNotAskedFor) {
  const FieldTable table = strains_of("X [mm],Y [mm],U [px],V [px],exx,eyy\n1,2,3,4,0.1,0.2\n");
  EXPECT_FALSE(table.has_u);
  EXPECT_EQ(table.unit, "mm");
}

TEST(StrainTable, WhatIsWrongIsToldWithItsLine) {
  EXPECT_EQ(complaint("X,Y,exx\n1,2,3\n"),
            "e.csv:1: there is `exx`, but no strain along y\n"
            "  export both; or tell the other's name: `columns: {EXX: exx, EYY: NAME}`. One gauge "
            "alone is `strain_of`");
  EXPECT_EQ(complaint("X,Y,U,V\n1,2,3,4\n"),
            "e.csv:1: the columns of points and strains are not found in X, Y, U, V\n"
            "  X, Y, exx, eyy and, where they are known, Z and exy; or tell the file's own names: "
            "`columns: {X: NAME, Y: NAME, EXX: NAME, EYY: NAME, EXY: NAME}`, with GXY for 2 EXY");
  EXPECT_EQ(complaint("X,Y,exx [furlong],eyy\n1,2,3,4\n"),
            "e.csv:1: column `exx` is in `furlong`, which is no unit of strains that is known\n"
            "  [1], [%], [mm/m] or [um/m]; mstrain and ustrain are known too");
  EXPECT_EQ(complaint("X,Y,exx [%],eyy [1]\n1,2,3,4\n"),
            "e.csv:1: column `eyy` is in `1`, others in `%`\n  one unit for all strains");
  EXPECT_EQ(complaint("X,Y,exx,eyy\n1,2,3,4\n5,2,3,4\n1,2,3,5\n"),
            "e.csv:4: the point (1, 2, 0) stands in line 2 already\n"
            "  one row a point; a file for each load case and each camera pair");
  EXPECT_EQ(complaint("X,Y,exx,eyy\n1,2,nan,4\n"),
            "e.csv: no point is left (1 rows dropped)\n"
            "  rows with numbers for the place and the strains of a point");
  EXPECT_EQ(complaint("X,Y,exx,eyy,exy\n1,2,3,4,5\n", {{"EXY", "exy"}, {"GXY", "exy"}}),
            "e.csv:1: `columns` names both EXY and GXY\n  one of them: GXY is 2 EXY");
}

TEST(StrainTable, DisplacementsOfAFileOfStrainsAreNotThere) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "e.csv") << "X,Y,exx,eyy\n1,2,3,4\n";
  try {
    read_field_table(folder.path() / "e.csv", "e.csv");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("its strains exx, eyy are read where the capture "
                                                 "says by which measure: `strain: green`"));
  }
}

TEST(StrainTable, MeasuresAndUnitsHaveManyNames) {
  EXPECT_EQ(measure_called(" - Lagrange"), "green");
  EXPECT_EQ(measure_called("Green-Lagrange"), "green");
  EXPECT_EQ(measure_called("log"), "hencky");
  EXPECT_EQ(measure_called("Euler-Almansi"), "almansi");
  EXPECT_EQ(measure_called("mm"), "");
  EXPECT_EQ(fraction_in("m"), 0.0);
  EXPECT_EQ(fraction_in("mm"), 0.0);
}

}  // namespace
}  // namespace hookeye::test
