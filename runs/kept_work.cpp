#include "runs/kept_work.h"

#include <spdlog/spdlog.h>

#include "core/fingerprint.h"
#include "core/own_file.h"
#include "core/text_file.h"
#include "estimation/fit/archive.h"
#include "runs/versions.h"

namespace hookeye {
namespace {

/// Another program, or another capture, comes to other answers.
std::string made_for(const Run& run) {
  return nlohmann::json{{"hookeye", versions()},
                        {"program", fingerprint_of(read_text(own_file()))},
                        {"options", run.timeline().value("options", nlohmann::json::object())},
                        {"capture", run.timeline().value("fingerprints", nlohmann::json())}}
      .dump();
}

}  // namespace

KeptWork::KeptWork(const Run& run, Bench& bench, const std::atomic<bool>* cancel)
    : run_(run), bench_(bench), cancel_(cancel) {
  auto archive = std::make_shared<Archive>(std::make_unique<Journal>(run.archive(), made_for(run)));
  from_before_ = !archive->empty();
  archive->on_event = [](const Question& question, Archive::Event event) {
    constexpr const char* kWords[] = {"known", "anew", "kept"};
    spdlog::debug("{}: {}", question.kind, kWords[static_cast<int>(event)]);
  };
  bench_.workspace.keep_in(std::move(archive));
}

KeptWork::~KeptWork() {
  for (const auto& [kind, tally] : bench_.workspace.archive()->tallies())
    spdlog::debug("{}: {} anew, {} known", kind, tally.kept, tally.found);
  bench_.workspace.keep_in(nullptr);
  if (!run_.steps().empty() || (cancel_ && *cancel_)) return;
  std::error_code ignored;
  std::filesystem::remove(run_.archive(), ignored);
}

}  // namespace hookeye
