#include "app/commands/limit_options.h"

#include <fmt/format.h>

#include <charconv>

#include "core/input_error.h"
#include "runs/run_limits.h"
#include "runs/text.h"

namespace hookeye {

namespace {

ToldLimit told_limit(const std::string& told) {
  const std::string right = "--set NAME=VALUE; `hookeye discover --options` lists them";
  const size_t at = told.find('=');
  if (at == std::string::npos)
    throw InputError({"--set"}, fmt::format("`{}` has no value", told), right);
  const std::string text = told.substr(at + 1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    throw InputError({"--set"}, fmt::format("`{}` is no number", text), right);
  return {told.substr(0, at), value, "--set"};
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

std::vector<ToldLimit> told_limits(const std::vector<std::string>& told) {
  std::vector<ToldLimit> out;
  for (const std::string& one : told) out.push_back(told_limit(one));
  return out;
}

}  // namespace hookeye
