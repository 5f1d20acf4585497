// ply and stl, as programs write them and as they must not be.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "meshing/surface_mesh.h"
#include "shapes.h"

namespace hookeye {
namespace {

using test::refusal;
using test::Scratch;
using ::testing::AllOf;
using ::testing::HasSubstr;

template <class T>
std::string bytes_of(T value, bool big = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  if (big) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

class Scan : public testing::Test {
 protected:
  SurfaceMesh read(const std::string& name, const std::string& content) const {
    return read_surface(scratch_.write(name, content));
  }
  std::string told(const std::string& name, const std::string& content) const {
    return refusal([&] { read(name, content); });
  }
  Scratch scratch_;
};

const std::string kFacet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1.1 0\n"
    " endloop\nendfacet\n";

TEST_F(Scan, TextOfAnStlInAnyCaseAndLayoutAndOfSeveralSolids) {
  const SurfaceMesh plain = read("a.stl", "solid a b facet\n" + kFacet + "endsolid a b facet\n");
  ASSERT_EQ(plain.triangles.size(), 1u);
  EXPECT_EQ(plain.X(1, 2), static_cast<double>(1.1f)) << "single precision, as in a binary file";
  std::string upper = "SOLID\n" + kFacet + "ENDSOLID\n", returns;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  EXPECT_EQ(read("a.stl", upper).X, plain.X);
  for (const char c : "solid\n" + kFacet + "endsolid")
    returns += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(read("a.stl", returns).X, plain.X);
  const std::string one = "solid a\n" + kFacet + "endsolid a\n";
  EXPECT_EQ(read("a.stl", one + one).triangles.size(), 2u);
  std::string no_normal = one;
  no_normal.replace(no_normal.find("0 0 1"), 5, "nan nan nan");
  EXPECT_EQ(read("a.stl", no_normal).X, plain.X);
}

TEST_F(Scan, FaultsOfATextStlHaveTheirLine) {
  const std::string whole = "solid a\n" + kFacet + "endsolid a\n";
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(told("a.stl", with("vertex 1 0 0", "vertex 1 zero 0")), HasSubstr("a.stl:5: 'zero'"));
  EXPECT_THAT(told("a.stl", with("vertex 1 0 0", "vertex nan 0 0")), HasSubstr("a.stl:5: 'nan'"));
  EXPECT_THAT(told("a.stl", with("vertex 1 0 0", "vertex 1e39 0 0")), HasSubstr("a.stl:5"));
  EXPECT_THAT(told("a.stl", with("  vertex 1 0 0\n", "")), HasSubstr("face 0 has 2 corners"));
  EXPECT_THAT(told("a.stl", with("vertex 1 0 0\n", "vertex 1 0 0\nvertex 1 0 0\n")),
              HasSubstr("face 0 has 4 corners"));
  EXPECT_THAT(told("a.stl", with("outer", "outre")), HasSubstr("a.stl:3: 'outre'"));
  for (size_t length = 0; length < whole.find("endsolid") + 8; length += 7)
    EXPECT_THAT(told("a.stl", whole.substr(0, length)), HasSubstr("a.stl")) << length;
}

TEST_F(Scan, ABinaryStlWithACornerThatIsNotFinite) {
  std::string file(80, ' ');
  file += bytes_of(uint32_t{1});
  for (const float x : {0.f, 0.f, 1.f, 0.f, 0.f, 0.f, std::nanf(""), 0.f, 0.f, 0.f, 1.f, 0.f})
    file += bytes_of(x);
  EXPECT_THAT(told("a.stl", file + "\0\0" + std::string(2, '\0')),
              HasSubstr("corner 1 of triangle 0 is not a finite number"));
}

/// A square of two triangles, with whatever stands beside its coordinates and faces.
struct Ply {
  std::string format = "ascii", vertex_more = "", face_more = "", type = "float";
  std::string vertices[4] = {"0 0 0", "1 0 0", "1 1.1 0", "0 1.1 0"};
  std::string faces[2] = {"3 0 1 2", "3 0 2 3"};
  std::string str() const {
    std::string out = fmt::format(
        "ply\nformat {} 1.0\ncomment by hand\nelement vertex 4\nproperty {} x\nproperty {} y\n"
        "property {} z\n{}element face 2\nproperty list uchar int vertex_indices\n{}end_header\n",
        format, type, type, type, vertex_more, face_more);
    for (const std::string& v : vertices) out += v + "\n";
    for (const std::string& f : faces) out += f + "\n";
    return out;
  }
};

TEST_F(Scan, PlyKeepsThePrecisionThatItTells) {
  EXPECT_EQ(read("a.ply", Ply().str()).X(1, 2), static_cast<double>(1.1f));
  EXPECT_EQ(read("a.ply", Ply{.type = "double"}.str()).X(1, 2), 1.1);
}

TEST_F(Scan, PlyTakesTextureFromVerticesOrFromFaces) {
  for (const auto& [u, v] : {std::pair("u", "v"), {"s", "t"}, {"texture_u", "texture_v"}}) {
    Ply ply{.vertex_more =
                fmt::format("property uchar red\nproperty float {}\nproperty float {}\n", u, v)};
    for (int i = 0; i < 4; ++i) ply.vertices[i] += fmt::format(" 255 0.{} 0.{}", i, i + 1);
    const SurfaceMesh s = read("a.ply", ply.str());
    ASSERT_EQ(s.uv.size(), 2u);
    EXPECT_EQ(s.uv[1][2], Vector2d(0.3f, 0.4f));
    EXPECT_EQ(s.X.cols(), 4);
  }
  Ply seams{.face_more = "property list uchar float texcoord\nproperty int texnumber\n"};
  for (int i = 0; i < 2; ++i) seams.faces[i] += fmt::format(" 6 0.{} 0 1 0 1 1 0", i + 5);
  const SurfaceMesh s = read("a.ply", seams.str());
  ASSERT_EQ(s.uv.size(), 2u);
  EXPECT_EQ(s.uv[0][0], Vector2d(0.5f, 0.0));
  EXPECT_EQ(s.uv[1][0], Vector2d(0.6f, 0.0));
  EXPECT_EQ(s.uv[1][2], Vector2d(1.0, 1.0));
  seams.faces[1] = "3 0 2 3 0 0";
  EXPECT_THAT(told("a.ply", seams.str()), HasSubstr("1 of 2 faces have texture coordinates"));
}

TEST_F(Scan, BinaryPlyIsTheSameAsText) {
  const SurfaceMesh text = read("a.ply", Ply().str());
  for (const bool big : {false, true}) {
    std::string file = Ply{.format = big ? "binary_big_endian" : "binary_little_endian"}.str();
    file.resize(file.find("end_header\n") + 11);
    for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.1f, 0.f, 0.f, 1.1f, 0.f})
      file += bytes_of(x, big);
    for (const auto& face : {std::array{0, 1, 2}, {0, 2, 3}}) {
      file += bytes_of(uint8_t{3});
      for (const int32_t i : face) file += bytes_of(i, big);
    }
    const SurfaceMesh s = read("a.ply", file);
    EXPECT_EQ(s.X, text.X);
    EXPECT_EQ(s.triangles, text.triangles);
    for (size_t length = 0; length < file.size(); length += 13)
      EXPECT_THAT(told("a.ply", file.substr(0, length)), HasSubstr("a.ply")) << length;
  }
}

TEST_F(Scan, FaultsOfATextPlyHaveTheirLine) {
  Ply ply;
  ply.vertices[1] = "1 nix 0";
  EXPECT_THAT(told("a.ply", ply.str()), HasSubstr("a.ply:12: 'nix' is no finite number"));
  EXPECT_THAT(told("a.ply", Ply{.type = "quad"}.str()), HasSubstr("a.ply:5: 'quad' is no type"));
  EXPECT_THAT(told("a.ply", Ply{.format = "text"}.str()), HasSubstr("a.ply:2: 'text'"));
  ply = {};
  ply.faces[1] = "3 0 2 4";
  EXPECT_THAT(told("a.ply", ply.str()),
              AllOf(HasSubstr("face 1 names vertex 4"), HasSubstr("below 4")));
  ply.faces[1] = "3 0 -1 2";
  EXPECT_THAT(told("a.ply", ply.str()), HasSubstr("face 1 names vertex -1"));
  ply.faces[1] = "4 0 1 2 3";
  EXPECT_THAT(told("a.ply", ply.str()), HasSubstr("face 1 has 4 corners"));
  ply.faces[1] = "-1";
  EXPECT_THAT(told("a.ply", ply.str()), HasSubstr("a.ply"));
  EXPECT_THAT(told("a.ply", "ply\nformat ascii 1.0\nelement nothing 4000000000\nend_header\n"),
              HasSubstr("element nothing has no properties"));
}

}  // namespace
}  // namespace hookeye
