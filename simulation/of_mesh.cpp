#include "simulation/of_mesh.h"

#include <mutex>
#include <vector>

#include "simulation/large_solver.h"

namespace hookeye {

OfMesh::OfMesh(const TetMesh& mesh)
    : assembly(mesh),
      symbolic(large_solvers().make ? std::make_shared<SymbolicFactors>(ends_of(mesh))
                                    : std::make_shared<SymbolicFactors>()) {
  assembly.find_pattern();
}

namespace {

struct Known {
  std::weak_ptr<const TetMesh> mesh;
  std::weak_ptr<OfMesh> parts;
};
std::mutex known_mutex;
std::vector<Known> known;

/// Null: nobody has one. While the mesh is alive no other is at its address.
std::shared_ptr<OfMesh> alive_of(const TetMesh& mesh) {
  std::erase_if(known, [](const Known& one) { return one.mesh.expired() || one.parts.expired(); });
  for (const Known& one : known)
    if (one.mesh.lock().get() == &mesh)
      if (auto alive = one.parts.lock()) return alive;
  return nullptr;
}

}  // namespace

std::shared_ptr<OfMesh> of_mesh(const std::shared_ptr<const TetMesh>& mesh) {
  if (mesh.use_count() == 0) return std::make_shared<OfMesh>(*mesh);
  const std::lock_guard lock(known_mutex);
  if (auto alive = alive_of(*mesh)) return alive;
  auto fresh = std::make_shared<OfMesh>(*mesh);
  known.push_back({mesh, fresh});
  return fresh;
}

std::shared_ptr<Assembly> assembly_of(const TetMesh& mesh) {
  {
    const std::lock_guard lock(known_mutex);
    if (auto alive = alive_of(mesh)) return {alive, &alive->assembly};
  }
  return std::make_shared<Assembly>(mesh);
}

}  // namespace hookeye
