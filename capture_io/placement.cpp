#include "capture_io/placement.h"

#include "capture_io/camera_pose.h"
#include "capture_io/yaml_section.h"

namespace hookeye {
namespace {

constexpr const char* kRight =
    "write `placement: {rotation: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], translation: [0, 0, 300]}`; "
    "`hookeye place` finds it";

bool read_flag(const YamlNode& node) {
  return read_choice(node, "fit of the placement", {"true", "false"}) == "true";
}

}  // namespace

ToldPlacement read_placement(const YamlNode& node) {
  ToldPlacement out;
  if (node.kind != YamlNode::Kind::map) {
    if (node.kind != YamlNode::Kind::scalar) unexpected(node, "the placement", kRight);
    out.fit = read_choice(node, "the placement", {"fit", "given"}) == "fit";
    return out;
  }
  const YamlSection section(node, "the placement", {"rotation", "translation", "fit"});
  const YamlNode& rotation = section.need("rotation", kRight);
  if (rotation.kind != YamlNode::Kind::sequence || rotation.items.size() != 3)
    unexpected(rotation, "rotation of the placement", "three rows of three numbers are expected");
  for (int i = 0; i < 3; ++i)
    out.R.row(i) =
        read_vector3(rotation.items[static_cast<size_t>(i)], "a row of the placement's rotation")
            .transpose();
  const std::string fault = make_rotation(out.R);
  if (!fault.empty())
    throw InputError(rotation.place, "rotation of the placement " + fault, rotation_rule);
  out.t = read_vector3(section.need("translation", kRight), "translation of the placement");
  if (const YamlNode* fit = section.find("fit")) out.fit = read_flag(*fit);
  return out;
}

ToldPlacement placement_of_capture(const YamlNode& root) {
  const YamlNode* body = root.find("body");
  const YamlNode* placement = body ? body->find("placement") : nullptr;
  return placement ? read_placement(*placement) : ToldPlacement{};
}

void take_to_body(const ToldPlacement& placement, std::vector<Camera>& cameras) {
  if (placement.R.isIdentity(0.0) && placement.t.isZero(0.0)) return;
  for (Camera& camera : cameras) {
    camera.t += camera.R * placement.t;
    camera.R = camera.R * placement.R;
  }
}

}  // namespace hookeye
