// The first guess of thin bodies against beams and plates, and fields of displacements against it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "core/text_file.h"
#include "estimation/inspection/inspection.h"
#include "inspection/inspected_capture.h"

namespace hookeye::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kMu = 0.3, kKappa = 1.5;  // MPa
double young() { return 9.0 * kKappa * kMu / (3.0 * kKappa + kMu); }

/// A sheet of 60 x 20 mm held at its left end; `end` says what happens to the right one.
class Sheet {
 public:
  Sheet(double thickness, int order, const std::string& end, const std::string& measured = "")
      : thickness_(thickness) {
    std::string obj;
    for (const double z : {0.0, thickness})
      for (const auto& [x, y] : {std::pair{0, 0}, {60, 0}, {60, 20}, {0, 20}})
        obj += fmt::format("v {} {} {}\n", x, y, z);
    for (const char* face : {"1 3 2", "1 4 3", "5 6 7", "5 7 8", "1 2 6", "1 6 5", "2 3 7", "2 7 6",
                             "3 4 8", "3 8 7", "4 1 5", "4 5 8"})
      obj += fmt::format("f {}\n", face);
    write_text(folder_ / "sheet.obj", obj);
    write_text(folder_ / "capture.yaml",
               fmt::format(R"(hookeye: 1
units: {{length: mm, force: N}}
body: {{surface: sheet.obj, mesh: {{edge: 3, order: {}}}}}
model:
  material: {{law: neo-hookean, mu: {}, kappa: {}}}
  fit: [mu]
regions:
  left: {{box: [[-0.1, -1, -1], [0.1, 21, 9]]}}
  right: {{box: [[59.9, -1, -1], [60.1, 21, 9]]}}
examples:
  load:
    supports: [{{region: left, fix: [x, y, z]}}]
    loads: [{{region: right, force: {}}}]
{})",
                           order, kMu, kKappa, end,
                           measured.empty() ? "" : "    measured: [" + measured + "]\n"));
  }
  void write_field(const std::function<Vector3d(const Vector3d&)>& u,
                   const char* name = "u.csv") const {
    std::string table = "X [mm],Y [mm],Z [mm],U [mm],V [mm],W [mm]\n";
    for (int x = 3; x < 60; x += 3)
      for (int y = 2; y < 20; y += 3) {
        const Vector3d X(x, y, thickness_), at = u(X);
        table += fmt::format("{},{},{},{:.6f},{:.6f},{:.6f}\n", x, y, thickness_, at.x(), at.y(),
                             at.z());
      }
    write_text(folder_ / name, table);
  }
  Inspection inspect() const { return hookeye::inspect(*load_scene(read_capture(folder_.path()))); }

 private:
  double thickness_;
  TemporaryFolder folder_;
};

double bent_by(double force, double thickness) {
  const double I = 20.0 * std::pow(thickness, 3) / 12.0;
  return force * std::pow(60.0, 3) / (3.0 * young() * I);
}

TEST(ThinBody, ASheetBendsAsBeamTheorySays) {
  for (const double thickness : {1.0, 2.0})
    for (const int order : {1, 2}) {
      const double force = 1e-4 * std::pow(thickness, 3);
      const Sheet sheet(thickness, order, fmt::format("[0, 0, {:.6g}]", force));
      const Inspection seen = sheet.inspect();
      ASSERT_EQ(seen.guesses.size(), 1U) << seen.no_guess;
      // A wide beam lies between beam and plate; the clamp adds a little.
      EXPECT_NEAR(seen.guesses[0].first_order / bent_by(force, thickness), 0.95, 0.1)
          << thickness << " " << order;
      if (order == 2)
        EXPECT_EQ(said(seen), "");
      else
        EXPECT_THAT(said(seen), AllOf(HasSubstr("thin_mesh: "), HasSubstr("capture.yaml:3"),
                                      HasSubstr("they lock"), HasSubstr("order: 2")));
    }
}

/// Pulled along, one layer of linear tetrahedra is as good as any.
TEST(ThinBody, ASheetInTensionDoesNotLock) {
  const Inspection seen = Sheet(1.0, 1, "[0.1, 0, 0]").inspect();
  EXPECT_EQ(said(seen), "");
}

constexpr const char* kField = "{field: u.csv, sigma: 0.01}";

/// To first order, of a beam pulled by `force` along it.
Vector3d pulled(double force, double thickness, const Vector3d& X) {
  const double strain = force / (20.0 * thickness * young());
  const double nu = (3.0 * kKappa - 2.0 * kMu) / (2.0 * (3.0 * kKappa + kMu));
  return strain * Vector3d(X.x(), -nu * (X.y() - 10.0), -nu * (X.z() - 0.5 * thickness));
}

TEST(ThinBody, ARightFieldIsLeftInPeace) {
  const Sheet sheet(1.0, 2, "[0.1, 0, 0]", kField);
  sheet.write_field([](const Vector3d& X) { return pulled(0.1, 1.0, X); });
  const Inspection seen = sheet.inspect();
  EXPECT_EQ(said(seen), "");
  ASSERT_EQ(seen.fields.size(), 1U);
  EXPECT_GT(seen.fields[0].cosine, 0.99);
  EXPECT_NEAR(seen.fields[0].seen / seen.fields[0].expected, 1.0, 0.05);
}

TEST(ThinBody, AFieldThatMovesAsAWholeIsToldAsThat) {
  const Sheet sheet(1.0, 2, "[0.1, 0, 0]", kField);
  sheet.write_field([](const Vector3d& X) {
    return Vector3d(pulled(0.1, 1.0, X) + Vector3d(0.3, 0.2, 4.2) +
                    Vector3d(0.0, 0.01, 0.0).cross(X));
  });
  const Inspection seen = sheet.inspect();
  EXPECT_THAT(said(seen), HasSubstr("magnitudes: "));
  EXPECT_THAT(said(seen), HasSubstr("once a rigid motion is out of both"));
  EXPECT_THAT(said(seen), HasSubstr("capture.yaml:14"));
}

TEST(ThinBody, AFieldInAnotherUnitIsTold) {
  const Sheet sheet(1.0, 2, "[0.1, 0, 0]", kField);
  sheet.write_field([](const Vector3d& X) { return Vector3d(100.0 * pulled(0.1, 1.0, X)); });
  EXPECT_THAT(said(sheet.inspect()), HasSubstr("times as far as the first guess"));
  EXPECT_THAT(said(sheet.inspect()), Not(HasSubstr("rigid")));
}

TEST(ThinBody, FieldsInOneAnothersPlacesAreTold) {
  const std::string push =
      "]\n  push:\n    supports: [{region: left, fix: [x, y, z]}]\n"
      "    loads: [{region: right, force: [-0.05, 0, 0]}]\n"
      "    measured: [{field: v.csv, sigma: 0.01}";
  const Sheet sheet(1.0, 2, "[0.1, 0, 0]", kField + push);
  const auto write = [&](double first, double second) {
    sheet.write_field([&](const Vector3d& X) { return pulled(first, 1.0, X); });
    sheet.write_field([&](const Vector3d& X) { return pulled(second, 1.0, X); }, "v.csv");
  };
  write(0.1, -0.05);
  EXPECT_EQ(said(sheet.inspect()), "");
  write(-0.05, 0.1);
  EXPECT_THAT(said(sheet.inspect()),
              AllOf(HasSubstr("exchanges: "), HasSubstr("u.csv shows the motion of example `push`"),
                    HasSubstr("v.csv shows the motion of example `load`")));
}

TEST(ThinBody, AForceInAnotherUnitThanThePrescribedMotionTakesIsTold) {
  const double force = young() * 20.0 * 0.06 / 60.0;  // N
  for (const double unit : {1.0, 1e-3}) {
    const std::string moved = fmt::format(
        "]\n  moved:\n    supports: [{{region: left, fix: [x, y, z]}}, {{region: right, move: "
        "{{x: 0.06}}}}]\n    measured: [{{force_on: right, value: [{:.6g}, 0, 0], sigma: 1e-6}}",
        unit * force);
    const Sheet sheet(1.0, 2, "[0.1, 0, 0]", kField + moved);
    sheet.write_field([](const Vector3d& X) { return pulled(0.1, 1.0, X); });
    if (unit == 1.0)
      EXPECT_EQ(said(sheet.inspect()), "");
    else
      EXPECT_THAT(said(sheet.inspect()), AllOf(HasSubstr("measured_values: "),
                                               HasSubstr("of about 0.001 times those told"),
                                               HasSubstr("capture.yaml:17")));
  }
}

}  // namespace
}  // namespace hookeye::test
