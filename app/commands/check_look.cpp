#include "app/commands/check_look.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "core/base64.h"
#include "core/text_file.h"
#include "runs/text.h"

namespace hookeye {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isnan(value) ? Json() : Json(value); }

std::string text(double value, const char* format) {
  return std::isnan(value) ? "-" : fmt::format(fmt::runtime(format), value);
}

Json describe_apart(const std::optional<Apart>& apart) {
  if (!apart) return {};
  Json piece;
  if (apart->largest > 0.0)
    piece = {{"share", apart->largest},
             {"middle_px", {apart->x, apart->y}},
             {"size_px", {apart->width, apart->height}},
             {"still", apart->photos > 0 ? Json(apart->largest_still) : Json()}};
  return {{"photo_alone", apart->photo_alone},
          {"model_alone", apart->model_alone},
          {"largest_piece", piece},
          {"overlap_without_still", number(apart->without_still)}};
}

/// What lowers the overlap of a camera, in words; "": nothing does.
std::string words_of(const std::string& camera, const PhotoLook& look) {
  if (!look.apart) return {};
  const Apart& apart = *look.apart;
  std::string out = fmt::format(
      "{}: the overlap is {:.2f}, as of what photo and model cover {:.0f} % is in the photo alone "
      "and {:.0f} % in the model alone.",
      camera, look.overlap, 100.0 * apart.photo_alone, 100.0 * apart.model_alone);
  if (apart.largest > 0.0) {
    out += fmt::format(
        " The photo's largest piece ({:.0f} %, {:.0f} x {:.0f} px around ({:.0f}, "
        "{:.0f}))",
        100.0 * apart.largest, apart.width, apart.height, apart.x, apart.y);
    const std::string left_out = "`mask:` leaves it out, a `background: {photo: FILE}` with it too";
    if (apart.largest_still)
      out += fmt::format(
          " stands still in all {} photos of a load: a clamp or a table, not the "
          "body. Without what stands still the overlap is {:.2f}; {}.",
          apart.photos, apart.without_still, left_out);
    else
      out += fmt::format(
          "{}: if it is a clamp, a table or a shadow, {}. If it is the body, pose "
          "or shape are off.",
          apart.photos > 0 ? " does not stand still" : "", left_out);
  }
  if (apart.largest == 0.0 && apart.photo_alone > apart.model_alone)
    out +=
        " It is a rim, as pixels leave in small photos, or a pose or shape that are a little off.";
  if (apart.model_alone > apart.photo_alone)
    out +=
        " What the model alone has is hidden in the photo, as dark or bright as what is behind "
        "it, or misplaced (`check -o DIR` draws it).";
  return out;
}

Json describe_look(const Scene& scene, const PhotoLook& look) {
  const ExampleSpec& example = scene.capture.examples[static_cast<size_t>(look.example)];
  return {{"example", example.name},
          {"camera", example.photos[static_cast<size_t>(look.photo)].camera},
          {"at_rest", look.at_rest},
          {"overlap", number(look.overlap)},
          {"correlation", number(look.correlation)},
          {"texture_found", number(look.share)},
          {"off_px", number(look.shift_px)},
          {"apart", describe_apart(look.apart)},
          {"no_overlap", look.no_overlap},
          {"no_correlation", look.no_correlation},
          {"picture", look.picture.string()}};
}

Json describe_guess(const Scene& scene, const GuessLook& guess) {
  return {{"example", scene.capture.examples[static_cast<size_t>(guess.example)].name},
          {"displacement", number(guess.displacement)},
          {"to_first_order", number(guess.first_order)},
          {"seen_px", number(guess.seen_px)},
          {"expected_px", number(guess.expected_px)},
          {"cosine", number(guess.cosine)},
          {"failure", guess.failure}};
}

Json describe_warning(const CaptureWarning& warning) {
  return {{"question", warning.question}, {"file", warning.place.file},
          {"line", warning.place.line},   {"column", warning.place.column},
          {"seen", warning.seen},         {"right", warning.right}};
}

std::string figure(const std::filesystem::path& picture, const std::string& caption) {
  const std::string bytes = read_text(picture);
  return fmt::format(
      "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption>"
      "</figure>\n",
      html_text(caption), base64(bytes.data(), bytes.size()));
}

std::string caption(const Scene& scene, const PhotoLook& look) {
  const ExampleSpec& example = scene.capture.examples[static_cast<size_t>(look.example)];
  return fmt::format("{}, {}: overlap {}, texture found {}, off by {}", example.name,
                     example.photos[static_cast<size_t>(look.photo)].camera,
                     text(look.overlap, "{:.2f}"), text(100.0 * look.share, "{:.0f} %"),
                     text(look.shift_px, "{:.1f} px"));
}

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>hookeye check</title><style>
body { font: 16px/1.45 system-ui, sans-serif; margin: 1.5rem auto; max-width: 80rem; padding: 0 1rem;
  color: #1c1c1c; background: #fafafa }
h1 { font-size: 1.3rem } li { margin: .3rem 0 } code { font-size: .9em }
.photos { display: grid; grid-template-columns: repeat(auto-fill, minmax(18rem, 1fr)); gap: 1rem }
figure { margin: 0 } img { width: 100%; display: block } figcaption { font-size: .85rem }
@media (prefers-color-scheme: dark) { body { color: #e8e8e8; background: #16181a } }
</style></head><body>
)";

Json describe_field_motion(const Scene& scene, const FieldMotion& field) {
  return {{"example", scene.capture.examples[static_cast<size_t>(field.example)].name},
          {"file", field.file},
          {"holds", field.strain ? "strains" : "displacements"},
          {"seen", field.seen},
          {"expected", field.expected},
          {"cosine", field.cosine},
          {"seen_without_rigid", field.seen_bent},
          {"expected_without_rigid", field.expected_bent},
          {"cosine_without_rigid", field.cosine_bent}};
}

/// "7.2 times as far as expected" where it is far from what right captures have.
std::string times_text(double seen, double expected) {
  const double times = seen / expected, most = InspectionOptions{}.usual_times;
  if (!(std::abs(std::log(times)) > std::log(most)) || !std::isfinite(std::log(times))) return {};
  return times > 1.0 ? fmt::format("{:.3g} times as far as expected", times)
                     : fmt::format("1/{:.3g} as far as expected", 1.0 / times);
}

std::string remark(const GuessLook& guess) {
  std::string out = guess.failure.empty() ? "" : "to first order: " + guess.failure;
  const std::string times = times_text(guess.seen_px, guess.expected_px);
  if (!times.empty()) out += (out.empty() ? "" : "; ") + times;
  return out;
}

void say_field_motions(const Scene& scene, const Inspection& inspection, const Session& session) {
  const std::string& length = scene.capture.units.length;
  std::vector<std::vector<std::string>> rows{{"field", "example", "moves [" + length + "]",
                                              "expected", "cosine", "without rigid", "expected",
                                              "cosine", ""}};
  std::vector<std::vector<std::string>> strains{
      {"strain field", "example", "rms [millistrain]", "expected", "cosine", ""}};
  for (const FieldMotion& field : inspection.fields) {
    const std::string file = std::filesystem::path(field.file).filename().string();
    const std::string& example = scene.capture.examples[static_cast<size_t>(field.example)].name;
    const std::string times = times_text(field.seen, field.expected);
    if (field.strain)
      strains.push_back({file, example, text(1e3 * field.seen, "{:.3g}"),
                         text(1e3 * field.expected, "{:.3g}"), text(field.cosine, "{:.3f}"),
                         times});
    else
      rows.push_back({file, example, text(field.seen, "{:.3g}"), text(field.expected, "{:.3g}"),
                      text(field.cosine, "{:.3f}"), text(field.seen_bent, "{:.3g}"),
                      text(field.expected_bent, "{:.3g}"), text(field.cosine_bent, "{:.3f}"),
                      times});
  }
  if (rows.size() > 1) session.say("\n{}", table(rows));
  if (strains.size() > 1) session.say("\n{}", table(strains));
}

}  // namespace

void describe_inspection(const Scene& scene, const Inspection& inspection, Session& session) {
  Json& d = session.document["inspection"];
  for (const char* key : {"cameras", "photos", "first_guess", "fields", "warnings"})
    d[key] = Json::array();
  for (const auto& look : inspection.cameras) d["cameras"].push_back(describe_look(scene, look));
  for (const auto& look : inspection.photos) d["photos"].push_back(describe_look(scene, look));
  for (const auto& guess : inspection.guesses)
    d["first_guess"].push_back(describe_guess(scene, guess));
  for (const auto& one : inspection.fields)
    d["fields"].push_back(describe_field_motion(scene, one));
  for (const auto& one : inspection.warnings) d["warnings"].push_back(describe_warning(one));
  d["contact_sheet"] = inspection.sheet.string();
}

void say_inspection(const Scene& scene, const Inspection& inspection, const Session& session) {
  std::vector<std::vector<std::string>> rows{
      {"camera", "example", "overlap", "correlation", "texture found", "off by", "cannot be told"}};
  for (const auto& look : inspection.cameras) {
    const ExampleSpec& example = scene.capture.examples[static_cast<size_t>(look.example)];
    std::string why = look.no_overlap;
    if (!look.no_correlation.empty()) why += (why.empty() ? "" : "; ") + look.no_correlation;
    rows.push_back({example.photos[static_cast<size_t>(look.photo)].camera, example.name,
                    text(look.overlap, "{:.3f}"), text(look.correlation, "{:.3f}"),
                    text(100.0 * look.share, "{:.0f} %"), text(look.shift_px, "{:.2f} px"),
                    why.empty() ? "" : why});
  }
  if (rows.size() > 1) session.say("\nthe model over the photos\n{}", table(rows));
  for (size_t i = 0; i < inspection.cameras.size(); ++i)
    if (const std::string parted = words_of(rows[i + 1].front(), inspection.cameras[i]);
        !parted.empty())
      session.say("{}", wrapped(parted, 2));
  rows = {{"first guess", "moves [" + scene.capture.units.length + "]", "in photos", "expected",
           "cosine", ""}};
  for (const auto& guess : inspection.guesses)
    rows.push_back(
        {scene.capture.examples[static_cast<size_t>(guess.example)].name,
         text(std::isnan(guess.displacement) ? guess.first_order : guess.displacement, "{:.3g}"),
         text(guess.seen_px, "{:.3g} px"), text(guess.expected_px, "{:.3g} px"),
         text(guess.cosine, "{:.3f}"), remark(guess)});
  if (rows.size() > 1) session.say("\n{}", table(rows));
  say_field_motions(scene, inspection, session);
  if (!inspection.no_guess.empty())
    session.say("{}", wrapped("no first guess: " + inspection.no_guess));
}

std::filesystem::path write_inspection_page(const Scene& scene, const Inspection& inspection,
                                            const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::string page = kHead;
  page += fmt::format("<h1>{}</h1>\n<p><code>{}</code></p>\n",
                      html_text(scene.capture.title.empty() ? "check" : scene.capture.title),
                      html_text(scene.capture.file.string()));
  page += inspection.warnings.empty() ? "<p>None of the usual slips was found.</p>\n" : "<ul>\n";
  for (const auto& warning : inspection.warnings)
    page +=
        fmt::format("<li><code>{}</code>: {}. <em>{}</em></li>\n", html_text(warning.place.str()),
                    html_text(warning.seen), html_text(warning.right));
  if (!inspection.warnings.empty()) page += "</ul>\n";
  page +=
      "<p>Orange: the model's outline; blue: at rest; green: held; magenta: loaded or moved. "
      "Loaded "
      "states are a first guess at the values that the capture tells.</p>\n<div "
      "class=\"photos\">\n";
  for (const auto& look : inspection.photos) page += figure(look.picture, caption(scene, look));
  page += "</div></body></html>\n";
  const auto file = folder / "index.html";
  write_text(file, page);
  return file;
}

}  // namespace hookeye
