// Meshes as bytes, between the program and its helpers.
#pragma once

#include "core/wire.h"
#include "meshing/detail.h"

namespace hookeye::detail {

void pack(Packer& to, const Place& place);
void pack(Packer& to, const RawVolume& volume);
/// Without texture coordinates.
void pack(Packer& to, const SurfaceMesh& surface);
Place unpack_place(Unpacker& from);
/// Throw WireFault where counts or indices do not fit each other.
RawVolume unpack_volume(Unpacker& from);
SurfaceMesh unpack_surface(Unpacker& from);

}  // namespace hookeye::detail
