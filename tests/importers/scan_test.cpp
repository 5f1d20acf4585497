// Textured scans as other programs write them.
#include "importers/scan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture_io/capture.h"
#include "capture_io/image.h"
#include "core/text_file.h"
#include "importers/published.h"
#include "meshing/surface_mesh.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kVertices =
    "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nvt 0.1 0.2\nvt 0.9 0.2\nvt 0.5 0.8\n";
const std::string kFaces = "f 1/1 3/3 2/2\nf 1/1 2/2 4/3\nf 2/2 3/1 4/3\nf 3/1 1/2 4/3\n";
const std::string kObj = "mtllib scan.mtl\n" + kVertices + "usemtl skin\n" + kFaces;

class ScanImport : public testing::Test {
 protected:
  ScanImport() {
    write_image(folder_ / "skin.png", {32, 32, 1, std::vector<float>(32 * 32, 0.5f)});
    write_text(folder_ / "scan.mtl", "newmtl skin\nKd 1 1 1\n  map_Kd skin.png\n");
  }
  ImportedScan import(const std::string& name, const std::string& text, double scale = 1) {
    write_text(folder_ / name, text);
    return import_scan(folder_ / name, scale, scratch_.path());
  }
  std::string refused(const std::string& text, const std::string& name = "scan.obj") {
    return complaint(folder_.path(), [&] { import(name, text); });
  }
  TemporaryFolder folder_, scratch_;
};

TEST_F(ScanImport, IsTheBodyOfACapture) {
  const ImportedScan scan = import("scan.obj", kObj, 10);
  EXPECT_EQ(scan.triangles, 4u);
  EXPECT_EQ(scan.texture, "texture.png");
  EXPECT_EQ(scan.high, Eigen::Vector3d(20, 20, 20));
  EXPECT_THAT(scan.said, IsEmpty());
  const TemporaryFolder out;
  for (const auto& [name, text] : scan.files) write_text(out / name, text);
  EXPECT_EQ(read_text(out / "texture.png"), read_text(folder_ / "skin.png"));
  write_text(out / "capture.yaml",
             "hookeye: 1\nunits: {length: mm, force: N}\n" + read_text(out / "body.yaml") +
                 "model: {material: {law: neo-hookean, mu: 0.05, kappa: 0.5}}\n"
                 "examples: {rest: {}}\n");
  const Capture capture = read_capture(out.path());
  EXPECT_EQ(capture.body.texture, BodySpec::Texture::image);
  const SurfaceMesh told = read_surface(folder_ / "scan.obj"),
                    got = read_surface(capture.body.surface);
  EXPECT_EQ(got.triangles, told.triangles);
  EXPECT_LT((got.X - 10 * told.X).norm(), 1e-12);
  ASSERT_EQ(got.uv.size(), told.uv.size());
  for (size_t t = 0; t < told.uv.size(); ++t)
    for (size_t k = 0; k < 3; ++k) EXPECT_EQ(got.uv[t][k], told.uv[t][k]);
}

TEST_F(ScanImport, PlyNamesItsPictureInAComment) {
  const ImportedScan scan = import(
      "scan.ply",
      "ply\nformat ascii 1.0\ncomment TextureFile skin.png\nelement vertex 4\nproperty float x\n"
      "property float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\n"
      "property list uchar float texcoord\nend_header\n0 0 0\n2 0 0\n0 2 0\n0 0 2\n"
      "3 0 2 1 6 0.1 0.2 0.5 0.8 0.9 0.2\n3 0 1 3 6 0.1 0.2 0.9 0.2 0.5 0.8\n"
      "3 1 2 3 6 0.1 0.2 0.9 0.2 0.5 0.8\n3 2 0 3 6 0.1 0.2 0.9 0.2 0.5 0.8\n");
  EXPECT_EQ(scan.texture, "texture.png");
  EXPECT_THAT(scan.files[0].second, HasSubstr("vt 0.5 0.8"));
}

TEST_F(ScanImport, WhatItLacksIsSaid) {
  EXPECT_THAT(import("scan.obj", kVertices + kFaces).said,
              ElementsAre(HasSubstr("the scan names no texture")));
  EXPECT_THAT(
      import("scan.obj", "mtllib scan.mtl\n" + kVertices + "f 1/1 3/3 2/2\nf 1/1 2/2 4/3\n").said,
      ElementsAre(HasSubstr("the surface bounds no body yet")));
}

TEST_F(ScanImport, MaterialsThatAreNotUsedDoNotCount) {
  write_text(folder_ / "scan.mtl",
             "newmtl other\nmap_Kd other.png\nnewmtl skin\nmap_Kd -s 1 1 1 skin.png\n");
  EXPECT_EQ(import("scan.obj", kObj).texture, "texture.png");
}

TEST_F(ScanImport, FaultsHaveTheirLine) {
  EXPECT_EQ(refused("mtllib scam.mtl\n" + kVertices + kFaces),
            "scan.obj:1: there is no file scam.mtl\n"
            "  the materials beside the obj; without a texture take the line out");
  write_text(folder_ / "scan.mtl", "newmtl a\nmap_Kd skin.png\nnewmtl b\nmap_Kd skin2.png\n");
  EXPECT_EQ(
      refused("mtllib scan.mtl\n" + kVertices + "usemtl a\nf 1/1 3/3 2/2\nusemtl b\n" + kFaces),
      "scan.mtl:4: the texture is in several pictures: skin.png and skin2.png\n"
      "  a capture has one: export the scan with one texture page");
  write_text(folder_ / "scan.mtl", "newmtl skin\nmap_Kd skim.png\n");
  EXPECT_EQ(refused(kObj),
            "scan.mtl:2: there is no picture skim.png\n  the picture where the scan names it");
  write_text(folder_ / "scan.mtl", "newmtl skin\nmap_Kd skin.png\n");
  EXPECT_EQ(refused("mtllib scan.mtl\nv 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nf 1 3 2\nf 1 2 4\n"
                    "f 2 3 4\nf 3 1 4\n"),
            "scan.obj: there is a texture, and no texture coordinates\n"
            "  an export with texture coordinates on all triangles");
  EXPECT_THAT(refused("v 0 0\n"), HasSubstr("scan.obj"));
}

}  // namespace
}  // namespace hookeye::test
