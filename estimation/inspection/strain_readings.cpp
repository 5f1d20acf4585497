#include "estimation/inspection/strain_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "estimation/model/strain_measure.h"
#include "estimation/model/strain_points.h"

namespace hookeye::inspection {

namespace {

/// Where the surface's tangents went by the displacements of the points near one; false: they are
/// too few to tell.
bool tangents_from(const FieldSpec& field, Eigen::Index point, double reach, const Tangents& T,
                   Tangents* A) {
  const StrainSpec& strain = *field.strain;
  std::vector<Eigen::Index> near;
  for (Eigen::Index k = 0; k < field.X.cols(); ++k)
    if ((field.X.col(k) - field.X.col(point)).norm() <= reach && strain.u.col(k).allFinite())
      near.push_back(k);
  constexpr size_t kLeast = 4;
  if (near.size() < kLeast) return false;
  const auto n = static_cast<Eigen::Index>(near.size());
  Eigen::MatrixX3d plane(n, 3);
  plane.col(0).setOnes();
  plane.rightCols<2>() = (field.X(Eigen::all, near).colwise() - field.X.col(point)).transpose() * T;
  Eigen::ColPivHouseholderQR<Eigen::MatrixX3d> qr(plane);
  qr.setThreshold(0.05);  // as far across as along, nearly
  if (qr.rank() < 3) return false;
  const Eigen::MatrixX3d fitted = qr.solve(strain.u(Eigen::all, near).transpose());
  *A = T + fitted.bottomRows<2>().transpose();
  return true;
}

}  // namespace

std::vector<StrainReading> out_of_displacements(const TetMesh& mesh, const FieldSpec& told,
                                                const InspectionOptions& options) {
  const StrainSpec& strain = *told.strain;
  if (strain.u.cols() == 0 || told.spacing <= 0.0) return {};
  const BoundaryLocator locator(mesh);
  const std::vector<Tangents> tangents = strain_tangents(mesh, told, locator);
  const double reach = std::max(0.5 * strain.gauge, options.steps_about * told.spacing);
  std::vector<StrainMeasure> measures{strain.measure};
  for (size_t i = 0; i < strain_measures().size(); ++i)
    if (const auto one = static_cast<StrainMeasure>(i); one != strain.measure)
      measures.push_back(one);
  std::vector<StrainReading> out;
  for (const StrainMeasure one : measures)
    out.push_back({VectorXd::Constant(told.components * told.X.cols(),
                                      std::numeric_limits<double>::quiet_NaN()),
                   fmt::format("they are {} strains", name_of(one)),
                   fmt::format("`strain: {}`", name_of(one))});
  const Eigen::Index step =
      std::max<Eigen::Index>(1, told.X.cols() / std::max(1, options.strain_points));
  for (Eigen::Index k = 0; k < told.X.cols(); k += step) {
    const Tangents& T = tangents[static_cast<size_t>(k)];
    Tangents A;
    if (!tangents_from(told, k, reach, T, &A)) continue;
    for (size_t i = 0; i < measures.size(); ++i)
      out[i].expected.segment(told.components * k, told.components) =
          strain_by(measures[i], A, T).e.head(told.components);
  }
  return out;
}

std::vector<StrainReading> other_readings(const FieldSpec& told, const StrainReading& right) {
  std::vector<StrainReading> out{right};
  const auto changed = [&](double xy, bool swap, const std::string& is, const std::string& fix) {
    StrainReading one{right.expected, is, fix};
    for (Eigen::Index k = 0; k < told.X.cols(); ++k) {
      auto e = one.expected.segment(told.components * k, told.components);
      if (swap) std::swap(e[0], e[1]);
      if (told.components == 3) e[2] *= xy;
    }
    out.push_back(std::move(one));
  };
  changed(1.0, true, "exx and eyy are in each other's places",
          "`axes` whose first is along exx, or the other names in `columns`");
  if (told.components < 3) return out;
  changed(
      -1.0, false, "exy has the other sign",
      "`axes` (or `frame`) with the y of the program that wrote it: of pictures it points down");
  changed(2.0, false, "its shear is gamma = 2 exy",
          "`columns: {GXY: NAME}` for the column of the shear");
  changed(
      -2.0, false, "its shear is gamma = 2 exy, and of the other sign",
      "`columns: {GXY: NAME}` for the column of the shear, and `axes` with the y of the program "
      "that wrote it");
  return out;
}

}  // namespace hookeye::inspection
