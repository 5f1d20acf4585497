// hookeye compare: where the newest step of a run fails.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "app/commands/commands.h"
#include "app/commands/run_support.h"
#include "core/json_file.h"

namespace hookeye {
namespace {

using nlohmann::json;

/// Each of a table's bars ends at the largest chi, or at the floor where all are below it.
double scale_of(const std::vector<double>& chi, double floor) {
  return std::max(floor, chi.empty() ? 0.0 : *std::max_element(chi.begin(), chi.end()));
}

/// `own`: floors of some of the rows by themselves, in a column if there are any.
std::string chi_rows(const json& table_json, const std::string& head, double floor,
                     const json& own = json::object()) {
  std::vector<std::vector<std::string>> rows = {{head, "chi", "over floor", "|: floor"}};
  if (!own.empty()) rows.front().push_back("own floor");
  std::vector<double> all;
  for (const auto& chi : table_json) all.push_back(chi);
  for (const auto& [name, chi] : table_json.items()) {
    rows.push_back({name, fmt::format("{:.2f}", chi.get<double>()),
                    fmt::format("{:.2f}", chi.get<double>() / floor),
                    marked_bar(chi, floor, scale_of(all, floor))});
    if (own.empty()) continue;
    rows.back().push_back(own.contains(name) ? fmt::format("{:.2f}", own[name].get<double>()) : "");
  }
  return table(rows);
}

std::string photo_rows(const json& photos, double floor) {
  std::vector<std::vector<std::string>> rows = {
      {"example", "camera", "use", "chi", "|: floor", "over floor", "rms px", "what is left"}};
  std::vector<double> all;
  std::set<std::pair<std::string, std::string>> coloured;  // one row a channel
  for (const auto& photo : photos) {
    all.push_back(photo.at("chi"));
    if (photo.value("plane", 0) > 0) coloured.emplace(photo.at("example"), photo.at("camera"));
  }
  for (const auto& photo : photos) {
    const double chi = photo.at("chi");
    std::string camera = photo.at("camera");
    if (coloured.contains({photo.at("example"), camera}))
      camera += std::string(" ") + "rgb"[std::clamp(photo.at("plane").get<int>(), 0, 2)];
    rows.push_back({photo.at("example"), camera, photo.at("use"), fmt::format("{:.2f}", chi),
                    marked_bar(chi, floor, scale_of(all, floor)),
                    fmt::format("{:.2f}", chi / floor),
                    fmt::format("{:.3f}", photo.at("rms_px").get<double>()),
                    photo.at("only_noise").get<bool>() ? "noise" : "structure"});
  }
  return table(rows);
}

size_t components_of(const json& one) {
  return std::min({one.at("measured").size(), one.at("predicted").size(),
                   one.at("over_sigma").size(), size_t{3}});
}

/// A line for each component: three vectors side by side would not fit.
std::string measured_rows(const json& measured) {
  if (measured.empty()) return "";
  std::vector<std::vector<std::string>> rows = {
      {"example", "measured", "region", "", "value", "model", "unit", "over sigma"}};
  for (const auto& one : measured)
    for (size_t i = 0; i < components_of(one); ++i) {
      const auto component = [&](const char* key) {
        return fmt::format("{:.4g}", one.at(key).at(i).get<double>());
      };
      const auto once = [&](const char* key) {
        return i == 0 ? one.at(key).get<std::string>() : std::string();
      };
      rows.push_back({once("example"), once("kind"), once("region"),
                      components_of(one) > 1 ? std::string(1, "xyz"[i]) : "", component("measured"),
                      component("predicted"), one.value("unit", ""), component("over_sigma")});
    }
  return table(rows);
}

std::string field_rows(const json& fields, double floor) {
  if (fields.empty()) return "";
  std::vector<std::vector<std::string>> rows = {
      {"example", "field", "use", "points", "chi", "|: floor", "over floor", "rms", "unit"}};
  std::vector<double> all;
  for (const auto& one : fields) all.push_back(one.at("chi"));
  for (const auto& one : fields) {
    const double chi = one.at("chi");
    std::string example = one.at("example");
    if (one.contains("from")) example += " from " + one.at("from").get<std::string>();
    rows.push_back({example,
                    std::filesystem::path(one.at("file").get<std::string>()).filename().string(),
                    one.at("use"), fmt::format("{:.0f}", one.at("points").get<double>()),
                    fmt::format("{:.2f}", chi), marked_bar(chi, floor, scale_of(all, floor)),
                    fmt::format("{:.2f}", chi / floor),
                    fmt::format("{:.3g}", one.at("rms").get<double>()), one.at("unit")});
  }
  return table(rows);
}

json metrics_of(const std::filesystem::path& step) {
  const json chi = {{"*", "number"}}, numbers = json::array({"number"});
  const json photo = {{"example", "text"},   {"camera", "text"},   {"use", "text"},
                      {"chi", "number"},     {"?plane", "number"}, {"rms_px", "number"},
                      {"only_noise", "flag"}};
  const json measured = {{"example", "text"},   {"kind", "text"},       {"region", "text"},
                         {"measured", numbers}, {"predicted", numbers}, {"over_sigma", numbers},
                         {"?unit", "text"}};
  const json field = {{"example", "text"},  {"file", "text"},  {"use", "text"},
                      {"chi", "number"},    {"rms", "number"}, {"unit", "text"},
                      {"points", "number"}, {"?from", "text"}};
  const auto file = step / "metrics.json";
  json found = read_json(file);
  expect_shape(found,
               {{"chi_fit", "number|null"},
                {"chi_validate", "number|null"},
                {"floor", {{"chi", "number"}, {"source", "text"}, {"?by_camera", chi}}},
                {"photos", json::array({photo})},
                {"chi_by_example", chi},
                {"chi_by_camera", chi},
                {"?chi_by_region", chi},
                {"measured", json::array({measured})},
                {"?fields", json::array({field})},
                {"?converged", "flag"},
                {"?iterations", "number"},
                {"undetermined", json::array({"text"})}},
               file);
  return found;
}

void run_compare(const std::string& folder, Session& session) {
  const Run run = open_run(folder, false);
  if (run.steps().empty())
    throw InputError({folder}, "the run has no finished step",
                     "run 'hookeye fit CAPTURE -o RUN' first");
  const auto step = run.steps().back();
  const json metrics = metrics_of(step);
  const double floor = metrics["floor"]["chi"];
  session.document = metrics;
  session.say("{}", wrapped(fmt::format("step {}: chi {} fitted, {} held out; floor {:.3f} ({})",
                                        step.filename().string(), chi_text(metrics["chi_fit"]),
                                        chi_text(metrics["chi_validate"]), floor,
                                        metrics["floor"]["source"].get<std::string>())));
  const bool photos = !metrics["photos"].empty();  // else fields, or forces and positions alone
  if (photos) {
    session.say("{}\n", photo_rows(metrics["photos"], floor));
    session.say("{}\n", chi_rows(metrics["chi_by_example"], "by example", floor));
    session.say("{}\n", chi_rows(metrics["chi_by_camera"], "by camera", floor,
                                 metrics["floor"].value("by_camera", json::object())));
  }
  if (metrics.contains("chi_by_region") && !metrics["chi_by_region"].empty())
    session.say("{}\n", chi_rows(metrics["chi_by_region"], "by region", floor));
  // Beside photos the floor is theirs: fields are over their told noise.
  session.say("{}", field_rows(metrics.value("fields", json::array()), photos ? 1.0 : floor));
  session.say("{}", measured_rows(metrics["measured"]));
  if (const auto said =
          not_converged(metrics.value("converged", true), metrics.value("iterations", 0));
      !said.empty())
    session.warn(said);
  for (const auto& sentence : metrics["undetermined"]) session.say("{}", wrapped(sentence));
  say_pictures(step, session);
  session.say("bodies:   {}\n", (step / "deformed").string());
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
