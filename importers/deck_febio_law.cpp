// Materials of FEBio as laws here.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "importers/deck_febio.h"

namespace hookeye::solver_deck {
namespace {

class FebioLaw {
 public:
  FebioLaw(const XmlFile& xml, const XmlNode& material, Deck& deck)
      : xml_(xml), material_(material), deck_(deck) {}

  Law law() {
    const std::string type(material_.attribute("type"));
    if (type == "neo-Hookean") {
      deck_.say(
          xml_.place(material_),
          "FEBio's coupled neo-Hookean becomes `neo-hookean` of the same moduli at rest; they "
          "part where the volume changes much");
      return neo_hookean(E() / (2 * (1 + v())), E() / (3 * (1 - 2 * v())));
    }
    if (type == "incomp neo-Hookean") return volume_said(neo_hookean(need("G"), need("k")));
    if (type == "Mooney-Rivlin") {
      const double c1 = need("c1"), c2 = value("c2"), k = need("k");
      if (c2 == 0) return volume_said(neo_hookean(2 * c1, k));
      return volume_said(
          {fmt::format("{{law: mooney-rivlin, c10: {}, c01: {}, kappa: {}}}", c1, c2, k),
           {"c10", "c01"}});
    }
    if (type == "Yeoh") return yeoh();
    if (type == "Ogden") return ogden();
    if (type == "isotropic elastic" || type == "St.Venant-Kirchhoff")
      return {fmt::format("{{law: stvk, lambda: {}, mu: {}}}",
                          E() * v() / ((1 + v()) * (1 - 2 * v())), E() / (2 * (1 + v()))),
              {"lambda", "mu"}};
    deck_.say(xml_.place(material_),
              fmt::format("material type {} is not here: write a law of docs/capture.md", type));
    return {};
  }

 private:
  double value(const std::string& name) const {
    const XmlNode node = material_.child(name.c_str());
    if (!node) return 0;
    std::string text(node.text());
    const size_t first = text.find_first_not_of(" \t\r\n");
    text = first == std::string::npos ? "" : text.substr(first);
    text.erase(text.find_last_not_of(" \t\r\n") + 1);
    if (!node.attribute("type").empty() && node.attribute("type") != "const")
      throw InputError(xml_.place(node), fmt::format("<{}> is no number", name),
                       "a constant; a stiffness that varies is fitted by effects");
    return real(text, xml_.place(node));
  }
  double need(const std::string& name) const {
    if (!material_.child(name.c_str()))
      throw InputError(xml_.place(material_), fmt::format("the material lacks <{}>", name),
                       "all numbers of its law");
    const double out = value(name);
    if (!(out > 0))
      throw InputError(xml_.place(material_.child(name.c_str())),
                       fmt::format("<{}> is {}", name, out), "a number above zero");
    return out;
  }
  double E() const { return need("E"); }
  double v() const {
    const double out = value("v");
    if (!(out > -1 && out < 0.5))
      throw InputError(xml_.place(material_), fmt::format("Poisson's ratio is {}", out),
                       "between -1 and 0.5");
    return out;
  }

  static Law neo_hookean(double mu, double kappa) {
    return {fmt::format("{{law: neo-hookean, mu: {}, kappa: {}}}", mu, kappa), {"mu"}};
  }

  Law yeoh() {
    for (const char* higher : {"c4", "c5", "c6"})
      if (value(higher) != 0) {
        deck_.say(xml_.place(material_), "a Yeoh of more than three terms is not here");
        return {};
      }
    return volume_said({fmt::format("{{law: yeoh, c1: {}, c2: {}, c3: {}, kappa: {}}}", need("c1"),
                                    value("c2"), value("c3"), need("k")),
                        {"c1", "c2", "c3"}});
  }

  Law ogden() {
    std::vector<double> mu, alpha;
    for (int i = 1; i <= 6; ++i) {
      const double c = value(fmt::format("c{}", i)), m = value(fmt::format("m{}", i));
      if (c == 0) continue;
      if (m == 0)
        throw InputError(xml_.place(material_), fmt::format("<m{}> is zero or missing", i),
                         "an exponent of the stretches");
      mu.push_back(c / m), alpha.push_back(m);
    }
    if (mu.empty())
      throw InputError(xml_.place(material_), "an Ogden law without terms", "c1 and m1");
    return volume_said({fmt::format("{{law: ogden, mu: [{}], alpha: [{}], kappa: {}}}",
                                    fmt::join(mu, ", "), fmt::join(alpha, ", "), need("k")),
                        {}});
  }

  Law volume_said(Law law) {
    const std::string_view model = material_.child("pressure_model").text();
    if (model.find("Abaqus") == std::string_view::npos)
      deck_.say(xml_.place(material_),
                "the volumetric energy k/2 (log J)^2 becomes kappa/2 (J - 1)^2, the same where the "
                "volume hardly changes");
    return law;
  }

  const XmlFile& xml_;
  const XmlNode& material_;
  Deck& deck_;
};

}  // namespace

Law febio_law(const XmlFile& xml, const XmlNode& material, Deck& deck) {
  return FebioLaw(xml, material, deck).law();
}

}  // namespace hookeye::solver_deck
