// hookeye import SCAN.obj: a textured scan as the body of a capture.
#include <nlohmann/json.hpp>

#include "app/commands/import_files.h"
#include "app/scratch_folder.h"
#include "capture_io/cameras_file.h"
#include "core/scope.h"
#include "importers/scan.h"

namespace hookeye {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void run_import_scan(const fs::path& scan, double scale, const fs::path& folder, Session& session) {
  const Scope scope("source " + scan.string());
  const ScratchFolder scratch("the scan");
  ImportedScan imported = import_scan(scan, scale, scratch.path());
  const std::string head = "# " + head_line("hookeye import scan " + scan.filename().string());
  for (auto& [name, text] : imported.files) {
    if (name == "body.obj") text = head + text;
    if (name == "body.yaml")
      text = head + "# for a capture.yaml, below `hookeye: 1` and `units`\n" + text;
  }
  write_imported(folder, imported.files);
  session.document = {{"hookeye", 1},
                      {"command", "import"},
                      {"kind", "scan"},
                      {"files", Json::array()},
                      {"vertices", imported.vertices},
                      {"triangles", imported.triangles},
                      {"low", {imported.low.x(), imported.low.y(), imported.low.z()}},
                      {"high", {imported.high.x(), imported.high.y(), imported.high.z()}},
                      {"texture", imported.texture},
                      {"said", imported.said}};
  for (const auto& [name, text] : imported.files)
    session.document["files"].push_back((folder / name).string());
  session.say("{}: a scan, {} vertices and {} triangles, from {} to {}\n", scan.string(),
              imported.vertices, imported.triangles, yaml_vector(imported.low),
              yaml_vector(imported.high));
  for (const std::string& said : imported.said) session.say("{}", wrapped(said, 2));
  session.say("written to {}: body.obj{}, and body.yaml, whose lines go into a capture.yaml\n",
              folder.string(), imported.texture.empty() ? "" : ", " + imported.texture);
}

}  // namespace hookeye
