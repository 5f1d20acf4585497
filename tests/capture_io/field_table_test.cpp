// Tables of displacements: whose columns are known, what is dropped, what is refused and where.
#include "capture_io/field_table.h"

#include <gmock/gmock.h>

#include <fstream>

#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

FieldTable table_of(const std::string& text,
                    const std::map<std::string, std::string>& columns = {}) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "u.csv", std::ios::binary) << text;
  return read_field_table(folder.path() / "u.csv", "u.csv", columns);
}

std::string complaint(const std::string& text,
                      const std::map<std::string, std::string>& columns = {}) {
  try {
    table_of(text, columns);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FieldTable, VicHasPixelsBesideAndMarksWhatIsLost) {
  const FieldTable table = table_of(
      "\"X\", \"Y\", \"Z\", \"U\", \"V\", \"W\", \"x\", \"y\", \"u\", \"v\", \"sigma\"\r\n"
      "1, 2, 3, 0.1, 0.2, 0.3, 100, 200, 5, 6, 0.01\r\n"
      "0, 0, 0, 0, 0, 0, 107, 200, 0, 0, -1\r\n");
  ASSERT_EQ(table.X.cols(), 1);
  EXPECT_EQ(table.X.col(0), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(table.u.col(0), Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(table.lines, std::vector<int>{2});
  EXPECT_EQ(table.dropped_lines, std::vector<int>{3});
  EXPECT_TRUE(table.has_z && table.has_w);
  EXPECT_EQ(table.unit, "");
}

TEST(FieldTable, UnitsStandInTheHeadAndCommasInNumbers) {
  const FieldTable table = table_of(
      "\xEF\xBB\xBF"
      "Coordinates.X [mm];Coordinates.Y [mm];Displacement.U [mm];Displacement.V [mm]\n"
      "1,5;-2,25;1e-3;NaN\n1,5;-2,25;1e-3;+0,5\n");
  ASSERT_EQ(table.X.cols(), 1);
  EXPECT_EQ(table.X.col(0), Eigen::Vector3d(1.5, -2.25, 0));
  EXPECT_EQ(table.u.col(0), Eigen::Vector3d(1e-3, 0.5, 0));
  EXPECT_EQ(table.unit, "mm");
  EXPECT_FALSE(table.has_z || table.has_w);
  EXPECT_EQ(table.dropped_lines, std::vector<int>{2});
}

TEST(FieldTable, DiceTellsOfItsRunAndOfFailedSubsets) {
  const FieldTable flat = table_of(
      "***\n*** Digital Image Correlation Engine\n***\n"
      "SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,SIGMA,STATUS_FLAG\n"
      "0,10,20,0.5,-0.25,0.01,4\n1,30,20,0.5,-0.25,-1,4\n2,50,20,0.5,-0.25,0.01,-2\n");
  EXPECT_EQ(flat.X.cols(), 1);
  EXPECT_EQ(flat.unit, "px");
  EXPECT_EQ(flat.dropped_lines.size(), 2u);
  EXPECT_EQ(flat.lines, std::vector<int>{5});
  const FieldTable stereo = table_of(
      "SUBSET_ID COORDINATE_X COORDINATE_Y DISPLACEMENT_X DISPLACEMENT_Y MODEL_COORDINATES_X "
      "MODEL_COORDINATES_Y MODEL_COORDINATES_Z MODEL_DISPLACEMENT_X MODEL_DISPLACEMENT_Y "
      "MODEL_DISPLACEMENT_Z\n0 10 20 1 1 1 2 3 4 5 6\n");
  EXPECT_EQ(stereo.u.col(0), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(stereo.unit, "");
}

TEST(FieldTable, PyvaleTellsWhatConverged) {
  const FieldTable table = table_of(
      "subset_x,subset_y,displacement_u,displacement_v,displacement_mag,converged,cost\n"
      "10,20,0.5,0.25,0.6,1,0.1\n20,20,0.5,0.25,0.6,0,0.1\n30,20,0.5,0.25,0.6,False,0.1\n");
  EXPECT_EQ(table.X.cols(), 1);
  EXPECT_EQ(table.dropped_lines.size(), 2u);
  EXPECT_EQ(table.unit, "px");
}

TEST(FieldTable, OtherNamesAreTold) {
  const FieldTable table = table_of("px [mm],py [mm],Z,ux [mm],uy [mm],W\n1,2,3,4,5,6\n",
                                    {{"X", "px"}, {"Y", "py [mm]"}, {"U", "ux"}, {"V", "uy"}});
  EXPECT_EQ(table.X.col(0), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(table.u.col(0), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(table.unit, "mm");
}

TEST(FieldTable, WhatIsWrongIsToldWithItsLine) {
  EXPECT_EQ(complaint("X,Y,Z,U,W\n1,2,3,4,5\n"),
            "u.csv:1: of X, Y, Z, U, V, W the file lacks V; it has X, Y, Z, U, W\n"
            "  export all of them; or tell the file's own names: `columns: {X: NAME, Y: NAME, U: "
            "NAME, V: NAME}`");
  EXPECT_THAT(complaint("COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,"
                        "MODEL_COORDINATES_Y,MODEL_COORDINATES_Z,MODEL_DISPLACEMENT_X,"
                        "MODEL_DISPLACEMENT_Y,MODEL_DISPLACEMENT_Z\n1,2,3,4,5,6,7,8,9\n"),
              testing::HasSubstr("the file lacks MODEL_COORDINATES_X; it has COORDINATE_X"));
  EXPECT_THAT(complaint("easting,northing,a,b\n1,2,3,4\n"),
              testing::HasSubstr("u.csv:1: the columns of points and displacements are not found"));
  EXPECT_EQ(complaint("X,Y,U,V\n1,2,3,4\n1,2,abc,4\n"),
            "u.csv:3: `abc` in column 3 is no number\n"
            "  a number, or nan where the point has none");
  EXPECT_EQ(complaint("# by hand\n\nX,Y,U,V\n1,2,3\n"),
            "u.csv:4: the row has 3 cells, the head 4\n"
            "  one cell for every column");
  EXPECT_EQ(complaint("X [mm],Y [mm],U [m],V [m]\n1,2,3,4\n"),
            "u.csv:1: column `U` is in m, others in mm\n"
            "  one unit for all of them");
  EXPECT_EQ(complaint("1,2,3,4\n"),
            "u.csv:1: the table begins without the names of its columns\n"
            "  a first line such as `X,Y,Z,U,V,W`");
  EXPECT_EQ(complaint("# X Y U V\n1 2 3 4\n"),
            "u.csv:2: the table begins without the names of its columns\n"
            "  a first line such as `X,Y,Z,U,V,W` without `#`: line 1 is a comment (np.savetxt: "
            "comments=\"\")");
  EXPECT_EQ(complaint("X,Y,U,V\nnan,2,3,4\n,,,\n"),
            "u.csv: no point is left (2 rows dropped)\n"
            "  rows with numbers for the place and the displacement of a point");
  EXPECT_EQ(complaint("\n\n"),
            "u.csv: the file is empty\n"
            "  a table of points with their displacements");
  EXPECT_EQ(complaint("X,Y,U,V\n", {{"X", "east"}}),
            "u.csv:1: there is no column `east`\n"
            "  the file has X, Y, U, V");
  EXPECT_EQ(complaint(std::string("X,Y,U,V\n1,2,\0,4\n", 16)),
            "u.csv:2: there is a zero byte: this is no text\n"
            "  a table as text, in UTF-8");
}

}  // namespace
}  // namespace hookeye::test
