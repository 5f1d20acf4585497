#include <fmt/format.h>

#include "importers/importer.h"

namespace hookeye {

#define HOOKEYE_IMPORTER(NAME) const Importer& importer_##NAME();
#include "importers/catalogue.def"
#undef HOOKEYE_IMPORTER

const std::vector<const Importer*>& importers() {
  static const std::vector<const Importer*> all = {
#define HOOKEYE_IMPORTER(NAME) &importer_##NAME(),
#include "importers/catalogue.def"
#undef HOOKEYE_IMPORTER
  };
  return all;
}

const Importer* find_importer(const std::string& name) {
  for (const Importer* importer : importers())
    if (importer->name() == name) return importer;
  return nullptr;
}

const Importer& recognise(const Importer::Sources& sources) {
  for (const auto& source : sources)
    if (std::error_code error; !std::filesystem::exists(source, error))
      throw InputError({source.string()}, "there is no such file or folder",
                       "name what the other program wrote");
  for (const Importer* importer : importers())
    if (importer->recognises(sources)) return *importer;
  std::string kinds;
  for (const Importer* importer : importers())
    kinds += (kinds.empty() ? "" : ", ") + importer->name();
  throw InputError({sources.front().string()}, "this looks like none of the sources that are read",
                   "name the kind before it: " + kinds);
}

}  // namespace hookeye
