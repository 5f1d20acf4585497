#include "capture_io/yaml_edit.h"
#include "core/input_error.h"
#include "proposal/proposal.h"

namespace hookeye {

namespace fs = std::filesystem;

void store(const Proposal& proposal, const fs::path& file, bool replace) {
  std::error_code error;
  if (fs::exists(file, error) && !replace)
    throw InputError({file.string()}, "there is a capture already",
                     "--force writes over it, -o names another file, as -o FOLDER/second.yaml");
  try {
    store_capture(file, proposal.yaml);
  } catch (const InputError& fault) {
    if (fault.place().file != file.string()) throw;
    throw InputError({file.string()}, "this folder gives no capture: " + fault.wrong(),
                     fault.right());
  }
}

}  // namespace hookeye
