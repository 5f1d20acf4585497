// What becomes of memory that is given back to the C library.
#pragma once

#include <atomic>

namespace hookeye {

/// For work on many things that keeps something small of each, as of a thousand photos. The C
/// library puts the small ones into the room of large ones that were freed, which the next large
/// ones then lack: it takes more and more. Every some dozens of calls pages on which nothing lies
/// are the machine's again. (After each, or by pages of their own for all large pieces, would cost
/// a quarter of the time.)
class FreedMemoryReturned {
 public:
  /// One more is done. Any thread.
  void after_one();

 private:
  std::atomic<int> done_ = 0;
};

}  // namespace hookeye
