#include "exporters/exporter.h"

namespace hookeye {

#define HOOKEYE_EXPORTER(NAME) const Exporter& exporter_##NAME();
#include "exporters/catalogue.def"
#undef HOOKEYE_EXPORTER

const std::vector<const Exporter*>& exporters() {
  static const std::vector<const Exporter*> all = {
#define HOOKEYE_EXPORTER(NAME) &exporter_##NAME(),
#include "exporters/catalogue.def"
#undef HOOKEYE_EXPORTER
  };
  return all;
}

const Exporter* find_exporter(const std::string& name) {
  for (const Exporter* exporter : exporters())
    if (exporter->name() == name) return exporter;
  return nullptr;
}

}  // namespace hookeye
