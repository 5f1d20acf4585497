#include <fmt/format.h>
#include <unistd.h>

#include "capture_io/capture.h"
#include "core/input_error.h"
#include "core/text_file.h"
#include "proposal/proposal.h"

namespace hookeye {

namespace fs = std::filesystem;

void store(const Proposal& proposal, const fs::path& file, bool replace) {
  std::error_code error;
  if (fs::exists(file, error) && !replace)
    throw InputError({file.string()}, "there is a capture already",
                     "--force writes over it, -o names another file, as -o FOLDER/second.yaml");
  // Read as any capture before it has its name: what the reader refuses is not left behind.
  const fs::path tried =
      file.parent_path() / fmt::format(".new-{}-{}", ::getpid(), file.filename().string());
  struct Removed {
    fs::path file;
    ~Removed() {
      std::error_code ignored;
      fs::remove(file, ignored);
    }
  } const removed{tried};
  write_text(tried, proposal.yaml);
  try {
    read_capture(tried);
  } catch (const InputError& fault) {
    if (fault.place().file != tried.string()) throw;
    throw InputError({file.string()}, "this folder gives no capture: " + fault.wrong(),
                     fault.right());
  }
  write_text(file, proposal.yaml);
}

}  // namespace hookeye
