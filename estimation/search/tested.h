// What is left of examples that no fit, score, order or stop has seen (use: test).
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "estimation/fit/fit.h"

namespace hookeye {

struct Tested {
  double chi = 0.0;  ///< of all their photos; 0: they have none
  struct Example {
    std::string name;
    double chi = 0.0;
    /// Worst measured value, over its told noise; 0: nothing is measured.
    double measured = 0.0;
  };
  std::vector<Example> examples;
};

/// The fitted model on the test examples of `whole`, the capture that the search saw without them
/// (without_tests). Numbers of one such example alone (where its jaw stood) are fitted to it, as
/// those of a held-out one are. Empty: it has none. Fails where a test example has no equilibrium,
/// or the model has a part that cannot be told with them.
Result<std::optional<Tested>> test(const Fitted& fitted, const Capture& whole,
                                   const FitOptions& options);

nlohmann::json to_json(const Tested& tested);

}  // namespace hookeye
