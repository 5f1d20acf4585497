// An archive for the time of one search.
#pragma once

#include <memory>

#include "estimation/evaluation/evaluation.h"
#include "estimation/fit/archive.h"

namespace hookeye {

/// While it lives the workspace works nothing out twice, whether or not what it comes to outlives
/// it: an archive in memory where it has none.
class OwnArchive {
 public:
  explicit OwnArchive(Workspace& workspace) : workspace_(workspace), own_(!workspace.archive()) {
    if (own_) workspace_.keep_in(std::make_shared<Archive>());
  }
  OwnArchive(const OwnArchive&) = delete;
  OwnArchive& operator=(const OwnArchive&) = delete;
  ~OwnArchive() {
    if (own_) workspace_.keep_in(nullptr);
  }

 private:
  Workspace& workspace_;
  bool own_;
};

}  // namespace hookeye
