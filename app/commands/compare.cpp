// hookeye compare: where the newest step of a run fails.
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/commands/run_support.h"

namespace hookeye {
namespace {

using nlohmann::json;

std::string chi_rows(const json& table_json, const std::string& head, double floor) {
  std::vector<std::vector<std::string>> rows = {{head, "chi", "over floor", ""}};
  double most = 0.0;
  for (const auto& [name, chi] : table_json.items()) most = std::max(most, chi.get<double>());
  for (const auto& [name, chi] : table_json.items())
    rows.push_back({name, fmt::format("{:.2f}", chi.get<double>()),
                    fmt::format("{:.2f}", chi.get<double>() / floor),
                    bar(chi.get<double>() / most).substr(7)});
  return table(rows);
}

std::string photo_rows(const json& photos, double floor) {
  std::vector<std::vector<std::string>> rows = {
      {"example", "camera", "use", "chi", "over floor", "rms px", "what is left"}};
  for (const auto& photo : photos)
    rows.push_back({photo["example"], photo["camera"], photo["use"],
                    fmt::format("{:.2f}", photo["chi"].get<double>()),
                    fmt::format("{:.2f}", photo["chi"].get<double>() / floor),
                    fmt::format("{:.3f}", photo["rms_px"].get<double>()),
                    photo["only_noise"].get<bool>() ? "noise" : "structure"});
  return table(rows);
}

std::string measured_rows(const json& measured) {
  if (measured.empty()) return "";
  std::vector<std::vector<std::string>> rows = {
      {"example", "measured", "region", "value", "model", "over sigma"}};
  auto three = [](const json& v) {
    return fmt::format("{:.4g} {:.4g} {:.4g}", v[0].get<double>(), v[1].get<double>(),
                       v[2].get<double>());
  };
  for (const auto& one : measured)
    rows.push_back({one["example"], one["kind"], one["region"], three(one["measured"]),
                    three(one["predicted"]), three(one["over_sigma"])});
  return table(rows);
}

void run_compare(const std::string& folder, Session& session) {
  const Run run = Run::open(folder, false);
  if (run.steps().empty())
    throw InputError({folder}, "the run has no finished step",
                     "run 'hookeye fit CAPTURE -o RUN' first");
  const auto step = run.steps().back();
  const json metrics = json::parse(read_text(step / "metrics.json"));
  const double floor = metrics["floor"]["chi"];
  session.document = metrics;
  session.say("step {}: chi {:.3f} fitted, {:.3f} held out; floor {:.3f} ({})\n",
              step.filename().string(), metrics["chi_fit"].get<double>(),
              metrics["chi_validate"].get<double>(), floor,
              metrics["floor"]["source"].get<std::string>());
  session.say("{}\n", photo_rows(metrics["photos"], floor));
  session.say("{}\n", chi_rows(metrics["chi_by_example"], "by example", floor));
  session.say("{}\n", chi_rows(metrics["chi_by_camera"], "by camera", floor));
  if (metrics.contains("chi_by_region") && !metrics["chi_by_region"].empty())
    session.say("{}\n", chi_rows(metrics["chi_by_region"], "by region", floor));
  session.say("{}", measured_rows(metrics["measured"]));
  for (const auto& sentence : metrics["undetermined"])
    session.say("{}\n", sentence.get<std::string>());
  session.say("pictures: {}/*.png\nbodies:   {}/*.vtu\n", (step / "compare").string(),
              (step / "deformed").string());
}

}  // namespace

void add_compare(CLI::App& app, CommandBody& chosen) {
  CLI::App* command =
      app.add_subcommand("compare", "Pictures and figures of where the newest step fails");
  const auto folder = std::make_shared<std::string>();
  command->add_option("RUN", *folder, "Run folder")->required();
  command->callback([&chosen, folder] {
    chosen = [folder](Session& session) { run_compare(*folder, session); };
  });
}

}  // namespace hookeye
