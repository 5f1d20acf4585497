// Any JSON of a run folder, before a shape is asked of it.
#include "core/json_file.h"
#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using nlohmann::json;
  static const json shape = {{"?a", "number|null"},
                             {"?b", json::array({{{"name", "text"}, {"*", "any"}}})},
                             {"*", json::array({"number", "number"})}};
  return hookeye::fuzz::on_file("a.json", data, size, [](const auto& file) {
    hookeye::expect_shape(hookeye::read_json(file), shape, file);
  });
}
