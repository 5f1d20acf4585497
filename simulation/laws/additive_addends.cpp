#include "simulation/laws/additive_addends.h"

#include <cmath>

namespace hookeye::laws {

CompiledAddend::CompiledAddend(const Addend& addend, int offset)
    : first_(addend.first),
      second_(addend.second),
      offset_(offset),
      even_(addend.even),
      a_(addend.at),
      values_(addend.stiffness) {
  if (second_ >= 0)
    b_.emplace(addend.at_second);
  else
    sum_ = a_.contract(values_);
}

double CompiledAddend::psi(const Strains& e) const {
  const double x = even_ ? std::abs(e[first_]) : e[first_];
  if (!b_) return HatBasis::second_integral(sum_, a_.find(x));
  const SmallVector weighted = grid() * a_.first_integrals(a_.find(x));
  return weighted.dot(b_->first_integrals(b_->find(e[second_])));
}

void CompiledAddend::add(const Strains& e, StrainEnergy& out) const {
  const int a = first_, b = second_;
  if (!b_) {
    const double sign = even_ && e[a] < 0 ? -1.0 : 1.0;
    const auto at = a_.find(sign * e[a]);
    out.psi += HatBasis::second_integral(sum_, at);
    out.d1[a] += sign * HatBasis::first_integral(sum_, at);
    out.d2[a][a] += HatBasis::value(sum_, at);
    return;
  }
  if (values_.size() == 1) {  // lambda a b
    const double k = values_[0];
    out.psi += k * e[a] * e[b];
    out.d1[a] += k * e[b];
    out.d1[b] += k * e[a];
    out.d2[a][b] += k;
    out.d2[b][a] += k;
    return;
  }
  // Psi = sum m_ij h1_i(a) h1_j(b)
  const auto at = a_.find(e[a]), bt = b_->find(e[b]);
  const SmallVector mh = grid() * a_.hats(at), mh1 = grid() * a_.first_integrals(at);
  const SmallVector ms = grid() * a_.slopes(at);
  const SmallVector h = b_->hats(bt), h1 = b_->first_integrals(bt);
  out.psi += mh1.dot(h1);
  out.d1[a] += mh.dot(h1);
  out.d1[b] += mh1.dot(h);
  out.d2[a][a] += ms.dot(h1);
  out.d2[b][b] += mh1.dot(b_->slopes(bt));
  const double mixed = mh.dot(h);
  out.d2[a][b] += mixed;
  out.d2[b][a] += mixed;
}

void CompiledAddend::d1_basis(const Strains& e, Eigen::MatrixX2d& out) const {
  out.setZero(size(), 2);
  const double sign = even_ && e[first_] < 0 ? -1.0 : 1.0;
  const auto at = a_.find(sign * e[first_]);
  if (!b_) {
    out.col(0) = sign * a_.first_integrals(at);
    return;
  }
  const auto bt = b_->find(e[second_]);
  const SmallVector ha = a_.hats(at), ia = a_.first_integrals(at);
  const SmallVector hb = b_->hats(bt), ib = b_->first_integrals(bt);
  for (int i = 0; i < a_.size(); ++i)
    for (int j = 0; j < b_->size(); ++j) {
      out(i * b_->size() + j, 0) = ha[i] * ib[j];
      out(i * b_->size() + j, 1) = ia[i] * hb[j];
    }
}

Eigen::MatrixX3d CompiledAddend::hessian_basis(const Strains& e, Side a, Side b) const {
  Eigen::MatrixX3d out = Eigen::MatrixX3d::Zero(size(), 3);
  const double x = even_ ? std::abs(e[first_]) : e[first_];
  const auto at = a == Side::above ? a_.find(x) : a_.find_below(x);
  if (!b_) {
    out.col(0) = a_.hats(at);
    return out;
  }
  const auto bt = b == Side::above ? b_->find(e[second_]) : b_->find_below(e[second_]);
  const SmallVector ha = a_.hats(at), ia = a_.first_integrals(at), sa = a_.slopes(at);
  const SmallVector hb = b_->hats(bt), ib = b_->first_integrals(bt), sb = b_->slopes(bt);
  for (int i = 0; i < a_.size(); ++i)
    for (int j = 0; j < b_->size(); ++j)
      out.row(i * b_->size() + j) << sa[i] * ib[j], ia[i] * sb[j], ha[i] * hb[j];
  return out;
}

Eigen::Vector3d CompiledAddend::hessian(const Strains& e, Side a, Side b) const {
  return hessian_basis(e, a, b).transpose() * values_;
}

Eigen::MatrixX3d CompiledAddend::curve_basis(double e) const {
  const double sign = even_ && e < 0 ? -1.0 : 1.0;
  const auto at = a_.find(sign * e);
  Eigen::MatrixX3d out(a_.size(), 3);
  out << a_.second_integrals(at), sign * a_.first_integrals(at), a_.hats(at);
  return out;
}

std::vector<CompiledAddend> compile(const AdditiveModel& model) {
  std::vector<CompiledAddend> all;
  int offset = 0;
  for (const Addend& addend : model.addends) {
    all.emplace_back(addend, addend.fixed ? -1 : offset);
    if (!addend.fixed) offset += static_cast<int>(addend.stiffness.size());
  }
  return all;
}

}  // namespace hookeye::laws
