#include "app/server/edit_server.h"

#include <fmt/format.h>

#include <mutex>
#include <optional>
#include <set>

#include "app/server/check_job.h"
#include "app/server/edit_view.h"
#include "app/server/edited_text.h"
#include "app/server/nudged.h"
#include "app/server/place_job.h"
#include "capture_io/camera_text.h"
#include "capture_io/yaml_edit.h"
#include "capture_io/yaml_section.h"
#include "core/text_file.h"
#include "placing/edit.h"
#include "runs/report/page.h"

namespace hookeye {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// The largest capture that is read (YamlLimits), as a string of json.
constexpr size_t kLargestRequest = size_t{40} << 20;
/// Where a new section comes in: people tell load cases last.
constexpr const char* kAboveNew = "examples";
/// The longer side of a shown photo [px].
constexpr int kShownPhoto = 1600;

fs::path capture_file(const fs::path& told) {
  std::error_code error;
  const fs::path file = fs::is_directory(told, error) ? told / "capture.yaml" : told;
  if (!fs::is_regular_file(file, error))
    throw InputError({file.string()}, "there is no such capture",
                     "`hookeye new FOLDER` proposes one from photos, a calibration and a mesh");
  return fs::canonical(file);
}

InputError bad_request(const std::string& right) {
  return {{"request"}, "it cannot be understood", right};
}

Eigen::Vector3d vector_of(const json& request, const char* key) {
  const json told = request.value(key, json::array({0, 0, 0}));
  Eigen::Vector3d out;
  for (size_t i = 0; i < 3; ++i) {
    if (!told.is_array() || told.size() != 3 || !told[i].is_number())
      throw bad_request(fmt::format("`{}` is a list of three numbers", key));
    out[static_cast<Eigen::Index>(i)] = told[i];
  }
  return out;
}

class Editor {
 public:
  Editor(const fs::path& told, const ServerOptions& options)
      : text_(capture_file(told)),
        server_({.lock = text_.file().parent_path() /
                         fmt::format(".edit-{}", text_.file().filename().string()),
                 .named = told,
                 .server = "an editor",
                 .thing = "capture",
                 .short_name = "editor"},
                options, kLargestRequest),
        check_(text_.file()) {
    make_page(document());  // fails here where there is no page
    look();
    route();
    server_.open();
  }
  ~Editor() { remove_unnamed_lists(); }
  std::string address() const { return server_.address(); }
  void run() {
    server_.run([] {});
  }

 private:
  static json document() {
    return {{"hookeye", 1},
            {"edit", true},
            {"photos", json::array()},
            {"steps", json::array()},
            {"faults", json::array()},
            {"run", ""},
            {"timeline", {{"steps", json::array()}}}};
  }

  /// Reads the newest text and has it checked. The caller holds the lock.
  void look() {
    read_ = read_partly(text_.file(), text_.text());
    check_.start(text_.mark());
  }

  json state() {
    json out = describe_partly(read_);
    out["file"] = text_.file().string();
    out["text"] = text_.text();
    out["can_undo"] = text_.can_undo();
    out["can_redo"] = text_.can_redo();
    out["pictures"] = pictures_in(text_.file().parent_path());
    out["pulse"] = pulse();
    return out;
  }

  json pulse() {
    return {{"mark", text_.mark()},
            {"outside", text_.changed_outside()},
            {"check", check_.state()},
            {"place", place_.state()}};
  }

  /// {seen: MARK, ...}: the text that the page has shown.
  static json asked(const WebRequest& request) {
    json out = json::parse(request.body, nullptr, false);
    if (!out.is_object() || !out.contains("seen") || !out["seen"].is_string())
      throw bad_request("a map with `seen`, the mark of the text that was changed");
    return out;
  }

  void edit(const json& request) {
    std::string text = text_.text();
    const json edits = request.value("edits", json::array());
    if (!edits.is_array()) throw bad_request("`edits` is a list of {path, value}");
    for (const json& one : edits) {
      YamlEdit edit;
      if (!one.is_object() || !one.value("path", json()).is_array() || one["path"].empty())
        throw bad_request("`path` is a list of keys");
      for (const json& step : one["path"]) {
        if (!step.is_string()) throw bad_request("keys are strings");
        edit.path.push_back(step);
      }
      if (one.contains("value") && one["value"].is_string()) edit.value = one["value"];
      edit.above = kAboveNew;
      text = edited_yaml(text, text_.file().string(), edit);
    }
    text_.set(text, request["seen"]);
  }

  /// A list of triangles in a file of its own. Files are not changed, so that undo finds the old.
  std::string write_list(const std::string& region, const json& triangles) {
    YamlNode name;
    name.kind = YamlNode::Kind::map;
    name.entries.push_back({region, {"request"}, {}});
    read_named(name, "regions");
    std::string list;
    if (!triangles.is_array() || triangles.empty())
      throw bad_request("`triangles` is a list of numbers");
    for (const json& triangle : triangles) {
      if (!triangle.is_number_unsigned()) throw bad_request("triangles are numbers from 0 on");
      list += fmt::format("{}\n", triangle.get<size_t>());
    }
    const fs::path folder = text_.file().parent_path();
    for (int i = 1;; ++i) {
      const std::string file =
          i == 1 ? region + ".faces.txt" : fmt::format("{}.faces-{}.txt", region, i);
      std::error_code error;
      if (fs::exists(fs::symlink_status(folder / file, error))) {
        if (lists_.contains(file) && read_text(folder / file) == list) return file;
        continue;
      }
      write_text(folder / file, list);
      lists_.insert(file);
      return file;
    }
  }

  void faces(const json& request) {
    if (!request.contains("name") || !request["name"].is_string())
      throw bad_request("`name` of the region");
    const std::string name = request["name"];
    const std::string file = write_list(name, request.value("triangles", json()));
    text_.set(edited_yaml(text_.text(), text_.file().string(),
                          {.path = {"regions", name},
                           .value = "{faces: " + yaml_name(file) + "}",
                           .above = kAboveNew}),
              request["seen"]);
  }

  /// Lists that this session wrote and the capture does not name.
  void remove_unnamed_lists() {
    std::error_code ignored;
    for (const std::string& file : lists_)
      if (text_.text().find(file) == std::string::npos)
        fs::remove(text_.file().parent_path() / file, ignored);
  }

  const Camera& camera(const std::string& name) const {
    for (const Camera& one : read_.capture.cameras)
      if (one.name == name) return one;
    throw InputError({text_.file().string()}, fmt::format("there is no camera `{}`", name),
                     "one of `cameras:`");
  }

  void nudge(const json& request) {
    const ShownBody& shown = body();
    const Eigen::Vector3d middle =
        0.5 * (shown.surface.X.rowwise().maxCoeff() + shown.surface.X.rowwise().minCoeff());
    const ToldPlacement place =
        nudged(placement_of_capture(read_.root), camera(request.value("camera", "")),
               vector_of(request, "move"), vector_of(request, "turn"), middle);
    text_.set(placed_text(text_.text(), text_.file().string(), place), request["seen"]);
  }

  /// By pairs [{camera, pixel, point}], else by the outline; what is found is written at the end.
  void place(const json& request) {
    std::vector<std::string> pairs;
    for (const json& pair : request.value("pairs", json::array())) {
      if (!pair.is_object()) throw bad_request("`pairs` is a list of {camera, pixel, point}");
      const Eigen::Vector3d point = vector_of(pair, "point");
      const json pixel = pair.value("pixel", json());
      if (!pixel.is_array() || pixel.size() != 2 || !pixel[0].is_number() || !pixel[1].is_number())
        throw bad_request("`pixel` is a list of two numbers");
      pairs.push_back(fmt::format("{}:{},{}={},{},{}", camera(pair.value("camera", "")).name,
                                  pixel[0].get<double>(), pixel[1].get<double>(), point.x(),
                                  point.y(), point.z()));
    }
    const std::string seen = request["seen"];
    if (seen != text_.mark()) throw bad_request("the mark of the newest text as `seen`");
    const bool began = place_.start(text_.file(), pairs, [this, seen](const ToldPlacement& found) {
      const std::lock_guard lock(mutex_);
      text_.set(placed_text(text_.text(), text_.file().string(), found), seen);
      look();
    });
    if (!began) throw bad_request("wait for the place that is being looked for");
  }

  const ShownBody& body() {
    const std::string stamp = stamp_of(read_.capture.body);
    if (!body_ || stamp != body_stamp_) {
      body_ = shown_body(read_.capture.body);
      body_stamp_ = stamp;
    }
    return *body_;
  }

  WebAnswer photo(const WebRequest& request) {
    std::optional<PhotoSpec> wanted;
    {
      const std::lock_guard lock(mutex_);
      for (const ExampleSpec& example : read_.capture.examples)
        for (const PhotoSpec& one : example.photos)
          if (example.name == request.parameter("example") &&
              one.camera == request.parameter("camera"))
            wanted = one;
    }
    if (!wanted) return refusal(404, "the capture has no such photo");
    return {200, picture_of(*wanted, kShownPhoto), "image/png", ""};
  }

  using Change = void (Editor::*)(const json& request);
  void change(const std::string& name, Change what) {
    server_.post(name, [this, what](const WebRequest& request) {
      const json wanted = asked(request);
      const std::lock_guard lock(mutex_);
      (this->*what)(wanted);
      look();
      return answer_json(state());
    });
  }
  void text(const json& request) {
    if (!request.contains("text") || !request["text"].is_string())
      throw bad_request("`text` is the new text");
    text_.set(request["text"], request["seen"]);
  }
  void undo(const json& request) { text_.undo(request["seen"]); }
  void redo(const json& request) { text_.redo(request["seen"]); }
  void reload(const json&) { text_.reload(); }

  void route() {
    const auto locked = [this](const std::string& name, auto answer) {
      server_.get(name, [this, answer](const WebRequest& request) {
        const std::lock_guard lock(mutex_);
        return answer_json(answer(request));
      });
    };
    server_.get("", [](const WebRequest&) {
      return WebAnswer{200, make_page(document()), "text/html; charset=utf-8", ""};
    });
    locked("state", [this](const WebRequest&) { return state(); });
    locked("pulse", [this](const WebRequest&) { return pulse(); });
    locked("body", [this](const WebRequest&) { return describe_shown(body()); });
    locked("sight", [this](const WebRequest& request) {
      return describe_sight(body(), camera(request.parameter("camera")));
    });
    server_.get("photo", [this](const WebRequest& request) { return photo(request); });
    server_.post("try", [this](const WebRequest& request) {  // a text that is not written yet
      const json wanted = json::parse(request.body, nullptr, false);
      if (!wanted.is_object() || !wanted.value("text", json()).is_string())
        throw bad_request("`text` is the text to read");
      return answer_json({{"faults", describe_faults(read_partly(text_.file(), wanted["text"]))}});
    });
    change("text", &Editor::text);
    change("edit", &Editor::edit);
    change("faces", &Editor::faces);
    change("nudge", &Editor::nudge);
    server_.post("place", [this](const WebRequest& request) {
      const json wanted = asked(request);
      const std::lock_guard lock(mutex_);
      place(wanted);
      return answer_json(pulse());
    });
    server_.post("stop", [this](const WebRequest&) {
      place_.stop();
      return answer_json(place_.state());
    });
    change("undo", &Editor::undo);
    change("redo", &Editor::redo);
    change("reload", &Editor::reload);
  }

  std::mutex mutex_;
  EditedText text_;
  LocalServer server_;
  CheckJob check_;
  PartialCapture read_;
  std::set<std::string> lists_;  ///< files of triangles that this session wrote
  std::optional<ShownBody> body_;
  std::string body_stamp_;
  PlaceJob place_;  ///< last: what it finds goes into the others
};

}  // namespace

void serve_editor(const fs::path& capture, const ServerOptions& options,
                  const std::function<void(const std::string& address)>& ready) {
  Editor editor(capture, options);
  ready(editor.address());
  editor.run();
}

}  // namespace hookeye
