// What `check` has seen, as lines, as JSON and as a page.
#pragma once

#include <filesystem>

#include "app/session.h"
#include "estimation/inspection/inspection.h"

namespace hookeye {

/// Fills "inspection" of the session's document.
void describe_inspection(const Scene& scene, const Inspection& inspection, Session& session);
/// One line a camera, one a load case.
void say_inspection(const Scene& scene, const Inspection& inspection, const Session& session);
/// FOLDER/index.html with all pictures inside: warnings, numbers, the model over every photo.
/// Returns the file.
std::filesystem::path write_inspection_page(const Scene& scene, const Inspection& inspection,
                                            const std::filesystem::path& folder);

}  // namespace hookeye
