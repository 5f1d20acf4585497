// A block of hexahedra, solved by CalculiX as it is, and here as the tetrahedra that import makes.
#include <fmt/format.h>

#include "exporters/block.h"
#include "importers/deck.h"

namespace hookeye::test {
namespace {

/// 4 x 4 x 6 hexahedra of side 5, clamped below; the top is moved by 3 upwards.
std::string block_deck() {
  std::string nodes = "*NODE\n", elements = "*ELEMENT, TYPE=C3D8, ELSET=EALL\n";
  std::string bottom = "*NSET, NSET=BOTTOM\n", cover = "*NSET, NSET=COVER\n";
  const auto label = [](int i, int j, int k) { return 1 + i + 5 * j + 25 * k; };
  for (int k = 0; k < 7; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) {
        nodes += fmt::format("{}, {}., {}., {}.\n", label(i, j, k), 5 * i, 5 * j, 5 * k);
        if (k == 0) bottom += fmt::format("{}\n", label(i, j, k));
        if (k == 6) cover += fmt::format("{}\n", label(i, j, k));
      }
  int e = 0;
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        elements += fmt::format("{}, {}, {}, {}, {}, {}, {}, {}, {}\n", ++e, label(i, j, k),
                                label(i + 1, j, k), label(i + 1, j + 1, k), label(i, j + 1, k),
                                label(i, j, k + 1), label(i + 1, j, k + 1),
                                label(i + 1, j + 1, k + 1), label(i, j + 1, k + 1));
  return nodes + elements + bottom + cover +
         "*MATERIAL, NAME=GEL\n*HYPERELASTIC, NEO HOOKE\n0.025, 4.\n"
         "*SOLID SECTION, ELSET=EALL, MATERIAL=GEL\n*STEP, NLGEOM\n*STATIC\n0.25, 1.\n"
         "*BOUNDARY\nBOTTOM, 1, 3\nCOVER, 1, 2\nCOVER, 3, 3, 3.\n"
         "*NODE PRINT, NSET=COVER, TOTALS=ONLY\nRF\n*END STEP\n";
}

/// The last total force in a .dat.
Vector3d total_force_in(const std::filesystem::path& dat) {
  std::istringstream lines(read_text(dat));
  Vector3d out = Vector3d::Constant(std::nan(""));
  bool next = false;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream numbers(line);
    Vector3d f;
    if (next && numbers >> f.x() >> f.y() >> f.z()) out = f, next = false;
    if (line.find("total force") != std::string::npos) next = true;
  }
  return out;
}

TEST(Hexahedra, TheForceIsCalculixsButForWhatTheSplitCosts) {
  HOOKEYE_NEEDS_CCX();
  const TemporaryFolder folder, scratch;
  write_text(folder / "pull.inp", block_deck());
  const std::string run = "cd '" + folder.path().string() +
                          "' && OMP_NUM_THREADS=1 timeout 300 ccx pull > log.txt 2>&1 </dev/null";
  ASSERT_EQ(std::system(run.c_str()), 0) << read_text(folder / "log.txt");
  const Vector3d theirs = total_force_in(folder / "pull.dat");
  ASSERT_GT(theirs.z(), 0.0);

  import_decks({folder / "pull.inp"}, scratch.path());
  const auto scene = load_scene(read_capture(scratch.path()), false);
  const ModelForm form = base_form(scene);
  const Model model = form.realise(form.initial());
  const auto solved =
      solve_equilibrium(scene->body->mesh, model.energy_of(0), model.examples[0].loading);
  ASSERT_TRUE(solved.has_value());
  const Vector3d own = support_force(*solved, scene->body->regions.at("COVER"));
  std::printf("hexahedra: %.5g, split: %.5g, %.2f %% more\n", theirs.z(), own.z(),
              100 * (own.z() / theirs.z() - 1));
  EXPECT_GT(own.z(), 0.99 * theirs.z()) << "linear tetrahedra are no softer";
  EXPECT_LT(own.z(), 1.10 * theirs.z());
  EXPECT_LT(own.head<2>().norm(), 0.06 * own.z()) << "the cuts lean to one side";
}

}  // namespace
}  // namespace hookeye::test
