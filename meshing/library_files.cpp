// Files that gmsh and VTK read and write, each in a helper of its own (helpers/).
#include "capture_io/helper.h"
#include "meshing/detail.h"
#include "meshing/parcels.h"
#include "meshing/tet_mesh.h"

namespace hookeye {
namespace {

namespace fs = std::filesystem;

Packer task(const std::string& name, const fs::path& file) {
  Packer out;
  out.put(name).put(file.string());
  return out;
}

HelperRequest request(const std::string& helper, Packer& content, const fs::path& file,
                      const std::string& right) {
  return {.name = helper,
          .content = content.take(),
          .limits = limits_for(file),
          .place = {file.string()},
          .right = right};
}

detail::TriangleSoup surface(const std::string& kind, const fs::path& file) {
  Packer what = task(kind, file);
  return ask_helper(request("vtk", what, file, "a complete " + kind + " file of triangles"),
                    detail::unpack_soup);
}

detail::RawVolume volume(const std::string& helper, const fs::path& file, const Place& place,
                         const std::string& right) {
  Packer what = task("volume", file);
  detail::pack(what, place);
  HelperRequest wanted = request(helper, what, file, right);
  // What gmsh has seen of one file it may hold against the next.
  wanted.once = helper == "gmsh";
  return ask_helper(wanted, detail::unpack_volume);
}

}  // namespace

namespace detail {

TriangleSoup read_ply(const fs::path& file) { return surface("ply", file); }

TriangleSoup read_stl(const fs::path& file) { return surface("stl", file); }

RawVolume read_vtu(const fs::path& file, const Place& place) {
  return volume("vtk", file, place, "a complete vtu file");
}

RawVolume read_gmsh(const fs::path& file, const Place& place) {
  return volume("gmsh", file, place, "a complete gmsh mesh (msh 2.2 or 4.1) or medit mesh");
}

}  // namespace detail

void write_vtu(const fs::path& file, const TetMesh& mesh, const std::vector<VtuArray>& arrays) {
  fs::path partial = file;
  partial += ".part";
  Packer what = task("write", partial);
  what.put(mesh.X).put(mesh.elements).put<uint64_t>(arrays.size());
  for (const VtuArray& array : arrays) what.put(array.name).put(array.values).put(array.on_points);
  HelperRequest wanted = request("vtk", what, file, "a disk with room");
  wanted.limits = unlimited;
  const bool written = ask_helper(wanted, [](Unpacker& from) { return from.take<bool>(); });
  std::error_code failed;
  if (written) fs::rename(partial, file, failed);
  if (!written || failed) {
    fs::remove(partial, failed);
    throw cannot_write(file.string());
  }
}

Eigen::MatrixXd read_vtu_array(const fs::path& file, const std::string& name, bool on_points) {
  Packer what = task("array", file);
  what.put(name).put(on_points);
  return ask_helper(request("vtk", what, file, "a complete vtu file"),
                    [](Unpacker& from) { return from.take<Eigen::MatrixXd>(); });
}

}  // namespace hookeye
