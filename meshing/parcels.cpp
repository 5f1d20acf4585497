#include "meshing/parcels.h"

namespace hookeye::detail {
namespace {

void demand(bool holds) {
  if (!holds) throw WireFault();
}

template <class Members>
void demand_below(const std::map<std::string, Members>& groups, Eigen::Index count) {
  for (const auto& [name, members] : groups)
    for (const int i : members) demand(i >= 0 && i < count);
}

}  // namespace

void pack(Packer& to, const Place& place) { to.put(place.file).put(place.line).put(place.column); }

Place unpack_place(Unpacker& from) {
  Place place;
  from.get(place.file);
  from.get(place.line);
  from.get(place.column);
  return place;
}

void pack(Packer& to, const RawVolume& volume) {
  to.put(volume.X).put(volume.elements).put(volume.lost).put(volume.element_names);
  to.put(volume.volume_groups).put(volume.face_groups).put(volume.node_groups);
}

RawVolume unpack_volume(Unpacker& from) {
  RawVolume volume;
  from.get(volume.X);
  from.get(volume.elements);
  from.get(volume.lost);
  from.get(volume.element_names);
  from.get(volume.volume_groups);
  from.get(volume.face_groups);
  from.get(volume.node_groups);
  const Eigen::Index nodes = volume.X.cols(), elements = volume.elements.cols();
  // That elements name nodes which are there is read_volume's to check, as of every format.
  demand(volume.elements.rows() == 4 || volume.elements.rows() == 10 || elements == 0);
  demand(volume.lost >= 0);
  demand(volume.element_names.empty() ||
         volume.element_names.size() == static_cast<size_t>(elements));
  demand_below(volume.volume_groups, elements);
  demand_below(volume.node_groups, nodes);
  for (const auto& [name, faces] : volume.face_groups)
    for (const auto& corners : faces)
      for (const int i : corners) demand(i >= 0 && i < nodes);
  return volume;
}

void pack(Packer& to, const SurfaceMesh& surface) { to.put(surface.X).put(surface.triangles); }

SurfaceMesh unpack_surface(Unpacker& from) {
  SurfaceMesh surface;
  from.get(surface.X);
  from.get(surface.triangles);
  for (const auto& corners : surface.triangles)
    for (const int i : corners) demand(i >= 0 && i < surface.X.cols());
  return surface;
}

}  // namespace hookeye::detail
