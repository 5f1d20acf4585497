// Decks written as the keyword manuals of Abaqus and CalculiX say.
#include "importers/deck.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture_io/capture.h"
#include "core/text_file.h"
#include "importers/published.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

/// A cube of side 10 in six tetrahedra about its diagonal 1-7, with its bottom and top.
const std::string kMesh =
    "*NODE, NSET=NALL\n1, 0, 0, 0\n2, 10, 0, 0\n3, 10, 10, 0\n4, 0, 10, 0\n5, 0, 0, 10\n"
    "6, 10, 0, 10\n7, 10, 10, 10\n8, 0, 10, 10\n"
    "*ELEMENT, TYPE=C3D4, ELSET=EALL\n11, 1, 2, 3, 7\n12, 1, 3, 4, 7\n13, 1, 4, 8, 7\n"
    "14, 1, 8, 5, 7\n15, 1, 5, 6, 7\n16, 1, 6, 2, 7\n"
    "*NSET, NSET=Bottom\n1, 2, 3, 4\n*NSET, NSET=Cover, GENERATE\n5, 8, 1\n";
const std::string kMaterial =
    "*MATERIAL, NAME=Gel\n*HYPERELASTIC, NEO HOOKE\n0.025, 4.\n*DENSITY\n1.07e-9\n"
    "*SOLID SECTION, ELSET=EALL, MATERIAL=GEL\n";
const std::string kStep =
    "*STEP, NLGEOM\n*STATIC\n0.1, 1.\n*BOUNDARY\nBottom, 1, 3\n*CLOAD\nCover, 3, 0.5\n"
    "*NODE FILE\nU\n*END STEP\n";

class DeckImport : public testing::Test {
 protected:
  ImportedDeck import(const std::string& deck) {
    write_text(folder_ / "pull.inp", deck);
    return import_decks({folder_ / "pull.inp"}, scratch_.path());
  }
  std::string refused(const std::string& deck) {
    return complaint(folder_.path(), [&] { import(deck); });
  }
  static std::string file(const ImportedDeck& imported, const std::string& name) {
    for (const auto& [own, text] : imported.files)
      if (own == name) return text;
    return "";
  }
  static bool says(const ImportedDeck& imported, const std::string& words) {
    for (const std::string& said : imported.said)
      if (said.find(words) != std::string::npos) return true;
    return false;
  }
  /// The material of a deck with these cards.
  std::string law(const std::string& cards) {
    return file(import(kMesh + "*MATERIAL, NAME=GEL\n" + cards +
                       "*SOLID SECTION, ELSET=EALL, MATERIAL=GEL\n" + kStep),
                "body.yaml");
  }

  TemporaryFolder folder_, scratch_;
};

TEST_F(DeckImport, IsACapture) {
  const ImportedDeck imported = import(kMesh + kMaterial + kStep);
  EXPECT_EQ(imported.nodes, 8);
  EXPECT_EQ(imported.elements, 6);
  const Capture capture = read_capture(scratch_.path());
  EXPECT_DOUBLE_EQ(capture.body.density, 1.07e-9);
  ASSERT_EQ(capture.materials.size(), 1u);
  EXPECT_EQ(capture.materials[0].law, "neo-hookean");
  EXPECT_DOUBLE_EQ(capture.materials[0].parameters.at("mu").numbers[0], 0.05);
  EXPECT_DOUBLE_EQ(capture.materials[0].parameters.at("kappa").numbers[0], 0.5);
  ASSERT_EQ(capture.examples.size(), 1u);
  const ExampleSpec& pull = capture.examples[0];
  EXPECT_EQ(pull.name, "pull");
  ASSERT_EQ(pull.supports.size(), 1u);
  EXPECT_EQ(pull.supports[0].region, "Bottom");
  // The same force on each of four nodes is no even spread over two triangles of the top.
  ASSERT_EQ(pull.loads.size(), 1u);
  EXPECT_EQ(pull.loads[0].region, "Cover");
  EXPECT_DOUBLE_EQ(pull.loads[0].force->z(), 2.0);
  EXPECT_TRUE(says(imported, "pull.inp:33: the forces on the nodes of `Cover` are no even spread"));
}

TEST_F(DeckImport, AnEvenSpreadIsTheForceItself) {
  // A diagonal of the top joins 5 and 7: each of its triangles gives a third of itself to them.
  const ImportedDeck imported =
      import(kMesh + kMaterial +
             "*STEP\n*STATIC\n*BOUNDARY\nBottom, ENCASTRE\n*CLOAD\n5, 3, 2.\n7, 3, 2.\n"
             "6, 3, 1.\n8, 3, 1.\n*END STEP\n");
  EXPECT_THAT(file(imported, "examples.yaml"), HasSubstr("{region: Cover, force: [0, 0, 6]}"));
  EXPECT_FALSE(says(imported, "even spread"));
}

TEST_F(DeckImport, PressureActsOnSides) {
  // Side 3 (2-4-3) of 14 is 8-7-5, of 15 (5, 6, 7) the same with 6: the top.
  const ImportedDeck imported = import(
      kMesh + kMaterial +
      "*STEP\n*STATIC\n*BOUNDARY\nBottom, 1, 3\n*DLOAD\n14, P3, 0.02\n15, P3, 0.02\n*END STEP\n");
  EXPECT_THAT(file(imported, "examples.yaml"), HasSubstr("{region: Cover, pressure: 0.02}"));
  const ImportedDeck by_surface = import(
      kMesh + kMaterial +
      "*SURFACE, TYPE=ELEMENT, NAME=LID\n14, S3\n15, S3\n*STEP\n*STATIC\n*BOUNDARY\nBottom, 1, 3\n"
      "*DSLOAD\nLID, P, 0.02\n*END STEP\n");
  EXPECT_EQ(file(by_surface, "examples.yaml"), file(imported, "examples.yaml"));
}

TEST_F(DeckImport, APressureThatEndsWithinAPatchKeepsItsSum) {
  // The nodes of these three sides bound side 1 of element 16, too.
  const ImportedDeck imported =
      import(kMesh + kMaterial +
             "*STEP\n*STATIC\n*BOUNDARY\nBottom, 1, 3\n*DLOAD\n15, P1, 0.02\n15, P3, 0.02\n"
             "16, P3, 0.02\n*END STEP\n");
  EXPECT_THAT(file(imported, "examples.yaml"), HasSubstr("{region: pressed, pressure: 0.015}"));
  EXPECT_TRUE(says(imported, "pull.inp:34: the pressure ends within region pressed"));
  EXPECT_THAT(refused(kMesh + kMaterial + "*STEP\n*STATIC\n*DLOAD\n15, P2, 1\n*END STEP\n"),
              HasSubstr("side 2 of element 15 lies within the body"));
}

TEST_F(DeckImport, StepsKeepWhatWasBefore) {
  const ImportedDeck imported =
      import(kMesh + kMaterial +
             "*BOUNDARY\nBottom, 1, 3\n*STEP, NAME=lift\n*STATIC\n*BOUNDARY\nCover, 3, 3, 2.\n"
             "*END STEP\n*STEP, NAME=turn\n*STATIC\n*BOUNDARY\nCover, 1, 1, 1.\n*END STEP\n"
             "*STEP, NAME=free\n*STATIC\n*BOUNDARY, OP=NEW\nBottom, 3\n2, 1\n*END STEP\n");
  const std::string examples = file(imported, "examples.yaml");
  EXPECT_THAT(examples, HasSubstr("  lift:\n    supports:\n"
                                  "      - {region: Bottom, fix: [x, y, z]}\n"
                                  "      - {region: Cover, move: {z: 2}}\n"));
  EXPECT_THAT(examples, HasSubstr("{region: Cover, move: {x: 1, z: 2}}"));
  EXPECT_THAT(examples, HasSubstr("  free:\n    supports:\n"
                                  "      - {region: Bottom, fix: [z]}\n"
                                  "      - {region: held, fix: [x]}\n"));
}

TEST_F(DeckImport, NodesThatTurnAreARigidSupport) {
  std::string turned = "*STEP\n*STATIC\n*BOUNDARY\nBottom, 1, 3\n";
  const Matrix3d R = turn({0, 0, 1}, 0.3);
  const double corners[4][2] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
  for (int i = 0; i < 4; ++i) {
    const Vector3d X(corners[i][0] - 5, corners[i][1] - 5, 0), u = R * X - X + Vector3d(0, 0, 1);
    for (int k = 0; k < 3; ++k)
      turned += fmt::format("{}, {}, {}, {:.12g}\n", i + 5, k + 1, k + 1, u[k]);
  }
  import(kMesh + kMaterial + turned + "*END STEP\n");
  const ExampleSpec example = read_capture(scratch_.path()).examples.at(0);
  ASSERT_EQ(example.supports.size(), 2u);
  EXPECT_EQ(example.supports[1].region, "Cover");
  const Vector3d at(10, 0, 10);
  EXPECT_LT(
      (example.supports[1].rigid.apply(at) - (R * (at - Vector3d(5, 5, 0)) + Vector3d(5, 5, 1)))
          .norm(),
      1e-8);
}

TEST_F(DeckImport, LawsAreThoseOfTheManuals) {
  EXPECT_THAT(law("*HYPERELASTIC, MOONEY-RIVLIN\n0.02, 0.005, 4.\n"),
              HasSubstr("{law: mooney-rivlin, c10: 0.02, c01: 0.005, kappa: 0.5}"));
  EXPECT_THAT(law("*HYPERELASTIC, YEOH\n0.02, -0.001, 0.0005, 4., 0., 0.\n"),
              HasSubstr("{law: yeoh, c1: 0.02, c2: -0.001, c3: 0.0005, kappa: 0.5}"));
  EXPECT_THAT(law("*HYPERELASTIC, POLYNOMIAL, N=2\n0.02, 0., 0.001, 0., 0., 4., 0.\n"),
              HasSubstr("{law: yeoh, c1: 0.02, c2: 0.001, c3: 0, kappa: 0.5}"));
  EXPECT_THAT(law("*HYPERELASTIC, OGDEN, N=2\n0.03, 2., 0.02, -2., 4., 0.\n"),
              HasSubstr("{law: ogden, mu: [0.03, -0.02], alpha: [2, -2], kappa: 0.5}"));
  EXPECT_THAT(law("*ELASTIC\n0.3, 0.25\n"), HasSubstr("{law: stvk, lambda: 0.12, mu: 0.12}"));
  EXPECT_THAT(law("*HYPERELASTIC, NEO HOOKE\n0.025, 0.\n"),
              HasSubstr("{law: neo-hookean, mu: 0.05, kappa: 1}"));
}

TEST_F(DeckImport, WhatIsLeftOutIsSaidWithItsLine) {
  const ImportedDeck imported =
      import(kMesh + "*MATERIAL, NAME=GEL\n*HYPERELASTIC, ARRUDA-BOYCE\n0.1, 7, 4\n" +
             "*SOLID SECTION, ELSET=EALL, MATERIAL=GEL\n*AMPLITUDE, NAME=RAMP\n0., 0., 1., 0.5\n"
             "*STEP\n*STATIC\n*BOUNDARY\nBottom, 1, 3\n*CLOAD, AMPLITUDE=ramp\nCover, 3, 1.\n"
             "*TEMPERATURE\nNALL, 20.\n*END STEP\n");
  EXPECT_TRUE(says(imported, "pull.inp:22: this law of *HYPERELASTIC is not here"));
  EXPECT_TRUE(says(imported, "pull.inp:31: amplitude ramp: its last value counts, 0.5"));
  EXPECT_TRUE(says(imported, "pull.inp:33: *TEMPERATURE is left out"));
  EXPECT_TRUE(says(imported, "no law could be taken"));
  EXPECT_THAT(file(imported, "examples.yaml"), HasSubstr("force: [0, 0, 2]"));
}

/// As Abaqus/CAE writes: a placed instance, sets of one name in part and assembly, a reference
/// point.
TEST_F(DeckImport, TheAssemblysSetsAreThoseOfTheSteps) {
  std::string mesh = kMesh;
  mesh.replace(mesh.find("*NSET, NSET=Bottom"), std::string::npos, "");
  const ImportedDeck imported =
      import("*Heading\n** Job name: Job-1\n*Part, name=Cube\n" + mesh +
             "*Nset, nset=Set-1, generate\n 1, 8, 1\n*Elset, elset=Set-1\n 11, 12, 13, 14, 15, 16\n"
             "*Solid Section, elset=Set-1, material=Gel\n,\n*End Part\n"
             "*Assembly, name=Assembly\n*Instance, name=Cube-1, part=Cube\n"
             "  100., 0., 0.\n  100., 0., 0., 100., 0., 1., 90.\n*End Instance\n"
             "*Node\n 1, 0., 0., 20.\n*Nset, nset=Set-1, instance=Cube-1\n 1, 2, 3, 4\n"
             "*Nset, nset=Ref\n 1,\n*Elset, elset=_Lid_S3, internal, instance=Cube-1\n 14, 15\n"
             "*Surface, type=ELEMENT, name=Lid\n_Lid_S3, S3\n*End Assembly\n"
             "*Material, name=Gel\n*Hyperelastic, neo hooke\n 0.025, 4.\n"
             "*Step, name=Step-1, nlgeom=YES\n*Static\n0.1, 1., 1e-05, 1.\n"
             "*Boundary\nSet-1, ENCASTRE\n*Dsload\nLid, P, 0.01\n"
             "*Output, field, variable=PRESELECT\n*End Step\n");
  const Capture capture = read_capture(scratch_.path());
  ASSERT_EQ(capture.examples.size(), 1u);
  EXPECT_EQ(capture.examples[0].name, "Step-1");
  EXPECT_EQ(capture.examples[0].supports.at(0).region, "Set-1");
  EXPECT_EQ(capture.examples[0].loads.at(0).region, "pressed");
  EXPECT_TRUE(says(imported, "reference points of the assembly are left out"));
  EXPECT_THAT(file(imported, "body.inp"), HasSubstr("*NSET, NSET=Set-1\n1,2,3,4\n"));
  // Node 3 at (10, 10, 0): shifted, then turned by 90 degrees about the axis through (100, 0, 0).
  const std::string body = file(imported, "body.inp");
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(body.c_str() + body.find("\n3,"), "\n3,%lf,%lf,%lf", &x, &y, &z), 3);
  EXPECT_LT((Eigen::Vector3d(x, y, z) - Eigen::Vector3d(90, 10, 0)).norm(), 1e-9);
}

TEST_F(DeckImport, LoadsOnNodesOfNoTetrahedronAreSaid) {
  std::string deck = kMesh + kMaterial + kStep;
  deck.replace(deck.find("8, 0, 10, 10\n"), 0, "99, 5, 5, 30\n");
  deck.replace(deck.find("*NODE FILE"), 0, "99, 1, 3.\n");
  const ImportedDeck imported = import(deck);
  EXPECT_TRUE(says(imported, "pull.inp:35: node 99 is in no tetrahedron"));
  EXPECT_THAT(file(imported, "examples.yaml"), HasSubstr("force: [0, 0, 2]"));
}

TEST_F(DeckImport, IncludedFilesAreFollowed) {
  write_text(folder_ / "mesh.inp", kMesh);
  const ImportedDeck imported = import("*INCLUDE, INPUT=mesh.inp\n" + kMaterial + kStep);
  EXPECT_EQ(imported.elements, 6);
  EXPECT_EQ(
      refused("*INCLUDE, INPUT=mash.inp\n" + kStep),
      "pull.inp:1: there is no file `mash.inp` to include\n  the included file beside this one");
  EXPECT_THAT(refused("*INCLUDE, INPUT=pull.inp\n"), HasSubstr("files include each other"));
}

TEST_F(DeckImport, FaultsHaveTheirLine) {
  const std::string whole = kMesh + kMaterial + kStep;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    text.replace(text.find(from), from.size(), to);
    return refused(text);
  };
  EXPECT_EQ(with("*END STEP\n", ""),
            "pull.inp:35: the deck ends within a step: it is cut off\n  *END STEP");
  EXPECT_EQ(with("16, 1, 6, 2, 7\n", "16, 1, 6\n"),
            "pull.inp:16: element 16 has 2 nodes\n  4 nodes");
  EXPECT_EQ(with("Cover, 3, 0.5", "Coverr, 3, 0.5"),
            "pull.inp:33: there is no node set `Coverr`\n  did you mean `Cover`?");
  EXPECT_EQ(with("*CLOAD", "*CLAOD"),
            "pull.inp:32: the keyword *CLAOD is not known here\n  did you mean *CLOAD?");
  EXPECT_EQ(with("Bottom, 1, 3\n", "Bottom, 1, 3, fast\n"),
            "pull.inp:31: `fast` is no number\n  a number");
  EXPECT_EQ(with("*NODE,", "*PART, NAME=A\n*END PART\n*PART, NAME=B\n*NODE,"),
            "pull.inp:3: there is a second part\n  one part with one instance at most");
  EXPECT_EQ(with("TYPE=C3D4", "TYPE=C3D20R"),
            "pull.inp:10: elements of type C3D20R are not read\n"
            "  C3D4, C3D10, C3D8 or C3D6: mesh the part anew with them");
  EXPECT_EQ(with("*STEP", "*TRANSFORM, NSET=Cover\n1, 0, 0, 0, 1, 0\n*STEP"),
            "pull.inp:27: *TRANSFORM is not obeyed\n"
            "  nodes, elements and supports written out, in the axes of the body");
  EXPECT_THAT(with("MATERIAL=GEL", "MATERIAL=JELLY"),
              HasSubstr("pull.inp:26: there is no material `JELLY`"));
  EXPECT_THAT(refused(""), HasSubstr("the deck is empty"));
  EXPECT_THAT(refused("hello\n"), HasSubstr("pull.inp:1: the deck does not begin with a keyword"));
}

/// Whatever is cut off: refused, or a capture.
TEST_F(DeckImport, AnyEndIsToldOrTaken) {
  const std::string whole = kMesh + kMaterial + kStep;
  for (size_t size = 0; size < whole.size(); size += 7) {
    const std::string said = refused(whole.substr(0, size));
    if (said.empty()) continue;
    EXPECT_THAT(said, HasSubstr("\n  ")) << size;
  }
}

}  // namespace
}  // namespace hookeye::test
