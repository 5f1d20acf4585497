// A question looks at a capture and may say a warning. To add one: questions/NAME.cpp with
//   void hookeye::inspection::ask_NAME(Sight& sight, Warnings& warnings)
// and HOOKEYE_QUESTION(NAME) in questions.def; its thresholds go to options.h, a mistake that it
// finds to tests/inspection/inspection_test.cpp.
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "capture_io/yaml_place.h"
#include "estimation/inspection/inspection.h"
#include "estimation/inspection/sight.h"

namespace hookeye::inspection {

/// Where warnings go, and where things stand in capture.yaml.
class Warnings {
 public:
  explicit Warnings(const Scene& scene);
  /// Of the question that is being asked.
  void say(const Place& place, std::string seen, std::string right);
  /// Adds to what this question has said with the same `right`; false: it has not.
  bool also(const std::string& right, const std::string& seen);
  Place place(std::initializer_list<std::string> path) const;
  bool has(std::initializer_list<std::string> path) const;

  std::string question;  ///< its name
  std::vector<CaptureWarning> all;

 private:
  std::optional<YamlPlaces> places_;  ///< none: the capture comes from no file
};

struct Question {
  std::string name;
  void (*ask)(Sight& sight, Warnings& warnings);
};
/// In the order in which they are asked.
const std::vector<Question>& questions();

}  // namespace hookeye::inspection
