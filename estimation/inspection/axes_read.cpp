#include "estimation/inspection/axes_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace hookeye::inspection {

namespace {

constexpr char kAxis[] = {'x', 'y', 'z'};

/// All 48, that as told the first.
std::vector<AxesRead> all_readings() {
  std::vector<AxesRead> out;
  std::array<int, 3> from{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      AxesRead one;
      one.from = from;
      for (size_t k = 0; k < 3; ++k) one.sign[k] = (signs >> k) & 1 ? -1 : 1;
      out.push_back(one);
    }
  } while (std::next_permutation(from.begin(), from.end()));
  return out;
}

/// What told vectors are held against.
class Comparison {
 public:
  Comparison(const ToldVectors& vectors, std::vector<int> columns, const InspectionOptions& options)
      : vectors_(vectors), columns_(std::move(columns)), options_(options) {
    if (columns_.empty()) {
      columns_.resize(static_cast<size_t>(vectors.told.cols()));
      std::iota(columns_.begin(), columns_.end(), 0);
    }
    for (int k = 0; k < 3; ++k) sure_expected_[static_cast<size_t>(k)] = is_expected(k);
  }

  bool says(const AxesRead& one, int axis) const {
    const auto k = static_cast<size_t>(axis);
    return sure_expected_[k] && vectors_.sure_told[static_cast<size_t>(one.from[k])];
  }

  /// `one` fits well, and clearly better than `other` on the axes where they differ. A sign needs
  /// an axis that says something.
  bool beats(const AxesRead& one, const AxesRead& other) const {
    std::array<bool, 3> axes{};
    bool any = false;
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<size_t>(k);
      axes[at] = one.from[at] != other.from[at] || one.sign[at] != other.sign[at];
      if (!axes[at]) continue;
      if (one.sign[at] < 0 && !says(one, k)) return false;
      any = any || says(one, k);
    }
    if (!any) return false;
    // A direction that is off by what a slip explains leaves that much.
    const double well = 1.0 - options_.sure_cosine * options_.sure_cosine;
    const double before = left(other, axes), now = left(one, axes);
    return before >= options_.left_of_exchanged && now <= well &&
           now <= options_.left_by_exchange * before;
  }

  /// All axes that say something have the other sign.
  bool is_whole(const AxesRead& one) const {
    for (int k = 0; k < 3; ++k) {
      const auto at = static_cast<size_t>(k);
      if (one.from[at] != k) return false;
      if (one.sign[at] > 0 && says(one, k)) return false;
    }
    return true;
  }

  /// Share of the squares on `axes` that is left if `one` is how vectors are told, in the way to
  /// expect that leaves least.
  double left(const AxesRead& one, const std::array<bool, 3>& axes) const {
    const Matrix3Xd told = one.of(vectors_.told);
    double least = 1e300;
    for (const Matrix3Xd& expected : vectors_.expected)
      least = std::min(least, left_against(told, expected, axes));
    return least;
  }

 private:
  /// More than a slip in one of the vectors, and the same to first order and in equilibrium.
  bool is_expected(int axis) const {
    bool matters = false;
    double both = 0.0, first = 0.0, last = 0.0;
    for (const int c : columns_) {
      const auto expected = vectors_.expected.back().col(c);
      const double along = std::pow(expected[axis], 2);
      matters = matters || (vectors_.sure[static_cast<size_t>(c)] &&
                            along > options_.left_of_exchanged * expected.squaredNorm());
      both += expected[axis] * vectors_.expected.front()(axis, c);
      first += std::pow(vectors_.expected.front()(axis, c), 2), last += along;
    }
    return matters && both >= options_.sure_cosine * std::sqrt(first * last);
  }

  bool is_read(int column) const {
    return std::binary_search(columns_.begin(), columns_.end(), column);
  }

  /// The factor of scaled columns: by those that are not read otherwise, where there are some.
  double factor(const Matrix3Xd& told, const Matrix3Xd& expected) const {
    std::array<double, 2> both{}, expected2{};  // of others, of those that are read
    for (int c = 0; c < told.cols(); ++c) {
      if (!vectors_.scaled[static_cast<size_t>(c)]) continue;
      const size_t of = is_read(c) ? 1 : 0;
      both[of] += (is_read(c) ? told : vectors_.told).col(c).dot(expected.col(c));
      expected2[of] += expected.col(c).squaredNorm();
    }
    const size_t by = both[0] > 0.0 ? 0 : 1;
    return expected2[by] > 0.0 ? std::max(both[by] / expected2[by], 0.0) : 1.0;
  }

  double left_against(const Matrix3Xd& told, const Matrix3Xd& expected,
                      const std::array<bool, 3>& axes) const {
    const double times = factor(told, expected);
    double left = 0.0, all = 0.0;
    for (const int c : columns_)
      for (int k = 0; k < 3; ++k) {
        if (!axes[static_cast<size_t>(k)]) continue;
        const double by = vectors_.scaled[static_cast<size_t>(c)] ? times : 1.0;
        left += std::pow(told(k, c) - by * expected(k, c), 2);
        all += std::pow(told(k, c), 2);
      }
    return all > 0.0 ? left / all : 0.0;
  }

  const ToldVectors& vectors_;
  std::vector<int> columns_;
  InspectionOptions options_;
  std::array<bool, 3> sure_expected_{};
};

}  // namespace

bool AxesRead::changes(int axis) const {
  const auto k = static_cast<size_t>(axis);
  return from[k] != axis || sign[k] < 0;
}

int AxesRead::count() const {
  return static_cast<int>(changes(0)) + static_cast<int>(changes(1)) + static_cast<int>(changes(2));
}

Matrix3Xd AxesRead::of(const Matrix3Xd& told) const {
  Matrix3Xd out(3, told.cols());
  for (int k = 0; k < 3; ++k)
    out.row(k) = sign[static_cast<size_t>(k)] * told.row(from[static_cast<size_t>(k)]);
  return out;
}

std::string AxesRead::in_words() const {
  std::string signs, places;
  bool plain = true;
  int moved = 0;
  for (int k = 0; k < 3; ++k) {
    const auto at = static_cast<size_t>(k);
    if (from[at] == k && sign[at] < 0)
      signs += fmt::format("{}{}", signs.empty() ? "" : " and ", kAxis[k]);
    if (from[at] == k) continue;
    ++moved;
    plain = plain && sign[at] > 0;
    places += fmt::format("{}{} is the told {}{}", places.empty() ? "" : ", ", kAxis[k],
                          sign[at] < 0 ? "-" : "", kAxis[from[at]]);
  }
  if (moved == 2 && plain) {
    std::string pair;
    for (int k = 0; k < 3; ++k)
      if (from[static_cast<size_t>(k)] != k)
        pair += fmt::format("{}{}", pair.empty() ? "" : " and ", kAxis[k]);
    places = pair + " stand in one another's places";
  }
  if (!signs.empty()) signs += signs.size() > 1 ? " have the other sign" : " has the other sign";
  return places + (places.empty() || signs.empty() ? "" : ", and ") + signs;
}

double share_left(const ToldVectors& vectors) {
  return Comparison(vectors, {}, {}).left({}, {true, true, true});
}

std::optional<AxesRead> read_otherwise(const ToldVectors& vectors, std::vector<int> columns,
                                       const InspectionOptions& options) {
  const Comparison comparison(vectors, std::move(columns), options);
  std::vector<AxesRead> all = all_readings();
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.count() < b.count(); });
  AxesRead best;
  for (const AxesRead& one : all)
    if (comparison.beats(one, best)) best = one;
  if (best.count() == 0) return {};
  const std::array<bool, 3> axes{best.changes(0), best.changes(1), best.changes(2)};
  best.told = comparison.left({}, axes), best.read = comparison.left(best, axes);
  best.whole = comparison.is_whole(best);
  return best;
}

}  // namespace hookeye::inspection
