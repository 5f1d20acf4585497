// hookeye report: a run as one self-contained page.
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "runs/report/answer.h"
#include "runs/report/write_report.h"

namespace hookeye {
namespace {

void run_report(const std::string& folder, const std::string& out, Session& session) {
  WriteReport told;
  told.cancel = &interrupted();
  {
    Progress progress("report", 0);
    told.progress = [&](int done, int of) { progress.set(done, of); };
    session.document = write_report(folder, out, told);
  }
  for (const auto& fault : session.document["faults"]) session.warn(fault.get<std::string>());
  if (const std::string reduced = session.document["reduction"]; !reduced.empty())
    session.warn(reduced);
  session.say("{}", answer_text(session.document["answer"]));
  session.say("written to {} ({:.1f} MB)\n", out, 1e-6 * session.document["bytes"].get<double>());
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
