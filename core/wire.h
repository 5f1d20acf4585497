// Values as plain bytes, for programs of one build on one machine: the program and its helpers.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace hookeye {

template <class T>
concept PlainBytes = std::is_trivially_copyable_v<T> && std::is_default_constructible_v<T> &&
                     !std::is_pointer_v<T> &&
                     !std::is_array_v<T>;

/// Appends values; counts stand before what they count.
class Packer {
 public:
  template <PlainBytes T>
  Packer& put(const T& value) {
    return raw(&value, sizeof value);
  }
  Packer& put(std::string_view text) {
    put<uint64_t>(text.size());
    return raw(text.data(), text.size());
  }
  Packer& put(const std::string& text) { return put(std::string_view(text)); }
  Packer& put(const char* text) { return put(std::string_view(text)); }
  template <PlainBytes T>
  Packer& put(const std::vector<T>& values) {
    put<uint64_t>(values.size());
    return raw(values.data(), values.size() * sizeof(T));
  }
  Packer& put(const std::vector<std::string>& values) {
    put<uint64_t>(values.size());
    for (const std::string& value : values) put(value);
    return *this;
  }
  template <class Scalar, int Rows, int Cols>
  Packer& put(const Eigen::Matrix<Scalar, Rows, Cols>& matrix) {
    put<uint64_t>(static_cast<uint64_t>(matrix.rows()));
    put<uint64_t>(static_cast<uint64_t>(matrix.cols()));
    return raw(matrix.data(), static_cast<size_t>(matrix.size()) * sizeof(Scalar));
  }
  template <class T>
  Packer& put(const std::map<std::string, std::vector<T>>& groups) {
    put<uint64_t>(groups.size());
    for (const auto& [name, members] : groups) put(name).put(members);
    return *this;
  }
  std::string take() { return std::move(bytes_); }

 private:
  Packer& raw(const void* from, size_t count) {
    bytes_.append(static_cast<const char*>(from), count);
    return *this;
  }
  std::string bytes_;
};

/// Takes them back in the same order. Believes no count: throws WireFault where more is announced
/// than is left, before anything is allocated.
struct WireFault : std::runtime_error {
  WireFault() : std::runtime_error("a message of a helper is damaged") {}
};
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : left_(bytes) {}
  template <PlainBytes T>
  void get(T& value) {
    raw(&value, sizeof value);
  }
  void get(std::string& text) {
    text.resize(count(1));
    raw(text.data(), text.size());
  }
  template <PlainBytes T>
  void get(std::vector<T>& values) {
    values.resize(count(sizeof(T)));
    raw(values.data(), values.size() * sizeof(T));
  }
  void get(std::vector<std::string>& values) {
    values.resize(count(sizeof(uint64_t)));
    for (std::string& value : values) get(value);
  }
  template <class Scalar, int Rows, int Cols>
  void get(Eigen::Matrix<Scalar, Rows, Cols>& matrix) {
    const auto rows = take<uint64_t>(), cols = take<uint64_t>();
    const bool fits = (Rows == Eigen::Dynamic || rows == static_cast<uint64_t>(Rows)) &&
                      (Cols == Eigen::Dynamic || cols == static_cast<uint64_t>(Cols)) &&
                      rows < limit && cols < limit && rows * cols <= left_.size() / sizeof(Scalar);
    if (!fits) throw WireFault();
    matrix.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(cols));
    raw(matrix.data(), static_cast<size_t>(rows * cols) * sizeof(Scalar));
  }
  template <class T>
  void get(std::map<std::string, std::vector<T>>& groups) {
    for (size_t n = count(2 * sizeof(uint64_t)); n > 0; --n) {
      const auto name = take<std::string>();
      get(groups[name]);
    }
  }
  template <class T>
  T take() {
    T value{};
    get(value);
    return value;
  }
  /// Nothing may be left over.
  void end() const {
    if (!left_.empty()) throw WireFault();
  }

 private:
  static constexpr uint64_t limit = uint64_t{1} << 31;
  /// Of items of at least `size` bytes each.
  size_t count(size_t size) {
    const auto n = take<uint64_t>();
    if (n > left_.size() / size) throw WireFault();
    return static_cast<size_t>(n);
  }
  void raw(void* to, size_t size) {
    if (size > left_.size()) throw WireFault();
    if (size > 0) std::memcpy(to, left_.data(), size);
    left_.remove_prefix(size);
  }
  std::string_view left_;
};

}  // namespace hookeye
