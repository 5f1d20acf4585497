// MatchID's calibration (caldat: lines `key;value`) and pyvale's, the same keys as yaml.
//
// As pyvale writes and reads both: x_in_second = R x_in_first + T, R = Rz(Psi) Ry(Phi) Rx(Theta);
// pixel = (Fx u + Fs v + Cx, Fy v + Cy). The two cameras are Cam0 and Cam1, or Cam1 and Cam2. The
// formula of Kappa and P is not published.
#include <fmt/format.h>

#include <map>

#include "capture_io/yaml_file.h"
#include "importers/detail.h"
#include "importers/lens_of_dic.h"
#include "meshing/file_cursor.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

/// Numbers by their keys, without the unit in brackets, with their lines.
class Keys {
 public:
  explicit Keys(const fs::path& file) : file_(file.string()) {
    if (detail::has_ending(file, {".yaml", ".yml"}))
      read_yaml();
    else
      read_lines(file);
  }

  const std::string& file() const { return file_; }
  bool has(const std::string& key) const { return values_.contains(key); }
  double need(const std::string& key) const {
    const auto found = values_.find(key);
    if (found == values_.end())
      throw InputError({file_}, fmt::format("`{}` is not there", key),
                       "the whole calibration as MatchID or pyvale wrote it");
    return found->second.value;
  }
  Place place(const std::string& key) const {
    const auto found = values_.find(key);
    return {file_, found == values_.end() ? 0 : found->second.line};
  }
  double otherwise_zero(const std::string& key) const { return has(key) ? need(key) : 0.0; }

 private:
  struct Told {
    double value = 0;
    int line = 0;
  };

  /// "Theta [deg]" -> "Theta"; angles in other units than degrees are refused.
  std::string key_of(std::string_view text, int line) const {
    const size_t bracket = text.find('[');
    std::string key(text.substr(0, bracket));
    key.erase(key.find_last_not_of(" \t") + 1);
    const bool angle = key == "Theta" || key == "Phi" || key == "Psi";
    if (angle && bracket != std::string_view::npos && !text.substr(bracket).starts_with("[deg"))
      throw InputError({file_, line}, fmt::format("`{}` is an angle of another unit", text),
                       "degrees");
    return key;
  }

  void put(std::string_view key, std::string_view number, int line) {
    number.remove_prefix(std::min(number.find_first_not_of(" \t"), number.size()));
    while (number.ends_with(' ') || number.ends_with('\t') || number.ends_with('\r'))
      number.remove_suffix(1);
    double value = 0;
    if (!detail::is_real(number, value))
      throw InputError({file_, line}, fmt::format("`{}` is `{}`", key, number), "a finite number");
    values_[key_of(key, line)] = {value, line};
  }

  void read_lines(const fs::path& path) {
    detail::FileCursor file(path);
    for (int line = 1; !file.rest().empty(); ++line) {
      const std::string_view text = file.line();
      if (text.find_first_not_of(" \t\r") == std::string_view::npos) continue;
      const size_t semicolon = text.find(';');
      if (semicolon == std::string_view::npos)
        throw InputError({file_, line}, "there is no semicolon",
                         "lines like `Cam0_Fx [pixels];1000`");
      put(text.substr(0, semicolon), text.substr(semicolon + 1), line);
    }
  }

  void read_yaml() {
    YamlLimits limits;
    limits.holds = "calibration";
    limits.begins = "the calibration as pyvale wrote it";
    for (const YamlNode::Entry& entry : load_yaml(file_, file_, limits).entries)
      put(entry.key, entry.value.text, entry.place.line);
  }

  std::string file_;
  std::map<std::string, Told> values_;
};

Camera read_camera(const Keys& keys, const std::string& name, const ImportOptions& options) {
  const auto need = [&](const char* key) { return keys.need(name + "_" + key); };
  const auto told = [&](const char* key) { return keys.otherwise_zero(name + "_" + key); };
  Camera camera;
  camera.name = name;
  camera.fx = need("Fx"), camera.fy = need("Fy"), camera.cx = need("Cx"), camera.cy = need("Cy");
  camera.skew = told("Fs");
  camera.distortion = detail::unpublished_lens(
      {told("Kappa 1"), told("Kappa 2"), told("Kappa 3"), told("P1"), told("P2")}, "MatchID",
      options, keys.place(name + "_Kappa 1"));
  return camera;
}

class MatchId final : public Importer {
 public:
  std::string name() const override { return "matchid"; }
  std::string title() const override {
    return "calibration of a stereo system by MatchID (caldat) or pyvale (yaml)";
  }
  bool recognises(const Sources& sources) const override {
    const std::string head = detail::head_of(sources.front());
    return head.find("cam1_fx") != std::string::npos && head.find("theta") != std::string::npos;
  }

  Imported read(const Sources& sources, const ImportOptions& options) const override {
    const Keys keys(detail::only_one(sources));
    const int first = keys.has("Cam0_Fx") ? 0 : 1;
    Imported out;
    for (const int n : {first, first + 1})
      out.cameras.push_back(read_camera(keys, fmt::format("Cam{}", n), options));
    Camera& second = out.cameras.back();
    second.R = detail::cardan(keys.need("Theta"), keys.need("Phi"), keys.need("Psi"));
    second.t = {keys.need("Tx"), keys.need("Ty"), keys.need("Tz")};
    out.world = fmt::format("the axes of Cam{}", first);
    return out;
  }
};

}  // namespace
}  // namespace hookeye

HOOKEYE_DEFINE_IMPORTER(matchid, MatchId)
