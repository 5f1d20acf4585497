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

/// Of one effect over all photos, in standard deviations: what is there and what is removed. NaN:
/// does not count.
struct Told {
  std::vector<double> now, removed;
  double unit;
};

Told told(const std::filesystem::path& file) {
  const json document = read_json(file);
  Told out;
  out.unit = document.at("unit");
  for (const auto& [name, photo] : document.at("photos").items()) {
    const std::string bytes = from_base64(photo.at("bytes").get<std::string>()).value();
    const size_t count = bytes.size() / 2;
    for (size_t i = 0; i < count; ++i) {
      const int now = static_cast<unsigned char>(bytes[i]),
                removed = static_cast<unsigned char>(bytes[count + i]);
      out.now.push_back(now == 0 ? std::nan("") : (now - 1) * out.unit);
      out.removed.push_back(now == 0 ? std::nan("") : (removed - 128) * out.unit);
    }
  }
  return out;
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
  ASSERT_EQ(fine.now.size(), coarse.now.size());
  double removed2 = 0.0, off2 = 0.0;
  int both = 0, one = 0;
  for (size_t i = 0; i < fine.now.size(); ++i) {
    const bool in_fine = !std::isnan(fine.now[i]), in_coarse = !std::isnan(coarse.now[i]);
    one += in_fine != in_coarse;
    if (!in_fine || !in_coarse) continue;
    ++both;
    removed2 += std::pow(fine.removed[i], 2);
    off2 += std::pow(fine.removed[i] - coarse.removed[i], 2);
  }
  EXPECT_LT(one, 0.05 * both) << "along the body's rim a pixel more or less is seen";
  ASSERT_GT(std::sqrt(removed2 / both), 1.0) << leader;
  EXPECT_LT(std::sqrt(off2 / removed2), 0.25);
}

}  // namespace
}  // namespace hookeye
