#include "capture_io/partial_capture.h"

#include <algorithm>

#include "capture_io/camera_covariance.h"
#include "capture_io/capture_reader.h"
#include "capture_io/placement.h"
#include "capture_io/yaml_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using Kind = YamlNode::Kind;

class PartialReader {
 public:
  PartialReader(PartialCapture& out, const CaptureFolder& folder) : out_(out), folder_(folder) {}

  void read() {
    Capture& capture = out_.capture;
    tried([&] {
      const YamlSection top(out_.root, "the capture", capture_keys());
      check_version(top);
    });
    if (out_.root.kind != Kind::map) return;
    section("title", "", [&](const YamlNode& node) { capture.title = read_title(node); });
    section("units", "write `units: {length: mm, force: N}`",
            [&](const YamlNode& node) { capture.units = read_units(node); });
    section("body", "write `body: {surface: rest.obj}`",
            [&](const YamlNode& node) { capture.body = read_body(node, folder_); });
    section("model", "write `model: {material: {law: neo-hookean, mu: ..., kappa: ...}}`",
            [&](const YamlNode& node) { read_model(node, capture); });
    section("cameras", "", [&](const YamlNode& node) { cameras(node); });
    tried([&] { take_to_body(placement_of_capture(out_.root), capture.cameras); });
    section("camera_covariance", "",
            [&](const YamlNode& node) { read_camera_covariance(node, folder_, capture); });
    section("light", "", [&](const YamlNode& node) { capture.light = read_light(node); });
    section("photos", "",
            [&](const YamlNode& node) { defaults_ = read_photo_defaults(node, folder_); });
    section("regions", "", [&](const YamlNode& node) { regions(node); });
    section("examples", "write `examples: {rest: {photos: {CAMERA: FILE}}}`",
            [&](const YamlNode& node) { examples(node); });
    if (out_.faults.empty()) tried([&] { check_together(capture); });
  }

 private:
  template <class Work>
  bool tried(const Work& work) {
    try {
      work();
      return true;
    } catch (const InputError& fault) {
      out_.faults.push_back(fault);
      return false;
    }
  }

  /// `missing`: what to write where the section is not there; "": it need not be.
  template <class Work>
  void section(const std::string& key, const std::string& missing, const Work& work) {
    const YamlNode* node = out_.root.find(key);
    if (node)
      tried([&] { work(*node); });
    else if (!missing.empty())
      out_.faults.emplace_back(out_.root.place, "the capture has no `" + key + "`", missing);
  }

  /// A map with one entry of `of`.
  static YamlNode only(const YamlNode& of, YamlNode::Entry entry) {
    YamlNode node;
    node.kind = Kind::map;
    node.place = of.place;
    node.entries.push_back(std::move(entry));
    return node;
  }

  void cameras(const YamlNode& node) {
    const YamlNode all = section_in_place(node, "cameras", folder_);
    if (all.kind != Kind::map) read_cameras(all, folder_);  // says what is wrong
    for (const YamlNode::Entry& entry : all.entries)
      tried([&] {
        const auto read = read_cameras(only(all, entry), folder_);
        out_.capture.cameras.insert(out_.capture.cameras.end(), read.begin(), read.end());
      });
  }

  void regions(const YamlNode& node) {
    if (node.kind != Kind::map) read_regions(node, folder_);
    for (const YamlNode::Entry& entry : node.entries) {
      const bool good = tried([&] {
        out_.capture.regions.push_back(read_regions(only(node, entry), folder_).front());
      });
      if (!good) out_.capture.regions.push_back({entry.key, entry.place, RegionSpec::Group{""}});
    }
  }

  ExampleSpec whole(const YamlNode& all, const YamlNode::Entry& entry) const {
    return read_examples(only(all, entry), out_.capture, defaults_, folder_).front();
  }

  void examples(const YamlNode& told) {
    const YamlNode node = section_in_place(told, "examples", folder_);
    if (node.kind != Kind::map || node.entries.empty())
      read_examples(node, out_.capture, defaults_, folder_);
    for (const YamlNode::Entry& entry : node.entries) {
      try {
        out_.capture.examples.push_back(whole(node, entry));
      } catch (const InputError& fault) {
        const size_t known = out_.faults.size();
        out_.capture.examples.push_back(by_pieces(node, entry));
        if (out_.faults.size() == known) out_.faults.push_back(fault);
      }
    }
  }

  /// What of an example can be read: each of its keys alone, and of that each entry.
  ExampleSpec by_pieces(const YamlNode& all, const YamlNode::Entry& entry) {
    ExampleSpec out;
    out.name = entry.key;
    out.place = entry.place;
    const YamlNode* supports = entry.value.find("supports");
    for (const YamlNode::Entry& key : entry.value.entries)
      for (YamlNode::Entry& piece : pieces(key)) {
        YamlNode value = only(entry.value, piece);
        // Forces are measured where a support holds the body.
        if (piece.key == "measured" && supports && !out.supports.empty())
          value.entries.push_back({"supports", supports->place, *supports});
        tried([&] {
          ExampleSpec read = whole(all, {entry.key, entry.place, value});
          if (piece.key == "use") out.validate = read.validate, out.test = read.test;
          if (piece.key == "supports") append(out.supports, read.supports);
          if (piece.key == "loads") append(out.loads, read.loads);
          if (piece.key == "photos") append(out.photos, read.photos);
          if (piece.key == "measured") append(out.measured, read.measured);
        });
      }
    return out;
  }

  template <class List>
  static void append(List& to, const List& more) {
    to.insert(to.end(), more.begin(), more.end());
  }

  static std::vector<YamlNode::Entry> pieces(const YamlNode::Entry& key) {
    std::vector<YamlNode::Entry> out;
    for (const YamlNode& item : key.value.items) {
      out.push_back({key.key, key.place, key.value});
      out.back().value.items = {item};
    }
    for (const YamlNode::Entry& one : key.value.entries) {
      out.push_back({key.key, key.place, key.value});
      out.back().value.entries = {one};
    }
    if (out.empty()) out.push_back(key);
    return out;
  }

  PartialCapture& out_;
  const CaptureFolder& folder_;
  PhotoDefaults defaults_;
};

}  // namespace

PartialCapture read_partly(const fs::path& file, const std::string& text) {
  PartialCapture out;
  const fs::path given = file.parent_path().empty() ? fs::path(".") : file.parent_path();
  out.capture.folder = fs::canonical(given);
  out.capture.file = out.capture.folder / file.filename();
  const CaptureFolder folder{file.parent_path(), out.capture.folder};
  try {
    out.root = parse_yaml(text, file.string());
  } catch (const InputError& fault) {
    out.faults.push_back(fault);
    return out;
  }
  PartialReader(out, folder).read();
  return out;
}

}  // namespace hookeye
