// The only file that touches TetGen. A program of its own: when TetGen gives up it frees its
// memory, throws, and frees it again while the exception passes; and it may refine without end.
#define TETLIBRARY  // as the library was built: faults are thrown, not exits
#include <tetgen.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <string>
#include <vector>

#include "core/helper_main.h"
#include "meshing/detail.h"

namespace hookeye::detail {
namespace {

using Triangle = std::array<int, 3>;

/// Facets and their markers, which count from one: 0 would mean "none".
void hand_over(const std::vector<double>& points, const std::vector<Triangle>& triangles,
               const std::vector<double>& holes, tetgenio& in) {
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(points.size() / 3);
  in.pointlist = new REAL[points.size()];
  std::copy(points.begin(), points.end(), in.pointlist);
  in.numberofholes = static_cast<int>(holes.size() / 3);
  in.holelist = new REAL[holes.size()];
  std::copy(holes.begin(), holes.end(), in.holelist);
  in.numberoffacets = static_cast<int>(triangles.size());
  in.facetlist = new tetgenio::facet[triangles.size()];
  in.facetmarkerlist = new int[triangles.size()];
  for (int t = 0; t < in.numberoffacets; ++t) {
    tetgenio::facet& f = in.facetlist[t];
    tetgenio::init(&f);
    f.numberofpolygons = 1;
    f.polygonlist = new tetgenio::polygon[1];
    tetgenio::init(&f.polygonlist[0]);
    f.polygonlist[0].numberofvertices = 3;
    f.polygonlist[0].vertexlist = new int[3];
    std::copy(triangles[t].begin(), triangles[t].end(), f.polygonlist[0].vertexlist);
    in.facetmarkerlist[t] = t + 1;
  }
}

template <class T>
void put(Packer& to, const T* values, size_t count) {
  to.put(values == nullptr ? std::vector<T>() : std::vector<T>(values, values + count));
}

std::string answer(Unpacker& request) {
  auto switches = request.take<std::string>();
  const auto points = request.take<std::vector<double>>();
  const auto triangles = request.take<std::vector<Triangle>>();
  const auto holes = request.take<std::vector<double>>();
  request.end();
  die_of_interrupts();
  tetgenio in, out;
  hand_over(points, triangles, holes, in);
  bool well = true;
  try {
    tetrahedralize(switches.data(), &in, &out);
  } catch (int) {  // TetGen's own
    well = false;
  }
  well = well && out.numberoftetrahedra > 0 && out.numberofcorners == 4;
  Packer to;
  to.put(well).put(static_cast<double>(std::clock()) / CLOCKS_PER_SEC);
  if (!well) return to.take();
  put(to, out.pointlist, 3 * static_cast<size_t>(out.numberofpoints));
  put(to, out.tetrahedronlist, 4 * static_cast<size_t>(out.numberoftetrahedra));
  const size_t faces = out.trifacemarkerlist == nullptr ? 0 : out.numberoftrifaces;
  put(to, out.trifacelist, 3 * faces);
  put(to, out.trifacemarkerlist, faces);
  return to.take();
}

}  // namespace
}  // namespace hookeye::detail

int main() { return hookeye::serve(hookeye::detail::answer); }
