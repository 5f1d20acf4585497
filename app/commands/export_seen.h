// What exporters of pictures want: the model against the photos.
#pragma once

#include <string>
#include <vector>

#include "app/session.h"
#include "exporters/exporter.h"

namespace hookeye {

/// As the command line tells them.
struct SeenArguments {
  int grid_px = 16, window = 5;
  std::vector<std::string> gauges, lines;
  std::string along;
  /// Something else than what holds without a word.
  bool told() const {
    return grid_px != 16 || window != 5 || !gauges.empty() || !lines.empty() || !along.empty();
  }
};

/// Throws InputError for a line or direction that is none.
SeenOptions seen_options(const SeenArguments& arguments);

/// Evaluates the form at p against its photos and fields.
SeenSurface look_at(const ModelForm& form, const VectorXd& p, const SeenOptions& options);

}  // namespace hookeye
