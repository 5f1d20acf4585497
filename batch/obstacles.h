// What a batch cannot go on with: another program under its own name, a disk without room.
#pragma once

#include <filesystem>
#include <string>

namespace hookeye {

/// Which file the program is: another one under its name is another program.
struct FileMark {
  unsigned long long device = 0, inode = 0;
  long long seconds = 0, nanoseconds = 0, size = 0;
  bool operator==(const FileMark&) const = default;
};
FileMark mark_of(const std::filesystem::path& file);

/// So little room is left that nothing more is begun.
bool out_of_room(const std::filesystem::path& folder);
/// Whether a line of error says that a disk or a quota is full.
bool tells_a_full_disk(const std::string& line);

}  // namespace hookeye
