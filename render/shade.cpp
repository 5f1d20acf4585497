#include <cmath>

#include "render/frame.h"

namespace hookeye {

namespace {

struct Albedo {
  double value = 1;
  Vector3d by_bary = Vector3d::Zero();
  Vector3d by_reference = Vector3d::Zero();
};

Albedo albedo(const Frame& f, const Sample& s, bool derivatives) {
  Albedo out;
  const Texture& texture = f.texture;
  if (texture.source == Texture::Source::uniform) {
    out.value = texture.albedo;
  } else if (texture.source == Texture::Source::image) {
    const auto& uv = f.surface.uv[s.triangle];
    const Lookup at =
        sample_bilinear(*texture.image, s.bary[0] * uv[0] + s.bary[1] * uv[1] + s.bary[2] * uv[2]);
    out.value = at.value;
    for (int k = 0; k < 3; ++k) out.by_bary[k] = at.gradient.dot(uv[k]);
  } else {
    const auto& t = f.surface.triangles[s.triangle];
    const View& view = *f.reference_view;
    Vector3d p = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) p += s.bary[k] * view.p.col(t[k]);
    Camera::Jacobian3 by_point;
    Camera::Jacobian7 by_camera;
    const Vector2d px =
        derivatives ? view.local.project(p, &by_point, &by_camera) : view.local.project(p);
    const Lookup at = f.spline->at(px);
    out.value = at.value / texture.reference_gain;
    if (!derivatives) return out;
    const Vector3d g = by_point.transpose() * at.gradient / texture.reference_gain;
    for (int k = 0; k < 3; ++k) out.by_bary[k] = g.dot(view.p.col(t[k]));
    out.by_reference = view.camera.R.transpose() * g;
  }
  return out;
}

/// Intensity before gain of a point with normal n (unit), and its derivatives at fixed albedo.
struct Light {
  double diffuse = 1, gloss = 0;  ///< I = albedo*diffuse + gloss
  Vector3d diffuse_by_n = Vector3d::Zero(), gloss_by_n = Vector3d::Zero();
  Vector3d diffuse_by_sun = Vector3d::Zero(), gloss_by_sun = Vector3d::Zero();
  double gloss_by_specular = 0;
  Vector3d gloss_by_eye = Vector3d::Zero();  ///< by the unit vector to the camera
};

Vector3d to_camera(const View& view, const Vector2d& h) {
  if (!view.perspective) return -view.camera.R.row(2).transpose();
  return -(view.camera.R.transpose() * h.homogeneous()).normalized();
}

void add_gloss(const Frame& f, const Sample& s, const Vector3d& n, Light* light) {
  const double strength = f.photo.sun.norm();
  const Vector3d sun = f.photo.sun / strength;
  const Vector3d sum = sun + to_camera(f.view, s.h);
  const double length = sum.norm();
  if (length <= 0) return;
  const Vector3d half = sum / length;
  const double c = n.dot(half), e = f.photo.shininess;
  if (c <= 0) return;
  const double power = std::pow(c, e), slope = f.photo.specular * strength * e * power / c;
  light->gloss_by_specular = strength * power;
  light->gloss = f.photo.specular * strength * power;
  light->gloss_by_n = slope * half;
  light->gloss_by_eye = slope / length * (n - c * half);
  light->gloss_by_sun = f.photo.specular * power * sun +
                        (light->gloss_by_eye - sun * sun.dot(light->gloss_by_eye)) / strength;
}

Light light_of(const Frame& f, const Sample& s, const Vector3d& n, double visibility) {
  Light out;
  out.diffuse = f.photo.ambient * visibility;
  const double cosine = n.dot(f.photo.sun);
  if (!s.lit) return out;
  if (cosine > 0) {
    out.diffuse += cosine;
    out.diffuse_by_n = f.photo.sun;
    out.diffuse_by_sun = n;
  }
  if (f.photo.specular != 0 || (f.options.derivatives && f.options.gloss_derivative))
    add_gloss(f, s, n, &out);
  return out;
}

}  // namespace

Shade shade(const Frame& f, const Sample& s, bool derivatives) {
  const auto& t = f.surface.triangles[s.triangle];
  const double gain = f.photo.gain;
  const Albedo a = albedo(f, s, derivatives);
  Shade out;
  out.by_facet.setZero();
  Light light;
  Vector3d n = Vector3d::Zero();
  double length = 1, visibility = 1, facet_share = 1;
  const bool smooth = f.options.smooth_normals;
  if (f.photo.shaded) {
    if (smooth)
      for (int k = 0; k < 3; ++k) n += s.bary[k] * f.normals.col(t[k]);
    else
      n = (f.x.col(t[1]) - f.x.col(t[0])).cross(f.x.col(t[2]) - f.x.col(t[0]));
    length = n.norm();
    if (length > 0) n /= length;
    visibility = 0;
    for (int k = 0; k < 3; ++k) visibility += s.bary[k] * f.visibility[t[k]];
    // Of the hemisphere about the interpolated normal the part below the facet sends nothing:
    // cosine-weighted, (1 + n.facet)/2 remains.
    facet_share = (1 + n.dot(f.facets[s.triangle])) / 2;
    light = light_of(f, s, n, visibility * facet_share);
  }
  out.I = gain * (a.value * light.diffuse + light.gloss);
  if (!derivatives) return out;

  Vector3d by_bary = gain * light.diffuse * a.by_bary;
  Vector3d by_n = gain * (a.value * light.diffuse_by_n + light.gloss_by_n);
  if (f.photo.shaded) {
    const double by_visibility = gain * a.value * f.photo.ambient;
    for (int k = 0; k < 3; ++k) by_bary[k] += by_visibility * facet_share * f.visibility[t[k]];
    if (smooth) {
      const double by_share = by_visibility * visibility / 2;
      out.by_facet = by_share * n;
      by_n += by_share * f.facets[s.triangle];
      by_n = length > 0 ? Vector3d((by_n - n * n.dot(by_n)) / length) : Vector3d(Vector3d::Zero());
      for (int k = 0; k < 3; ++k) by_bary[k] += by_n.dot(f.normals.col(t[k]));
    }
  }
  if (smooth)
    out.by_normal = by_n;
  else
    out.by_normal.setZero(), out.by_facet = by_n;
  out.by_reference = gain * light.diffuse * a.by_reference;

  // Under the fixed ray dbary = -(1 - bary 1^T) Q dP bary, with P the corners in camera axes.
  const Vector3d slid = by_bary - Vector3d::Constant(by_bary.dot(s.bary));
  Vector3d g = -(f.view.Q[s.triangle].transpose() * slid);
  if (!f.view.perspective) g.z() = 0;
  out.by_motion = f.view.camera.R.transpose() * g;

  Vector3d p = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) p += s.bary[k] * f.view.p.col(t[k]);
  const Vector2d zoom = f.view.zoom(s.h);
  auto& d = out.photo;
  d.setZero();
  d.segment<3>(kRotate) = p.cross(g);
  d.segment<3>(kMove) = g;
  d[kZoom] = (f.view.perspective ? p.z() : 1.0) * zoom.dot(g.head<2>());
  d[kLogGain] = out.I;
  if (!f.photo.shaded) return out;
  d[kAmbient] = gain * a.value * visibility * facet_share;
  d.segment<3>(kSun) = gain * (a.value * light.diffuse_by_sun + light.gloss_by_sun);
  d[kSpecular] = gain * light.gloss_by_specular;
  if (f.photo.specular != 0 && s.lit) {
    // The camera turns, and the direction to it with it: d(to camera) = -w x (to camera).
    const Vector3d eye = f.view.camera.R * to_camera(f.view, s.h);
    const Vector3d by_eye = gain * (f.view.camera.R * light.gloss_by_eye);
    d.segment<3>(kRotate) -= eye.cross(by_eye);
    if (f.view.perspective) {
      const Vector3d turn = Vector3d(zoom.x(), zoom.y(), 0) / s.h.homogeneous().norm();
      d[kZoom] += by_eye.dot(turn - eye * eye.dot(turn));
    }
  }
  return out;
}

}  // namespace hookeye
