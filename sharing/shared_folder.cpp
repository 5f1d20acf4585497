#include "sharing/shared_folder.h"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

class FolderOnDisk final : public SharedFolder {
 public:
  FolderOnDisk(fs::path path, bool lasting) : path_(std::move(path)), lasting_(lasting) {}

  std::vector<std::string> names(const std::string& folder) override {
    std::vector<std::string> out;
    for (const fs::directory_entry& entry : fs::directory_iterator(path_ / folder))
      if (std::string name = entry.path().filename().string(); name[0] != '.')
        out.push_back(std::move(name));
    return out;
  }
  bool exists(const std::string& file) override {
    std::error_code ignored;
    return fs::exists(path_ / file, ignored);
  }
  std::optional<std::string> read(const std::string& file) override {
    std::ifstream stream(path_ / file, std::ios::binary);
    if (!stream) return {};
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }
  void write(const std::string& file, const std::string& text) override {
    write_text(path_ / file, text);
  }
  void write_openly(const std::string& file, const std::string& text) override {
    const fs::path target = path_ / file;
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(target.c_str(), "we"),
                                                                 std::fclose);
    if (!stream || std::fwrite(text.data(), 1, text.size(), stream.get()) != text.size() ||
        std::fflush(stream.get()) != 0 || (lasting_ && ::fsync(::fileno(stream.get())) != 0))
      throw cannot_write(target.string(), std::strerror(errno));
  }
  bool rename(const std::string& from, const std::string& to) override {
    const fs::path source = path_ / from, target = path_ / to;
    if (std::rename(source.c_str(), target.c_str()) == 0) return true;
    const int why = errno;
    if (why == ENOENT) return false;
    throw cannot_write(target.string(), std::strerror(why));
  }
  bool link(const std::string& from, const std::string& to) override {
    const fs::path target = path_ / to;
    std::error_code failed;
    fs::create_hard_link(path_ / from, target, failed);
    if (failed && !fs::exists(target)) throw cannot_write(target.string(), failed.message());
    return !failed;
  }
  void remove(const std::string& file) override {
    std::error_code ignored;
    fs::remove(path_ / file, ignored);
  }
  double seconds() const override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

 private:
  fs::path path_;
  bool lasting_;
};

}  // namespace

std::shared_ptr<SharedFolder> folder_on_disk(const fs::path& folder, bool lasting) {
  return std::make_shared<FolderOnDisk>(folder, lasting);
}

}  // namespace hookeye
