// The only file that touches gmsh: msh 2.2 / 4.1 and medit meshes. A program of its own.
#include <fmt/format.h>
#include <gmsh.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <unordered_map>

#include "core/helper_main.h"
#include "meshing/detail.h"
#include "meshing/parcels.h"
#include "meshing/whole_numbers.h"

namespace hookeye::detail {
namespace {

/// Silent, without the user's start-up files.
class Session {
 public:
  Session() {
    gmsh::initialize(0, nullptr, false);
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::option::setNumber("General.AbortOnError", 2);  // throw
    gmsh::logger::start();
  }
  ~Session() { gmsh::finalize(); }
  /// What gmsh said was wrong.
  static std::string complaint() {
    std::vector<std::string> log;
    gmsh::logger::get(log);
    for (const std::string& line : log) {
      if (line.rfind("Error: ", 0) == 0) return line.substr(7);
    }
    return "";
  }
};

using Tags = std::vector<std::size_t>;

/// Elements of one kind with their nodes, over the entities of a dimension.
struct Block {
  int dimension, entity, type;
  Tags elements, nodes;
};

std::vector<Block> blocks(int dimension) {
  std::vector<Block> out;
  gmsh::vectorpair entities;
  gmsh::model::getEntities(entities, dimension);
  for (const auto& [dim, tag] : entities) {
    std::vector<int> types;
    std::vector<Tags> elements, nodes;
    gmsh::model::mesh::getElements(types, elements, nodes, dim, tag);
    for (size_t i = 0; i < types.size(); ++i) {
      out.push_back({dim, tag, types[i], std::move(elements[i]), std::move(nodes[i])});
    }
  }
  return out;
}

std::string group_name(int dimension, int tag) {
  std::string name;
  gmsh::model::getPhysicalName(dimension, tag, name);
  return name.empty() ? std::to_string(tag) : name;
}

std::vector<std::string> groups_of(const Block& block) {
  std::vector<int> tags;
  gmsh::model::getPhysicalGroupsForEntity(block.dimension, block.entity, tags);
  std::vector<std::string> names;
  for (const int tag : tags) names.push_back(group_name(block.dimension, std::abs(tag)));
  return names;
}

/// In msh 2 a group belongs to the element, and gmsh gives it to all elements of the same
/// elementary tag. What a text file says itself: groups by an element's corners, ascending. Empty:
/// not told.
class OwnGroups {
 public:
  explicit OwnGroups(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    double version = 0;
    int binary = 0;
    size_t count = 0;
    while (std::getline(in, line) && line.rfind("$Elements", 0) != 0)
      if (line.rfind("$MeshFormat", 0) == 0) in >> version >> binary;
    if (version < 2 || version >= 3 || binary != 0 || !(in >> count)) return;
    std::getline(in, line);
    for (size_t i = 0; i < count && std::getline(in, line); ++i) add(line);
  }
  /// Of one element of a block.
  std::vector<std::string> of(const Block& block, const std::size_t* nodes, size_t corners,
                              const std::vector<std::string>& all) const {
    if (all.size() < 2) return all;
    const auto found = groups_.find(key(nodes, corners));
    if (found == groups_.end()) return all;
    std::vector<std::string> names;
    for (int tag : found->second) names.push_back(group_name(block.dimension, tag));
    return names;
  }

 private:
  static Tags key(const std::size_t* nodes, size_t corners) {
    Tags out(nodes, nodes + corners);
    std::sort(out.begin(), out.end());
    return out;
  }
  /// "number type count-of-tags group elementary ... nodes"
  void add(const std::string& line) {
    std::istringstream in(line);
    size_t number = 0;
    int type = 0, tags = 0, group = 0, other = 0;
    in >> number >> type >> tags;
    if (tags < 1 || !(in >> group) || group == 0) return;
    for (int i = 1; i < tags && in >> other;) ++i;
    const size_t corners = type == 4 || type == 11 ? 4 : type == 2 || type == 9 ? 3 : 0;
    Tags nodes(corners);
    for (std::size_t& node : nodes) in >> node;
    if (corners && in) groups_[key(nodes.data(), corners)].insert(std::abs(group));
  }
  std::map<Tags, std::set<int>> groups_;
};

/// Nodes a text msh announces (0: unknown): gmsh leaves out silently those of no element.
int announced_nodes(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  int version = 0, binary = 0;
  while (std::getline(in, line) && line.rfind("$Nodes", 0) != 0) {
    if (line.rfind("$MeshFormat", 0) == 0 && std::getline(in, line)) {
      std::istringstream format(line);
      double number = 0;
      format >> number >> binary;
      version = static_cast<int>(number);
    }
  }
  int first = 0, second = 0;
  if (binary != 0 || !(in >> first)) return 0;
  return version >= 4 && in >> second ? second : first;
}

/// gmsh takes a medit file for whole wherever it ends: what it announces has to be there.
void expect_all_tetrahedra(const std::filesystem::path& file, Eigen::Index held,
                           const Place& place) {
  if (file.extension() != ".mesh") return;
  std::ifstream in(file);
  Eigen::Index announced = 0;
  for (std::string word; in >> word;)
    if (word.starts_with("Tetrahedra") && in >> announced) break;
  if (announced > held)
    throw InputError(
        place,
        fmt::format("{} announces {} tetrahedra and holds {}", file.string(), announced, held),
        "the whole file");
}

/// Elements of a text msh 2 and of a medit file.
void check_numbers(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  double version = 0;
  int binary = 0;
  bool counts = file.extension() == ".mesh";
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.starts_with("$MeshFormat") && std::getline(in, line)) {
      ++number;
      std::istringstream(line) >> version >> binary;
      if (binary != 0 || version >= 4) return;
    }
    if (line.starts_with('$')) counts = line.starts_with("$Elements");
    if (counts) check_whole_numbers(line, {file.string(), number});
  }
}

/// Node tags ascending: node i of a file numbered without gaps becomes column i-1.
std::unordered_map<std::size_t, int> read_nodes(RawVolume& raw) {
  Tags tags;
  std::vector<double> positions, parameters;
  gmsh::model::mesh::getNodes(tags, positions, parameters, -1, -1, false, false);
  Tags ascending = tags;
  std::sort(ascending.begin(), ascending.end());
  ascending.erase(std::unique(ascending.begin(), ascending.end()), ascending.end());
  std::unordered_map<std::size_t, int> column_of;
  for (size_t i = 0; i < ascending.size(); ++i) column_of[ascending[i]] = static_cast<int>(i);
  raw.X.resize(3, static_cast<Eigen::Index>(ascending.size()));
  for (size_t i = 0; i < tags.size(); ++i) {
    raw.X.col(column_of[tags[i]]) = Eigen::Map<const Vector3d>(positions.data() + 3 * i);
  }
  return column_of;
}

/// gmsh's element types: 4 and 11 are tetrahedra, 2 and 9 triangles of order 1 and 2.
void take_tetrahedra(RawVolume& raw, const std::unordered_map<std::size_t, int>& column_of,
                     const OwnGroups& own, const std::filesystem::path& file) {
  struct Tet {
    std::size_t tag;
    const std::size_t* nodes;
    const Block* block;
  };
  const std::vector<Block> all = blocks(3);
  std::vector<Tet> tets;
  int type = 0;
  for (const Block& block : all) {
    if (block.type != 4 && block.type != 11) {
      throw InputError({file.string()},
                       fmt::format("element {} is no tetrahedron with 4 or 10 nodes",
                                   block.elements.empty() ? 0 : block.elements[0]),
                       "only tetrahedra of order 1 or 2 in the volume");
    }
    if (type != 0 && block.type != type) {
      throw InputError({file.string()}, "mixes tetrahedra of order 1 and 2", "one order");
    }
    type = block.type;
    const size_t n = type == 4 ? 4 : 10;
    for (size_t i = 0; i < block.elements.size(); ++i) {
      tets.push_back({block.elements[i], block.nodes.data() + n * i, &block});
    }
  }
  std::sort(tets.begin(), tets.end(), [](const Tet& a, const Tet& b) { return a.tag < b.tag; });
  raw.elements.resize(type == 11 ? 10 : 4, static_cast<Eigen::Index>(tets.size()));
  std::unordered_map<const Block*, std::vector<std::string>> names;
  for (const Block& block : all) names[&block] = groups_of(block);
  for (size_t e = 0; e < tets.size(); ++e) {
    for (Eigen::Index k = 0; k < raw.elements.rows(); ++k) {
      const auto it = column_of.find(tets[e].nodes[k]);
      raw.elements(k, static_cast<Eigen::Index>(e)) = it == column_of.end() ? -1 : it->second;
    }
    // gmsh's tet10 ends with the mids of 23 and 13, as ours does.
    raw.element_names.push_back(std::to_string(tets[e].tag));
    for (const std::string& name : own.of(*tets[e].block, tets[e].nodes, 4, names[tets[e].block])) {
      raw.volume_groups[name].push_back(static_cast<int>(e));
    }
  }
}

void take_triangles(RawVolume& raw, const std::unordered_map<std::size_t, int>& column_of,
                    const OwnGroups& own) {
  for (const Block& block : blocks(2)) {
    if (block.type != 2 && block.type != 9) continue;
    const size_t n = block.type == 2 ? 3 : 6;
    const std::vector<std::string> names = groups_of(block);
    for (size_t i = 0; i < block.elements.size(); ++i) {
      std::array<int, 3> corners;
      bool known = true;
      for (size_t k = 0; k < 3; ++k) {
        const auto it = column_of.find(block.nodes[n * i + k]);
        known = known && it != column_of.end();
        corners[k] = known ? it->second : -1;
      }
      if (!known) continue;
      for (const std::string& name : own.of(block, block.nodes.data() + n * i, 3, names))
        raw.face_groups[name].push_back(corners);
    }
  }
}

RawVolume taken(const std::filesystem::path& file, const Place& place) {
  RawVolume raw;
  const auto column_of = read_nodes(raw);
  raw.lost = std::max(0, announced_nodes(file) - static_cast<int>(raw.X.cols()));
  const OwnGroups own(file);
  take_tetrahedra(raw, column_of, own, file);
  take_triangles(raw, column_of, own);
  expect_all_tetrahedra(file, raw.elements.cols(), place);
  return raw;
}

RawVolume read(const std::filesystem::path& file, const Place& place) {
  const Session session;
  std::string fault;
  check_numbers(file);
  try {
    gmsh::open(file.string());
    fault = Session::complaint();
    if (fault.empty()) return taken(file, place);
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::string& message) {
    fault = Session::complaint();
    if (fault.empty()) fault = message;
  } catch (const std::exception& e) {
    fault = e.what();
  } catch (...) {
    fault = "unreadable";
  }
  throw InputError(place, fmt::format("{} cannot be read: {}", file.string(), fault),
                   "a complete gmsh mesh (msh 2.2 or 4.1) or medit mesh");
}

std::string answer(Unpacker& request) {
  request.take<std::string>();  // it has one task
  const std::filesystem::path file = request.take<std::string>();
  const Place place = unpack_place(request);
  Packer out;
  pack(out, read(file, place));
  return out.take();
}

}  // namespace
}  // namespace hookeye::detail

int main() { return hookeye::serve(hookeye::detail::answer); }
