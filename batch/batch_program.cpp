#include "batch/batch_program.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>

#include "batch/child.h"
#include "core/helper.h"
#include "core/json_file.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kPatience = 60.0;  // [s] until a program that does not answer is given up

std::vector<std::string> names_of(const VerbOptions& options) {
  std::vector<std::string> out;
  for (const auto& [name, kind] : options) out.push_back(name);
  return out;
}

bool can_be_started(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0;
}

/// What it prints.
std::string said_by(const fs::path& program, const std::vector<std::string>& words) {
  std::string name = (fs::temp_directory_path() / "hookeye-XXXXXX").string();
  const int file = ::mkstemp(name.data());
  if (file < 0) throw cannot_write(name, "no temporary file can be made");
  ::close(file);
  int status = -1;
  {
    Child child(program, words, name, "/dev/null", 0.0);
    while (child.seconds() < kPatience) {
      if (const auto end = child.ended()) {
        status = end->status;
        break;
      }
      pollfd ends{child.handle(), POLLIN, 0};
      ::poll(&ends, 1, 20);
    }
  }
  const std::string said = read_text(name);
  std::error_code ignored;
  fs::remove(name, ignored);
  return status == 0 ? said : "";
}

VerbOptions options_from(const json& told) {
  VerbOptions out;
  for (const auto& [name, kind] : told.items())
    out[name] = kind == "flag" ? OptionKind::flag : OptionKind::valued;
  return out;
}

}  // namespace

const VerbOptions& BatchProgram::options_of(const std::string& verb) const {
  const auto found = verbs.find(verb);
  if (found != verbs.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [name, options] : verbs) known.push_back(name);
  throw InputError({}, fmt::format("batch: there is no verb '{}'", verb),
                   fmt::format("one of {}", fmt::join(known, ", ")));
}

KindOfOption BatchProgram::kind_in(const std::string& verb) const {
  return [options = options_of(verb)](const std::string& name) {
    const auto found = options.find(name);
    return found == options.end() ? OptionKind::unknown : found->second;
  };
}

json to_json(const BatchProgram& program) {
  json verbs = json::object();
  for (const auto& [verb, options] : program.verbs) {
    verbs[verb] = json::object();
    for (const auto& [name, kind] : options)
      verbs[verb][name] = kind == OptionKind::flag ? "flag" : "valued";
  }
  return {{"hookeye", 1},
          {"command", "batch"},
          {"version", program.version},
          {"verbs", std::move(verbs)}};
}

fs::path program_beside() {
  const fs::path prefix = helper_folder().parent_path().parent_path();
  for (const char* place : {"bin/hookeye", "app/hookeye"})
    if (can_be_started(prefix / place)) return prefix / place;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (!folder.empty() && can_be_started(fs::path(folder) / "hookeye"))
      return fs::path(folder) / "hookeye";
  throw InputError({}, "batch: the program hookeye, which works on captures, is not found",
                   "install Hookeye as a whole, or name it: program='.../hookeye'");
}

BatchProgram ask_program(const fs::path& file, const std::string& version) {
  const std::string right = "the program that was built with this module";
  if (!can_be_started(file))
    throw InputError({file.string()}, "there is no program of this name", right);
  std::string damage;
  const auto told = parse_json(said_by(file, {"batch", "--verbs", "--json"}), damage);
  if (!told || !told->is_object() || !told->contains("verbs") || !told->contains("version") ||
      !(*told)["version"].is_string() || !(*told)["verbs"].is_object())
    throw InputError({file.string()}, "this program is no Hookeye that takes captures", right);
  BatchProgram out{fs::canonical(file), (*told)["version"], {}};
  if (out.version != version)
    throw InputError(
        {file.string()},
        fmt::format("this program is version {}, the module is {}", out.version, version), right);
  for (const auto& [verb, options] : (*told)["verbs"].items())
    if (options.is_object()) out.verbs[verb] = options_from(options);
  return out;
}

std::vector<std::string> option_words(const BatchProgram& program, const std::string& verb,
                                      const std::string& name,
                                      const std::vector<std::string>& values) {
  const VerbOptions& known = program.options_of(verb);
  const auto found = known.find(name);
  if (found == known.end())
    throw InputError({}, fmt::format("`{}` is no option of `hookeye {}` in a batch", name, verb),
                     fmt::format("one of {}", fmt::join(names_of(known), ", ")));
  const bool flag = found->second == OptionKind::flag;
  if (flag != values.empty())
    throw InputError(
        {}, fmt::format("option `{}` of `{}` takes {} value", name, verb, flag ? "no" : "a"),
        flag ? "True or False" : "a value, or a list of them");
  if (flag) return {"--" + name};
  std::vector<std::string> out;
  for (const std::string& value : values) out.insert(out.end(), {"--" + name, value});
  return out;
}

}  // namespace hookeye
