// Decks of FEBio, written as its manual says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture_io/capture.h"
#include "core/text_file.h"
#include "importers/deck.h"
#include "importers/published.h"
#include "meshing/tet_mesh.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

const std::string kFebHead =
    "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n<Module type=\"solid\"/>\n";
const std::string kFebMesh =
    "<Mesh>\n<Nodes name=\"body\">\n<node id=\"1\">0,0,0</node><node id=\"2\">10,0,0</node>\n"
    "<node id=\"3\">10,10,0</node><node id=\"4\">0,10,0</node>\n<node id=\"5\">0,0,10</node>"
    "<node id=\"6\">10,0,10</node>\n<node id=\"7\">10,10,10</node><node id=\"8\">0,10,10</node>\n"
    "</Nodes>\n<Elements type=\"hex8\" name=\"Part1\">\n<elem id=\"1\">1,2,3,4,5,6,7,8</elem>\n"
    "</Elements>\n<NodeSet name=\"Bottom\">1,2,3,4</NodeSet>\n"
    "<Surface name=\"Cover\"><quad4 id=\"1\">5,6,7,8</quad4></Surface>\n</Mesh>\n"
    "<MeshDomains><SolidDomain name=\"Part1\" mat=\"Gel\"/></MeshDomains>\n";

std::string material(const std::string& type, const std::string& numbers) {
  return "<Material><material id=\"1\" name=\"Gel\" type=\"" + type + "\">" + numbers +
         "</material></Material>\n";
}

const std::string kFebGel = material("Mooney-Rivlin",
                                     "<density>1e-9</density><c1>0.02</c1><c2>0.005</c2><k>0.5</k>"
                                     "<pressure_model>Abaqus</pressure_model>");
const std::string kFebFix =
    "<bc name=\"f\" type=\"zero displacement\" node_set=\"Bottom\"><x_dof>1</x_dof>"
    "<y_dof>1</y_dof><z_dof>1</z_dof></bc>";
const std::string kFebTail =
    "<LoadData><load_controller id=\"1\" type=\"loadcurve\"><interpolate>LINEAR</interpolate>"
    "<points><pt>0,0</pt><pt>2,2</pt></points></load_controller></LoadData>\n</febio_spec>\n";
const std::string kFebControl =
    "<Control><time_steps>10</time_steps><step_size>0.1</step_size></Control>\n";

class FebioImport : public testing::Test {
 protected:
  ImportedDeck import(const std::string& deck) {
    write_text(folder_ / "pull.feb", deck);
    return import_decks({folder_ / "pull.feb"}, scratch_.path());
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
  TemporaryFolder folder_, scratch_;
};

TEST_F(FebioImport, IsACapture) {
  const ImportedDeck imported = import(
      kFebHead + kFebControl + kFebGel + kFebMesh + "<Boundary>" + kFebFix +
      "<bc type=\"prescribed displacement\" node_set=\"@surface:Cover\"><dof>z</dof>"
      "<value lc=\"1\">1.5</value></bc></Boundary>\n<Loads><surface_load type=\"pressure\" "
      "surface=\"Cover\"><pressure lc=\"1\">0.01</pressure></surface_load>"
      "<body_load type=\"body force\"><force lc=\"1\">0,0,9810</force></body_load></Loads>\n" +
      kFebTail);
  const Capture capture = read_capture(scratch_.path());
  EXPECT_EQ(imported.elements, 6);
  EXPECT_DOUBLE_EQ(capture.body.density, 1e-9);
  ASSERT_EQ(capture.materials.size(), 1u);
  EXPECT_EQ(capture.materials[0].law, "mooney-rivlin");
  EXPECT_DOUBLE_EQ(capture.materials[0].parameters.at("c01").numbers[0], 0.005);
  EXPECT_DOUBLE_EQ(capture.gravity->z(), -9810);
  ASSERT_EQ(capture.examples.size(), 1u);
  const ExampleSpec& pull = capture.examples[0];
  EXPECT_EQ(pull.name, "pull");
  ASSERT_EQ(pull.supports.size(), 2u);
  EXPECT_THAT(file(imported, "examples.yaml"), HasSubstr("{region: Cover, move: {z: 1.5}}"));
  EXPECT_THAT(file(imported, "examples.yaml"), HasSubstr("{region: Cover, pressure: 0.01}"));
  EXPECT_TRUE(says(imported, "1 hexahedra are split"));
  EXPECT_FALSE(says(imported, "volumetric"));
  EXPECT_NEAR(quality(read_volume(scratch_ / "body.inp", {})).volume, 1000, 1e-9);
}

TEST_F(FebioImport, StepsActOnTopOfWhatHoldsAlways) {
  const auto step = [](const std::string& name, const std::string& inside) {
    return "<step id=\"1\" name=\"" + name + "\">" + kFebControl + inside + "</step>";
  };
  const std::string up =
      "<Boundary><bc type=\"prescribed displacement\" node_set=\"@surface:Cover\"><dof>z</dof>"
      "<value lc=\"1\">1</value><relative>1</relative></bc></Boundary>";
  const ImportedDeck imported =
      import(kFebHead + kFebGel + kFebMesh + "<Boundary>" + kFebFix + "</Boundary><Step>" +
             step("lifted", up) + step("again", up) +
             step("pushed",
                  "<Loads><nodal_load type=\"nodal_force\" node_set=\"@surface:Cover\"><value "
                  "lc=\"1\">0.5,0,0</value></nodal_load></Loads>") +
             "</Step>\n" + kFebTail);
  const std::string examples = file(imported, "examples.yaml");
  ASSERT_EQ(imported.cases.size(), 3u);
  EXPECT_THAT(examples, HasSubstr("  lifted:\n"));
  EXPECT_THAT(examples, HasSubstr("{region: Cover, move: {z: 1}}"));  // curve 1 at time 1
  // Four nodes with 0.5 each at time 3, where the curve is at 2.
  EXPECT_THAT(examples, HasSubstr("force: [4, 0, 0]"));
  EXPECT_THAT(examples, HasSubstr("{region: Cover, move: {z: 3}}"));  // 1 more than 1, times 2
}

TEST_F(FebioImport, LawsOfItsManual) {
  const auto law = [&](const std::string& text) {
    return file(
        import(kFebHead + text + kFebMesh + "<Boundary>" + kFebFix + "</Boundary>" + kFebTail),
        "body.yaml");
  };
  EXPECT_THAT(law(material("neo-Hookean", "<E>3</E><v>0.25</v>")),
              HasSubstr("{law: neo-hookean, mu: 1.2, kappa: 2}"));
  EXPECT_THAT(law(material("incomp neo-Hookean", "<G>0.1</G><k>2</k>")),
              HasSubstr("{law: neo-hookean, mu: 0.1, kappa: 2}"));
  EXPECT_THAT(law(material("Ogden", "<c1>0.75</c1><m1>3</m1><c2>-0.5</c2><m2>-2</m2><k>5</k>")),
              HasSubstr("mu: [0.25, 0.25], alpha: [3, -2], kappa: 5"));
  EXPECT_THAT(law(material("Yeoh", "<c1>0.1</c1><c2>0.01</c2><k>5</k>")),
              HasSubstr("{law: yeoh, c1: 0.1, c2: 0.01, c3: 0, kappa: 5}"));
  EXPECT_THAT(law(material("isotropic elastic", "<E>3</E><v>0.25</v>")),
              HasSubstr("{law: stvk, lambda: 1.2, mu: 1.2}"));
  const ImportedDeck other = import(kFebHead + material("trans iso Mooney-Rivlin", "<c1>1</c1>") +
                                    kFebMesh + "<Boundary>" + kFebFix + "</Boundary>" + kFebTail);
  EXPECT_TRUE(says(other, "trans iso Mooney-Rivlin is not here"));
  EXPECT_THAT(file(other, "body.yaml"), HasSubstr("# not from the deck"));
}

TEST_F(FebioImport, FaultsHaveTheirLines) {
  const std::string rest = "<Boundary>" + kFebFix + "</Boundary>\n" + kFebTail;
  const std::string whole = kFebHead + kFebGel + kFebMesh + rest;
  EXPECT_EQ(refused(whole), "");
  const auto with = [&](const std::string& old, const std::string& now) {
    std::string text = whole;
    text.replace(text.find(old), old.size(), now);
    return refused(text);
  };
  EXPECT_THAT(refused(whole.substr(0, whole.size() / 2)), HasSubstr("pull.feb:"));
  EXPECT_THAT(refused("solid ascii\n"), HasSubstr("pull.feb"));
  EXPECT_THAT(refused("<mesh/>\n"), HasSubstr("there is no <febio_spec>"));
  EXPECT_THAT(with("version=\"4.0\"", "version=\"2.5\""), HasSubstr("pull.feb:2: this is version"));
  EXPECT_THAT(with("1,2,3,4,5,6,7,8", "1,2,3,4,5,6,7,88"),
              HasSubstr("pull.feb:13: element 1 names node 88, which is not there"));
  EXPECT_THAT(with("1,2,3,4,5,6,7,8", "1,2,3,4"), HasSubstr("element 1 has 4 nodes"));
  EXPECT_THAT(with("\"hex8\"", "\"hex20\""), HasSubstr("elements of type hex20 are not read"));
  EXPECT_THAT(with("5,6,7,8</quad4>", "2,4,5,7</quad4>"),
              HasSubstr("this face is no side of one element"));
  EXPECT_THAT(with("node_set=\"Bottom\"", "node_set=\"Botton\""),
              HasSubstr("there is no node set `Botton`"));
  EXPECT_THAT(with("mat=\"Gel\"", "mat=\"Gell\""), HasSubstr("there is no material `GELL`"));
  EXPECT_THAT(with("10,0,0</node>", "10,0</node>"), HasSubstr("<node> has 2 numbers"));
  EXPECT_THAT(with("<k>0.5</k>", "<k>soft</k>"), HasSubstr("pull.feb:4"));
  EXPECT_THAT(with("<k>0.5</k>", ""), HasSubstr("the material lacks <k>"));
  EXPECT_THAT(with("<Mesh>", "<Mesh from=\"m.feb\">"), HasSubstr("in a file of its own"));
}

}  // namespace
}  // namespace hookeye::test
