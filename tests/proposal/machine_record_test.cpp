// Tables of test machines in several dialects: numbers, units, gaps, the load cell's zero.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proposal/lab_folder.h"

namespace hookeye::test {
namespace {

using testing::HasSubstr;

MachineRecord record_of(const LabFolder& lab, const std::string& text,
                        const Questions::Answers& answers = {}, std::string name = "test.csv") {
  lab.write(name, text);
  Questions questions(answers);
  const auto table = read_text_table(lab.path() / name);
  if (!table) throw std::runtime_error("no table");
  return machine_record(*table, questions);
}

/// 20 rows from line `first`: time in `s`, travel in `mm`, force in `N`, as the dialect has them.
struct Dialect {
  const char* name;
  const char* head;
  const char* form;  ///< of time, travel and force
  double time, travel, force;
  bool comma;
  int first;
};
const Dialect kDialects[] = {
    {"Instron",
     "\"Specimen\",\"bar 3\"\n\"Operator\",\"A, B\"\n\n\"Time\",\"Extension\",\"Load\"\n"
     "\"(s)\",\"(mm)\",\"(kN)\"\n",
     "\"{:.4f}\",\"{:.5f}\",\"{:.7f}\"\n", 1, 1, 1e-3, false, 6},
    {"Zwick", "Prüfzeit;Standardweg;Standardkraft\ns;mm;N\n", "{:.4f};{:.5f};{:.5f}\n", 1, 1, 1,
     true, 3},
    {"ZwickInName", "Zeit in s;Weg in mm;Kraft in N\n", "{:.4f};{:.5f};{:.5f}\n", 1, 1, 1, true, 2},
    {"MtsTabs", "Data Header:\nTime\tAxial Displacement\tAxial Force\nms\tm\tN\n",
     "{:.2f}\t{:.8f}\t{:.5f}\n", 1e3, 1e-3, 1, false, 4},
    {"Slashes", "time/s\textension/mm\tforce/N\n", "{:.4f}\t{:.5f}\t{:.5f}\n", 1, 1, 1, true, 2},
    {"Imperial", "Time (sec),Crosshead (in),Load (lbf)\n", "{:.4f},{:.7f},{:.7f}\n", 1, 1 / 25.4,
     1 / 4.4482216152605, false, 2},
    {"Blanks", "time_s travel_mm force_N\n", "{:.4f}   {:.5f}  {:.5f}\n", 1, 1, 1, false, 2},
};

class Dialects : public testing::TestWithParam<Dialect> {};

TEST_P(Dialects, GiveTheSameNumbers) {
  const LabFolder lab;
  const Dialect& dialect = GetParam();
  std::string text = dialect.head;
  const auto rows = ramp(10, 40, 1.5);
  for (const RampRow& row : rows) {
    std::string line = fmt::format(fmt::runtime(dialect.form), row.time * dialect.time,
                                   row.travel * dialect.travel, row.force * dialect.force);
    if (dialect.comma) std::replace(line.begin(), line.end(), '.', ',');
    text += line;
  }
  const MachineRecord record = record_of(lab, text);
  ASSERT_EQ(record.size(), rows.size());
  EXPECT_EQ(record.lines.front(), dialect.first);
  EXPECT_NEAR(record.force_zero, 1.5, 2e-3);
  EXPECT_GE(record.still_rows, 9u);
  EXPECT_LE(record.still_rows, 11u);
  EXPECT_NEAR(record.onset, 4.5, 0.3);
  for (size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR(record.time[i], rows[i].time, 1e-3);
    EXPECT_NEAR(record.travel[i], rows[i].travel, 1e-3);
    EXPECT_NEAR(record.force[i], rows[i].force - 1.5, 5e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Machines, Dialects, testing::ValuesIn(kDialects),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(MachineRecord, Utf16AsWindowsWritesIt) {
  const LabFolder lab;
  const std::string text = plain_table(ramp(10, 20));
  std::string wide = "\xFF\xFE";
  for (const char c : text) wide += {c, '\0'};
  EXPECT_EQ(record_of(lab, wide).force, record_of(lab, text).force);
}

TEST(MachineRecord, RowsThatAreNoneAreToldWithTheirLine) {
  const LabFolder lab;
  std::string text = plain_table(ramp(10, 20));
  const auto replace = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
  };
  replace("\n7.000,", "\nSpecimen slipped\n7.000,");
  replace("9.000,1.8000,3.5980", "9.000,1.8000,overload");
  const MachineRecord record = record_of(lab, text);
  EXPECT_EQ(record.size(), 29u);
  EXPECT_TRUE(any_says(record.said, "test.csv:16: `Specimen slipped`"))
      << fmt::format("{}", fmt::join(record.said, "\n"));
  EXPECT_TRUE(any_says(record.said, "test.csv:21: `Force [N]` is `overload`: the row is left out"))
      << fmt::format("{}", fmt::join(record.said, "\n"));
}

std::string refusal(const std::string& text, const Questions::Answers& answers = {}) {
  const LabFolder lab;
  try {
    record_of(lab, text, answers);
    return "";
  } catch (const InputError& error) {
    const std::string what = error.what();
    const size_t at = what.find("test.csv");
    return at == std::string::npos ? what : what.substr(at);
  }
}

TEST(MachineRecord, RefusalsNameTheLine) {
  const std::string rows = "0,0,0\n1,1,1\n2,2,2\n3,3,3\n";
  EXPECT_THAT(refusal("time [s],travel [mm],force [kip]\n" + rows),
              testing::StartsWith("test.csv:1: the unit `kip` of `force [kip]` is not known"));
  EXPECT_EQ(refusal("time [s],travel [mm],force [kip]\n" + rows, {{"force_unit", "kN"}}), "");
  EXPECT_THAT(refusal("time [s],travel [mm],force [N]\n" + rows + "1.5,4,4\n"),
              testing::StartsWith("test.csv:6: time goes back from 3 s to 1.5 s"));
  EXPECT_THAT(refusal("time [s],travel [mm],force [N]\n" + rows, {{"force_column", "farce [N]"}}),
              HasSubstr("did you mean `force [N]`?"));
}

TEST(MachineRecord, MissingUnitsAreAsked) {
  const LabFolder lab;
  lab.write("test.csv", "time [s],travel,force\n0,0,0\n1,1,1\n2,2,2\n3,3,3\n");
  Questions questions({});
  machine_record(*read_text_table(lab.path() / "test.csv"), questions);
  std::vector<std::string> open;
  for (const CaptureQuestion& one : questions.open()) open.push_back(one.name);
  EXPECT_THAT(open, testing::ElementsAre("force_unit", "travel_unit"));
}

/// The crosshead in m beside an extensometer in mm: the same motion.
TEST(MachineRecord, ATravelAThousandTimesAnotherOneIsAsked) {
  const LabFolder lab;
  const auto asked = [&](const std::string& head, double travel, double other) {
    std::string text = head + "\n";
    for (const RampRow& row : ramp(10, 20))
      text += fmt::format("{},{:.7f},{:.7f},{:.4f}\n", row.time, travel * row.travel,
                          other * row.travel, row.force);
    lab.write("test.csv", text);
    Questions questions({});
    const MachineRecord record =
        machine_record(*read_text_table(lab.path() / "test.csv"), questions);
    for (const CaptureQuestion& one : questions.open())
      if (one.name == "travel_unit")
        return fmt::format("{} | {} | {}", one.text, one.why, one.standard);
    return std::string();
  };
  const std::string head = "time [s],travel [mm],extension [mm],force [N]";
  EXPECT_EQ(asked(head, 1.0, 0.7), "");
  EXPECT_EQ(asked(head, 1.0, 0.02), "") << "a stiff specimen in soft grips";
  EXPECT_EQ(asked("time [s],travel [m],extension [mm],force [N]", 1e-3, 0.7), "");
  const std::string in_metres = asked(head, 1e-3, 0.7);
  EXPECT_THAT(in_metres, HasSubstr("in which the table's lengths do not go together"));
  EXPECT_THAT(in_metres, HasSubstr("`travel [mm]` goes over 0.004 mm"));
  EXPECT_THAT(in_metres, HasSubstr("as if it were in m | mm"));
  EXPECT_THAT(asked("time [s],travel,extension [mm],force [N]", 1e-3, 0.7),
              testing::EndsWith("as if it were in m | m"));
}

TEST(MachineRecord, ATestThatBeginsAtOnceHasNoZero) {
  const LabFolder lab;
  for (const size_t rows : {30u, 3000u}) {
    const MachineRecord record = record_of(lab, plain_table(ramp(0, rows, 1.5)));
    EXPECT_EQ(record.still_rows, 0u) << rows;
    EXPECT_EQ(record.force_zero, 0) << rows;
    EXPECT_TRUE(any_says(record.said, "no rows at rest stand out"));
  }
}

TEST(MachineRecord, ARowAPhotoHasFewRowsAtRest) {
  const LabFolder lab;
  const std::string head = "Image,Displacement [mm],Force [N]\n";
  const auto read = [&](const std::string& rows) {
    lab.write("test.csv", head + rows);
    Questions questions({});
    return machine_record(*read_text_table(lab.path() / "test.csv"), questions);
  };
  const MachineRecord three =
      read("0,0,0.21\n1,0,0.19\n2,0,0.2\n3,2,1.7\n4,4,3.1\n5,6,4.5\n6,8,5.8\n");
  EXPECT_EQ(three.still_rows, 3u);
  EXPECT_NEAR(three.force_zero, 0.2, 1e-12);
  const MachineRecord none = read("0,0,0\n1,1,1\n2,2,2\n3,3,3\n4,4,4\n5,5,5\n6,6,6\n");
  EXPECT_EQ(none.still_rows, 0u);
}

TEST(MachineRecord, CommasBetweenAndWithinNumbersAreRefused) {
  const LabFolder lab;
  lab.write("test.csv",
            "Time [s],Travel [mm],Force [N]\n0,0,0,00,0,10\n1,0,1,00,0,20\n2,0,2,00,0,30\n");
  Questions questions({});
  try {
    machine_record(*read_text_table(lab.path() / "test.csv"), questions);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.place().line, 2);
    EXPECT_THAT(error.wrong(), HasSubstr("the row has 6 cells, the head 3 names"));
    EXPECT_THAT(error.right(), HasSubstr("semicolons"));
  }
}

TEST(TextTable, CellsAreNumbersOrNot) {
  EXPECT_EQ(number_in("1.5", false), 1.5);
  EXPECT_EQ(number_in("-1,5E-3", true), -1.5e-3);
  EXPECT_EQ(number_in("1,234.5", false), 1234.5);
  EXPECT_EQ(number_in("1.234,5", true), 1234.5);
  EXPECT_EQ(number_in("0,500", false), std::nullopt);
  EXPECT_EQ(number_in("1.5 N", false), std::nullopt);
  EXPECT_EQ(number_in("nan", false), std::nullopt);
  bool clock = false;
  EXPECT_EQ(number_in("00:01:30.5", false, &clock), 90.5);
  EXPECT_TRUE(clock);
  EXPECT_EQ(number_in("1970-01-02 00:00:01", false), 86401.0);
  EXPECT_EQ(number_in("02.01.1970 01:00", true), 90000.0);
  EXPECT_EQ(unit_in("mN", Quantity::force), 1e-3);
  EXPECT_EQ(unit_in("MN", Quantity::force), 1e6);
  EXPECT_EQ(unit_in("mm", Quantity::force), std::nullopt);
}

}  // namespace
}  // namespace hookeye::test
