// Work in C++ on behalf of a Python call: on a thread of its own, without the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace hookeye {

/// Runs one body of work. The calling thread waits, lets other Python threads run, and looks every
/// few hundredths of a second for Ctrl-C, for `cancel` and for log lines. Callbacks run on it, too.
/// All members but tell() belong to the calling thread, which holds the lock.
class Work {
 public:
  /// `cancel`: None, or an object with is_set() (threading.Event).
  explicit Work(pybind11::object cancel);
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  /// For FitOptions::cancel and its like.
  const std::atomic<bool>* cancelled() const { return &cancelled_; }

  /// Called by the work, from any of its threads: `callback` runs on the calling thread, and has
  /// run when this returns. What it throws ends the work and comes out of run().
  void tell(const std::function<void()>& callback);

  /// Waits until nobody else works with what `mutex` guards. Throws InputError in a callback of
  /// that very work, which would wait for ever.
  std::unique_lock<std::mutex> alone_with(std::mutex& mutex);

  /// Throws what `body` throws; before it what a callback or Ctrl-C threw, and Stopped where
  /// `cancel` was set.
  template <class Body>
  auto run(const Body& body) {
    std::optional<decltype(body())> out;
    run_body([&] { out.emplace(body()); });
    return *std::move(out);
  }

  /// For the work, before it writes: throws Interrupted where it is to end.
  void stop_if_cancelled() const;

 private:
  void run_body(const std::function<void()>& body);
  void work(const std::function<void()>& body);
  void look();
  void answer(std::unique_lock<std::mutex>& lock);

  pybind11::object cancel_;
  std::atomic<bool> cancelled_{false};
  bool by_cancel_ = false;
  std::exception_ptr thrown_;  ///< by a callback or by Ctrl-C
  std::exception_ptr failed_;  ///< of the body
  std::mutex mutex_, telling_;
  std::condition_variable news_, answered_;
  const std::function<void()>* callback_ = nullptr;
  bool done_ = false;
};

/// `cancel` was set.
struct Stopped {};

/// Marks this thread as within Python that a work has called: what it may not wait for is refused.
class InCallback {
 public:
  InCallback();
  ~InCallback();
  InCallback(const InCallback&) = delete;
  InCallback& operator=(const InCallback&) = delete;
};

}  // namespace hookeye
