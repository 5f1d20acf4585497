#include "importers/deck_febio_mesh.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text_file.h"

namespace hookeye::solver_deck {

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> out;
  constexpr const char* kBetween = " ,\t\r\n";
  for (size_t at = 0; (at = text.find_first_not_of(kBetween, at)) != std::string_view::npos;) {
    const size_t end = std::min(text.find_first_of(kBetween, at), text.size());
    out.emplace_back(text.substr(at, end - at));
    at = end;
  }
  return out;
}

FebioFile::FebioFile(const std::filesystem::path& file)
    : xml_(read_text(file), file.string(), "a deck of FEBio, febio_spec 3.0 or 4.0"),
      top_(xml_.child("febio_spec")),
      stem_(file.stem().string()) {
  if (!top_) throw InputError({file.string()}, "there is no <febio_spec>", "a deck of FEBio");
  const std::string version = str(top_.attribute("version"));
  if (version != "3.0" && version != "4.0")
    fault(top_, fmt::format("this is version `{}`", version),
          "febio_spec 3.0 or 4.0: open it in FEBio Studio and export it again");
  for (const XmlNode& section : top_.children())
    if (section.has("from"))
      fault(section, "a section in a file of its own is not read", "all sections in one file");
}

void FebioFile::fault(const XmlNode& node, const std::string& wrong,
                      const std::string& right) const {
  throw InputError(place(node), wrong, right);
}
void FebioFile::leave(const XmlNode& node, const std::string& what) {
  deck.say(place(node), what + " is left out");
}

std::vector<double> FebioFile::numbers(const XmlNode& node, size_t count) const {
  std::vector<double> out;
  for (const std::string& word : words_of(node.text())) out.push_back(real(word, place(node)));
  if (count > 0 && out.size() != count)
    fault(node, fmt::format("<{}> has {} numbers", node.name(), out.size()),
          fmt::format("{} of them", count));
  return out;
}
std::vector<int> FebioFile::labels(const XmlNode& node) const {
  std::vector<int> out;
  for (const std::string& word : words_of(node.text())) out.push_back(whole(word, place(node)));
  return out;
}
int FebioFile::id_of(const XmlNode& node) const {
  return whole(str(node.attribute("id")), place(node));
}

std::string FebioFile::key_of(const std::string& set) const {
  const std::string key = capitals(stem_ + ":" + set);
  const auto at = alias_.find(key);
  return at == alias_.end() ? key : at->second;
}

void FebioFile::keep(const std::string& name, LabelSet set) {
  const std::string key = capitals(stem_ + ":" + name);
  const auto [at, fresh] = first_.try_emplace(set.members, key);
  if (fresh)
    deck.node_sets[key] = std::move(set);
  else
    alias_[key] = at->second;
}

FebioMesh::FebioMesh(FebioFile& file) : file_(file), splitter_(file.deck) {
  add_nodes_and_elements();
  add_sets();
  splitter_.say(file.place(file.top()));
}

const std::vector<int>* FebioMesh::set(const std::string& name) const {
  const auto at = in_order_.find(name);
  return at == in_order_.end() ? nullptr : &at->second;
}

const std::vector<std::set<Side>>* FebioMesh::surface(const std::string& name) const {
  const auto at = faces_.find(name);
  return at == faces_.end() ? nullptr : &at->second;
}

void FebioMesh::add_nodes_and_elements() {
  const XmlNode mesh = file_.top().child("Mesh");
  if (!mesh) file_.fault(file_.top(), "there is no <Mesh>", "nodes and elements of one body");
  for (const XmlNode& nodes : mesh.all("Nodes"))
    for (const XmlNode& node : nodes.children()) {
      const std::vector<double> x = file_.numbers(node, 3);
      if (!file_.deck.nodes.try_emplace(file_.id_of(node), x[0], x[1], x[2]).second)
        file_.fault(node, fmt::format("node {} is there twice", file_.id_of(node)),
                    "each node once");
    }
  for (const XmlNode& elements : mesh.all("Elements")) add_elements(elements);
  if (file_.deck.elements.empty())
    file_.fault(mesh, "the deck has no solid elements",
                "elements of type tet4, tet10, hex8 or penta6");
  for (const auto& [label, nodes] : file_.deck.elements)
    for (int side = 1; side <= 4; ++side) {
      std::array<int, 3> corners = tetrahedron_side(nodes, side);
      std::sort(corners.begin(), corners.end());
      side_of_[corners] = {label, side};
    }
}

void FebioMesh::add_elements(const XmlNode& elements) {
  const std::string type = str(elements.attribute("type"));
  const size_t per = type == "tet4"                         ? 4
                     : type == "tet10" || type == "TET10G4" ? 10
                     : type == "hex8"                       ? 8
                     : type == "penta6"                     ? 6
                                                            : 0;
  if (per == 0 && (type.starts_with("tet") || type.starts_with("hex") || type.starts_with("pen") ||
                   type.starts_with("pyra")))
    file_.fault(elements, fmt::format("elements of type {} are not read", type),
                "tet4, tet10, hex8 or penta6: mesh the part anew with them");
  if (per == 0) {
    file_.leave(elements, "elements of type " + type);
    return;
  }
  const int tetrahedron = per == 10 ? 10 : 4;
  if (file_.deck.per_element != 0 && file_.deck.per_element != tetrahedron)
    file_.fault(elements, "linear and quadratic elements are mixed", "elements of one order");
  file_.deck.per_element = tetrahedron;
  LabelSet set;
  set.name = str(elements.attribute("name")), set.place = file_.place(elements);
  for (const XmlNode& elem : elements.all("elem")) {
    const std::vector<int> nodes = file_.labels(elem);
    const int id = file_.id_of(elem);
    if (nodes.size() != per)
      file_.fault(elem, fmt::format("element {} has {} nodes", id, nodes.size()),
                  fmt::format("{} nodes", per));
    for (const int node : nodes)
      if (!file_.deck.nodes.contains(node))
        file_.fault(elem, fmt::format("element {} names node {}, which is not there", id, node),
                    "a node of <Nodes>");
    if (solid_shape(per))
      splitter_.add(id, nodes, file_.place(elem)), set.solids.insert(id);
    else if (splitter_.has(id) || !file_.deck.elements.try_emplace(id, nodes).second)
      file_.fault(elem, fmt::format("element {} is there twice", id), "each element once");
    set.members.merge(file_.deck.elements_of(id));
  }
  file_.deck.element_sets[capitals(set.name)].name = set.name;
  file_.deck.element_sets[capitals(set.name)].add(set);
}

void FebioMesh::add_sets() {
  const XmlNode mesh = file_.top().child("Mesh");
  for (const XmlNode& node_set : mesh.all("NodeSet")) {
    std::vector<int> members = file_.labels(node_set);
    for (const XmlNode& one : node_set.children()) members.push_back(file_.id_of(one));
    keep_set(str(node_set.attribute("name")), members, node_set);
  }
  for (const XmlNode& surface : mesh.all("Surface")) {
    std::vector<std::set<Side>>& faces = faces_[str(surface.attribute("name"))];
    std::vector<int> nodes;
    for (const XmlNode& face : surface.children()) {
      const std::vector<int> of_face = file_.labels(face);
      nodes.insert(nodes.end(), of_face.begin(), of_face.end());
      faces.push_back(sides_of_face(face, of_face));
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    keep_set("@surface:" + str(surface.attribute("name")), nodes, surface);
  }
}

void FebioMesh::keep_set(const std::string& name, const std::vector<int>& members,
                         const XmlNode& node) {
  for (const int label : members)
    if (!file_.deck.nodes.contains(label))
      file_.fault(node, fmt::format("set `{}` names node {}, which is not there", name, label),
                  "a node of <Nodes>");
  in_order_[name] = members;
  LabelSet set;
  set.name = name.starts_with("@surface:") ? name.substr(9) : name;
  set.place = file_.place(node);
  set.members.insert(members.begin(), members.end());
  file_.keep(name, std::move(set));
}

/// Sides of tetrahedra that a triangle or a quadrilateral is.
std::set<Side> FebioMesh::sides_of_face(const XmlNode& face, const std::vector<int>& nodes) const {
  const size_t corners = str(face.name()).starts_with("quad") ? 4 : 3;
  if (nodes.size() < corners)
    file_.fault(face, "a face has too few nodes", "three or four corners");
  std::set<Side> out;
  const auto add = [&](std::array<int, 3> three) {
    std::sort(three.begin(), three.end());
    if (const auto at = side_of_.find(three); at != side_of_.end()) out.insert(at->second);
  };
  add({nodes[0], nodes[1], nodes[2]});
  if (corners == 4) {
    add({nodes[0], nodes[2], nodes[3]});
    add({nodes[0], nodes[1], nodes[3]});
    add({nodes[1], nodes[2], nodes[3]});
  }
  if (out.size() != corners - 2)
    file_.fault(face, "this face is no side of one element", "faces of the body's elements");
  return out;
}

}  // namespace hookeye::solver_deck
