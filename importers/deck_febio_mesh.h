// What all parts of a deck of FEBio are read by, and its mesh. For this folder alone.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/xml_file.h"
#include "importers/deck_split.h"

namespace hookeye::solver_deck {

inline std::string str(std::string_view text) { return std::string(text); }
/// Between blanks and commas.
std::vector<std::string> words_of(std::string_view text);

/// The file, and the deck that it becomes.
class FebioFile {
 public:
  /// Throws InputError for another version and for sections in files of their own.
  explicit FebioFile(const std::filesystem::path& file);
  const XmlFile& xml() const { return xml_; }
  XmlNode top() const { return top_; }
  Place place(const XmlNode& node) const { return xml_.place(node); }
  [[noreturn]] void fault(const XmlNode& node, const std::string& wrong,
                          const std::string& right) const;
  void leave(const XmlNode& node, const std::string& what);  ///< "... is left out"
  /// Of the text of a tag; `count` 0: as many as there are.
  std::vector<double> numbers(const XmlNode& node, size_t count) const;
  std::vector<int> labels(const XmlNode& node) const;
  int id_of(const XmlNode& node) const;
  /// Key of a node set in the deck, of several of the same nodes that of the first. Decks of one
  /// body may call two sets alike.
  std::string key_of(const std::string& set) const;
  /// Keeps a set for key_of().
  void keep(const std::string& name, LabelSet set);

  Deck deck;

 private:
  XmlFile xml_;
  XmlNode top_;
  std::string stem_;
  std::map<std::set<int>, std::string> first_;  ///< key by members
  std::map<std::string, std::string> alias_;    ///< a set's key, of the first of its members
};

/// <Mesh>: nodes, elements, node sets and surfaces.
class FebioMesh {
 public:
  explicit FebioMesh(FebioFile& file);
  /// Nodes of a set as they are listed, "@surface:NAME" too; null: there is none.
  const std::vector<int>* set(const std::string& name) const;
  /// Sides of a surface, face by face; null: there is none.
  const std::vector<std::set<Side>>* surface(const std::string& name) const;

 private:
  void add_nodes_and_elements();
  void add_elements(const XmlNode& elements);
  void add_sets();
  void keep_set(const std::string& name, const std::vector<int>& members, const XmlNode& node);
  std::set<Side> sides_of_face(const XmlNode& face, const std::vector<int>& nodes) const;

  FebioFile& file_;
  Splitter splitter_;
  std::map<std::array<int, 3>, Side> side_of_;
  std::map<std::string, std::vector<int>> in_order_;
  std::map<std::string, std::vector<std::set<Side>>> faces_;
};

}  // namespace hookeye::solver_deck
