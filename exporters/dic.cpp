// dic: displacements and strains of the surface as programs for image correlation tell them, of the
// model and of the photos.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "exporters/dic_report.h"
#include "exporters/exporter.h"

namespace hookeye::dic {
namespace {

/// Cells of a row; what is not known is an empty one.
class Row {
 public:
  explicit Row(std::string& out) : out_(out) {}
  ~Row() { out_ += '\n'; }
  Row(const Row&) = delete;
  Row& operator=(const Row&) = delete;
  Row& text(const std::string& cell) {
    if (!first_) out_ += ',';
    first_ = false;
    out_ += quoted(cell);
    return *this;
  }
  Row& number(double value) {
    return text(std::isfinite(value) ? fmt::format("{:.9g}", value) : std::string());
  }
  template <class Vector>
  Row& vector(const Vector& values) {
    for (const double value : values) number(value);
    return *this;
  }
  Row& strain(const SurfaceStrain& e) {
    return number(e.xx)
        .number(e.yy)
        .number(e.xy)
        .number(e.first())
        .number(e.second())
        .number(e.angle())
        .number(e.von_mises());
  }
  Row& strain(const std::optional<SurfaceStrain>& e) {
    if (e) return strain(*e);
    for (int i = 0; i < 7; ++i) text("");
    return *this;
  }

 private:
  std::string& out_;
  bool first_ = true;
};

std::string strain_heads(const std::string& of) {
  std::string out;
  for (const char* name : {"exx", "eyy", "exy", "e1", "e2", "angle", "von_mises"})
    out += fmt::format(",{}{}", name, of);
  return out;
}

std::string points_text(const SeenPoints& view, const std::string& length) {
  std::string out;
  if (view.camera) out += "x_px,y_px,";
  for (const char* name : {"x", "y", "z", "u", "v", "w"})
    out += fmt::format("{}{} [{}]", name[0] == 'x' ? "" : ",", name, length);
  out += strain_heads("");
  for (const char* name : {"u_photo", "v_photo", "w_photo", "sigma_photo"})
    out += fmt::format(",{} [{}]", name, length);
  out += ",known" + strain_heads("_photo") + "\n";
  for (int i = 0; i < view.size(); ++i) {
    const auto k = static_cast<size_t>(i);
    Row row(out);
    if (view.camera) row.vector(Eigen::Vector2d(view.px.col(i)));
    row.vector(Vector3d(view.X.col(i))).vector(Vector3d(view.u.col(i))).strain(view.strain[k]);
    row.vector(Vector3d(view.u.col(i) + view.apart.col(i))).number(view.sigma[i]);
    row.number(view.known[k]).strain(view.strain_seen[k]);
  }
  return out;
}

std::string gauges_text(const SeenSurface& seen) {
  std::string out = "case,use,gauge,along_x,along_y,along_z" + strain_heads("") + ",points" +
                    strain_heads("_photo") + strain_heads("_same_points") + "\n";
  for (const SeenCase& one : seen.cases)
    for (const Gauge& gauge : one.gauges)
      Row(out)
          .text(one.name)
          .text(one.use)
          .text(gauge.name)
          .vector(gauge.along)
          .strain(gauge.strain)
          .number(gauge.points)
          .strain(gauge.seen)
          .strain(gauge.differ);
  return out;
}

std::string lines_text(const SeenSurface& seen, const std::string& length) {
  std::string out = "case,use,line,x1,y1,z1,x2,y2,z2";
  for (const char* name : {"rest", "length", "length_photo"})
    out += fmt::format(",{} [{}]", name, length);
  out += ",strain,strain_photo\n";
  for (const SeenCase& one : seen.cases)
    for (const Line& line : one.lines) {
      const double photo = line.seen.value_or(std::nan(""));
      Row(out)
          .text(one.name)
          .text(one.use)
          .text(line.name)
          .vector(line.ends[0])
          .vector(line.ends[1])
          .number(line.rest)
          .number(line.length)
          .number(photo)
          .number(line.length / line.rest - 1.0)
          .number(photo / line.rest - 1.0);
    }
  return out;
}

std::string along_line(const Line& line, const std::string& length) {
  std::string out = fmt::format("s [{}]", length);
  for (const char* name : {"x", "y", "z", "u", "v", "w"})
    out += fmt::format(",{} [{}]", name, length);
  out += strain_heads("") + "\n";
  double s = 0.0;
  for (Eigen::Index i = 0; i < line.X.cols(); ++i) {
    if (i > 0) s += (line.X.col(i) - line.X.col(i - 1)).norm();
    Row(out)
        .number(s)
        .vector(Vector3d(line.X.col(i)))
        .vector(Vector3d(line.u.col(i)))
        .strain(line.strain[static_cast<size_t>(i)]);
  }
  return out;
}

/// "CASE-VIEW", numbered where that is taken, in any case of letters.
std::string file_name(const std::string& of, std::set<std::string>& taken) {
  const auto lower = [](std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
  };
  std::string name = of;
  for (int i = 2; !taken.insert(lower(name)).second; ++i) name = fmt::format("{}-{}", of, i);
  return name + ".csv";
}

class Dic final : public Exporter {
 public:
  std::string name() const override { return "dic"; }
  std::string title() const override {
    return "tables as of image correlation: displacements and strains of the surface";
  }
  bool of_pictures() const override { return true; }
  Exported write(const SolverModel& model) const override {
    const SeenSurface& seen = *model.seen;
    const std::string& length = model.units.length;
    Exported out;
    std::set<std::string> taken = {"gauges", "lines", "reporting"};
    for (const SeenCase& one : seen.cases) {
      for (const SeenPoints& view : one.views)
        out.files.emplace_back(file_name(one.name + "-" + view.view, taken),
                               points_text(view, length));
      for (const Line& line : one.lines)
        out.files.emplace_back(file_name(one.name + "-" + line.name, taken),
                               along_line(line, length));
    }
    if (!seen.scene->body->regions.all().empty())
      out.files.emplace_back("gauges.csv", gauges_text(seen));
    if (!seen.options.lines.empty()) out.files.emplace_back("lines.csv", lines_text(seen, length));
    out.files.emplace_back("reporting.csv", report_csv(reporting_table(seen, model)));
    out.files.emplace_back("README.txt", readme(seen, model));
    out.notes = {
        "x, y, z are where a point is at rest, u, v, w the model's displacement; u_photo "
        "and its like add what the photos still ask for"};
    for (const SeenCase& one : seen.cases)
      for (const SeenPoints& view : one.views)
        if (!view.from.empty())
          out.notes.push_back(fmt::format(
              "{}-{}.csv has its field's reference: places are those of load case {}, and what it "
              "holds leads on from there",
              one.name, view.view, view.from));
    for (const SeenCase& one : seen.cases)
      if (std::ranges::none_of(one.views, [](const auto& view) { return view.size() > 0; }))
        out.lacks.push_back(one.name + ": no camera and no field shows a point of the body");
    return out;
  }
};

}  // namespace
}  // namespace hookeye::dic

HOOKEYE_DEFINE_EXPORTER(dic, dic::Dic)
