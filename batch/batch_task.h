// What a batch is asked to do: one verb with its options, a task a capture.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace hookeye {

/// What all captures of a folder have in common.
struct BatchOrder {
  std::string verb;                  ///< "discover"
  std::vector<std::string> options;  ///< of the verb, for every capture
  std::string program;               ///< fingerprint of the program's file
  std::string version;               ///< the same for people
  bool reports = true;               ///< a page of every run

  bool operator==(const BatchOrder&) const = default;
};

/// What a batch may give captures to.
const std::vector<std::string>& batch_verbs();
/// Whether the verb's result is a run folder, with a verdict and parameters.
bool makes_run(const std::string& verb);

/// One capture. `key` is made of what its result depends on: all bytes of the capture's files, the
/// verb, the options and the program.
struct BatchTask {
  std::string key;                   ///< 32 hexadecimal digits
  std::string label;                 ///< for people: of the list, else the name of the folder
  std::filesystem::path capture;     ///< its yaml, absolute
  std::vector<std::string> options;  ///< of its row alone
  std::string content;               ///< fingerprint of the capture's files

  /// Of its files in the folder: the label without what a file's name may not hold, and the first
  /// digits of the key.
  std::string file_name() const;
};

/// Fingerprint of the names and bytes of all files that a capture consists of.
std::string content_of(const std::filesystem::path& yaml);
/// Sets content and key.
void set_key(BatchTask& task, const BatchOrder& order);

nlohmann::json to_json(const BatchOrder& order);
nlohmann::json to_json(const BatchTask& task);
/// Throw InputError for what is none; `file` is where they are from.
BatchOrder batch_order_from(const nlohmann::json& json, const std::filesystem::path& file);
BatchTask batch_task_from(const nlohmann::json& json, const std::filesystem::path& file);

}  // namespace hookeye
