// Hexahedra and wedges as tetrahedra: whatever the labels, the volume stays and neighbours match.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "capture_io/capture.h"
#include "core/text_file.h"
#include "importers/deck.h"
#include "importers/deck_split.h"
#include "importers/published.h"
#include "meshing/tet_mesh.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using solver_deck::solid_shape;
using solver_deck::split_solid;
using testing::HasSubstr;

using Triangles = std::set<std::set<int>>;

/// Corners of a unit cube, or of a prism, as the programs count them.
const Vector3d kCube[8] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                           {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
const Vector3d kPrism[6] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}};

double volume(const std::array<int, 4>& t, const std::map<int, Vector3d>& x) {
  Eigen::Matrix3d edges;
  edges << x.at(t[1]) - x.at(t[0]), x.at(t[2]) - x.at(t[0]), x.at(t[3]) - x.at(t[0]);
  return edges.determinant() / 6;
}

/// Sides of the tetrahedra whose nodes are all in the plane x = 1.
Triangles on_plane(const std::vector<std::array<int, 4>>& all, const std::map<int, Vector3d>& x) {
  Triangles out;
  for (const auto& t : all)
    for (int left = 0; left < 4; ++left) {
      std::set<int> side;
      for (int k = 0; k < 4; ++k)
        if (k != left && std::abs(x.at(t[static_cast<size_t>(k)]).x() - 1) < 1e-9)
          side.insert(t[static_cast<size_t>(k)]);
      if (side.size() == 3) out.insert(side);
    }
  return out;
}

TEST(SplitSolid, WhateverTheLabelsTheVolumeStaysAndNeighboursMatch) {
  std::mt19937 random(7);
  std::vector<int> labels(12);
  std::iota(labels.begin(), labels.end(), 1);
  const int next_to[8] = {1, 8, 9, 2, 5, 10, 11, 6};  // the cube beyond x = 1, by index of labels
  for (int round = 0; round < 500; ++round) {
    std::shuffle(labels.begin(), labels.end(), random);
    std::map<int, Vector3d> x;
    std::vector<int> own, other;
    for (int k = 0; k < 8; ++k) {
      own.push_back(labels[static_cast<size_t>(k)]);
      x[own.back()] = kCube[k];
    }
    for (int k = 0; k < 8; ++k) {
      other.push_back(labels[static_cast<size_t>(next_to[k])]);
      x[other.back()] = kCube[k] + Vector3d::UnitX();
    }
    const auto here = split_solid(*solid_shape(8), own),
               there = split_solid(*solid_shape(8), other);
    double sum = 0;
    for (const auto& t : here) {
      EXPECT_GT(volume(t, x), 1e-9);
      sum += volume(t, x);
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_EQ(here.size(), 6u);
    EXPECT_EQ(on_plane(here, x), on_plane(there, x));
    EXPECT_EQ(on_plane(here, x).size(), 2u);
  }
}

TEST(SplitSolid, AWedgeIsThreeTetrahedra) {
  std::mt19937 random(3);
  std::vector<int> labels = {1, 2, 3, 4, 5, 6};
  for (int round = 0; round < 100; ++round) {
    std::shuffle(labels.begin(), labels.end(), random);
    std::map<int, Vector3d> x;
    for (size_t k = 0; k < 6; ++k) x[labels[k]] = kPrism[k];
    double sum = 0;
    const auto all = split_solid(*solid_shape(6), labels);
    for (const auto& t : all) {
      EXPECT_GT(volume(t, x), 1e-9);
      sum += volume(t, x);
    }
    EXPECT_NEAR(sum, 0.5, 1e-12);
    EXPECT_EQ(all.size(), 3u);
  }
}

/// A block of 2 x 2 x 3 hexahedra of side 5, its nodes numbered downwards.
std::string hexahedra(const std::string& type = "C3D8") {
  std::string nodes = "*NODE\n", elements = "*ELEMENT, TYPE=" + type + ", ELSET=EALL\n";
  const auto label = [](int i, int j, int k) { return 100 - (i + 3 * j + 9 * k); };
  std::string bottom = "*NSET, NSET=Bottom\n", top = "*NSET, NSET=Cover\n";
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        nodes += fmt::format("{}, {}, {}, {}\n", label(i, j, k), 5 * i, 5 * j, 5 * k);
        if (k == 0) bottom += fmt::format("{}\n", label(i, j, k));
        if (k == 3) top += fmt::format("{}\n", label(i, j, k));
      }
  int e = 0;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i)
        elements += fmt::format("{}, {}, {}, {}, {}, {}, {}, {}, {}\n", ++e, label(i, j, k),
                                label(i + 1, j, k), label(i + 1, j + 1, k), label(i, j + 1, k),
                                label(i, j, k + 1), label(i + 1, j, k + 1),
                                label(i + 1, j + 1, k + 1), label(i, j + 1, k + 1));
  return nodes + elements + bottom + top +
         "*ELSET, ELSET=UPPER, GENERATE\n9, 12, 1\n*MATERIAL, NAME=GEL\n*HYPERELASTIC, NEO HOOKE\n"
         "0.025, 4.\n*SOLID SECTION, ELSET=EALL, MATERIAL=GEL\n";
}

class SplitDeck : public testing::Test {
 protected:
  ImportedDeck import(const std::string& deck) {
    write_text(folder_ / "pull.inp", deck);
    return import_decks({folder_ / "pull.inp"}, scratch_.path());
  }
  TemporaryFolder folder_, scratch_;
};

TEST_F(SplitDeck, ABlockOfHexahedraKeepsItsVolumeSetsAndSides) {
  // Side 2 of a hexahedron is its top, by the element, by a set and by a surface.
  const std::string step = "*STEP\n*STATIC\n*BOUNDARY\nBottom, 1, 3\n";
  const ImportedDeck by_set = import(hexahedra() + step + "*DLOAD\nUPPER, P2, 0.02\n*END STEP\n");
  EXPECT_EQ(by_set.nodes, 36);
  EXPECT_EQ(by_set.elements, 12 * 6);
  const TetMesh mesh = read_volume(scratch_ / "body.inp", {});
  EXPECT_NEAR(quality(mesh).volume, 10 * 10 * 15, 1e-9);
  // Two triangles a square of the outside: what does not match within would be outside too.
  EXPECT_EQ(mesh.boundary.cols(), 2 * (2 * 4 + 4 * 6));
  const auto examples = [](const ImportedDeck& imported) { return imported.files[2].second; };
  EXPECT_THAT(examples(by_set), HasSubstr("{region: Cover, pressure: 0.02}"));
  EXPECT_THAT(examples(by_set), HasSubstr("{region: Bottom, fix: [x, y, z]}"));
  const ImportedDeck by_element =
      import(hexahedra("C3D8R") + step +
             "*DLOAD\n9, P2, 0.02\n10, P2, 0.02\n11, P2, 0.02\n12, P2, 0.02\n"
             "*END STEP\n");
  EXPECT_EQ(examples(by_element), examples(by_set));
  const ImportedDeck by_surface =
      import(hexahedra() + "*SURFACE, TYPE=ELEMENT, NAME=LID\nUPPER, S2\n" + step +
             "*DSLOAD\nLID, P, 0.02\n*END STEP\n");
  EXPECT_EQ(examples(by_surface), examples(by_set));
  bool said = false;
  for (const std::string& line : by_set.said) said |= line.find("12 hexahedra") != line.npos;
  EXPECT_TRUE(said);
  read_capture(scratch_.path());
}

TEST_F(SplitDeck, WhatCannotBeSplitIsRefusedWithItsLine) {
  const auto refused = [&](const std::string& deck) {
    return complaint(folder_.path(), [&] { import(deck); });
  };
  const std::string cube =
      "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n5, 0, 0, 1\n6, 1, 0, 1\n7, 1, 1, 1\n"
      "8, 0, 1, 1\n";
  EXPECT_THAT(refused(cube + "*ELEMENT, TYPE=C3D8\n1, 5, 6, 7, 8, 1, 2, 3, 4\n"),
              HasSubstr("pull.inp:11: element 1 is twisted or inside out"));
  EXPECT_THAT(refused(cube + "*ELEMENT, TYPE=C3D8\n1, 1, 2, 4, 3, 5, 6, 7, 8\n"),
              HasSubstr("pull.inp:11: element 1 is twisted"));
  EXPECT_THAT(refused(cube + "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 9\n"),
              HasSubstr("pull.inp:11: element 1 names node 9, which is not there"));
  EXPECT_THAT(refused(cube + "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7\n"),
              HasSubstr("element 1 has 7 nodes"));
  EXPECT_THAT(refused(cube + "*ELEMENT, TYPE=C3D20\n1, 1, 2, 3, 4, 5, 6, 7\n"),
              HasSubstr("elements of type C3D20 are not read"));
  EXPECT_THAT(refused(hexahedra() + "*STEP\n*STATIC\n*DLOAD\n9, P7, 1\n*END STEP\n"), "");
  EXPECT_THAT(refused(hexahedra() + "*STEP\n*STATIC\n*DLOAD\n1, P2, 1\n*END STEP\n"),
              HasSubstr("lies within the body"));
  EXPECT_THAT(refused(cube + "*ELEMENT, TYPE=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*ELEMENT, "
                             "TYPE=C3D4\n1, 1, 2, 3, 5\n"),
              HasSubstr("element 1 is there twice"));
}

}  // namespace
}  // namespace hookeye::test
