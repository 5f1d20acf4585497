// Other processes that answer questions about the same capture: what an archive asks of them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/journal.h"

namespace hookeye {

/// Begins the key of what is no question but a whole task of several (ahead.h).
inline constexpr const char* kTaskMark = "task-";

/// Who is at which question. Answers go by journals, one a process: who has answered one says so
/// when it is written there.
class SharedWork {
 public:
  virtual ~SharedWork() = default;

  /// Whether anybody else is at work.
  virtual bool others() = 0;
  /// What the others have written so far. It grows at its end, and stays in its order.
  virtual const std::vector<std::unique_ptr<JournalReader>>& journals() = 0;
  /// True: it is this process' turn, and nobody else's until finish(). False: somebody else is at
  /// it, or has answered it.
  virtual bool claim(const std::string& key) = 0;
  /// `answered`: what came of it is in the journal; else it is the next one's turn.
  virtual void finish(const std::string& key, bool answered) = 0;
  virtual bool answered(const std::string& key) = 0;
  /// A moment, until others may have come farther.
  virtual void wait() = 0;
};

}  // namespace hookeye
