// The block of the catalogue and the sample's like, exported; decks read back.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <vector>

#include "estimation/model/declaration.h"
#include "exporters/exporter.h"
#include "simulation/equilibrium.h"
#include "support/temporary_folder.h"

namespace hookeye::test {

/// Lines of a deck behind a card that begins so, up to the next card.
inline std::vector<std::string> behind(const std::string& deck, const std::string& card) {
  std::vector<std::string> out;
  std::istringstream lines(deck);
  bool within = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("**")) continue;
    if (line.starts_with("*"))
      within = line.starts_with(card);
    else if (within)
      out.push_back(line);
  }
  return out;
}

/// Numbers between commas.
inline std::vector<double> numbers_of(const std::string& line) {
  std::vector<double> out;
  std::istringstream words(line);
  for (std::string word; std::getline(words, word, ',');)
    if (!word.empty()) out.push_back(std::stod(word));
  return out;
}

inline const std::string& file_of(const Exported& exported, const std::string& name) {
  for (const auto& [own, text] : exported.files)
    if (own == name) return text;
  throw std::runtime_error("no file " + name);
}

inline bool mentions(const std::vector<std::string>& sentences, const std::string& word) {
  for (const auto& sentence : sentences)
    if (sentence.find(word) != std::string::npos) return true;
  return false;
}

}  // namespace hookeye::test
