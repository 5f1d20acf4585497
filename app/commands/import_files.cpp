#include "app/commands/import_files.h"

#include <system_error>

#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {

namespace fs = std::filesystem;

namespace {

/// The begin of a text of the program; "" of a picture.
std::string own_mark(const std::string& text) {
  for (const char* mark : {"# hookeye ", "** hookeye "})
    if (text.starts_with(mark)) return mark;
  return "";
}

}  // namespace

void write_imported(const fs::path& folder,
                    const std::vector<std::pair<std::string, std::string>>& files) {
  std::error_code error;
  std::vector<fs::path> fresh;
  for (const auto& [name, text] : files) {
    const fs::path file = folder / name;
    if (!fs::exists(file, error)) {
      fresh.push_back(file);
      continue;
    }
    const std::string there = read_text(file);
    if (there != text && !(own_mark(text).size() > 0 && there.starts_with(own_mark(text))))
      throw InputError({file.string()}, "there is another file of this name",
                       "another folder behind -o, or move the file away");
  }
  fs::create_directories(folder, error);
  if (error) throw cannot_write(folder.string(), error.message());
  try {
    for (const auto& [name, text] : files) write_text(folder / name, text);
  } catch (...) {
    for (const fs::path& file : fresh) fs::remove(file, error);
    throw;
  }
}

}  // namespace hookeye
