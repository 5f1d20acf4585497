// A value that its copies share until one of them is changed.
#pragma once

#include <memory>
#include <utility>

namespace hookeye {

/// Photos are large and stand in several scenes: copying one copies a pointer. Reads as a const T.
template <class T>
class SharedValue {
 public:
  SharedValue() : value_(std::make_shared<T>()) {}
  SharedValue(T value) : value_(std::make_shared<T>(std::move(value))) {}
  const T& operator*() const { return *value_; }
  const T* operator->() const { return value_.get(); }
  operator const T&() const { return *value_; }
  std::shared_ptr<const T> pointer() const { return value_; }
  /// To be changed: of this copy alone from now on.
  T& own() {
    if (value_.use_count() > 1) value_ = std::make_shared<T>(*value_);
    return *value_;
  }

 private:
  std::shared_ptr<T> value_;
};

}  // namespace hookeye
