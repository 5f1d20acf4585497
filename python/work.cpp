#include "python/work.h"

#include <csignal>

#include "core/interrupted.h"
#include "estimation/evaluation/evaluation.h"
#include "python/errors.h"
#include "python/log.h"

namespace hookeye {

namespace py = pybind11;

Work::Work(py::object cancel) : cancel_(std::move(cancel)) {
  if (!cancel_.is_none() && !py::hasattr(cancel_, "is_set"))
    throw py::type_error("cancel: an object with is_set() is expected, as threading.Event");
  static std::once_flag once;
  std::call_once(once, keep_freed_memory);
}

namespace {

constexpr auto kLook = std::chrono::milliseconds(40);
thread_local int callbacks = 0;  ///< that this thread is in

}  // namespace

InCallback::InCallback() { ++callbacks; }
InCallback::~InCallback() { --callbacks; }

std::unique_lock<std::mutex> Work::alone_with(std::mutex& mutex) {
  std::unique_lock lock(mutex, std::try_to_lock);
  while (!lock) {
    if (callbacks > 0) bad_argument("this run or model is at work", "ask it when the call is over");
    {
      const py::gil_scoped_release others;
      std::this_thread::sleep_for(kLook);
    }
    look();
    if (thrown_) std::rethrow_exception(thrown_);
    if (by_cancel_) throw Stopped{};
    (void)lock.try_lock();
  }
  return lock;
}

void Work::tell(const std::function<void()>& callback) {
  const std::lock_guard one_at_a_time(telling_);
  std::unique_lock lock(mutex_);
  if (cancelled_) return;
  callback_ = &callback;
  news_.notify_all();
  answered_.wait(lock, [&] { return !callback_; });
}

void Work::stop_if_cancelled() const {
  if (cancelled_) throw Interrupted{};
}

/// Signals go to Python's threads: METIS puts a handler of its own in the place of SIGTERM's.
void Work::work(const std::function<void()>& body) {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  std::exception_ptr failed;
  try {
    body();
  } catch (...) {
    failed = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  failed_ = failed;
  done_ = true;
  news_.notify_all();
}

/// Ctrl-C and `cancel`.
void Work::look() {
  if (thrown_) {
    PyErr_CheckSignals();  // a further Ctrl-C ends nothing sooner
    PyErr_Clear();
    return;
  }
  try {
    drain_log();
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!cancel_.is_none() && !by_cancel_ && cancel_.attr("is_set")().cast<bool>())
      by_cancel_ = cancelled_ = true;
  } catch (const py::error_already_set&) {
    thrown_ = std::current_exception();
    cancelled_ = true;
  }
}

/// A callback that waits. Holds the interpreter's lock, and not the other.
void Work::answer(std::unique_lock<std::mutex>& lock) {
  const std::function<void()>* callback = callback_;
  if (!callback) return;
  lock.unlock();
  if (!thrown_) try {
      const InCallback mark;
      (*callback)();
    } catch (...) {
      thrown_ = std::current_exception();
      cancelled_ = true;
    }
  lock.lock();
  callback_ = nullptr;
  answered_.notify_all();
}

void Work::run_body(const std::function<void()>& body) {
  follow_level();
  look();
  if (thrown_) std::rethrow_exception(thrown_);
  if (by_cancel_) throw Stopped{};
  std::thread worker([&] { work(body); });
  for (bool done = false; !done;) {
    {
      const py::gil_scoped_release others;
      std::unique_lock lock(mutex_);
      news_.wait_for(lock, kLook, [&] { return done_ || callback_; });
      done = done_;
    }
    look();
    std::unique_lock lock(mutex_);
    answer(lock);
  }
  {
    const py::gil_scoped_release others;
    worker.join();
  }
  drain_log();
  if (thrown_) std::rethrow_exception(thrown_);
  if (!failed_) return;
  try {
    std::rethrow_exception(failed_);
  } catch (const Interrupted&) {
    if (by_cancel_) throw Stopped{};
    throw;
  }
}

}  // namespace hookeye
