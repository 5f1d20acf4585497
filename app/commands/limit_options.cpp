#include "app/commands/limit_options.h"

#include <fmt/format.h>

#include <charconv>

#include "app/report/run_limits.h"
#include "app/text.h"
#include "capture_io/input_error.h"

namespace hookeye {

namespace {

void set_told(Limits& limits, const std::string& told) {
  const std::string right = "--set NAME=VALUE; `hookeye discover --options` lists them";
  const size_t at = told.find('=');
  if (at == std::string::npos)
    throw InputError({"--set"}, fmt::format("`{}` has no value", told), right);
  const std::string text = told.substr(at + 1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw InputError({"--set"}, fmt::format("`{}` is no number", text), right);
  set_limit(limits, told.substr(0, at), value, "--set");
}

}  // namespace

std::string limits_table() {
  std::string out;
  for (const LimitSpec& spec : specs({}))
    out += fmt::format("{} = {:g}{}{}\n", spec.name, spec.standard, spec.unit.empty() ? "" : " ",
                       spec.unit) +
           wrapped(spec.what, 4) +
           wrapped(fmt::format("({:g} to {:g}; {})", spec.low, spec.high, spec.source), 4);
  return out;
}

void add_limit_options(CLI::App& command, std::vector<std::string>& told) {
  command.add_option("--set", told, "NAME=VALUE: another number to decide by (--options)")
      ->allow_extra_args(false);
  command
      .add_flag_callback(
          "--options",
          [] {
            fmt::print("{}", limits_table());
            throw CLI::Success();
          },
          "Print the numbers that --set can change, and why they are so")
      ->trigger_on_parse();
}

Limits limits_for(const std::filesystem::path& run, const std::vector<std::string>& told) {
  Limits kept;
  bool steps = false;
  if (std::filesystem::exists(run / "run.json")) {
    const Run there = Run::open(run, false);
    kept = limits_of(there.timeline());
    steps = !there.steps().empty();
  }
  Limits limits = kept;
  for (const std::string& one : told) set_told(limits, one);
  if (steps && changed(limits) != changed(kept))
    throw InputError({run.string()}, "the steps of this run were made by other options",
                     "leave --set out, or name a new folder");
  return limits;
}

void keep_limits(Run& run, const Limits& limits) {
  const auto told = changed(limits);
  if (told.empty()) return;
  run.update([&](nlohmann::json& timeline) { timeline["options"] = told; });
}

}  // namespace hookeye
