// hookeye report: a run as one self-contained page.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/report/page.h"
#include "capture_io/run.h"

namespace hookeye {
namespace {

/// A page that may be mailed.
constexpr size_t kMostBytes = 30'000'000;

struct Reduction {
  int earlier, newest;  ///< by how much pictures are shrunk
  const char* said;
};
constexpr Reduction kReductions[] = {
    {1, 1, ""},
    {2, 1,
     "Residuals of earlier steps are at half size to keep this file under 30 MB; the newest "
     "step and the photos are whole."},
    {2, 2, "All pictures are at half size to keep this file under 30 MB."},
    {4, 4, "All pictures are at a quarter of their size to keep this file under 30 MB."},
    {8, 8, "All pictures are at an eighth of their size to keep this file under 30 MB."}};

std::string parts_of(RunView& run, const nlohmann::json& document, nlohmann::json& faults) {
  const auto names = blob_names(document);
  Progress progress("report", static_cast<int>(names.size()));
  std::string parts;
  for (const auto& name : names) {
    if (interrupted()) throw Interrupted{};
    try {
      if (const auto blob = run.blob(name))
        parts += part(name, *blob);
      else
        faults.push_back(name + " is not there");
    } catch (const std::exception& error) {
      faults.push_back(name + ": " + error.what());
    }
    progress.advance();
    if (parts.size() > kMostBytes) break;
  }
  return parts;
}

void run_report(const std::string& folder, const std::string& out, Session& session) {
  RunView run(folder);
  for (const Reduction& reduction : kReductions) {
    nlohmann::json document = run.document(reduction.earlier, reduction.newest);
    document["reduction"] = reduction.said;
    const std::string parts = parts_of(run, document, document["faults"]);
    const std::string page = make_page(document, parts);
    if (page.size() > kMostBytes && &reduction != std::end(kReductions) - 1) continue;
    write_text(out, page);
    session.document = {{"hookeye", 1},
                        {"report", out},
                        {"bytes", page.size()},
                        {"reduction", reduction.said},
                        {"faults", document["faults"]}};
    for (const auto& fault : document["faults"]) session.warn(fault.get<std::string>());
    if (reduction.said[0]) session.warn(reduction.said);
    session.say("written to {} ({:.1f} MB)\n", out, 1e-6 * static_cast<double>(page.size()));
    return;
  }
}

}  // namespace

void add_report(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("report", "A run as one self-contained page");
  const auto folder = std::make_shared<std::string>(), out = std::make_shared<std::string>();
  command->add_option("RUN", *folder, "Run folder")->required();
  command->add_option("-o,--out", *out, "The page (html)")->required();
  command->callback([&chosen, folder, out] {
    chosen = [folder, out](Session& session) { run_report(*folder, *out, session); };
  });
}

}  // namespace hookeye
