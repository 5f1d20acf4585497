// What several commands say about a body, a parameter, a material: as JSON and as lines.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "capture_io/capture.h"
#include "core/parameter.h"
#include "meshing/tet_mesh.h"

namespace hookeye {

nlohmann::ordered_json describe_mesh(const TetMesh& mesh);
std::string mesh_lines(const TetMesh& mesh);
/// Where a mesh comes from, which decides how its flat tetrahedra are mended.
enum class MeshedFrom { surface, repaired_surface, remeshed_surface, volume };
/// Of flat tetrahedra: how many, where, whether they hurt and what mends them; empty: it is well.
/// `surface`: the file's name, "" where nobody knows it.
std::string flat_tetrahedra_lines(const TetMesh& mesh, MeshedFrom from,
                                  const std::string& surface = "");
nlohmann::ordered_json describe_vector(const Vector3d& v);
/// "(1, 0, 2.5)"; what is tiny beside `scale` or its largest component reads as zero.
std::string vector_text(const Vector3d& v, double scale = 0.0);

}  // namespace hookeye
