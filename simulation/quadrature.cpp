#include "simulation/quadrature.h"

namespace hookeye {
namespace {

/// Mid-edge node k (0..5) lies between these corners (gmsh's order).
constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {2, 3}, {1, 3}};
constexpr int kFaceEdges[3][2] = {{0, 1}, {1, 2}, {2, 0}};

TetRule one_point() { return {{Eigen::Vector4d::Constant(0.25)}, {1.0}}; }

TetRule four_points() {
  const double a = 0.58541019662496852, b = 0.1381966011250105;
  TetRule rule;
  for (int i = 0; i < 4; ++i) {
    Eigen::Vector4d p = Eigen::Vector4d::Constant(b);
    p[i] = a;
    rule.points.push_back(p);
    rule.weights.push_back(0.25);
  }
  return rule;
}

FacePoint face_point(int order, double l1, double l2, double weight) {
  const Eigen::Vector3d l(1 - l1 - l2, l1, l2);
  Eigen::Matrix<double, 3, 2> dl;
  dl << -1, -1, 1, 0, 0, 1;
  FacePoint p;
  p.weight = weight;
  p.N.resize(order == 1 ? 3 : 6);
  p.dN.resize(p.N.size(), 2);
  for (int i = 0; i < 3; ++i) {
    p.N[i] = order == 1 ? l[i] : l[i] * (2 * l[i] - 1);
    p.dN.row(i) = (order == 1 ? 1.0 : 4 * l[i] - 1) * dl.row(i);
  }
  for (int e = 0; order == 2 && e < 3; ++e) {
    const int i = kFaceEdges[e][0], j = kFaceEdges[e][1];
    p.N[3 + e] = 4 * l[i] * l[j];
    p.dN.row(3 + e) = 4 * (l[i] * dl.row(j) + l[j] * dl.row(i));
  }
  return p;
}

/// On a corner of the parameter triangle and the two sides from there (opposite ones turn it over).
struct Part {
  double l1, l2, side;
};

/// The rule on each part of the triangle.
std::vector<FacePoint> make_face_rule(int order, const std::vector<Part>& parts) {
  const double a[2] = {0.445948490915964886, 0.091576213509770743};
  const double w[2] = {0.223381589678011466 / 2, 0.109951743655321868 / 2};
  std::vector<FacePoint> rule;
  for (const Part& part : parts) {
    const auto add = [&](double l1, double l2, double weight) {
      rule.push_back(face_point(order, part.l1 + part.side * l1, part.l2 + part.side * l2,
                                part.side * part.side * weight));
    };
    for (int g = 0; g < 2; ++g) {
      const double c = 1 - 2 * a[g];
      add(a[g], a[g], w[g]);
      add(c, a[g], w[g]);
      add(a[g], c, w[g]);
    }
  }
  return rule;
}

}  // namespace

const TetRule& stiffness_rule(int order) {
  static const TetRule rules[2] = {one_point(), four_points()};
  return rules[order - 1];
}

VectorXd shape_values(int order, const Eigen::Vector4d& l) {
  if (order == 1) return l;
  VectorXd N(10);
  for (int i = 0; i < 4; ++i) N[i] = l[i] * (2 * l[i] - 1);
  for (int e = 0; e < 6; ++e) N[4 + e] = 4 * l[kEdges[e][0]] * l[kEdges[e][1]];
  return N;
}

MatrixXd shape_derivatives(int order, const Eigen::Vector4d& l) {
  Eigen::Matrix<double, 4, 3> dl;
  dl << -1, -1, -1, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  if (order == 1) return dl;
  MatrixXd dN(10, 3);
  for (int i = 0; i < 4; ++i) dN.row(i) = (4 * l[i] - 1) * dl.row(i);
  for (int e = 0; e < 6; ++e) {
    const int i = kEdges[e][0], j = kEdges[e][1];
    dN.row(4 + e) = 4 * (l[i] * dl.row(j) + l[j] * dl.row(i));
  }
  return dN;
}

const std::vector<FacePoint>& face_rule(int order) {
  static const std::vector<Part> whole = {{0.0, 0.0, 1.0}};
  static const std::vector<FacePoint> rules[2] = {make_face_rule(1, whole),
                                                  make_face_rule(2, whole)};
  return rules[order - 1];
}

const std::vector<FacePoint>& fine_face_rule(int order) {
  static const std::vector<Part> quarters = {
      {0.0, 0.0, 0.5}, {0.5, 0.0, 0.5}, {0.0, 0.5, 0.5}, {0.5, 0.5, -0.5}};
  static const std::vector<FacePoint> rules[2] = {make_face_rule(1, quarters),
                                                  make_face_rule(2, quarters)};
  return rules[order - 1];
}

}  // namespace hookeye
