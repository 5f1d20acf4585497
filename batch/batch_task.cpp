#include "batch/batch_task.h"

#include "capture_io/fingerprints.h"
#include "core/fingerprint.h"
#include "core/input_error.h"
#include "core/json_file.h"

namespace hookeye {
namespace {

using nlohmann::json;

constexpr size_t kShownDigits = 8;
constexpr size_t kLongestName = 80;

bool may_stand_in_a_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-' || c == '+';
}

/// The digits behind "xxh3:".
std::string digits_of(const std::string& fingerprint) {
  return fingerprint.substr(fingerprint.find(':') + 1);
}

}  // namespace

const std::vector<std::string>& batch_verbs() {
  static const std::vector<std::string> verbs{"discover", "fit", "check", "simulate", "render"};
  return verbs;
}

bool makes_run(const std::string& verb) { return verb == "fit" || verb == "discover"; }

std::string BatchTask::file_name() const {
  std::string out;
  for (const char c : label.substr(0, kLongestName)) out += may_stand_in_a_name(c) ? c : '_';
  return out + "-" + key.substr(0, kShownDigits);
}

std::string content_of(const std::filesystem::path& yaml) {
  return fingerprint_of(json(fingerprints(yaml)).dump());
}

void set_key(BatchTask& task, const BatchOrder& order) {
  task.content = content_of(task.capture);
  task.key = digits_of(fingerprint_of(json{
      {"content", task.content},
      {"verb", order.verb},
      {"options", order.options},
      {"of_row", task.options},
      {"program", order.program}}.dump()));
}

json to_json(const BatchOrder& order) {
  return {{"hookeye_batch", 1},       {"verb", order.verb},       {"options", order.options},
          {"program", order.program}, {"version", order.version}, {"reports", order.reports}};
}

json to_json(const BatchTask& task) {
  return {{"key", task.key},
          {"label", task.label},
          {"capture", task.capture.string()},
          {"options", task.options},
          {"content", task.content}};
}

BatchOrder batch_order_from(const json& told, const std::filesystem::path& file) {
  if (!told.is_object() || told.value("hookeye_batch", json()) != json(1))
    throw InputError({file.string()}, "this is not a batch in format 1",
                     "choose another folder, or restore the file");
  expect_shape(told,
               {{"verb", "text"},
                {"options", json::array({"text"})},
                {"program", "text"},
                {"version", "text"},
                {"reports", "flag"},
                {"*", "any"}},
               file);
  return {told["verb"], told["options"], told["program"], told["version"], told["reports"]};
}

BatchTask batch_task_from(const json& told, const std::filesystem::path& file) {
  expect_shape(told,
               {{"key", "text"},
                {"label", "text"},
                {"capture", "text"},
                {"options", json::array({"text"})},
                {"content", "text"},
                {"*", "any"}},
               file);
  return {told["key"], told["label"], told["capture"].get<std::string>(), told["options"],
          told["content"]};
}

}  // namespace hookeye
