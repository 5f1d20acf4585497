// The least that one photo's share of a Gauss-Newton iteration costs: the same scene and sums as
// the product's, by plain loops that know nothing else. One ray a pixel, a bilinear texture, an
// ambient and a sun, smooth normals; no silhouettes, shadows, filter, masks, lenses or choice of
// columns. Flat arrays alone, so that it may be compiled for this machine's own vectors.
#pragma once

#include <vector>

namespace hookeye::bench {

struct FloorScene {
  int vertices = 0;
  std::vector<int> triangles;  ///< 3 a triangle
  std::vector<float> uv;       ///< 6 a triangle [texel]
  std::vector<float> texture;  ///< row-major
  int texture_width = 0;
  float ambient = 0, sun[3] = {};  ///< the sun's times its strength
};

/// What Embree says of one ray, and the ray's direction.
struct FloorHit {
  int triangle;  ///< -1: none
  float b1, b2, direction[3];
};

/// J^T J and J^T r of one photo whose every pixel should be `wanted`: r = wanted - I.
class OneViewFloor {
 public:
  explicit OneViewFloor(FloorScene scene);
  /// x, n: 3 a vertex, positions and unit normals. Fills the tables of the triangles.
  void begin(const float* x, const float* n);
  void add(const FloorHit* hits, int count, float wanted);
  /// S: 6 rows a vertex (by position, by normal), `columns` each. JtJ columns^2, Jtr columns.
  void reduce(const double* S, int columns, std::vector<double>* JtJ, std::vector<double>* Jtr);

 private:
  struct Row {
    float by_b1[3], by_b2[3], facet[3], normals[9], uv[6];
  };
  /// A pixel's derivative by corner k is b_k d, d by position and normal, padded to eight.
  struct Sums {
    float M[6][6][8], b[3][8];  ///< [corners (0,0), (0,1), (0,2), (1,1), (1,2), (2,2)]
  };
  struct Pair {
    int row, column;  ///< vertices, row <= column
    float M[6][8];    ///< [number of the row][of the column]
  };
  void add_pixel(const FloorHit& hit, float wanted);

  FloorScene scene_;
  std::vector<Row> rows_;
  std::vector<Sums> sums_;    ///< by triangle
  std::vector<char> seen_;    ///< by triangle
  std::vector<Pair> pairs_;   ///< by row
  std::vector<int> pair_of_;  ///< 6 a triangle, as Sums::M
};

}  // namespace hookeye::bench
