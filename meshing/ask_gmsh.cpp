// Meshes that gmsh reads, in a helper of its own (helpers/gmsh.cpp).
#include "core/helper.h"
#include "meshing/detail.h"
#include "meshing/parcels.h"

namespace hookeye::detail {

RawVolume read_gmsh(const std::filesystem::path& file, const Place& place) {
  if (!std::filesystem::exists(helper_folder() / "gmsh"))
    throw InputError(
        {file.string()},
        "this build of hookeye reads no msh and no medit mesh: it was made without gmsh",
        "a vtu or inp file, or a build where libgmsh-dev is installed");
  Packer what;
  what.put("volume").put(file.string());
  pack(what, place);
  HelperRequest request;
  request.name = "gmsh";
  request.content = what.take();
  request.limits = limits_for(file);
  request.once = true;  // what gmsh has seen of one file it may hold against the next
  request.place = {file.string()};
  request.right = "a complete gmsh mesh (msh 2.2 or 4.1) or medit mesh";
  return ask_helper(request, unpack_volume);
}

}  // namespace hookeye::detail
