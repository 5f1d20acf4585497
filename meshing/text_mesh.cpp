// Plain text formats that no library in Debian 12 reads: "nnodes ntets nodes_per_tet", and decks of
// Abaqus (inp). gmsh 4.8 has GModel::writeINP but no reader of them; the .inp that VTK 9.1 reads is
// AVS UCD, another format of that name. What moves or makes nodes and elements is obeyed (the
// placement of an instance) or refused, never passed over.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <sstream>
#include <string_view>
#include <unordered_map>

#include "meshing/detail.h"

namespace hookeye::detail {
namespace {

/// Lines of a file with their numbers; faults carry file and line.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : file_(file.string()), in_(file) {
    if (!in_) throw InputError({file_}, "cannot be read", "a readable file");
  }
  bool next() {
    if (!std::getline(in_, line_)) return false;
    ++number_;
    if (!line_.empty() && line_.back() == '\r') line_.pop_back();
    return true;
  }
  const std::string& line() const { return line_; }
  [[noreturn]] void fault(const std::string& wrong, const std::string& right) const {
    throw InputError({file_, number_}, wrong, right);
  }
  /// Fields of the line, separated by blanks and commas.
  std::vector<std::string_view> fields() const {
    std::vector<std::string_view> out;
    const std::string_view text = line_;
    size_t i = 0;
    while ((i = text.find_first_not_of(" \t,", i)) != std::string_view::npos) {
      const size_t end = std::min(text.find_first_of(" \t,", i), text.size());
      out.push_back(text.substr(i, end - i));
      i = end;
    }
    return out;
  }
  double real(std::string_view field) const {
    if (!field.empty() && field.front() == '+') field.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size()) {
      fault(fmt::format("'{}' is no number", field), "a number");
    }
    return value;
  }
  int integer(std::string_view field) const {
    int value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size()) {
      fault(fmt::format("'{}' is no whole number", field), "a whole number");
    }
    return value;
  }

 private:
  std::string file_;
  std::ifstream in_;
  std::string line_;
  int number_ = 0;
};

}  // namespace

RawVolume read_text_mesh(const std::filesystem::path& file) {
  Lines lines(file);
  const char* head = "nnodes ntets nodes_per_tet";
  if (!lines.next() || lines.fields().size() != 3) {
    lines.fault("the first line is not three counts", head);
  }
  const auto counts = lines.fields();
  const int n = lines.integer(counts[0]), m = lines.integer(counts[1]),
            per = lines.integer(counts[2]);
  const auto bytes = static_cast<double>(std::filesystem::file_size(file));
  if (n < 4 || m < 1 || (per != 4 && per != 10) || 6.0 * n + 2.0 * per * m > bytes) {
    lines.fault(fmt::format("{} nodes and {} tetrahedra of {} nodes cannot be", n, m, per),
                "at least 4 nodes and one tetrahedron of 4 or 10 nodes, all in the file");
  }
  RawVolume raw;
  raw.X.resize(3, n);
  raw.elements.resize(per, m);
  for (int i = 0; i < n; ++i) {
    if (!lines.next()) lines.fault(fmt::format("ends after {} of {} nodes", i, n), "all nodes");
    const auto f = lines.fields();
    if (f.size() != 3) lines.fault("a node needs three coordinates", "x y z");
    for (int k = 0; k < 3; ++k) raw.X(k, i) = lines.real(f[k]);
  }
  for (int e = 0; e < m; ++e) {
    if (!lines.next())
      lines.fault(fmt::format("ends after {} of {} elements", e, m), "all elements");
    const auto f = lines.fields();
    if (static_cast<int>(f.size()) != per) {
      lines.fault(fmt::format("{} nodes", f.size()), fmt::format("{} nodes", per));
    }
    for (int k = 0; k < per; ++k) {
      raw.elements(k, e) = lines.integer(f[k]);
      if (raw.elements(k, e) < 0 || raw.elements(k, e) >= n) {
        lines.fault(fmt::format("there is no node {}", raw.elements(k, e)),
                    fmt::format("0 to {}: nodes are counted from 0", n - 1));
      }
    }
    raw.element_names.push_back(std::to_string(e));
  }
  return raw;
}

namespace {

/// Abaqus' order of the mid nodes: 01 12 02 03 13 23; ours ends 23 13.
constexpr int kFromAbaqus[10] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

std::string upper(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return toupper(c); });
  return out;
}

class InpReader {
 public:
  explicit InpReader(const std::filesystem::path& file) : lines_(file) {}

  RawVolume read() {
    while (lines_.next()) {
      const std::string& line = lines_.line();
      if (line.rfind("**", 0) == 0 || line.find_first_not_of(" \t") == std::string::npos) continue;
      if (line[0] == '*') {
        keyword();
      } else {
        data();
      }
    }
    if (!pending_.empty()) lines_.fault("the last element has too few nodes", "all its nodes");
    if (in_instance_) lines_.fault("*INSTANCE is not closed", "*END INSTANCE");
    return finished();
  }

 private:
  enum class Block { other, node, element, node_set, element_set, instance };

  void keyword() {
    if (!pending_.empty()) lines_.fault("the element before has too few nodes", "all its nodes");
    const auto parts = lines_.fields();
    // Keywords may hold blanks ("*END STEP"), so only the first field up to a comma counts.
    const std::string word = upper(lines_.line().substr(0, lines_.line().find(',')));
    std::unordered_map<std::string, std::string> options;
    for (size_t i = 1; i < parts.size(); ++i) {
      const size_t equal = parts[i].find('=');
      const bool has_value = equal != std::string_view::npos;
      options[upper(parts[i].substr(0, equal))] =
          has_value ? std::string(parts[i].substr(equal + 1)) : "";
    }
    const auto trimmed = word.substr(0, word.find_last_not_of(" \t") + 1);
    block_ = Block::other;
    generate_ = options.contains("GENERATE");
    set_.clear();
    if (trimmed == "*NODE") {
      check_node_options(options);
      block_ = Block::node;
      set_ = options["NSET"];
    } else if (trimmed == "*ELEMENT") {
      if (options.contains("INPUT")) {
        lines_.fault("INPUT= is not followed", "one file with all nodes and elements");
      }
      begin_elements(upper(options["TYPE"]), options["ELSET"]);
    } else if (trimmed == "*NSET") {
      block_ = Block::node_set;
      set_ = options["NSET"];
    } else if (trimmed == "*ELSET") {
      block_ = Block::element_set;
      set_ = options["ELSET"];
    } else {
      structure(trimmed);
    }
  }

  /// Keywords that group, place or make nodes and elements.
  void structure(const std::string& word) {
    static const char* const makers[] = {"*SYSTEM", "*NGEN",  "*NFILL", "*NCOPY",
                                         "*NMAP",   "*ELGEN", "*ELCOPY"};
    if (word == "*INCLUDE") {
      lines_.fault("*INCLUDE is not followed", "one file with all nodes and elements");
    } else if (word == "*PART") {
      if (++parts_ > 1) lines_.fault("more than one part", "one part with one instance at most");
    } else if (word == "*INSTANCE") {
      if (++instances_ > 1) {
        lines_.fault("more than one instance", "one part with one instance at most");
      }
      in_instance_ = true;
      block_ = Block::instance;
    } else if (word == "*END INSTANCE") {
      for (auto& [label, x] : nodes_) x = placement_ * x;
      in_instance_ = false;
    } else if (std::find(std::begin(makers), std::end(makers), word) != std::end(makers)) {
      lines_.fault(fmt::format("{} is not obeyed", word),
                   "all nodes and elements written out, in the coordinates of the body");
    }
  }

  void check_node_options(const std::unordered_map<std::string, std::string>& options) const {
    const auto system = options.find("SYSTEM");
    if (system != options.end() && upper(system->second) != "R") {
      lines_.fault(fmt::format("nodes in coordinates of system {}", system->second),
                   "rectangular coordinates");
    }
    if (options.contains("INPUT")) {
      lines_.fault("INPUT= is not followed", "one file with all nodes and elements");
    }
  }

  void begin_elements(const std::string& type, const std::string& set) {
    const int nodes = type == "C3D4" || type == "C3D4H" ? 4 : type.rfind("C3D10", 0) == 0 ? 10 : 0;
    if (nodes == 0 && type.rfind("C3D", 0) == 0) {
      lines_.fault(fmt::format("elements of type {} are not read", type), "C3D4 or C3D10");
    }
    if (nodes == 0) return;  // shells, springs, masses: no part of the volume
    if (per_ != 0 && per_ != nodes) lines_.fault("mixes C3D4 and C3D10", "one order");
    per_ = nodes;
    block_ = Block::element;
    set_ = set;
  }

  void data() {
    switch (block_) {
      case Block::node:
        return add_node();
      case Block::element:
        return add_element();
      case Block::node_set:
        return add_set(node_sets_[set_]);
      case Block::element_set:
        return add_set(element_sets_[set_]);
      case Block::instance:
        return place_instance();
      case Block::other:
        return;
    }
  }

  /// First line: the translation. Second: two points of an axis and an angle in degrees, a turn
  /// about that axis after the translation (Abaqus Keywords Guide, *INSTANCE).
  void place_instance() {
    std::vector<double> v;
    for (const std::string_view f : lines_.fields()) v.push_back(lines_.real(f));
    const int line = ++placement_lines_;
    if (line == 1) v.resize(std::max<size_t>(v.size(), 3), 0.0);
    if (line > 2 || v.size() != (line == 1 ? 3 : 7)) {
      lines_.fault("no placement of an instance",
                   "x, y, z of a translation, then seven numbers of a rotation: two points of its "
                   "axis and degrees");
    }
    if (line == 1) {
      placement_ = Eigen::Translation3d(v[0], v[1], v[2]);
      return;
    }
    const Vector3d a(v[0], v[1], v[2]), axis = Vector3d(v[3], v[4], v[5]) - a;
    if (!(axis.norm() > 0.0)) lines_.fault("the axis has no direction", "two distinct points");
    const Eigen::AngleAxisd turn(v[6] * EIGEN_PI / 180.0, axis.normalized());
    placement_ = Eigen::Translation3d(a) * turn * Eigen::Translation3d(-a) * placement_;
  }

  void add_node() {
    const auto f = lines_.fields();
    if (f.size() < 4) lines_.fault("a node needs a number and three coordinates", "n, x, y, z");
    const int label = lines_.integer(f[0]);
    if (!nodes_
             .try_emplace(label, Vector3d(lines_.real(f[1]), lines_.real(f[2]), lines_.real(f[3])))
             .second) {
      lines_.fault(fmt::format("node {} is there twice", label), "each node once");
    }
    if (!set_.empty()) node_sets_[set_].push_back(label);
  }

  void add_element() {
    for (const std::string_view f : lines_.fields()) pending_.push_back(lines_.integer(f));
    const size_t full = static_cast<size_t>(per_) + 1;
    if (pending_.size() < full) return;  // goes on in the next line
    if (pending_.size() > full) {
      lines_.fault(fmt::format("element {} has {} nodes", pending_[0], pending_.size() - 1),
                   fmt::format("{} nodes", per_));
    }
    for (size_t k = 1; k < full; ++k) {
      if (!nodes_.contains(pending_[k])) {
        lines_.fault(
            fmt::format("element {} names node {}, which is not there", pending_[0], pending_[k]),
            "nodes given by *NODE before");
      }
    }
    if (!elements_.try_emplace(pending_[0], pending_.begin() + 1, pending_.end()).second) {
      lines_.fault(fmt::format("element {} is there twice", pending_[0]), "each element once");
    }
    if (!set_.empty()) element_sets_[set_].push_back(pending_[0]);
    pending_.clear();
  }

  void add_set(std::vector<int>& set) {
    const auto f = lines_.fields();
    if (generate_) {
      if (f.size() < 2) lines_.fault("GENERATE needs first, last and step", "first, last, step");
      const long first = lines_.integer(f[0]), last = lines_.integer(f[1]);
      const long step = f.size() > 2 ? lines_.integer(f[2]) : 1;
      if (first < 1 || step < 1) lines_.fault("no such range", "first >= 1, last, step >= 1");
      count_members((last - first) / step);
      for (long i = first; i <= last; i += step) set.push_back(static_cast<int>(i));
      return;
    }
    for (const std::string_view field : f) {
      if (isdigit(static_cast<unsigned char>(field[0]))) set.push_back(lines_.integer(field));
    }
  }

  /// A range takes no room in the file, but in memory.
  void count_members(long more) {
    constexpr long kMost = 20'000'000;
    generated_ += std::max(more, 0L);
    if (generated_ > kMost)
      lines_.fault(fmt::format("the ranges of the sets have more than {} members", kMost),
                   "ranges over numbers that the file has");
  }

  RawVolume finished() const {
    RawVolume raw;
    std::unordered_map<int, int> column_of, element_of;
    raw.X.resize(3, static_cast<Eigen::Index>(nodes_.size()));
    for (const auto& [label, x] : nodes_) {
      const int column = static_cast<int>(column_of.size());
      raw.X.col(column) = x;
      column_of[label] = column;
    }
    raw.elements.resize(per_, static_cast<Eigen::Index>(elements_.size()));
    for (const auto& [label, nodes] : elements_) {
      const int e = static_cast<int>(element_of.size());
      for (int k = 0; k < per_; ++k) {
        raw.elements(k, e) = column_of.at(nodes[static_cast<size_t>(kFromAbaqus[k])]);
      }
      element_of[label] = e;
      raw.element_names.push_back(std::to_string(label));
    }
    const auto translate = [](const std::map<std::string, std::vector<int>>& from,
                              const std::unordered_map<int, int>& index, auto& to) {
      for (const auto& [name, labels] : from) {
        for (const int label : labels) {
          const auto it = index.find(label);
          if (it != index.end()) to[name].push_back(it->second);
        }
      }
    };
    translate(node_sets_, column_of, raw.node_groups);
    translate(element_sets_, element_of, raw.volume_groups);
    return raw;
  }

  Lines lines_;
  Block block_ = Block::other;
  bool generate_ = false;
  long generated_ = 0;
  int per_ = 0, parts_ = 0, instances_ = 0, placement_lines_ = 0;
  bool in_instance_ = false;
  Eigen::Isometry3d placement_ = Eigen::Isometry3d::Identity();  ///< of the instance's nodes
  std::string set_;
  std::vector<int> pending_;
  std::map<int, Vector3d> nodes_;  ///< ascending labels: label i of a full numbering is column i-1
  std::map<int, std::vector<int>> elements_;
  std::map<std::string, std::vector<int>> node_sets_, element_sets_;
};

}  // namespace

RawVolume read_inp(const std::filesystem::path& file) { return InpReader(file).read(); }

}  // namespace hookeye::detail
