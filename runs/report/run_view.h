// A run as the page sees it: one document that says what there is, and pictures and fields by name.
// Reads only. What is broken or not there yet is named in the document's "faults".
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "capture_io/capture.h"
#include "estimation/model/photo_reading.h"

namespace hookeye {

class RunView {
 public:
  /// Throws InputError when the folder holds nothing of a run.
  explicit RunView(std::filesystem::path folder);

  /// The document (studio/src/document.ts declares it). Reads the run anew at every call.
  /// `shrink_old`, `shrink_new`: by how much the pictures of earlier steps, and of the newest step
  /// and the photos, are reduced.
  nlohmann::json document(int shrink_old = 1, int shrink_new = 1);

  struct Blob {
    std::string bytes, type;
    bool text = false;
  };
  /// A part by the name that the document gives it. Empty: there is none. Thread-safe.
  std::optional<Blob> blob(const std::string& name);

  /// Finished steps in the folder now.
  size_t step_count() const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  nlohmann::json photos_json(nlohmann::json& faults, int shrink);
  nlohmann::json step_json(const std::filesystem::path& step, nlohmann::json& faults, int shrink);
  std::optional<Blob> photo_blob(const std::string& kind, const std::string& name, int shrink);
  std::optional<Blob> residual_blob(const std::string& step, const std::string& name, int shrink);

  struct Plane {
    PhotoSpec spec;
    Camera camera;
    PhotoReading reading;  ///< as the pictures of the newest step were
    int plane = 0;
  };
  std::filesystem::path folder_;
  std::mutex mutex_;
  std::optional<Capture> capture_;
  std::string capture_fault_;
  std::map<std::string, Plane> planes_;  ///< by EXAMPLE-CAMERA
};

}  // namespace hookeye
