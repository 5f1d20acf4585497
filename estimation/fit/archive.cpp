#include "estimation/fit/archive.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/fingerprint.h"

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
  };
  std::unique_ptr<Journal> journal;
  std::vector<std::string> memory;                     ///< records, where there is no journal
  std::map<std::string, std::vector<Entry>> by_asked;  ///< by kind and fingerprint of the text
  std::map<std::string, Tally> tallies;

  static std::string asked(const Question& question) {
    return question.kind + " " + fingerprint_of(question.text);
  }
  std::string read(size_t record) const { return journal ? journal->read(record) : memory[record]; }
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
    impl_->by_asked[entry.at("asked")].push_back({entry.at("numbers"), i});
  }
}
Archive::~Archive() = default;

bool Archive::find(const Question& question, json& answer) {
  bool found = false;
  const auto same_text = impl_->by_asked.find(Impl::asked(question));
  if (same_text != impl_->by_asked.end())
    for (const Impl::Entry& entry : same_text->second) {
      if (found || !same(entry.numbers, question.numbers)) continue;
      answer = json::from_cbor(impl_->read(entry.record)).at("answer");
      found = true;
    }
  if (found) ++impl_->tallies[question.kind].found;
  if (on_event) on_event(question, found ? Event::known : Event::anew);
  return found;
}

void Archive::keep(const Question& question, const json& answer) {
  const std::string asked = Impl::asked(question);
  const json entry = {{"asked", asked}, {"numbers", question.numbers}, {"answer", answer}};
  const auto bytes = json::to_cbor(entry);
  impl_->by_asked[asked].push_back(
      {question.numbers, impl_->add(std::string(bytes.begin(), bytes.end()))});
  ++impl_->tallies[question.kind].kept;
  if (on_event) on_event(question, Event::kept);
}

bool Archive::empty() const { return impl_->by_asked.empty(); }

const std::map<std::string, Archive::Tally>& Archive::tallies() const { return impl_->tallies; }

}  // namespace hookeye
