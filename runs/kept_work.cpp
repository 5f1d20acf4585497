#include "runs/kept_work.h"

#include <spdlog/spdlog.h>

#include "core/fingerprint.h"
#include "core/own_file.h"
#include "core/text_file.h"
#include "estimation/effects/session_effects.h"
#include "estimation/fit/archive.h"
#include "estimation/model/session_sensors.h"
#include "runs/versions.h"

namespace hookeye {
namespace {

/// To know it is not worth a command's end: a full disk or a folder that has gone is silent.
void append_work(const Run& run, const CommandWork& work) {
  try {
    run.append_line(kWorkFile, work_line(work));
  } catch (const std::exception& error) {
    spdlog::debug("{}", error.what());
  }
}

}  // namespace

std::string made_for(const Run& run) {
  nlohmann::json out = {{"hookeye", versions()},
                        {"program", fingerprint_of(read_text(own_file()))},
                        {"options", run.timeline().value("options", nlohmann::json::object())},
                        {"capture", run.timeline().value("fingerprints", nlohmann::json())}};
  if (const auto added = added_to_catalogue(); !added.empty()) out["effects"] = added;
  if (const auto added = added_sensors(); !added.empty()) out["sensors"] = added;
  return out.dump();
}

KeptWork::KeptWork(const Run& run, Bench& bench, const std::atomic<bool>* cancel,
                   std::shared_ptr<SharedWork> others)
    : run_(run), bench_(bench), cancel_(cancel), first_step_(run.steps().size()) {
  auto archive = std::make_shared<Archive>(std::make_unique<Journal>(run.archive(), made_for(run)));
  from_before_ = !archive->empty();
  archive->on_event = [](const Question& question, Archive::Event event) {
    constexpr const char* kWords[] = {"known", "anew", "kept"};
    spdlog::debug("{}: {}", question.kind, kWords[static_cast<int>(event)]);
  };
  if (others) archive->share(std::move(others), true);
  bench_.workspace.keep_in(std::move(archive));
}

KeptWork::~KeptWork() {
  for (const auto& [kind, tally] : bench_.workspace.archive()->tallies())
    spdlog::debug("{}: {} anew, {} known", kind, tally.kept, tally.found);
  bench_.workspace.keep_in(nullptr);
  if (!run_.steps().empty())
    append_work(run_, {first_step_, run_.steps().size(), worked_since(before_), false});
  if (!run_.steps().empty() || (cancel_ && *cancel_)) return;
  std::error_code ignored;
  std::filesystem::remove(run_.archive(), ignored);
}

}  // namespace hookeye
