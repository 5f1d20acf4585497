#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "capture_io/camera_text.h"
#include "capture_io/yaml_file.h"
#include "importers/deck.h"
#include "proposal/loading.h"
#include "proposal/looks.h"
#include "proposal/proposal.h"
#include "proposal/proposed_cameras.h"
#include "proposal/words.h"

namespace hookeye {

namespace fs = std::filesystem;

namespace {

/// Everything that the text is made of.
struct Parts {
  std::string length;  ///< unit
  double mm = 1;       ///< of it
  BodyFacts body;
  MachineRecord record;
  Pairing pairing;
  LoadCases cases;
  ProposedCameras cameras;
  MachineLoading loading;
  Looks looks;
  double mu = 0, edge = 0;
  std::optional<LawInDeck> law;  ///< none: a guess of `mu`
};

fs::path chosen(const std::vector<fs::path>& files, const fs::path& folder, const std::string& name,
                const std::string& text, Questions& questions) {
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(file.lexically_relative(folder).string());
  const std::string answer = questions.ask({.name = name,
                                            .text = text,
                                            .standard = names.front(),
                                            .choices = names,
                                            .asked = names.size() > 1});
  return files[static_cast<size_t>(std::find(names.begin(), names.end(), answer) - names.begin())];
}

BodyFacts chosen_body(const Inventory& inventory, Questions& questions) {
  if (inventory.surfaces.empty() && inventory.volumes.empty())
    throw InputError({inventory.folder.string()}, "there is no mesh of the body in it",
                     "a closed surface (stl, obj, ply) or tetrahedra (msh, vtu, inp, mesh)");
  std::vector<fs::path> meshes = inventory.surfaces;
  meshes.insert(meshes.end(), inventory.volumes.begin(), inventory.volumes.end());
  const fs::path file =
      chosen(meshes, inventory.folder, "body", "which mesh is the body at rest", questions);
  const bool is_volume = std::find(inventory.volumes.begin(), inventory.volumes.end(), file) !=
                         inventory.volumes.end();
  return body_facts(file, is_volume);
}

/// No mesh tells its unit; a size that no laboratory has in mm is asked for.
std::string length_unit(const BodyFacts& body, Questions& questions) {
  const double size = body.diagonal();
  const bool plausible = size >= 2 && size <= 3000;
  return questions.ask({.name = "length",
                        .text = fmt::format("unit of the mesh, which is {:.3g} across", size),
                        .standard = plausible  ? "mm"
                                    : size < 2 ? "m"
                                               : "um",
                        .why = plausible ? "" : "in mm it would be a strange size for a laboratory",
                        .choices = {"mm", "cm", "m", "um"},
                        .asked = !plausible});
}

MachineRecord chosen_record(const Inventory& inventory, Questions& questions) {
  if (inventory.tables.empty()) {
    std::string instead;
    if (!inventory.other_tables.empty())
      instead = ": " + columns_told(inventory.other_tables.front());
    throw InputError({inventory.folder.string()},
                     "there is no table of a test machine in it" + instead,
                     "a csv or txt with named columns of a force, or of a travel with a time or a "
                     "photo's number; loads that no machine recorded are written by hand "
                     "(docs/capture.md)");
  }
  std::vector<fs::path> files;
  for (const TextTable& table : inventory.tables) files.push_back(table.file);
  const fs::path file =
      chosen(files, inventory.folder, "table", "which table is the machine's", questions);
  const auto at = std::find(files.begin(), files.end(), file) - files.begin();
  return machine_record(inventory.tables[static_cast<size_t>(at)], questions);
}

/// Each camera's photos that another one has; a load case goes without them.
void say_missing_photos(const ProposedCameras& cameras, std::vector<std::string>& said) {
  std::set<long> all;
  for (const auto& [camera, series] : cameras.cameras)
    for (const auto& [number, file] : series->photos) all.insert(number);
  for (const auto& [camera, series] : cameras.cameras) {
    std::vector<long> missing;
    for (const long number : all)
      if (!series->photos.contains(number)) missing.push_back(number);
    if (missing.empty()) continue;
    const size_t told = std::min<size_t>(missing.size(), 8);
    said.push_back(fmt::format(
        "of `{}` photos are missing that another camera has: {}{}", series->camera,
        fmt::join(missing.begin(), missing.begin() + static_cast<std::ptrdiff_t>(told), ", "),
        told < missing.size() ? fmt::format(" and {} more", missing.size() - told) : ""));
  }
}

double start_mu(const Parts& parts, Questions& questions) {
  const double guess = start_modulus(parts.loading, parts.record, parts.cases, parts.mm);
  const std::string stress = parts.length == "mm"  ? "MPa"
                             : parts.length == "m" ? "Pa"
                                                   : "N/" + parts.length + "^2";
  return questions.ask_number(
      {.name = "mu",
       .text = "shear modulus to start from, in " + stress,
       .standard = fmt::format("{:.2g}", guess > 0 ? guess : 0.05 * parts.mm * parts.mm),
       .why = guess > 0 ? "force over section and travel over length of the middle load case"
                        : "0.05 MPa, a soft silicone; may be ten times off"},
      true);
}

/// The law of a deck in the folder, that of the body first; the user may not want it.
std::optional<LawInDeck> law_of_a_deck(const Inventory& inventory, const BodyFacts& body,
                                       Questions& questions, std::vector<std::string>& said) {
  std::vector<fs::path> decks;
  for (const fs::path& file : inventory.volumes)
    if (is_deck(file)) decks.insert(file == body.file ? decks.begin() : decks.end(), file);
  for (const fs::path& file : decks) {
    std::optional<LawInDeck> law;
    try {
      law = law_in_deck(file);
    } catch (const InputError& error) {
      said.push_back(fmt::format("the material of {} is not taken: {}: {}",
                                 file.lexically_relative(inventory.folder).string(),
                                 error.place().str(), error.wrong()));
    }
    if (!law) continue;
    const std::string answer = questions.ask(
        {.name = "material",
         .text = "what to start from: the law of the deck, or a guess out of the machine's table",
         .standard = "deck",
         .why = fmt::format("{}, line {}", file.lexically_relative(inventory.folder).string(),
                            law->place.line),
         .choices = {"deck", "guess"},
         .asked = false});
    if (answer == "deck") {
      said.push_back(
          fmt::format("the material is that of {}, line {} (`--set material=guess`: of "
                      "the machine's table)",
                      file.lexically_relative(inventory.folder).string(), law->place.line));
      return law;
    }
    break;
  }
  return {};
}

std::string model_text(const Parts& parts, const fs::path& folder) {
  const std::string gravity = fmt::format("  # gravity: [0, 0, {:.6g}]\n", -9810 / parts.mm);
  if (!parts.law)
    return fmt::format(
               "model:\n  material: {{law: neo-hookean, mu: {:.3g}, kappa_over_mu: 12}}  # nearly "
               "incompressible\n  fit: [mu]\n",
               parts.mu) +
           gravity;
  const LawInDeck& law = *parts.law;
  std::string from = fs::path(law.place.file).lexically_relative(folder).string();
  std::replace_if(
      from.begin(), from.end(), [](unsigned char c) { return c < 32; }, '?');
  std::string out =
      fmt::format("model:\n  material: {}  # of {}, line {}\n", law.yaml, from, law.place.line);
  if (!law.to_fit.empty()) out += fmt::format("  fit: [{}]\n", fmt::join(law.to_fit, ", "));
  return out + gravity;
}

/// The path of a file from the capture's folder, which it may not leave.
std::string path_in(const fs::path& file, const fs::path& folder) {
  const fs::path relative = file.lexically_relative(folder);
  if (relative.empty() || *relative.begin() == "..")
    throw InputError({(folder / "capture.yaml").string()},
                     fmt::format("{} lies outside of the capture's folder", file.string()),
                     "a capture takes files from its own folder: leave -o out, or name the folder "
                     "of the photos or one above it");
  return yaml_name(relative.string());
}

std::string body_text(const Parts& parts, const fs::path& folder) {
  std::string out = fmt::format("body:\n  {}: {}\n", parts.body.is_volume ? "volume" : "surface",
                                path_in(parts.body.file, folder));
  if (!parts.body.is_volume)
    out += fmt::format("  mesh: {{edge: {:.3g}, order: 2}}  # a twelfth of the diagonal\n",
                       parts.edge);
  const double water = 1e-9 * std::pow(parts.mm, 4);  // N s^2/mm^4 in N s^2/length^4
  const bool told = parts.law && parts.law->density > 0;
  out += fmt::format(
      "  # density: {:.3g}  # of {}, in N s^2/{}^4; with `gravity` below the body weighs\n",
      told ? parts.law->density : 1.07 * water, told ? "the deck" : "silicone", parts.length);
  return out + parts.looks.texture;
}

std::string case_text(const Parts& parts, const std::string& name, const PairedPhoto& photo,
                      const fs::path& folder) {
  std::string out = fmt::format("    photos:\n");
  size_t found = 0;
  for (const auto& [camera, series] : parts.cameras.cameras) {
    const auto at = series->photos.find(photo.number);
    if (at == series->photos.end()) continue;
    ++found;
    out += fmt::format("      {}: {}\n", yaml_name(camera.name), path_in(at->second, folder));
  }
  if (found == 0)
    throw InputError({folder.string()}, fmt::format("no camera has a photo for `{}`", name),
                     "photos of one moment have one number in all cameras");
  return out;
}

std::string examples_text(const Parts& parts, const fs::path& folder) {
  const auto row = [&](const PairedPhoto& photo) {
    std::string out = fmt::format("photo {}, line {} of the table", photo.number, photo.line);
    if (!parts.record.time.empty()) out += fmt::format(", {:.6g} s", photo.time);
    if (!parts.record.force.empty()) out += fmt::format(", {:.4g} N", photo.force);
    if (!parts.record.travel.empty()) out += fmt::format(", {:.4g} mm", photo.travel);
    return out;
  };
  const auto& [rest, loads, said] = parts.cases;
  std::string out = fmt::format("examples:\n  rest:  # the reference image: {}\n", row(rest));
  out += "    supports:\n      - {region: held, fix: [x, y, z]}\n" +
         case_text(parts, "rest", rest, folder);
  for (const LoadCase& one : loads) {
    out += fmt::format("  {}:  # {}\n", one.name, row(one.photo));
    if (one.held_out) out += "    use: validate  # held out: not fitted, it judges\n";
    out +=
        loading_text(parts.loading, parts.record, one.photo, parts.mm, parts.pairing.clock_error) +
        case_text(parts, one.name, one.photo, folder);
  }
  return out;
}

std::string relative_name(const fs::path& file, const fs::path& folder) {
  return file.lexically_relative(folder).string();
}

/// A line of yaml, whatever names stand in it.
std::string comment(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32; }, '?');
  return "# " + text + "\n";
}

/// How well the cameras are known, where `hookeye calibrate` told. Lengths of its file are taken by
/// its unit, unless the cameras were scaled otherwise.
std::string covariance_text(const Parts& parts, const fs::path& folder) {
  const fs::path& file = parts.cameras.covariance;
  if (file.empty()) return "";
  const YamlNode root = load_yaml(file, file.string());
  const YamlNode* unit = root.find("unit");
  const auto mm = unit ? unit_in(unit->text, Quantity::length) : std::nullopt;
  const double by_unit = mm.value_or(1.0) / parts.mm;
  const std::string name = path_in(file, folder);
  if (std::abs(by_unit - parts.cameras.scale) < 1e-9 * by_unit)
    return "camera_covariance: " + name + "\n";
  return fmt::format("camera_covariance: {{from: {}, scale: {}}}\n", name, parts.cameras.scale);
}

std::string capture_text(const Parts& parts, const Inventory& inventory, const fs::path& file) {
  const fs::path folder = file.parent_path();
  const std::string table = relative_name(parts.record.file, folder);
  std::string out = "# A proposal of `hookeye new`. The format: docs/capture.md. Look at it by\n";
  out += comment("  hookeye check . -o look");
  out += comment("Photos are paired with rows of " + table + " " + parts.pairing.how + ".");
  for (const auto* said : {&parts.pairing.said, &parts.record.said})
    for (const std::string& one : *said) out += comment(one);
  out += fmt::format("hookeye: 1\ntitle: {}\n", yaml_name(inventory.folder.filename().string()));
  out += fmt::format("units: {{length: {}, force: N}}\n", parts.length);
  out += body_text(parts, folder);
  out += model_text(parts, folder);
  out += comment("Cameras of " + parts.cameras.source) + "cameras:\n";
  for (const auto& [camera, series] : parts.cameras.cameras) {
    if (camera.name != series->camera) out += "  " + comment("took the photos " + series->scheme);
    out += camera_text(camera);
  }
  out += covariance_text(parts, folder) + parts.looks.light + parts.looks.photos;
  out +=
      fmt::format("regions:\n  held: {}\n  pulled: {}\n", parts.loading.held, parts.loading.pulled);
  return out + examples_text(parts, folder);
}

void append(std::vector<std::string>& to, const std::vector<std::string>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

[[noreturn]] void refuse_without_photos(const Inventory& inventory) {
  std::string right = "photos as CAMERA_0001.tif, or a folder for each camera";
  if (!inventory.videos.empty())
    right = fmt::format("photos out of the video, by `hookeye import {} -o {}`",
                        inventory.videos.front().string(), inventory.folder.string());
  throw InputError({inventory.folder.string()}, "there are no photos with numbers in it", right);
}

/// Reads all and asks; the text is made where nothing is left open that has no default.
Parts gather(const Inventory& inventory, Questions& questions, std::vector<std::string>& said) {
  if (inventory.series.empty()) refuse_without_photos(inventory);
  Parts parts;
  parts.body = chosen_body(inventory, questions);
  parts.length = length_unit(parts.body, questions);
  parts.mm = *unit_in(parts.length, Quantity::length);
  parts.edge = parts.body.diagonal() / 12;
  parts.record = chosen_record(inventory, questions);
  parts.cameras = propose_cameras(inventory, parts.body, questions);
  say_missing_photos(parts.cameras, said);
  parts.pairing = pair_photos(*parts.cameras.cameras.front().second, parts.record, questions);
  parts.loading = propose_loading(parts.body, parts.record, questions, said);
  parts.looks = {};
  return parts;
}

}  // namespace

Proposal propose(const Inventory& inventory, const Questions::Answers& answers,
                 const fs::path& file) {
  Proposal out;
  Questions questions(answers);
  out.said = inventory.said;
  std::vector<std::string> said;
  Parts parts = gather(inventory, questions, said);
  const double count = questions.ask_number(
      {.name = "cases", .text = "how many load cases", .standard = "6", .asked = false}, true);
  if (count > 1000 || count != std::floor(count))
    refuse_answer("cases", fmt::format("{}", count), "a whole number from 1 to 1000");
  const fs::path folder = file.parent_path();
  parts.looks = propose_looks(inventory, parts.body, questions,
                              [&](const fs::path& one) { return path_in(one, folder); });
  out.needed = questions.needed();
  if (out.needed.empty())
    parts.cases = choose_cases(parts.pairing, parts.record, static_cast<size_t>(count));
  parts.law = law_of_a_deck(inventory, parts.body, questions, said);
  if (!parts.law) parts.mu = start_mu(parts, questions);
  questions.expect_no_other();
  out.questions = questions.all();
  out.open = questions.open();
  out.cameras = parts.cameras.source;
  out.pairing = parts.pairing.how;
  for (const auto* more :
       {&parts.record.said, &parts.cameras.said, &parts.pairing.said, &parts.cases.said, &said})
    append(out.said, *more);
  out.cases = parts.cases;
  out.timed = !parts.record.time.empty();
  if (out.needed.empty()) out.yaml = capture_text(parts, inventory, file);
  return out;
}

}  // namespace hookeye
