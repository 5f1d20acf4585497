// run.json: as a run that commands go on from, and as what `report` shows.
#include "capture_io/run.h"

#include "fuzz.h"
#include "runs/report/run_view.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace hookeye;
  static const bool ready =
      std::filesystem::create_directories(fuzz::folder() / "run" / "steps" / "00-base");
  (void)ready;
  return fuzz::on_file("run/run.json", data, size, [](const auto& file) {
    RunView(file.parent_path()).document();
    Run::open(file.parent_path(), false).steps();
  });
}
