// What an effect would remove, as the page has it: drawn coarsely it says what it says drawn
// finely.
#include "estimation/output/removed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base64.h"
#include "core/json_file.h"
#include "tests/estimation/small_capture.h"

namespace hookeye {
namespace {

using nlohmann::json;

/// Of one effect over all photos, in standard deviations: what is there and what is removed.
struct Told {
  std::vector<double> now, removed;
};

Told told(const std::filesystem::path& file) {
  const json document = read_json(file);
  const double unit = document.at("unit");
  Told out;
  for (const auto& [name, photo] : document.at("photos").items()) {
    const std::string bytes = from_base64(photo.at("bytes").get<std::string>()).value();
    const size_t count = bytes.size() / 2;
    for (size_t i = 0; i < count; ++i) {
      const auto now = static_cast<unsigned char>(bytes[i]);
      if (now == 0) continue;
      out.now.push_back((now - 1) * unit);
      out.removed.push_back((static_cast<unsigned char>(bytes[count + i]) - 128) * unit);
    }
  }
  return out;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(Removed, CoarselyDrawnItIsWhatItIsDrawnFinely) {
  const test::SmallScene small(
      {.hidden = "hidden:\n  - {effect: gravity, values: {gravity.z: -9810}}\n"});
  Workspace workspace(small.scene);
  Step step = test::base_step(workspace);
  const std::string& leader = step.diagnosis.effects.front().effect;
  test::TemporaryFolder folder;
  for (const bool pictured : {true, false}) {
    for (EffectScore& score : step.diagnosis.effects) score.pictured = pictured;
    const auto out = folder.path() / (pictured ? "fine" : "coarse");
    std::filesystem::create_directories(out);
    write_removed(out, step);
    EXPECT_EQ(std::filesystem::is_directory(out / leader), pictured);
  }
  const Told fine = told(folder.path() / "fine" / (leader + ".json")),
             coarse = told(folder.path() / "coarse" / (leader + ".json"));
  EXPECT_EQ(fine.now, coarse.now) << "the residual there is is the fit's own";
  ASSERT_GT(rms(fine.removed), 1.0) << leader;
  std::vector<double> off = fine.removed;
  for (size_t i = 0; i < off.size(); ++i) off[i] -= coarse.removed[i];
  EXPECT_LT(rms(off), 0.1 * rms(fine.removed));
}

}  // namespace
}  // namespace hookeye
