#include "estimation/evaluation/load_case_bytes.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <type_traits>

namespace hookeye {

namespace {

/// Writes and reads by the same calls, so that neither can differ from the other.
class Bytes {
 public:
  Bytes() = default;
  explicit Bytes(const std::string& told) : told_(&told) {}
  bool reading() const { return told_ != nullptr; }
  std::string written;

  void block(void* data, size_t size) {
    if (!reading()) {
      written.append(static_cast<const char*>(data), size);
      return;
    }
    if (size > told_->size() - at_) throw std::runtime_error("a load case came in part");
    if (size > 0) std::memcpy(data, told_->data() + at_, size);
    at_ += size;
  }
  /// How many there are, and room for them where they are read. `each` [bytes].
  template <class Container>
  void size(Container& all, size_t each) {
    std::uint64_t n = all.size();
    block(&n, sizeof n);
    if (reading() && n > (told_->size() - at_) / std::max<size_t>(1, each))
      throw std::runtime_error("a load case came in part");
    if (reading()) all.resize(n);
  }
  bool at_end() const { return at_ == told_->size(); }

 private:
  const std::string* told_ = nullptr;
  size_t at_ = 0;
};

template <class T>
requires std::is_arithmetic_v<T> || std::is_enum_v<T>
void visit(Bytes& bytes, T& value) { bytes.block(&value, sizeof value); }

void visit(Bytes& bytes, std::string& text) {
  bytes.size(text, 1);
  bytes.block(text.data(), text.size());
}

template <class Scalar, int Rows, int Columns, int Options>
void visit(Bytes& bytes, Eigen::Matrix<Scalar, Rows, Columns, Options>& matrix) {
  std::int64_t rows = matrix.rows(), columns = matrix.cols();
  bytes.block(&rows, sizeof rows);
  bytes.block(&columns, sizeof columns);
  if (bytes.reading()) matrix.resize(rows, columns);
  bytes.block(matrix.data(), static_cast<size_t>(matrix.size()) * sizeof(Scalar));
}

void visit(Bytes& bytes, SparseMatrix& matrix) {
  std::int64_t rows = matrix.rows(), columns = matrix.cols(), values = matrix.nonZeros();
  for (std::int64_t* one : {&rows, &columns, &values}) bytes.block(one, sizeof *one);
  if (bytes.reading()) {
    matrix.resize(rows, columns);
    matrix.resizeNonZeros(values);
  } else {
    matrix.makeCompressed();
  }
  using Index = SparseMatrix::StorageIndex;
  bytes.block(matrix.outerIndexPtr(), static_cast<size_t>(columns + 1) * sizeof(Index));
  bytes.block(matrix.innerIndexPtr(), static_cast<size_t>(values) * sizeof(Index));
  bytes.block(matrix.valuePtr(), static_cast<size_t>(values) * sizeof(double));
}

template <class T>
void visit(Bytes& bytes, std::vector<T>& all) {
  if constexpr (std::is_arithmetic_v<T>) {
    bytes.size(all, sizeof(T));
    bytes.block(all.data(), all.size() * sizeof(T));
  } else {
    bytes.size(all, 1);
    for (T& one : all) visit(bytes, one);
  }
}

template <class... Fields>
void visit_all(Bytes& bytes, Fields&... fields) {
  (visit(bytes, fields), ...);
}

void visit(Bytes& bytes, Image& image) {
  visit_all(bytes, image.width, image.height, image.channels, image.values);
}

void visit(Bytes& bytes, FlowCell& cell) {
  visit_all(bytes, cell.column, cell.row, cell.centre_px, cell.pixels, cell.estimate,
            cell.information, cell.z, cell.explained, cell.r2, cell.reliable, cell.known);
}

void visit(Bytes& bytes, FlowField& flow) { visit_all(bytes, flow.cell_px, flow.cells); }

void visit(Bytes& bytes, CondensedPhoto& sums) {
  visit_all(bytes, sums.JtJ, sums.Jtr, sums.r2, sums.count);
}

void visit(Bytes& bytes, PhotoEvaluation& photo) {
  visit_all(bytes, photo.example, photo.photo, photo.plane, photo.sums, photo.r2, photo.count,
            photo.model, photo.residual, photo.triangle, photo.flow, photo.aligned, photo.linear_r2,
            photo.free_variance, photo.motion_px, photo.taken_r2, photo.taken_count);
}

void visit(Bytes& bytes, MeasuredEvaluation& measured) {
  visit_all(bytes, measured.example, measured.index, measured.predicted, measured.r, measured.J,
            measured.numbers, measured.inflation, measured.effective);
}

/// Without tangent and factor, which no evaluation keeps.
void visit(Bytes& bytes, Equilibrium& state) {
  visit_all(bytes, state.q, state.R, state.W_ff, state.newton_iterations, state.factorizations,
            state.stable);
}

void visit(Bytes& bytes, std::shared_ptr<const Equilibrium>& state) {
  bool there = state != nullptr;
  visit(bytes, there);
  if (!there) return;
  Equilibrium own = bytes.reading() ? Equilibrium{} : *state;
  visit(bytes, own);
  if (bytes.reading()) state = std::make_shared<const Equilibrium>(std::move(own));
}

void visit(Bytes& bytes, ExampleEvaluation& example) {
  visit_all(bytes, example.example, example.held_out, example.equilibrium, example.S,
            example.photos, example.measured);
}

void visit(Bytes& bytes, Result<void>& ended) {
  bool well = ended.has_value();
  visit(bytes, well);
  if (well) return;
  NumericalFailure why = bytes.reading() ? NumericalFailure{} : ended.error();
  visit_all(bytes, why.example, why.load_fraction, why.reason, why.kind);
  if (bytes.reading()) ended = no_result(std::move(why));
}

void visit(Bytes& bytes, LoadCaseShare::Result& result) {
  visit_all(bytes, result.evaluation, result.ended, result.seconds);
}

}  // namespace

std::string to_bytes(const LoadCaseShare::Result& result) {
  Bytes bytes;
  LoadCaseShare::Result own = result;
  visit(bytes, own);
  return std::move(bytes.written);
}

LoadCaseShare::Result from_bytes(const std::string& told) {
  Bytes bytes(told);
  LoadCaseShare::Result result;
  visit(bytes, result);
  if (!bytes.at_end()) throw std::runtime_error("a load case came with more than it holds");
  return result;
}

}  // namespace hookeye
