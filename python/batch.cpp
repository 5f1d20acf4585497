#include "python/batch.h"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "batch/batch_index.h"
#include "batch/batch_program.h"
#include "batch/enrolment.h"
#include "core/fingerprint.h"
#include "core/memory_left.h"
#include "python/arrays.h"
#include "python/errors.h"
#include "python/work.h"
#include "runs/versions.h"

namespace hookeye {

namespace py = pybind11;

namespace {

using std::filesystem::path;
using Options = std::vector<std::pair<std::string, std::vector<std::string>>>;

/// A word as the command takes them; with a name and options of its own where they are told.
struct NamedCapture {
  std::string word, label;
  Options options;
};

struct PythonBatch {
  std::vector<NamedCapture> captures;
  std::string verb;
  path out, program;
  Options options;
  MachineShare share;
  double timeout = 0.0;
  bool retry = false, reports = true;
};

std::vector<std::string> words_of(const BatchProgram& program, const std::string& verb,
                                  const Options& options) {
  std::vector<std::string> out;
  for (const auto& [name, values] : options)
    for (const std::string& word : option_words(program, verb, name, values)) out.push_back(word);
  return out;
}

std::vector<ListedCapture> list_of(const PythonBatch& told, const BatchProgram& program) {
  std::vector<ListedCapture> out;
  for (const NamedCapture& one : told.captures) {
    const std::vector<std::string> own = words_of(program, told.verb, one.options);
    for (ListedCapture& listed : read_capture_list({one.word}, program.kind_in(told.verb))) {
      if (!one.label.empty()) listed.label = one.label;
      listed.options.insert(listed.options.end(), own.begin(), own.end());
      out.push_back(std::move(listed));
    }
  }
  if (out.empty()) bad_argument("batch: there are no captures", "at least one");
  return out;
}

struct BatchEnd {
  path folder;
  std::vector<nlohmann::json> rows;
};

BatchEnd work_through(const PythonBatch& told, const Work& work,
                      const std::function<void(int, int, const std::string&)>& tell) {
  const BatchProgram program =
      ask_program(told.program.empty() ? program_beside() : told.program, version_text());
  (void)program.options_of(told.verb);
  const std::vector<std::string> options = words_of(program, told.verb, told.options);
  const std::vector<ListedCapture> list = list_of(told, program);
  const auto warn = [](const std::string& sentence) { spdlog::warn("{}", sentence); };
  const BatchFolder folder =
      BatchFolder::make(told.out, {told.verb, options, fingerprint_of_file(program.file),
                                   program.version, makes_run(told.verb) && told.reports});
  const std::vector<std::string> keys = enrol(folder, list, {work.cancelled(), {}, warn});
  if (told.retry) try_failed_again(folder, keys);
  const BatchCounts before = count(folder, keys);
  WorkOptions wanted;
  wanted.program = program.file;
  wanted.keys = keys;
  wanted.timeout = told.timeout;
  wanted.cancel = work.cancelled();
  wanted.warn = warn;
  share_machine(told.share, before.todo + before.running, wanted);
  const auto told_of = [&](const BatchCounts& now) {
    tell(now.done + now.failed, now.all(),
         now.failed ? fmt::format("{} failed", now.failed) : std::string());
  };
  wanted.progress = told_of;
  work_and_index(folder, wanted);
  told_of(count(folder, keys));
  return {folder.path(), batch_rows(folder, keys)};
}

double bytes_from(const py::object& memory) {
  if (memory.is_none()) return 0.0;
  const auto text = py::str(memory).cast<std::string>();
  const auto bytes = bytes_in(text);
  if (!bytes || !(*bytes > 0.0)) bad_argument("memory: " + text, "bytes, or a text as \"4G\"");
  return *bytes;
}

py::tuple run_batch(const std::vector<std::tuple<std::string, std::string, Options>>& captures,
                    const std::string& verb, const path& out, const Options& options,
                    const py::dict& how, py::object on_step, py::object cancel) {
  PythonBatch told;
  for (const auto& [word, label, own] : captures) told.captures.push_back({word, label, own});
  told.verb = verb, told.out = out, told.options = options;
  told.program = how["program"].cast<std::string>();
  told.share = {how["jobs"].cast<int>(), how["threads"].cast<int>(), bytes_from(how["memory"])};
  told.timeout = how["timeout"].cast<double>();
  told.retry = how["retry"].cast<bool>(), told.reports = how["reports"].cast<bool>();
  Work work(std::move(cancel));
  const auto tell = [&](int done, int of, const std::string& note) {
    if (!on_step.is_none()) work.tell([&] { on_step("batch", note, done, of, 0.0); });
  };
  const BatchEnd end = work.run([&] { return work_through(told, work, tell); });
  py::list rows;
  for (const nlohmann::json& row : end.rows) rows.append(python_of(row));
  return py::make_tuple(end.folder.string(), rows);
}

}  // namespace

void bind_batch(py::module_& m) {
  m.def("batch", &run_batch, py::arg("captures"), py::arg("verb"), py::arg("out"),
        py::arg("options"), py::arg("how"), py::arg("on_step"), py::arg("cancel"));
}

}  // namespace hookeye
