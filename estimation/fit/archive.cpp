#include "estimation/fit/archive.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/fingerprint.h"
#include "estimation/fit/shared_work.h"

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

std::string_view bytes_of(const std::vector<double>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)};
}

std::string asked_of(const Question& question) {
  return question.kind + " " + fingerprint_of(question.text);
}

json from_bytes(const std::string& bytes) { return json::from_cbor(bytes); }

constexpr int kOwn = -1;

}  // namespace

struct Archive::Impl {
  struct Entry {
    std::vector<double> numbers;
    std::string from;
    int journal;  ///< kOwn, or which of the others'
    size_t record;
    bool of_before;     ///< was in the journal when it was opened
    size_t turn = 0;    ///< when it was asked or worked out in its turn; 0: it was not yet
    bool gone = false;  ///< another's, and cannot be read any more
  };
  std::unique_ptr<Journal> journal;
  std::vector<std::string> memory;                     ///< records, where there is no journal
  std::map<std::string, std::vector<Entry>> by_asked;  ///< by kind and fingerprint of the text
  std::vector<std::pair<std::string, size_t>> turns;   ///< entries that had theirs
  std::map<std::string, Tally> tallies;

  std::shared_ptr<SharedWork> shared;
  bool collect = false;
  std::vector<size_t> read_of;  ///< records of each of the others' journals that are known here
  std::set<std::string> at;     ///< questions that are this process' turn
  int ahead = 0;

  size_t add(const std::string& record) {
    if (journal) return journal->add(record);
    memory.push_back(record);
    return memory.size() - 1;
  }
  size_t add(const std::string& asked, const Question& question, const json& answer) {
    const json entry = {{"asked", asked},
                        {"numbers", question.numbers},
                        {"from", question.from},
                        {"answer", answer}};
    const auto bytes = json::to_cbor(entry);
    return add(std::string(bytes.begin(), bytes.end()));
  }
  void know(const json& record, int which, size_t number) {
    by_asked[record.at("asked")].push_back(
        {record.at("numbers"), record.at("from"), which, number, which == kOwn});
  }

  void look_at_others() {
    if (!shared) return;
    const auto& journals = shared->journals();
    read_of.resize(journals.size(), 0);
    for (size_t j = 0; j < journals.size(); ++j)
      for (; read_of[j] < journals[j]->size(); ++read_of[j])
        if (const auto record = journals[j]->read(read_of[j]))
          know(from_bytes(*record), static_cast<int>(j), read_of[j]);
  }

  void had_its_turn(const std::string& asked, size_t entry) {
    size_t& turn = by_asked.at(asked)[entry].turn;
    if (turn != 0) return;
    turns.emplace_back(asked, entry);
    turn = turns.size();
  }

  /// What had its turn before, the first of it; else exactly this; else what an earlier process
  /// left.
  std::optional<size_t> best(const std::string& asked, const Question& question) const {
    const auto place = by_asked.find(asked);
    if (place == by_asked.end()) return {};
    std::optional<size_t> first, exact, before;
    const std::vector<Entry>& entries = place->second;
    for (size_t i = 0; i < entries.size(); ++i) {
      const Entry& one = entries[i];
      if (one.gone || !same(one.numbers, question.numbers)) continue;
      if (one.turn != 0 && (!first || one.turn < entries[*first].turn)) first = i;
      if (one.from == question.from && bytes_of(one.numbers) == bytes_of(question.numbers))
        exact = exact.value_or(i);
      if (one.of_before) before = before.value_or(i);
    }
    return first ? first : exact ? exact : before;
  }

  bool known(const std::string& asked, const Question& question, json& answer) {
    while (const auto found = best(asked, question)) {
      Entry& entry = by_asked.at(asked)[*found];
      std::optional<std::string> record;
      if (entry.journal != kOwn)
        record = shared->journals()[static_cast<size_t>(entry.journal)]->read(entry.record);
      else
        record = journal ? journal->read(entry.record) : memory[entry.record];
      if (!record) {
        entry.gone = true;
        continue;
      }
      answer = from_bytes(*record).at("answer");
      if (collect && entry.journal != kOwn) {
        entry.record = add(asked, question, answer);
        entry.journal = kOwn;
      }
      had_its_turn(asked, *found);
      return true;
    }
    return false;
  }

  /// The same where others may be at it.
  bool known_to_anybody(const std::string& asked, const Question& question, json& answer,
                        const std::atomic<bool>* cancel) {
    if (known(asked, question, answer)) return true;
    if (!shared) return false;
    look_at_others();
    if (known(asked, question, answer)) return true;
    if (!shared->others()) return false;
    const std::string key = key_of(question);
    while (!(cancel && *cancel)) {
      if (shared->claim(key)) {
        look_at_others();  // between the look and the turn it may have been answered
        if (known(asked, question, answer)) {
          shared->finish(key, true);
          return true;
        }
        at.insert(key);
        return false;
      }
      shared->wait();
      look_at_others();
      if (known(asked, question, answer)) return true;
    }
    return false;
  }

  void finish(const Question& question, bool answered) {
    if (at.empty()) return;
    const auto place = at.find(key_of(question));
    if (place == at.end()) return;
    shared->finish(*place, answered);
    at.erase(place);
  }
};

Archive::Archive(std::unique_ptr<Journal> journal) : impl_(std::make_unique<Impl>()) {
  impl_->journal = std::move(journal);
  for (size_t i = 0; impl_->journal && i < impl_->journal->size(); ++i)
    impl_->know(from_bytes(impl_->journal->read(i)), kOwn, i);
}
Archive::~Archive() = default;

void Archive::share(std::shared_ptr<SharedWork> others, bool collect) {
  impl_->shared = std::move(others);
  impl_->collect = collect;
}

bool Archive::find(const Question& question, json& answer, const std::atomic<bool>* cancel) {
  const bool found = impl_->known_to_anybody(asked_of(question), question, answer, cancel);
  if (found) ++impl_->tallies[question.kind].found;
  if (on_event) on_event(question, found ? Event::known : Event::anew);
  return found;
}

void Archive::keep(const Question& question, const json& answer) {
  const std::string asked = asked_of(question);
  auto& entries = impl_->by_asked[asked];
  entries.push_back(
      {question.numbers, question.from, kOwn, impl_->add(asked, question, answer), false});
  impl_->had_its_turn(asked, entries.size() - 1);
  impl_->finish(question, true);
  ++impl_->tallies[question.kind].kept;
  if (on_event) on_event(question, Event::kept);
}

void Archive::leave(const Question& question) { impl_->finish(question, false); }

bool Archive::empty() const { return impl_->by_asked.empty(); }

bool Archive::may_go_ahead() const {
  return impl_->ahead == 0 && impl_->shared && impl_->shared->others();
}

Archive::Ahead::Ahead(Archive& archive) : archive_(archive), asked_(archive.impl_->turns.size()) {
  ++archive.impl_->ahead;
}

Archive::Ahead::~Ahead() {
  auto& turns = archive_.impl_->turns;
  for (; turns.size() > asked_; turns.pop_back())
    archive_.impl_->by_asked.at(turns.back().first)[turns.back().second].turn = 0;
  --archive_.impl_->ahead;
}

SharedWork* Archive::others() const { return impl_->shared.get(); }

std::string Archive::key_of(const Question& question) {
  const std::string mark = fingerprint_of(asked_of(question) + " " + question.from + " " +
                                          std::string(bytes_of(question.numbers)));
  return mark.substr(mark.find(':') + 1);
}

const std::map<std::string, Archive::Tally>& Archive::tallies() const { return impl_->tallies; }

}  // namespace hookeye
