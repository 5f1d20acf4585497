// hookeye mesh: a closed surface filled with tetrahedra.
#include <CLI/CLI.hpp>

#include "app/commands/commands.h"
#include "app/commands/describe.h"
#include "app/validators.h"
#include "capture_io/scope.h"
#include "meshing/surface_mesh.h"
#include "meshing/tet_mesh.h"

namespace hookeye {
namespace {

struct MeshOptions {
  std::string surface, body;
  FillOptions fill;
};

void run_mesh(const MeshOptions& options, Session& session) {
  const Scope scope("surface " + options.surface);
  const std::filesystem::path out = options.body;
  if (out.extension() != ".vtu")
    throw InputError({options.body}, "a body is written as .vtu",
                     "-o " + std::filesystem::path(out).replace_extension(".vtu").string());
  const Place place{options.surface};
  const SurfaceMesh surface = read_surface(options.surface);
  const MendedSurface mended = mend(surface, place);
  const TetMesh mesh = fill(mended.surface, options.fill, place);
  if (out.has_parent_path()) std::filesystem::create_directories(out.parent_path());
  write_vtu(out, mesh, {});

  auto& document = session.document;
  document = {{"hookeye", 1}, {"command", "mesh"}, {"surface", options.surface}};
  document["body"] = out.string();
  document["triangles"] = surface.triangles.size();
  document["said"] = mended.said;
  document["asked"] = {{"min_dihedral_deg", options.fill.min_dihedral_deg},
                       {"radius_edge_ratio", options.fill.radius_edge_ratio}};
  document["quality"] = describe_mesh(mesh);
  for (const auto& said : mended.said) session.warn(said);
  session.say("{}: {} triangles\n", options.surface, surface.triangles.size());
  session.say("{}", mesh_lines(mesh));
  if (const double reached = quality(mesh).min_dihedral_deg;
      reached < options.fill.min_dihedral_deg)
    session.say(
        "  the mesher was asked for angles of {:g} degrees and more (--min-angle) and reached "
        "{:.1f}\n",
        options.fill.min_dihedral_deg, reached);
  session.say("written to {}\n", out.string());
}

}  // namespace

void add_mesh(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("mesh", "Fill a closed surface with tetrahedra");
  const auto options = std::make_shared<MeshOptions>();
  command->add_option("SURFACE", options->surface, "Closed triangle surface: obj, ply, stl")
      ->required();
  command->add_option("-o,--out", options->body, "The body to write: BODY.vtu")->required();
  command->add_option("--edge", options->fill.edge, "Target edge (default: diagonal / 12)")
      ->check(above_zero());
  command->add_option("--order", options->fill.order, "Order of the tetrahedra (default: 2)")
      ->check(CLI::IsMember({1, 2}));
  // Where more is asked, TetGen may refine without end.
  command
      ->add_option("--min-angle", options->fill.min_dihedral_deg,
                   "Smallest dihedral angle to ask for [degrees] (default: 12)")
      ->check(CLI::Range(0.0, 15.0));
  command
      ->add_option("--radius-edge", options->fill.radius_edge_ratio,
                   "Largest circumradius over shortest edge to ask for (default: 1.4)")
      ->check(CLI::Range(1.2, 10.0));
  command->callback([&chosen, options] {
    chosen = [options](Session& session) { run_mesh(*options, session); };
  });
}

}  // namespace hookeye
