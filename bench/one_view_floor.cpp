#include "bench/one_view_floor.h"

#include <cblas.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

namespace hookeye::bench {

namespace {

constexpr int kFirst[6] = {0, 0, 0, 1, 1, 2}, kSecond[6] = {0, 1, 2, 1, 2, 2};

}  // namespace

OneViewFloor::OneViewFloor(FloorScene scene) : scene_(std::move(scene)) {
  const size_t count = scene_.triangles.size() / 3;
  rows_.resize(count), sums_.resize(count), seen_.resize(count), pair_of_.resize(6 * count);
  const auto pair = [&](size_t t, int k) {
    return std::minmax(scene_.triangles[3 * t + kFirst[k]], scene_.triangles[3 * t + kSecond[k]]);
  };
  std::map<std::pair<int, int>, int> place;
  for (size_t t = 0; t < count; ++t)
    for (int k = 0; k < 6; ++k) place[pair(t, k)] = 0;
  for (auto& [ij, at] : place) {
    at = static_cast<int>(pairs_.size());
    pairs_.push_back({ij.first, ij.second, {}});
  }
  for (size_t t = 0; t < count; ++t)
    for (int k = 0; k < 6; ++k) pair_of_[6 * t + k] = place[pair(t, k)];
}

void OneViewFloor::begin(const float* x, const float* n) {
  for (size_t t = 0; t < rows_.size(); ++t) {
    const int* v = &scene_.triangles[3 * t];
    Row& row = rows_[t];
    float e1[3], e2[3];
    for (int c = 0; c < 3; ++c) {
      e1[c] = x[3 * v[1] + c] - x[3 * v[0] + c], e2[c] = x[3 * v[2] + c] - x[3 * v[0] + c];
      for (int k = 0; k < 3; ++k) row.normals[3 * k + c] = n[3 * v[k] + c];
    }
    const auto cross = [](const float* a, const float* b, float* out) {
      for (int c = 0; c < 3; ++c)
        out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
    };
    float normal[3];
    cross(e1, e2, normal);
    const float square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    cross(e2, normal, row.by_b1), cross(normal, e1, row.by_b2);
    for (int c = 0; c < 3; ++c) {
      row.by_b1[c] /= square, row.by_b2[c] /= square;
      row.facet[c] = normal[c] / std::sqrt(square);
    }
    std::memcpy(row.uv, &scene_.uv[6 * t], sizeof row.uv);
  }
  std::fill(seen_.begin(), seen_.end(), 0);
}

/// A material point that moves by dx moves its colour under the fixed ray d by
/// -(grad I) (1 - d n^T / n.d) dx; I = albedo (ambient + max(0, n.sun)).
void OneViewFloor::add_pixel(const FloorHit& hit, float wanted) {
  const Row& row = rows_[hit.triangle];
  const float b[3] = {1 - hit.b1 - hit.b2, hit.b1, hit.b2};
  const float *uv = row.uv, *sun = scene_.sun;
  float n[3] = {}, g[3], by_n[3], by_b[3];
  for (int k = 0; k < 3; ++k)
    for (int c = 0; c < 3; ++c) n[c] += b[k] * row.normals[3 * k + c];
  const float inverse = 1 / std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (float& c : n) c *= inverse;
  const float cosine = n[0] * sun[0] + n[1] * sun[1] + n[2] * sun[2];
  const float light = scene_.ambient + std::max(0.0f, cosine);

  const float u = b[0] * uv[0] + b[1] * uv[2] + b[2] * uv[4];
  const float v = b[0] * uv[1] + b[1] * uv[3] + b[2] * uv[5];
  const int iu = static_cast<int>(u), iv = static_cast<int>(v);
  const float* texel = &scene_.texture[iv * scene_.texture_width + iu];
  const float fu = u - iu, fv = v - iv, t00 = texel[0], t10 = texel[1];
  const float t01 = texel[scene_.texture_width], t11 = texel[scene_.texture_width + 1];
  const float by_u = (1 - fv) * (t10 - t00) + fv * (t11 - t01);
  const float top = t00 + fu * (t10 - t00), by_v = t01 + fu * (t11 - t01) - top;
  const float albedo = top + fv * by_v;

  for (int c = 0; c < 3; ++c)
    by_n[c] = cosine > 0 ? albedo * inverse * (sun[c] - cosine * n[c]) : 0;
  for (int k = 0; k < 3; ++k) {
    const float* nk = row.normals + 3 * k;
    by_b[k] = light * (by_u * uv[2 * k] + by_v * uv[2 * k + 1]) + by_n[0] * nk[0] +
              by_n[1] * nk[1] + by_n[2] * nk[2];
  }
  float along = 0, facing = 0;
  for (int c = 0; c < 3; ++c) {
    g[c] = (by_b[1] - by_b[0]) * row.by_b1[c] + (by_b[2] - by_b[0]) * row.by_b2[c];
    along += g[c] * hit.direction[c], facing += row.facet[c] * hit.direction[c];
  }
  for (int c = 0; c < 3; ++c) g[c] = along / facing * row.facet[c] - g[c];

  alignas(32) const float d[8] = {g[0], g[1], g[2], by_n[0], by_n[1], by_n[2], 0, 0};
  Sums& sums = sums_[hit.triangle];
  if (!std::exchange(seen_[hit.triangle], 1)) sums = {};
  for (int k = 0; k < 6; ++k)
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 8; ++j) sums.M[k][i][j] += b[kFirst[k]] * b[kSecond[k]] * d[i] * d[j];
  const float r = wanted - albedo * light;
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 8; ++j) sums.b[k][j] += r * b[k] * d[j];
}

void OneViewFloor::add(const FloorHit* hits, int count, float wanted) {
  for (int i = 0; i < count; ++i)
    if (hits[i].triangle >= 0) add_pixel(hits[i], wanted);
}

void OneViewFloor::reduce(const double* S, int columns, std::vector<double>* JtJ,
                          std::vector<double>* Jtr) {
  const int n = 6 * scene_.vertices;
  for (Pair& pair : pairs_) std::memset(pair.M, 0, sizeof pair.M);
  std::vector<double> b(n, 0.0), Y(n * columns, 0.0);
  for (size_t t = 0; t < sums_.size(); ++t) {
    if (!seen_[t]) continue;
    // symmetric by itself for a triangle's two corners: M_kl = sum b_k b_l d d^T
    for (int k = 0; k < 6; ++k)
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 8; ++j) pairs_[pair_of_[6 * t + k]].M[i][j] += sums_[t].M[k][i][j];
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 6; ++j) b[6 * scene_.triangles[3 * t + k] + j] += sums_[t].b[k][j];
  }
  // J^T J = S^T M S with M = U + U^T - D: Y = (U - D/2) S, then S^T Y + Y^T S.
  for (const Pair& pair : pairs_) {
    const double factor = pair.row == pair.column ? 0.5 : 1.0;
    if (pair.M[0][0] == 0 && pair.M[3][3] == 0) continue;
    for (int i = 0; i < 6; ++i) {
      double* to = Y.data() + (6 * pair.row + i) * columns;
      for (int c = 0; c < columns; ++c) {
        double sum = 0;
        for (int j = 0; j < 6; ++j) sum += pair.M[i][j] * S[(6 * pair.column + j) * columns + c];
        to[c] += factor * sum;
      }
    }
  }
  JtJ->assign(columns * columns, 0), Jtr->resize(columns);
  cblas_dsyr2k(CblasRowMajor, CblasUpper, CblasTrans, columns, n, 1, S, columns, Y.data(), columns,
               0, JtJ->data(), columns);
  cblas_dgemv(CblasRowMajor, CblasTrans, n, columns, 1, S, columns, b.data(), 1, 0, Jtr->data(), 1);
}

}  // namespace hookeye::bench
