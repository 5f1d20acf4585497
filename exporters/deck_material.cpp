// Materials and springs of a deck.
//
// Abaqus' and CalculiX's *HYPERELASTIC have the volumetric energy 1/D1 (J - 1)^2, which is kappa/2
// (J - 1)^2 with D1 = 2/kappa: there is no difference to the energy here at any J. NEO HOOKE C10 =
// mu/2; OGDEN sum 2 mu_i/alpha_i^2 (...), which is mu_i/alpha_i (...) with mu_i alpha_i/2.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <cmath>
#include <iterator>

#include "exporters/deck.h"
#include "simulation/quadrature.h"

namespace hookeye::deck {
namespace {

bool fits_ogden(const Rubber& r, const Dialect& dialect) {
  return r.c20 == 0 && r.c30 == 0 && r.as_ogden().size() <= dialect.most_ogden_terms;
}

/// Up to eight numbers a line.
std::string lines(const std::vector<double>& values) {
  std::string out;
  for (size_t i = 0; i < values.size(); ++i)
    out += number(values[i]) + (i + 1 == values.size() || i % 8 == 7 ? "\n" : ",");
  return out;
}

std::string rubber_cards(const Rubber& r, const Dialect& dialect) {
  const double D1 = 2.0 / r.some_kappa();
  if (!r.ogden.empty() && fits_ogden(r, dialect)) {
    const auto terms = r.as_ogden();
    std::vector<double> values;
    for (const auto& [mu, alpha] : terms) values.insert(values.end(), {0.5 * mu * alpha, alpha});
    values.push_back(D1);
    values.resize(3 * terms.size(), 0.0);
    return fmt::format("*HYPERELASTIC, OGDEN, N={}\n{}", terms.size(), lines(values));
  }
  // Powers of the stretches that do not fit enter by their shear modulus at rest.
  double c10 = r.c10;
  for (const auto& [mu, alpha] : r.ogden) c10 += 0.25 * mu * alpha;
  if (r.c20 == 0 && r.c30 == 0 && r.c01 == 0)
    return "*HYPERELASTIC, NEO HOOKE\n" + lines({c10, D1});
  if (r.c20 == 0 && r.c30 == 0) return "*HYPERELASTIC, MOONEY-RIVLIN\n" + lines({c10, r.c01, D1});
  if (r.c01 == 0) return "*HYPERELASTIC, YEOH\n" + lines({c10, r.c20, r.c30, D1, 0.0, 0.0});
  return "*HYPERELASTIC, POLYNOMIAL, N=3\n" +
         lines({c10, r.c01, r.c20, 0, 0, r.c30, 0, 0, 0, D1, 0, 0});
}

std::string linear_cards(const Stiffness6& C) {
  const double mu = C(5, 5), lambda = C(0, 1);
  Stiffness6 isotropic = Stiffness6::Zero();
  isotropic.topLeftCorner<3, 3>().setConstant(lambda);
  isotropic.diagonal().head<3>().array() += 2 * mu;
  isotropic.diagonal().tail<3>().setConstant(mu);
  if ((C - isotropic).norm() <= 1e-12 * C.norm())
    return "*ELASTIC\n" +
           lines({mu * (3 * lambda + 2 * mu) / (lambda + mu), lambda / (2 * (lambda + mu))});
  constexpr int order[] = {0, 1, 2, 5, 4, 3};  // 11 22 33 12 13 23
  std::vector<double> values;
  for (int b = 0; b < 6; ++b)
    for (int a = 0; a <= b; ++a) values.push_back(C(order[a], order[b]));
  return "*ELASTIC, TYPE=ANISO\n" + lines(values);
}

/// Share of a node in the bed's stiffness: its row sum over the faces.
std::map<int, Eigen::Matrix3d> lumped(const TetMesh& mesh, const FoundationOn& bed) {
  std::map<int, Eigen::Matrix3d> out;
  for (const auto& [face, fraction] : bed.faces) {
    const MatrixXd x = mesh.X(Eigen::all, mesh.boundary.col(face));
    for (const FacePoint& g : face_rule(mesh.order)) {
      const Eigen::Matrix<double, 3, 2> t = x * g.dN;
      const Vector3d normal = t.col(0).cross(t.col(1)), n = normal.normalized();
      const Eigen::Matrix3d nn = n * n.transpose();
      const Eigen::Matrix3d k =
          (fraction * g.weight * normal.norm()) *
          (bed.k_normal * nn + bed.k_tangent * (Eigen::Matrix3d::Identity() - nn));
      for (Eigen::Index a = 0; a < x.cols(); ++a) {
        auto [at, isnew] = out.try_emplace(mesh.boundary(a, face), Eigen::Matrix3d::Zero());
        at->second += g.N[a] * k;
      }
    }
  }
  return out;
}

}  // namespace

bool has_both(const SolverMaterial& material) {
  return !material.rubber.none() && !material.linear.isZero(0.0);
}

std::string material_cards(const SolverModel& model, const SolverMaterial& material, double factor,
                           const Dialect& dialect) {
  std::string out;
  const auto add = [&](const std::string& set, const std::string& cards, bool heavy) {
    out += fmt::format("*MATERIAL, NAME={}\n{}", set, cards);
    if (heavy) out += fmt::format("*DENSITY\n{}\n", number(model.density));
    if (model.energy.swelling.size() > 0) out += "*EXPANSION, ZERO=0.\n1.\n";
    out += fmt::format("*SOLID SECTION, ELSET={0}, MATERIAL={0}\n", set);
  };
  const bool both = has_both(material), linear = material.rubber.none();
  if (!linear) add(material.name, rubber_cards(material.rubber.scaled(factor), dialect), true);
  if (linear || both)
    add(both ? material.name + "_L" : material.name, linear_cards(material.linear * factor), !both);
  return out;
}

std::vector<std::string> material_lacks(const SolverModel& model, const Dialect& dialect) {
  std::vector<std::string> out;
  bool ogden = false, elastic = false, soft = false;
  for (const SolverMaterial& m : model.materials) {
    ogden |= !m.rubber.ogden.empty() && !fits_ogden(m.rubber, dialect);
    elastic |= !m.linear.isZero(0.0) && !dialect.elastic_by_green;
    soft |= !m.rubber.none() && m.rubber.kappa == 0;
  }
  if (ogden)
    out.push_back(fmt::format(
        "powers of the stretches beside powers of I1bar, or more than {} of them, are not in one "
        "*HYPERELASTIC: they enter by their shear modulus at rest",
        dialect.most_ogden_terms));
  if (elastic)
    out.push_back(dialect.program +
                  "'s *ELASTIC is linear between Cauchy stress and logarithmic strain, not between "
                  "second Piola-Kirchhoff stress and Green strain: it agrees at small strains");
  if (soft)
    out.push_back(
        "a hyperelastic part has no bulk modulus of its own, and *HYPERELASTIC needs one: it has a "
        "millionth of its shear modulus");
  return out;
}

std::string spring_cards(const SolverModel& model, const SolverCase& one, int first_element) {
  std::string out;
  int element = first_element;
  for (const FoundationOn& bed : one.foundations) {
    const auto shares = lumped(model.mesh(), bed);
    double largest = 0.0;
    for (const auto& [node, k] : shares) largest = std::max(largest, k.norm());
    for (const auto& [node, k] : shares) {
      if (k.norm() < 1e-9 * largest) continue;  // corners of quadratic faces have none
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(k);
      const bool along_mesh = Eigen::Matrix3d(k.diagonal().asDiagonal()).isApprox(k, 1e-9);
      std::string turned;
      if (!along_mesh) {
        turned = fmt::format(", ORIENTATION=O{}", element);
        const auto& V = axes.eigenvectors();
        out += fmt::format("*ORIENTATION, NAME=O{}\n", element) +
               lines({V(0, 0), V(1, 0), V(2, 0), V(0, 1), V(1, 1), V(2, 1)});
      }
      for (int i = 0; i < 3; ++i) {
        const double stiffness = along_mesh ? k(i, i) : axes.eigenvalues()[i];
        out += fmt::format(
            "*ELEMENT, TYPE=SPRING1, ELSET=S{0}\n{0},{1}\n*SPRING, ELSET=S{0}{2}\n"
            "{3}\n{4}\n",
            element, node + 1, turned, i + 1, number(stiffness));
        ++element;
      }
    }
  }
  return out;
}

}  // namespace hookeye::deck
