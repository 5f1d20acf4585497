// hookeye mesh: a closed surface filled with tetrahedra.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "app/commands/commands.h"
#include "app/commands/describe.h"
#include "app/validators.h"
#include "core/scope.h"
#include "meshing/repair.h"
#include "meshing/surface_mesh.h"
#include "meshing/tet_mesh.h"

namespace hookeye {
namespace {

struct MeshOptions {
  std::string surface, body;
  FillOptions fill;
  bool repair = false;
  double tolerance = 0.0;  ///< of the repair
};

void refuse_unless_writable(const MeshOptions& options) {
  const std::filesystem::path out = options.body;
  if (out.extension() == ".vtu" || (options.repair && out.extension() == ".obj")) return;
  throw InputError({options.body},
                   options.repair ? "a body is written as .vtu, a repaired surface as .obj"
                                  : "a body is written as .vtu",
                   "-o " + std::filesystem::path(out).replace_extension(".vtu").string());
}

/// "volume 990 -> 1000 (+1 %)".
std::string change_text(const char* what, double before, double now) {
  return fmt::format("{} {:.6g} -> {:.6g} ({:+.2g} %)", what, before, now,
                     before > 0.0 ? 100.0 * (now / before - 1.0) + 0.0 : 0.0);
}

/// What a repair cuts off or fills in shows in volume and area; the area of an open surface, too.
void tell_size(const RepairedSurface& repaired, Session& session) {
  auto& document = session.document;
  const bool open = std::isnan(repaired.volume_before);
  document["volume"] = repaired.volume;
  document["volume_before"] =
      open ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(repaired.volume_before);
  document["area"] = repaired.area;
  document["area_before"] = repaired.area_before;
  session.say("  {}\n",
              open ? fmt::format("volume {:.6g} now; before, it enclosed none", repaired.volume)
                   : change_text("volume", repaired.volume_before, repaired.volume));
  session.say("  {}\n", change_text("area", repaired.area_before, repaired.area));
}

/// The surface, mended by as little as it takes or repaired; what was done is told.
SurfaceMesh body_surface(const MeshOptions& options, Session& session) {
  const Place place{options.surface};
  const SurfaceMesh surface = read_surface(options.surface);
  auto& document = session.document;
  document["triangles"] = surface.triangles.size();
  if (!options.repair) {
    const MendedSurface mended = mend(surface, place);
    document["said"] = mended.said;
    for (const auto& said : mended.said) session.warn(said);
    session.say("{}: {} triangles\n", options.surface, surface.triangles.size());
    return mended.surface;
  }
  const RepairedSurface repaired = repair(surface, {options.tolerance, options.fill.edge}, place);
  document["said"] = repaired.said;
  document["moved"] = repaired.moved;
  session.say("{}: {} triangles\n", options.surface, surface.triangles.size());
  for (const auto& said : repaired.said) session.say("  {}\n", said);
  if (repaired.said.empty()) session.say("  nothing was wrong with the surface\n");
  session.say("  {} triangles now, at most {:.2g} from where they were\n",
              repaired.surface.triangles.size(), repaired.moved);
  tell_size(repaired, session);
  return repaired.surface;
}

void tell_body(const TetMesh& mesh, const MeshOptions& options, Session& session) {
  session.document["asked"] = {{"min_dihedral_deg", options.fill.min_dihedral_deg},
                               {"radius_edge_ratio", options.fill.radius_edge_ratio}};
  session.document["quality"] = describe_mesh(mesh);
  session.say("{}", mesh_lines(mesh));
  const MeshQuality reached = quality(mesh);
  if (reached.min_dihedral_deg < options.fill.min_dihedral_deg)
    session.say(
        "  the mesher was asked for angles of {:g} degrees and more (--min-angle) and reached "
        "{:.1f}\n",
        options.fill.min_dihedral_deg, reached.min_dihedral_deg);
  const MeshedFrom from = !options.repair           ? MeshedFrom::surface
                          : options.fill.edge > 0.0 ? MeshedFrom::remeshed_surface
                                                    : MeshedFrom::repaired_surface;
  session.say("{}", flat_tetrahedra_lines(mesh, from, options.surface));
}

void run_mesh(const MeshOptions& options, Session& session) {
  const Scope scope("surface " + options.surface);
  refuse_unless_writable(options);
  const std::filesystem::path out = options.body;
  session.document = {{"hookeye", 1}, {"command", "mesh"}, {"surface", options.surface}};
  session.document[out.extension() == ".obj" ? "repaired" : "body"] = out.string();
  const SurfaceMesh surface = body_surface(options, session);
  const auto make_room = [&] {
    if (out.has_parent_path()) std::filesystem::create_directories(out.parent_path());
  };
  if (out.extension() == ".obj") {
    make_room();
    write_surface_obj(out, surface);
  } else {
    std::vector<std::string> said;
    const TetMesh mesh = fill(surface, options.fill, {options.surface}, &said);
    make_room();
    write_vtu(out, mesh, {});
    for (const std::string& remark : said) session.say("  {}\n", remark);
    tell_body(mesh, options, session);
  }
  session.say("written to {}\n", out.string());
}

}  // namespace

void add_mesh(CLI::App& app, CommandBody& chosen) {
  CLI::App* command = app.add_subcommand("mesh", "Fill a closed surface with tetrahedra");
  const auto options = std::make_shared<MeshOptions>();
  command->add_option("SURFACE", options->surface, "Closed triangle surface: obj, ply, stl")
      ->required();
  command
      ->add_option("-o,--out", options->body, "BODY.vtu, or with --repair the surface: SURFACE.obj")
      ->required();
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
  CLI::Option* repair = command->add_flag("--repair", options->repair,
                                          "Mend the surface first; remesh it to --edge if given");
  command
      ->add_option("--tolerance", options->tolerance,
                   "Width of gaps to close (default: diagonal / 10000)")
      ->check(above_zero())
      ->needs(repair);
  command->callback([&chosen, options] {
    chosen = [options](Session& session) { run_mesh(*options, session); };
  });
}

}  // namespace hookeye
