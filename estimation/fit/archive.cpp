#include "estimation/fit/archive.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/fingerprint.h"
#include "estimation/fit/crew.h"

namespace hookeye {

using nlohmann::json;

namespace {

constexpr double kSame = 1e-6;

bool same(double a, double b) {
  const double size = std::max(std::abs(a), std::abs(b));
  return a == b || (std::isfinite(size) && std::abs(a - b) <= kSame * (1.0 + size));
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return same(x, y); });
}

}  // namespace

struct Archive::Impl {
  struct Entry {
    std::vector<double> numbers;
    size_t record;
    const Journal* other;  ///< where it is; null: the own one
  };
  struct Result {
    Question question;
    std::any value;
  };
  std::unique_ptr<Journal> journal;
  std::vector<std::string> memory;                     ///< records, where there is no journal
  std::map<std::string, std::vector<Entry>> by_asked;  ///< by kind and fingerprint of the text
  std::map<std::string, Tally> tallies;
  std::shared_ptr<Crew> crew;
  std::map<std::shared_ptr<Journal>, size_t> others;  ///< how much of each is known
  int tasks = 0, depth = 0;
  std::vector<Result> results;  ///< of tasks

  static std::string asked(const Question& question) {
    return question.kind + " " + fingerprint_of(question.text);
  }
  std::string read(size_t record) const { return journal ? journal->read(record) : memory[record]; }
  const Entry* look_up(const Question& question) const {
    const auto same_text = by_asked.find(asked(question));
    if (same_text == by_asked.end()) return nullptr;
    const auto entry =
        std::find_if(same_text->second.begin(), same_text->second.end(),
                     [&](const Entry& one) { return same(one.numbers, question.numbers); });
    return entry == same_text->second.end() ? nullptr : &*entry;
  }
  size_t add(const std::string& record) {
    if (journal) return journal->add(record);
    memory.push_back(record);
    return memory.size() - 1;
  }
};

Archive::Archive(std::unique_ptr<Journal> journal) : impl_(std::make_unique<Impl>()) {
  impl_->journal = std::move(journal);
  for (size_t i = 0; impl_->journal && i < impl_->journal->size(); ++i) {
    const json entry = json::from_cbor(impl_->read(i));
    impl_->by_asked[entry.at("asked")].push_back({entry.at("numbers"), i, nullptr});
  }
}
Archive::~Archive() = default;

bool Archive::find(const Question& question, json& answer) {
  const Impl::Entry* entry = impl_->look_up(question);
  while (!entry && impl_->crew && !in_task() && impl_->crew->wait())
    entry = impl_->look_up(question);
  if (entry) {
    const auto text = entry->other ? entry->other->read(entry->record) : impl_->read(entry->record);
    answer = json::from_cbor(text).at("answer");
    ++impl_->tallies[question.kind].found;
  }
  if (on_event) on_event(question, entry ? Event::known : Event::anew);
  return entry;
}

void Archive::keep(const Question& question, const json& answer) {
  const std::string asked = Impl::asked(question);
  const json entry = {{"asked", asked}, {"numbers", question.numbers}, {"answer", answer}};
  const auto bytes = json::to_cbor(entry);
  impl_->by_asked[asked].push_back(
      {question.numbers, impl_->add(std::string(bytes.begin(), bytes.end())), nullptr});
  ++impl_->tallies[question.kind].kept;
  if (on_event) on_event(question, Event::kept);
}

void Archive::sync() const {
  if (impl_->journal) impl_->journal->sync();
}

void Archive::work_with(std::shared_ptr<Crew> crew) { impl_->crew = std::move(crew); }
Crew* Archive::crew() const { return impl_->crew.get(); }

bool Archive::learn_from(const std::shared_ptr<Journal>& other, bool copied) {
  size_t& known = impl_->others[other];
  other->look_again();
  const bool more = known < other->size();
  for (; known < other->size(); ++known) {
    const std::string record = other->read(known);
    const json entry = json::from_cbor(record);
    const Question question{"", "", entry.at("numbers")};
    auto& same_text = impl_->by_asked[entry.at("asked")];
    if (std::any_of(same_text.begin(), same_text.end(),
                    [&](const Impl::Entry& one) { return same(one.numbers, question.numbers); }))
      continue;
    same_text.push_back(
        {question.numbers, copied ? impl_->add(record) : known, copied ? nullptr : other.get()});
  }
  return more;
}

Archive::Task::Task(Archive& archive) : archive_(archive) { ++archive.impl_->tasks; }
Archive::Task::~Task() { --archive_.impl_->tasks; }
bool Archive::in_task() const { return impl_->tasks > 0; }
void Archive::drop_results() { impl_->results.clear(); }

Archive::Asking::Asking(Archive* archive) : archive_(archive) {
  if (archive_) ++archive_->impl_->depth;
}
Archive::Asking::~Asking() {
  if (archive_) --archive_->impl_->depth;
}

std::any Archive::Asking::result(const Question& question) const {
  auto& results = archive_->impl_->results;
  const auto found = std::find_if(results.begin(), results.end(), [&](const Impl::Result& one) {
    return one.question.kind == question.kind && one.question.text == question.text &&
           same(one.question.numbers, question.numbers);
  });
  if (archive_->in_task() || found == results.end()) return {};
  std::any out = std::move(found->value);
  results.erase(found);
  return out;
}

bool Archive::Asking::keeps() const { return archive_->in_task() && archive_->impl_->depth == 1; }

void Archive::Asking::keep(const Question& question, std::any result) const {
  archive_->impl_->results.push_back({question, std::move(result)});
}

bool Archive::empty() const { return impl_->by_asked.empty(); }

const std::map<std::string, Archive::Tally>& Archive::tallies() const { return impl_->tallies; }

}  // namespace hookeye
