#include "app/server/edited_text.h"

#include <utility>

#include "core/fingerprint.h"
#include "core/input_error.h"
#include "core/text_file.h"

namespace hookeye {
namespace {

/// Of a long session; 16 MiB is the largest capture.
constexpr size_t kMostSteps = 200;

void keep(std::vector<std::string>& steps, std::string text) {
  steps.push_back(std::move(text));
  if (steps.size() > kMostSteps) steps.erase(steps.begin());
}

}  // namespace

EditedText::EditedText(std::filesystem::path file)
    : file_(std::move(file)), text_(read_text(file_)), mark_(fingerprint_of(text_)) {}

bool EditedText::changed_outside() const { return fingerprint_of_file(file_) != mark_; }

void EditedText::expect_newest(const std::string& seen) const {
  if (seen != mark_)
    throw InputError({file_.string()}, "it was changed in another window of this page",
                     "look at its newest text and change that");
  if (changed_outside())
    throw InputError({file_.string()}, "another program has changed it meanwhile",
                     "take its text in first; nothing was written");
}

void EditedText::write(const std::string& text) {
  write_text(file_, text);
  text_ = text;
  mark_ = fingerprint_of(text_);
}

void EditedText::set(const std::string& text, const std::string& seen) {
  expect_newest(seen);
  if (text == text_) return;
  std::string old = text_;
  write(text);
  keep(before_, std::move(old));
  after_.clear();
}

void EditedText::undo(const std::string& seen) {
  expect_newest(seen);
  if (before_.empty()) return;
  std::string old = text_;
  write(before_.back());
  before_.pop_back();
  keep(after_, std::move(old));
}

void EditedText::redo(const std::string& seen) {
  expect_newest(seen);
  if (after_.empty()) return;
  std::string old = text_;
  write(after_.back());
  after_.pop_back();
  keep(before_, std::move(old));
}

void EditedText::reload() {
  std::string now = read_text(file_);
  if (now == text_) return;
  keep(before_, std::move(text_));
  after_.clear();
  text_ = std::move(now);
  mark_ = fingerprint_of(text_);
}

}  // namespace hookeye
