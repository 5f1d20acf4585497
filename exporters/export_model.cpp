// What all programs get: README.txt, and the displacements found here to compare with.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "exporters/exporter.h"

namespace hookeye {
namespace {

/// Lines of at most 90 characters behind "- ".
std::string item(const std::string& text) {
  std::string out = "-", line = "-";
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    if (line.size() + 1 + word.size() > 90) {
      out += "\n ";
      line.assign(1, ' ');
    }
    out += " " + word;
    line += " " + word;
    at = end + 1;
  }
  return out + "\n";
}

std::string displacements(const SolverCase& one) {
  std::string out = "node,ux,uy,uz\n";
  for (Eigen::Index n = 0; 3 * n < one.displacement->size(); ++n)
    fmt::format_to(std::back_inserter(out), "{},{:.12g},{:.12g},{:.12g}\n", n + 1,
                   (*one.displacement)[3 * n], (*one.displacement)[3 * n + 1],
                   (*one.displacement)[3 * n + 2]);
  return out;
}

std::string material_text(const SolverModel& model) {
  std::string out;
  for (const auto& part : model.energy.parts) {
    std::string line = "material: " + part.term->name();
    for (const Parameter& p : part.term->parameters(model.units))
      line += fmt::format(", {} = {:.6g}{}{}", p.name, p.value, p.unit.empty() ? "" : " ", p.unit);
    if (part.weight.size()) line += "; it varies over the body";
    out += item(line);
  }
  for (const Added& a : model.added)
    out += item(fmt::format("added: {}: {}{}", a.name, a.sentence,
                            a.mechanical ? "" : " (of the pictures alone: not in these files)"));
  return out;
}

std::string case_text(const SolverModel& model, const SolverCase& one) {
  if (!one.strains) return item(one.name + ": nothing acts on the body; no file");
  std::string line = fmt::format("{} ({}): ", one.name, one.use);
  if (!one.displacement) return item(line + "Hookeye found no equilibrium");
  line += fmt::format(
      "largest displacement {:.5g} {}, volume ratios {:.4f} .. {:.4f}",
      one.displacement->reshaped(3, one.displacement->size() / 3).colwise().norm().maxCoeff(),
      model.units.length, one.lowest_J, one.highest_J);
  if (one.stiffness != 1.0)
    line += fmt::format("; stiffness {:.5g} times that of the material above", one.stiffness);
  return item(line);
}

std::string readme(const Exporter& exporter, const SolverModel& model, const Exported& exported) {
  const Units& u = model.units;
  std::string out =
      fmt::format("{}\n\nStep {} of a run of hookeye, for {}.\n",
                  model.title.empty() ? "untitled" : model.title, model.step, exporter.name());
  out += fmt::format(
      "Units: {}, {}, {}, s; density {}. {} {} tetrahedra, {} nodes.\n\n"
      "The model\n",
      u.length, u.force, u.stress(),
      model.density_told ? fmt::format("{:.6g} {} s^2/{}^4", model.density, u.force, u.length)
                         : "not told (1 stands in; gravity is the weight of a volume)",
      model.mesh().size(), model.mesh().order == 1 ? "linear" : "quadratic", model.mesh().nodes());
  out += material_text(model) + "\nLoad cases\n";
  for (const SolverCase& one : model.cases) out += case_text(model, one);
  out += "\nCASE.csv has the displacements that Hookeye found, by node as numbered in the files.\n";
  out += "\nNotes\n";
  for (const std::string& note : exported.notes) out += item(note);
  out += "\nWhat is lacking\n";
  for (const std::string& lack : exported.lacks) out += item(lack);
  if (exported.lacks.empty()) out += item("nothing");
  return out;
}

}  // namespace

Exported export_model(const Exporter& exporter, const SolverModel& model) {
  Exported out = exporter.write(model);
  if (exporter.of_pictures()) return out;
  if (exporter.name() != "json") {
    out.lacks.insert(out.lacks.begin(), model.lacks.begin(), model.lacks.end());
    for (const SolverCase& one : model.cases)
      if (one.strains && one.displacement)
        out.files.emplace_back(one.file + ".csv", displacements(one));
  }
  out.files.emplace_back("README.txt", readme(exporter, model, out));
  return out;
}

}  // namespace hookeye
