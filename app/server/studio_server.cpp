#include "app/server/studio_server.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/server/refit_job.h"
#include "core/input_error.h"
#include "core/text_file.h"
#include "runs/report/inside.h"
#include "runs/report/page.h"

namespace hookeye {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// Requests of the studio are a few words.
constexpr size_t kLargestRequest = 4096;

class Studio {
 public:
  Studio(const fs::path& run, const ServerOptions& options)
      : server_({.lock = run / ".studio", .named = run}, options, kLargestRequest),
        view_(run),
        job_(run) {
    make_page(view_.document());  // fails here, not at the first request, when there is no page
    route();
    server_.open();
  }
  std::string address() const { return server_.address(); }
  void run() {
    server_.run([this] { job_.stop(); });
  }

 private:
  json document() {
    json out = view_.document();
    out["live"] = true;
    return out;
  }

  json job_state() {
    json out = job_.state();
    out["steps"] = view_.step_count();
    return out;
  }

  WebAnswer file(const WebRequest& request) {
    std::error_code error;
    const fs::path wanted = fs::canonical(view_.folder() / request.parameter("name"), error);
    static const std::string kKinds[] = {".json", ".vtu", ".csv", ".yaml", ".exr", ".png"};
    const bool kind =
        std::find(std::begin(kKinds), std::end(kKinds), wanted.extension()) != std::end(kKinds);
    if (error || !inside(view_.folder(), wanted) || !kind || !fs::is_regular_file(wanted))
      return refusal(404, "there is no such file in this run");
    std::string name = wanted.filename().string();
    std::replace_if(
        name.begin(), name.end(),
        [](unsigned char c) { return c < 32 || c == 127 || c == '"' || c == '\\'; }, '_');
    return {200, read_text(wanted), "application/octet-stream", name};
  }

  WebAnswer add(const WebRequest& request) {
    const json wanted = json::parse(request.body, nullptr, false);
    if (!wanted.is_object() || !wanted.contains("effect") || !wanted["effect"].is_string())
      return refusal(400, "tell the effect: {\"effect\": \"gravity\"}");
    const json take_back = wanted.value("take_back", json(false));
    if (!take_back.is_boolean())
      return refusal(400, "take_back is true or false, not " + take_back.dump());
    const AddRequest what{wanted["effect"], take_back};
    check_effect(what.effect);
    // A refit reads the newest step and writes beside it: no link may lead it elsewhere.
    if (const fs::path out = link_out_of(view_.folder()); !out.empty())
      return refusal(409, fmt::format("{} is a link out of this run: nothing is written here",
                                      out.lexically_relative(view_.folder()).string()));
    try {
      check_stands(open_run(view_.folder(), false), what);
    } catch (const InputError& error) {
      return refusal(409, error.what());
    }
    if (!job_.start(what)) return refusal(409, "a refit is running already");
    return answer_json(job_state());
  }

  void route() {
    server_.get("", [this](const WebRequest&) {
      return WebAnswer{200, make_page(document()), "text/html; charset=utf-8", ""};
    });
    server_.get("document", [this](const WebRequest&) { return answer_json(document()); });
    server_.get("job", [this](const WebRequest&) { return answer_json(job_state()); });
    server_.get("part", [this](const WebRequest& request) {
      auto blob = view_.blob(request.parameter("name"));
      if (!blob) return refusal(404, "there is no such part of this run");
      return WebAnswer{200, std::move(blob->bytes), blob->type, ""};
    });
    server_.get("file", [this](const WebRequest& request) { return file(request); });
    server_.post("add", [this](const WebRequest& request) { return add(request); });
    server_.post("stop", [this](const WebRequest&) {
      job_.stop();
      return answer_json(job_state());
    });
  }

  LocalServer server_;  ///< first: it locks the run
  RunView view_;
  RefitJob job_;
};

}  // namespace

void serve_studio(const fs::path& run, const ServerOptions& options,
                  const std::function<void(const std::string& address)>& ready) {
  Studio studio(run, options);
  ready(studio.address());
  studio.run();
}

}  // namespace hookeye
