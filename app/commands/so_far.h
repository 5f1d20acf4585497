// What a search that is stopped has come to: told, and nothing of it settled.
#pragma once

#include <string>
#include <vector>

#include "app/session.h"
#include "runs/search.h"

namespace hookeye {

class SoFar {
 public:
  /// Listens to the search that `wanted` asks for, which must not outlive this.
  explicit SoFar(SearchRequest& wanted);
  /// The newest step and its material, refits that are no step yet, effects that lead, where the
  /// run is (`folder` as the user named it) and how it goes on.
  void say(const Run& run, const std::string& folder, const Session& session) const;

 private:
  std::vector<EndedRefit> refits_;  ///< since the newest step, by effect
};

}  // namespace hookeye
