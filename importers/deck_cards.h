// Decks of Abaqus and CalculiX as cards: a keyword, its options and its lines. For this folder
// alone.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/input_error.h"

namespace hookeye::solver_deck {

struct CardLine {
  std::string text;
  Place place;
  /// Between commas, without blanks around; a comma at the end adds none.
  std::vector<std::string> fields() const;
};

struct Card {
  std::string word;                            ///< "*NODE PRINT": capitals, one blank between words
  std::map<std::string, std::string> options;  ///< by their names in capitals; "": without a value
  std::vector<CardLine> lines;
  Place place;

  bool has(const std::string& option) const { return options.contains(option); }
  /// The value of an option, "" where there is none.
  std::string option(const std::string& name) const;
  [[noreturn]] void fault(const std::string& wrong, const std::string& right) const;
};

std::string capitals(const std::string& text);
double real(const std::string& field, const Place& place);
int whole(const std::string& field, const Place& place);
/// Whether the field is a label and not a name.
bool is_label(const std::string& field);

/// All cards, those of included files in their places. `end`: the last line. Throws InputError.
std::vector<Card> read_cards(const std::filesystem::path& file, Place& end);

}  // namespace hookeye::solver_deck
