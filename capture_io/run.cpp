#include "capture_io/run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <system_error>

#include "capture_io/fingerprints.h"
#include "core/json_file.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string temporary_prefix = ".tmp-";
constexpr const char* kArchive = "archive";

/// An advisory lock on RUN/.lock, held as long as the object lives; the kernel drops it with the
/// process, so a kill leaves no stale lock.
class Lock {
 public:
  explicit Lock(const fs::path& folder) : file_(folder / ".lock") {
    handle_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (handle_ < 0)
      throw InputError({folder.string()}, "the run folder cannot be written",
                       "check its permissions or choose another folder");
    if (::flock(handle_, LOCK_EX | LOCK_NB) != 0) {
      ::close(handle_);
      throw InputError({folder.string()}, "another process is writing this run",
                       "wait until it has finished or choose another folder");
    }
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  ~Lock() { ::close(handle_); }

  /// False: the folder, or what was in it, was removed or moved since.
  bool still_there() const {
    struct stat ours {
    }, there{};
    return ::fstat(handle_, &ours) == 0 && ::stat(file_.c_str(), &there) == 0 &&
           ours.st_dev == there.st_dev && ours.st_ino == there.st_ino;
  }

 private:
  fs::path file_;
  int handle_ = -1;
};

/// What a kill in the middle of a step left over.
void remove_leftovers(const fs::path& folder) {
  std::vector<fs::path> doomed;
  const auto collect = [&](const fs::path& where) {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(where, ignored))
      if (entry.path().filename().string().rfind(temporary_prefix, 0) == 0)
        doomed.push_back(entry.path());
  };
  collect(folder);
  collect(folder / "steps");
  std::error_code ignored;
  for (const fs::directory_entry& step : fs::directory_iterator(folder / "steps", ignored))
    collect(step.path());
  for (const fs::path& path : doomed) fs::remove_all(path, ignored);
}

bool is_file_name(const std::string& name) {
  return !name.empty() && name[0] != '.' && name.find('/') == std::string::npos &&
         name.find('\0') == std::string::npos;
}

json read_timeline(const fs::path& folder) {
  const fs::path file = folder / "run.json";
  json timeline = read_json(file);
  if (!timeline.is_object() || timeline.value("hookeye", json()) != json(1))
    throw InputError({file.string()}, "this is not a run's timeline in format 1",
                     "choose another folder, or restore the file");
  expect_shape(timeline,
               {{"capture", "text"},
                {"?fingerprints", {{"*", "text"}}},
                {"steps", json::array({{{"name", "text"}}})}},
               file);
  for (const json& step : timeline["steps"])
    if (!is_file_name(step["name"]))
      throw InputError({file.string()}, "the name of a step is no name of a folder",
                       "restore the file, or start a new run");
  return timeline;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool same_content(const fs::path& a, const fs::path& b) {
  if (fs::is_directory(a) != fs::is_directory(b)) return false;
  if (!fs::is_directory(a)) return bytes_of(a) == bytes_of(b);
  size_t count = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(a)) {
    const fs::path other = b / entry.path().filename();
    if (!fs::exists(other) || !same_content(entry.path(), other)) return false;
    ++count;
  }
  return count ==
         static_cast<size_t>(std::distance(fs::directory_iterator(b), fs::directory_iterator()));
}

/// The capture's yaml, whether the user named it or its folder.
fs::path yaml_of(const fs::path& capture) {
  return fs::weakly_canonical(fs::is_directory(capture) ? capture / "capture.yaml" : capture);
}

/// Steps made from another text or other photos cannot stand beside those made from these. The
/// timeline takes the fingerprints of what its next step is made from.
void check_unchanged(json& timeline, const fs::path& folder) {
  using Marks = std::map<std::string, std::string>;
  const fs::path yaml = timeline["capture"].get<std::string>();
  const Marks now = fingerprints(yaml);
  const std::string changed = changed_since(timeline.value("fingerprints", now), now);
  if (now.empty()) return;
  if (!changed.empty() && !timeline["steps"].empty())
    throw InputError({(yaml.parent_path() / changed).string()},
                     fmt::format("this has changed since the run {} was made", folder.string()),
                     "name a new folder for the changed capture's run, or undo the change");
  timeline["fingerprints"] = now;
}

void check_name(const std::string& name) {
  if (!is_file_name(name)) throw std::invalid_argument("Run: not a file name: '" + name + "'");
}

}  // namespace

struct Run::Impl {
  fs::path folder;
  json timeline;
  std::unique_ptr<Lock> lock;               ///< empty: opened for reading
  bool began = false, made_folder = false;  ///< the run by this object, and its folder

  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  /// A run that began here and has no step to show is none.
  ~Impl() {
    if (!began || !timeline.at("steps").empty() || fs::exists(folder / kArchive)) return;
    remove_leftovers(folder);
    std::error_code ignored;
    if (!fs::is_empty(folder / "steps", ignored)) return;
    for (const char* name : {"run.json", "steps", ".lock"}) fs::remove(folder / name, ignored);
    if (made_folder) fs::remove(folder, ignored);
  }

  void store(json changed) {
    write_text(folder / "run.json", changed.dump(2) + "\n");
    timeline = std::move(changed);
  }
  /// Nothing is written into a folder that somebody has removed: it would come back with the half
  /// of a run.
  void demand_folder() const {
    if (!lock) throw std::logic_error("Run: opened for reading only");
    if (!lock->still_there())
      throw InputError({folder.string()},
                       "the run folder was removed or moved while it was written",
                       "leave it where it is until the command has ended; start the command again");
  }
};

Run::Run(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Run::Run(Run&&) noexcept = default;
Run& Run::operator=(Run&&) noexcept = default;
Run::~Run() = default;

Run Run::create(const fs::path& folder, const fs::path& capture) {
  std::error_code error;
  if (fs::exists(folder) && !fs::is_directory(folder))
    throw InputError({folder.string()}, "this is a file, not a folder",
                     "name a new folder for the run");
  const bool is_run = fs::exists(folder / "run.json");
  if (!is_run && fs::exists(folder)) {
    // A kill before run.json was written leaves only the lock, temporary files and empty steps/.
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      if (name == ".lock" || name.rfind(temporary_prefix, 0) == 0) continue;
      if (name == "steps" && fs::is_empty(entry.path())) continue;
      throw InputError({folder.string()},
                       fmt::format("the folder holds something else than a run: {}", name),
                       "name a new or empty folder for the run");
    }
  }
  const bool made = fs::create_directories(folder, error);
  if (error)
    throw InputError({folder.string()}, "the folder cannot be made: " + error.message(),
                     "choose a folder that you may write");
  if (is_run) {
    Run run = open(folder, true);
    if (run.capture() != yaml_of(capture))
      throw InputError(
          {folder.string()},
          fmt::format("the folder holds a run of another capture: {}", run.capture().string()),
          "name a new folder for this capture's run");
    return run;
  }
  auto impl = std::make_unique<Impl>();
  impl->folder = fs::canonical(folder);
  impl->lock = std::make_unique<Lock>(impl->folder);
  remove_leftovers(impl->folder);
  fs::create_directories(impl->folder / "steps");
  impl->store({{"hookeye", 1},
               {"capture", yaml_of(capture).string()},
               {"fingerprints", fingerprints(yaml_of(capture))},
               {"verdict", "unexplained"},
               {"steps", json::array()}});
  impl->began = true;
  impl->made_folder = made;
  return Run(std::move(impl));
}

Run Run::open(const fs::path& folder, bool write) {
  if (!fs::exists(folder / "run.json"))
    throw InputError({folder.string()}, "there is no run in this folder",
                     "make one with `hookeye fit CAPTURE -o RUN`");
  auto impl = std::make_unique<Impl>();
  impl->folder = fs::canonical(folder);
  if (write) impl->lock = std::make_unique<Lock>(impl->folder);
  impl->timeline = read_timeline(impl->folder);
  if (write) check_unchanged(impl->timeline, impl->folder);
  if (write) remove_leftovers(impl->folder);
  return Run(std::move(impl));
}

const fs::path& Run::folder() const { return impl_->folder; }
fs::path Run::capture() const { return impl_->timeline["capture"].get<std::string>(); }
fs::path Run::archive() const { return impl_->folder / kArchive; }
const json& Run::timeline() const { return impl_->timeline; }

std::vector<fs::path> Run::steps() const {
  std::vector<fs::path> folders;
  const json& steps = impl_->timeline["steps"];
  for (size_t i = 0; i < steps.size(); ++i)
    folders.push_back(impl_->folder / "steps" /
                      fmt::format("{:02}-{}", i, steps[i].at("name").get<std::string>()));
  return folders;
}

fs::path Run::add_step(const std::string& name, json entry,
                       const std::function<void(const fs::path&)>& write) {
  impl_->demand_folder();
  check_name(name);
  const std::string full = fmt::format("{:02}-{}", impl_->timeline["steps"].size(), name);
  const fs::path steps = impl_->folder / "steps";
  const fs::path temporary = steps / (temporary_prefix + full), final = steps / full;
  fs::create_directories(steps);
  fs::remove_all(temporary);
  fs::create_directory(temporary);
  try {
    write(temporary);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(temporary, ignored);
    impl_->demand_folder();  // the reason, where it was removed meanwhile
    throw;
  }
  // A folder of this number that run.json does not know was renamed just before a kill.
  for (const fs::directory_entry& other : fs::directory_iterator(steps))
    if (other.path().filename().string().rfind(full.substr(0, full.find('-') + 1), 0) == 0)
      fs::remove_all(other.path());
  fs::rename(temporary, final);
  json changed = impl_->timeline;
  entry["name"] = name;
  changed["steps"].push_back(std::move(entry));
  impl_->store(std::move(changed));
  return final;
}

void Run::add_file(const fs::path& step, const std::string& name,
                   const std::function<void(const fs::path&)>& write, bool replace) {
  impl_->demand_folder();
  check_name(name);
  // The temporary name keeps the extension: writers choose their format by it.
  const fs::path temporary = step / (temporary_prefix + name), final = step / name;
  fs::remove_all(temporary);
  try {
    write(temporary);
    if (!fs::exists(temporary)) throw std::logic_error("Run::add_file: nothing was written");
    if (fs::exists(final)) {
      if (same_content(temporary, final)) {
        fs::remove_all(temporary);
        return;
      }
      if (!replace)
        throw InputError({final.string()}, "the step already has this file with other content",
                         "finished steps are never changed: start a new run");
      if (fs::is_directory(final)) fs::remove_all(final);
    }
    fs::rename(temporary, final);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(temporary, ignored);
    impl_->demand_folder();
    throw;
  }
}

void Run::append_line(const std::string& name, const std::string& line) const {
  impl_->demand_folder();
  check_name(name);
  std::ofstream file(impl_->folder / name, std::ios::app);
  if (!(file << line << '\n' << std::flush))
    throw cannot_write((impl_->folder / name).string(), "the disk may be full");
}

void Run::update(const std::function<void(json&)>& change) {
  impl_->demand_folder();
  json changed = impl_->timeline;
  change(changed);
  impl_->store(std::move(changed));
}

}  // namespace hookeye
