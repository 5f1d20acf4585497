#include "importers/deck_cards.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "core/text_file.h"
#include "meshing/file_cursor.h"

namespace hookeye::solver_deck {
namespace {

namespace fs = std::filesystem;
constexpr int kDeepest = 16;

std::string trimmed(const std::string& text) {
  const size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

std::string unquoted(const std::string& text) {
  const bool quoted = text.size() > 1 && text.front() == '"' && text.back() == '"';
  return quoted ? text.substr(1, text.size() - 2) : text;
}

/// "* Node   print" is "*NODE PRINT".
std::string keyword(const std::string& field) {
  std::istringstream words(field.substr(1));
  std::string out = "*";
  for (std::string word; words >> word;) out += (out.size() > 1 ? " " : "") + capitals(word);
  return out;
}

class CardReader {
 public:
  void read(const fs::path& file, int depth) {
    std::istringstream text(read_text(file));
    Place place{file.string(), 0};
    std::string pending;  // of a keyword that goes on
    Place begun;
    for (std::string line; std::getline(text, line);) {
      ++place.line;
      line = trimmed(line);
      if (line.empty() || line.starts_with("**")) continue;
      if (line.find('\0') != std::string::npos)
        throw InputError(place, "this is no text", "an input deck of Abaqus or CalculiX");
      if (pending.empty() && line[0] != '*') {
        data(line, place);
        continue;
      }
      if (pending.empty()) begun = place;
      pending += line;
      if (line.back() == ',') continue;
      begin(pending, begun, file, depth);
      pending.clear();
    }
    end_ = place;
    if (!pending.empty())
      throw InputError(begun, "the deck ends within a keyword", "the whole deck");
  }

  std::vector<Card> cards_;
  Place end_;

 private:
  void data(const std::string& line, const Place& place) {
    if (cards_.empty())
      throw InputError(place, "the deck does not begin with a keyword",
                       "an input deck of Abaqus or CalculiX: keywords begin with *");
    cards_.back().lines.push_back({line, place});
  }

  void begin(const std::string& text, const Place& place, const fs::path& file, int depth) {
    Card card;
    card.place = place;
    const std::vector<std::string> fields = CardLine{text, place}.fields();
    card.word = keyword(fields.front());
    for (size_t i = 1; i < fields.size(); ++i) {
      const size_t equal = fields[i].find('=');
      card.options[capitals(trimmed(fields[i].substr(0, equal)))] =
          equal == std::string::npos ? "" : unquoted(trimmed(fields[i].substr(equal + 1)));
    }
    if (card.word != "*INCLUDE") {
      cards_.push_back(std::move(card));
      return;
    }
    const std::string input = card.option("INPUT");
    const fs::path included = file.parent_path() / input;
    std::error_code error;
    if (input.empty() || !fs::is_regular_file(included, error))
      card.fault(fmt::format("there is no file `{}` to include", input),
                 "the included file beside this one");
    if (depth >= kDeepest) card.fault("files include each other", "files that end");
    read(included, depth + 1);
  }
};

}  // namespace

std::vector<std::string> CardLine::fields() const {
  std::vector<std::string> out;
  size_t at = 0;
  while (at <= text.size()) {
    const size_t comma = std::min(text.find(',', at), text.size());
    out.push_back(trimmed(text.substr(at, comma - at)));
    at = comma + 1;
  }
  if (out.size() > 1 && out.back().empty()) out.pop_back();
  return out;
}

std::string Card::option(const std::string& name) const {
  const auto at = options.find(name);
  return at == options.end() ? "" : at->second;
}

void Card::fault(const std::string& wrong, const std::string& right) const {
  throw InputError(place, wrong, right);
}

std::string capitals(const std::string& text) {
  std::string out = text;
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return out;
}

double real(const std::string& field, const Place& place) {
  double value = 0;
  if (!detail::is_real(field, value))
    throw InputError(place, fmt::format("`{}` is no number", field.substr(0, 40)), "a number");
  return value;
}

int whole(const std::string& field, const Place& place) {
  int value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc() || end != field.data() + field.size() || field.empty())
    throw InputError(place, fmt::format("`{}` is no whole number", field.substr(0, 40)),
                     "a whole number");
  return value;
}

bool is_label(const std::string& field) {
  return !field.empty() &&
         std::all_of(field.begin(), field.end(), [](unsigned char c) { return std::isdigit(c); });
}

std::vector<Card> read_cards(const fs::path& file, Place& end) {
  CardReader reader;
  reader.read(file, 0);
  end = reader.end_;
  if (reader.cards_.empty())
    throw InputError({file.string()}, "the deck is empty", "an input deck of Abaqus or CalculiX");
  return std::move(reader.cards_);
}

}  // namespace hookeye::solver_deck
