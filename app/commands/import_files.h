// What `hookeye import` writes beside cameras: files of one source, all or none of them.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/commands.h"
#include "importers/video.h"

namespace hookeye {

/// Files of other hands stay: throws InputError where one of these names is taken by them. Each
/// text begins with "# hookeye " or "** hookeye ", by which the program may write it anew; other
/// files, as pictures, stay where they differ.
void write_imported(const std::filesystem::path& folder,
                    const std::vector<std::pair<std::string, std::string>>& files);

/// The parts of a capture that decks of Abaqus or CalculiX hold.
void run_import_decks(const std::vector<std::filesystem::path>& decks,
                      const std::filesystem::path& folder, Session& session);

/// A textured scan as the body of a capture; `scale` as of cameras.
void run_import_scan(const std::filesystem::path& scan, double scale,
                     const std::filesystem::path& folder, Session& session);

/// Frames of videos, a camera each, as photos with times.
void run_import_videos(const std::vector<std::filesystem::path>& videos, const FrameChoice& choice,
                       const std::filesystem::path& folder, Session& session);

}  // namespace hookeye
