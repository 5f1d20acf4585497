#include "proposal/looks.h"

#include <fmt/format.h>

#include <algorithm>

#include "capture_io/coded_photo.h"
#include "capture_io/image.h"
#include "proposal/text_table.h"
#include "proposal/words.h"

namespace hookeye {
namespace {

/// 8 bits do not say whether they are brightness or its root: files of a photo camera hold sRGB, a
/// camera of a laboratory hands its pixels over as they are. EXIF may say it.
std::string encoding_of(const std::filesystem::path& photo, Questions& questions) {
  const ImageHeader header = read_image_header(photo);
  const bool told = !header.floating && !header.lossy && is_told_srgb(photo);
  if (header.floating || (header.bits > 8 && !told)) return "";
  return questions.ask(
      {.name = "encoding",
       .text = fmt::format("how the {} bits of a pixel hold brightness: linear (machine vision "
                           "camera) or srgb (photo camera)",
                           header.bits),
       .standard = header.lossy || told ? "srgb" : "linear",
       .why = header.lossy ? "JPEG"
              : told       ? "the photo's EXIF data say so"
                           : "no JPEG; cameras of laboratories store brightness itself",
       .choices = {"linear", "srgb"}});
}

/// "fit", "harmonics", "0.4" or "0.4,-0.3,-0.5,0.8,0.6": ambient, then where the sun is and its
/// strength.
std::string light_yaml(const std::string& answer) {
  if (answer == "fit") return "";
  if (answer == "harmonics") return "light: {harmonics: fit}\n";
  const auto parts = between_commas(answer);
  std::vector<double> numbers;
  for (const std::string& part : parts)
    if (const auto value = number_in(part, false)) numbers.push_back(*value);
  if (numbers.size() != parts.size() || (numbers.size() != 1 && numbers.size() != 5))
    refuse_answer("light", answer,
                  "fit, harmonics, or AMBIENT, or AMBIENT,X,Y,Z,STRENGTH of one lamp");
  std::string out = fmt::format("light:\n  ambient: {:.6g}\n", numbers[0]);
  if (numbers.size() == 5)
    out += fmt::format("  sun: {{toward: [{:.6g}, {:.6g}, {:.6g}], strength: {:.6g}}}\n",
                       numbers[1], numbers[2], numbers[3], numbers[4]);
  return out;
}

}  // namespace

Looks propose_looks(const Inventory& inventory, const BodyFacts& body, Questions& questions,
                    const std::function<std::string(const std::filesystem::path&)>& yaml_path) {
  Looks out;
  std::vector<std::string> choices{"rest", "uniform", "silhouette"};
  const bool mapped = !body.surface.uv.empty() && !inventory.textures.empty();
  if (mapped) choices.insert(choices.begin(), "albedo");
  const std::string texture = questions.ask(
      {.name = "texture",
       .text = fmt::format("what gives the surface its texture: {}the photos at rest, none "
                           "(uniform), or no matter (photos are silhouettes)",
                           mapped ? "its picture (albedo), " : ""),
       .standard = choices.front(),
       .why = mapped ? inventory.textures.front().filename().string() + " and texture coordinates"
                     : "the photo at rest shows it",
       .choices = choices});
  if (texture == "silhouette") {
    out.photos = "photos: {kind: silhouette}\n";
    return out;
  }
  const std::string encoding =
      encoding_of(inventory.series.front().photos.begin()->second, questions);
  if (!encoding.empty()) out.photos = fmt::format("photos: {{encoding: {}}}\n", encoding);
  if (texture == "rest") {
    out.texture = "  texture: {from: rest}\n";
    return out;
  }
  out.texture = texture == "uniform" ? "  texture: {uniform: fit}\n"
                                     : fmt::format("  texture: {{image: {}}}\n",
                                                   yaml_path(inventory.textures.front()));
  out.light = light_yaml(
      questions.ask({.name = "light",
                     .text = "light: fit (a sky and a sun), harmonics (several lamps or a window, "
                             "fitted), or AMBIENT, or AMBIENT,X,Y,Z,STRENGTH of one lamp",
                     .standard = "fit",
                     .why = "found from the photos"}));
  return out;
}

}  // namespace hookeye
