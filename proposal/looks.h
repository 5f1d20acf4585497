// What the photos' pixels and the body's surface are taken for.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "proposal/body_facts.h"
#include "proposal/inventory.h"
#include "proposal/questions.h"

namespace hookeye {

struct Looks {
  std::string texture;  ///< yaml below `body`; "": none
  std::string light;    ///< yaml at the top level; "": none
  std::string photos;   ///< yaml at the top level; "": none
};

/// `yaml_path` gives the path of a file in the capture.
Looks propose_looks(const Inventory& inventory, const BodyFacts& body, Questions& questions,
                    const std::function<std::string(const std::filesystem::path&)>& yaml_path);

}  // namespace hookeye
