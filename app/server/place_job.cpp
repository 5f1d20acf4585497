#include "app/server/place_job.h"

#include <fmt/format.h>

#include <utility>

#include "core/input_error.h"

namespace hookeye {

using nlohmann::json;

namespace {

ToldPlacement place_of(const json& told) {
  ToldPlacement out;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto row = static_cast<size_t>(i);
    for (Eigen::Index k = 0; k < 3; ++k)
      out.R(i, k) = told.at("rotation").at(row).at(static_cast<size_t>(k));
    out.t[i] = told.at("translation").at(row);
  }
  out.fit = told.at("fit");
  return out;
}

std::string words_of(const json& document) {
  std::string out =
      fmt::format("Turned by {:.3g} degrees, moved by {:.3g}; off by {:.3g} {} (root mean square).",
                  document.at("turned_degrees").get<double>(), document.at("moved").get<double>(),
                  document.at("misfit").at("rms").get<double>(),
                  document.at("misfit").at("unit").get<std::string>());
  const json warnings = document.value("warnings", json::array());
  if (!warnings.empty()) out += " Warning: " + warnings.front().get<std::string>() + ".";
  if (warnings.size() > 1)
    out += fmt::format(" And {} more, by `hookeye place --dry-run`.", warnings.size() - 1);
  return out;
}

}  // namespace

PlaceJob::~PlaceJob() {
  stop();
  if (thread_.joinable()) thread_.join();
}

bool PlaceJob::start(const std::filesystem::path& file, const std::vector<std::string>& pairs,
                     Found found) {
  const std::lock_guard lock(mutex_);
  if (running_) return false;
  if (thread_.joinable()) thread_.join();
  running_ = true;
  stopped_ = false;
  state_ = {{"state", "running"}, {"message", ""}};
  std::vector<std::string> arguments{"place", "--json", "--dry-run", file.string()};
  for (const std::string& pair : pairs) arguments.insert(arguments.end(), {"--pair", pair});
  thread_ = std::thread([this, arguments = std::move(arguments), found = std::move(found)] {
    work(arguments, found);
  });
  return true;
}

void PlaceJob::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  program_.kill();
}

json PlaceJob::state() {
  const std::lock_guard lock(mutex_);
  return state_;
}

void PlaceJob::finish(const std::string& state, const std::string& message) {
  const std::lock_guard lock(mutex_);
  running_ = false;
  state_ = {{"state", stopped_ ? "stopped" : state}, {"message", stopped_ ? "" : message}};
}

void PlaceJob::work(std::vector<std::string> arguments, const Found& found) {
  const json document = program_.run(std::move(arguments), [this] {
    const std::lock_guard lock(mutex_);
    return !stopped_;
  });
  try {
    if (document.is_null()) return finish("failed", "`hookeye place` ended without an answer");
    if (document.contains("error"))
      return finish("failed", document["error"].value("message", "`hookeye place` failed"));
    found(place_of(document.at("placement")));
    finish("done", words_of(document));
  } catch (const std::exception& error) {
    finish("failed", error.what());
  }
}

}  // namespace hookeye
