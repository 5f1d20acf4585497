// The only file that touches gmsh: msh 2.2 / 4.1 and medit meshes.
#include <fmt/format.h>
#include <gmsh.h>

#include <fstream>
#include <mutex>
#include <sstream>
#include <unordered_map>

#include "meshing/detail.h"

namespace hookeye::detail {
namespace {

/// gmsh keeps one global state: one session at a time, silent, without the user's start-up files.
class Session {
 public:
  Session() : lock_(mutex()) {
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

 private:
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  std::lock_guard<std::mutex> lock_;
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
                     const std::filesystem::path& file) {
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
    for (const std::string& name : names[tets[e].block]) {
      raw.volume_groups[name].push_back(static_cast<int>(e));
    }
  }
}

void take_triangles(RawVolume& raw, const std::unordered_map<std::size_t, int>& column_of) {
  for (const Block& block : blocks(2)) {
    if (block.type != 2 && block.type != 9) continue;
    const size_t n = block.type == 2 ? 3 : 6;
    for (const std::string& name : groups_of(block)) {
      auto& faces = raw.face_groups[name];
      for (size_t i = 0; i < block.elements.size(); ++i) {
        std::array<int, 3> corners;
        bool known = true;
        for (size_t k = 0; k < 3; ++k) {
          const auto it = column_of.find(block.nodes[n * i + k]);
          known = known && it != column_of.end();
          corners[k] = known ? it->second : -1;
        }
        if (known) faces.push_back(corners);
      }
    }
  }
}

}  // namespace

RawVolume read_gmsh(const std::filesystem::path& file, const Place& place) {
  const Session session;
  std::string fault;
  try {
    gmsh::open(file.string());
    fault = Session::complaint();
  } catch (const std::string& message) {
    fault = Session::complaint();
    if (fault.empty()) fault = message;
  } catch (const std::exception& e) {
    fault = e.what();
  } catch (...) {
    fault = "unreadable";
  }
  if (!fault.empty()) {
    throw InputError(place, fmt::format("{} cannot be read: {}", file.string(), fault),
                     "a complete gmsh mesh (msh 2.2 or 4.1) or medit mesh");
  }
  RawVolume raw;
  const auto column_of = read_nodes(raw);
  raw.lost = std::max(0, announced_nodes(file) - static_cast<int>(raw.X.cols()));
  take_tetrahedra(raw, column_of, file);
  take_triangles(raw, column_of);
  return raw;
}

}  // namespace hookeye::detail
