// What was being done when something went wrong: "example pull, load 0.7, element 1234".
#pragma once

#include <exception>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace hookeye {

/// Stands in a block and names what the block works on. Costs nothing but a string until an
/// exception leaves the block; then the text is kept for whoever reports the exception, whatever
/// thread it came from.
class Scope {
 public:
  explicit Scope(std::string text)
      : text_(std::move(text)), exceptions_(std::uncaught_exceptions()) {}
  Scope(const Scope&) = delete;
  Scope& operator=(const Scope&) = delete;
  ~Scope() {
    if (std::uncaught_exceptions() <= exceptions_) return;
    const std::lock_guard lock(mutex());
    left().push_back(std::move(text_));
  }

  /// Scopes that exceptions left since the last call, outermost first; forgets them.
  static std::string take_context() {
    const std::lock_guard lock(mutex());
    std::string context;
    for (auto text = left().rbegin(); text != left().rend(); ++text)
      context += (context.empty() ? "" : ", ") + *text;
    left().clear();
    return context;
  }

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  static std::vector<std::string>& left() {
    static std::vector<std::string> instance;
    return instance;
  }

  std::string text_;
  int exceptions_;
};

}  // namespace hookeye
