// What a batch has found: as a table, as a database, and as a page that obeys no text of a file.
#include "batch/batch_index.h"

#include <gmock/gmock.h>
#include <sqlite3.h>

#include <cstdio>
#include <fstream>

#include "batch/fleet_page.h"
#include "batch/fleet_style.h"
#include "batch/strip_plot.h"
#include "core/base64.h"
#include "support/temporary_folder.h"

namespace hookeye::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

const BatchOrder kOrder{"discover", {"--set", "fit.pixels=0"}, "xxh3:1", "0.2.0", true};

json row_of(const std::string& label, double mu) {
  return {{"label", label},
          {"capture", "/c/" + label},
          {"key", label},
          {"options", json::array()},
          {"state", "done"},
          {"verdict", "explained"},
          {"sentence", "The given model lacks gravity"},
          {"found", {"gravity"}},
          {"tie", json::array()},
          {"parameters",
           {{{"name", "mu"},
             {"unit", "MPa"},
             {"long_name", "shear modulus"},
             {"value", mu},
             {"low", 0.04},
             {"high", 0.06}}}},
          {"chi_fit", 1.02},
          {"chi_validate", nullptr},
          {"floor", 1.0},
          {"rms_px", 0.01},
          {"seconds", 12.5},
          {"cpu_seconds", 20.0},
          {"memory", 3e8},
          {"exit", 0},
          {"error", nullptr},
          {"run", "runs/" + label},
          {"report", "reports/" + label + ".html"},
          {"log", "logs/" + label + ".txt"}};
}

json failed_row(const std::string& label, const std::string& error) {
  json out = row_of(label, 0.0);
  for (const char* key : {"verdict", "sentence", "chi_fit", "floor", "rms_px"}) out[key] = nullptr;
  out["found"] = out["parameters"] = json::array();
  out["state"] = "failed";
  out["exit"] = 3;
  out["error"] = error;
  out["report"] = "";
  return out;
}

TEST(IndexCsv, HasALineACaptureAndColumnsAParameter) {
  const std::string text =
      index_csv({row_of("one", 0.05), failed_row("two", "no equilibrium, \"pull\"\nmore")});
  EXPECT_THAT(text, HasSubstr(",report,mu,mu_low,mu_high,mu_unit\n"));
  EXPECT_THAT(text, HasSubstr("one,/c/one,,done,explained,gravity,,1.02,,1.0,0.01,12.5,"));
  EXPECT_THAT(text, HasSubstr("reports/one.html,0.05,0.04,0.06,MPa\n"));
  EXPECT_THAT(text, HasSubstr("\"no equilibrium, \"\"pull\"\"\nmore\",runs/two,,,,,\n"));
}

TEST(IndexSqlite, AnswersQuestions) {
  const TemporaryFolder folder;
  const std::string file = folder / "index.sqlite";
  std::ofstream(file, std::ios::binary)
      << index_sqlite({row_of("one", 0.05), row_of("two", 0.07), failed_row("x", "bad")}, kOrder);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  const auto ask = [&](const char* question) {
    std::string out;
    sqlite3_exec(
        database, question,
        [](void* to, int count, char** values, char**) {
          for (int i = 0; i < count; ++i)
            *static_cast<std::string*>(to) += std::string(values[i] ? values[i] : "null") + " ";
          return 0;
        },
        &out, nullptr);
    return out;
  };
  EXPECT_EQ(ask("SELECT count(*), max(value), unit FROM parameters"), "2 0.07 MPa ");
  EXPECT_EQ(ask("SELECT effect, count(*) FROM found GROUP BY effect"), "gravity 2 ");
  EXPECT_EQ(ask("SELECT label, error, chi_fit FROM captures WHERE state = 'failed'"),
            "x bad null ");
  EXPECT_EQ(ask("SELECT verb, options FROM batch"), "discover [\"--set\",\"fit.pixels=0\"] ");
  sqlite3_close(database);
}

TEST(FleetPage, ShowsTextAndObeysNone) {
  std::vector<json> rows = {failed_row("<script>alert(1)</script>", "a \"quoted\" & <b>bold</b>")};
  for (int i = 0; i < 7; ++i) rows.push_back(row_of(fmt::format("c{}", i), 0.05 + 1e-4 * i));
  rows.push_back(row_of("odd", 0.09));
  const std::string page = fleet_page(rows, kOrder);
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("<b>bold")));
  EXPECT_THAT(page, Not(HasSubstr("style=\"")));  // the policy forbids it
  EXPECT_THAT(page, HasSubstr("a &quot;quoted&quot; &amp; &lt;b&gt;bold&lt;/b&gt;"));
  EXPECT_THAT(page, HasSubstr("8 of 8"));  // gravity
  EXPECT_THAT(page,
              HasSubstr("<a href=\"reports/odd.html\">odd</a>: mu = 0.09 MPa (median 0.05035)"));
  EXPECT_THAT(page, HasSubstr("discover --set fit.pixels=0"));
}

TEST(FleetPage, OfNothingYet) {
  json row = failed_row("one", "");
  row["state"] = "todo";
  row["exit"] = row["seconds"] = row["cpu_seconds"] = row["memory"] = nullptr;
  EXPECT_THAT(fleet_page({row}, kOrder), HasSubstr("<b>1</b>to do"));
}

TEST(FleetStyle, IsWhatItsPolicyAllows) {
  const TemporaryFolder folder;
  const std::string file = folder / "style";
  std::ofstream(file) << kFleetStyle;
  std::FILE* const pipe = ::popen(("sha256sum '" + file + "'").c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  char hex[65] = "";
  ASSERT_EQ(std::fread(hex, 1, 64, pipe), 64U);
  ::pclose(pipe);
  std::string bytes;
  for (int i = 0; i < 32; ++i)
    bytes += static_cast<char>(std::stoi(std::string(hex + 2 * i, 2), nullptr, 16));
  EXPECT_EQ(kFleetStyleHash, base64(bytes.data(), bytes.size()));
}

TEST(Outliers, AreFarFromTheOthersAndBeyondTheirOwnInterval) {
  std::vector<StripPoint> points;
  for (int i = 0; i < 9; ++i)
    points.push_back({1.0 + 0.01 * i, 1.0, 1.1, fmt::format("{}", i), ""});
  points.push_back({2.0, 1.9, 2.1, "far", ""});
  points.push_back({2.0, 0.5, 3.5, "unsure", ""});
  mark_outliers(points);
  for (const StripPoint& one : points) EXPECT_EQ(one.outlier, one.label == "far") << one.label;
  std::vector<StripPoint> few(points.begin() + 7, points.end());
  mark_outliers(few);
  EXPECT_FALSE(few[2].outlier);
  EXPECT_THAT(strip_plot(points, "MPa"), HasSubstr(">far</text>"));
}

TEST(StripPlots, TakeEqualAndLoneValues) {
  for (const double value : {0.0, 5.0, -1e-9, 1e300}) {
    const std::string plot = strip_plot({{value, value, value, "a", ""}}, "");
    EXPECT_THAT(plot, Not(HasSubstr("nan"))) << value;
    EXPECT_THAT(plot, Not(HasSubstr("inf"))) << value;
  }
  EXPECT_EQ(strip_plot({}, ""), "");
}

}  // namespace
}  // namespace hookeye::test
