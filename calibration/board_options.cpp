#include "calibration/board_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>

#include "calibration/detection.h"

namespace hookeye {
namespace {

/// "7x5".
void read_counts(const std::string& option, const std::string& text, Board& board) {
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, board.columns);
  const bool middle = first.ec == std::errc() && first.ptr != end && *first.ptr == 'x';
  const auto second = middle ? std::from_chars(first.ptr + 1, end, board.rows) : first;
  const bool good = middle && second.ec == std::errc() && second.ptr == end;
  const int least = board.dots() ? 2 : 3;
  if (!good || board.columns < least || board.rows < least || board.columns > 200 ||
      board.rows > 200)
    throw bad_calibration(fmt::format("{} {} is no count of columns and rows", option, text),
                          fmt::format("as {} 7x5, {} to 200 of each", option, least));
}

void need(bool there, const std::string& kind, const std::string& option, const std::string& what) {
  if (!there)
    throw bad_calibration(fmt::format("a board of kind {} needs {}", kind, option),
                          fmt::format("{}: {}", option, what));
}

void check_lengths(const ToldBoard& told) {
  for (const auto& [option, length] : {std::pair{"--square", told.square},
                                       {"--marker", told.marker},
                                       {"--spacing", told.spacing},
                                       {"--diameter", told.diameter}})
    if (!std::isfinite(length) || length < 0.0)
      throw bad_calibration(fmt::format("{} {:g} is no length", option, length),
                            "a number above zero");
}

std::string upper_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

void read_dictionary(const std::string& told, Board& board) {
  std::string name = upper_case(told);
  if (name.starts_with("DICT_")) name.erase(0, 5);
  for (const std::string& known : marker_dictionaries())
    if (upper_case(known) == name) board.dictionary = known;
  if (!board.dictionary.empty()) return;
  const std::string near = nearest_name(name, marker_dictionaries());
  throw bad_calibration(fmt::format("there is no dictionary {} of markers", name),
                        near.empty()
                            ? fmt::format("one of {}", fmt::join(marker_dictionaries(), ", "))
                            : fmt::format("did you mean {}?", near));
}

void read_dots(const ToldBoard& told, Board& board) {
  need(!told.dots.empty(), told.kind, "--dots", "how many, as 11x8: in a row, and rows");
  need(told.spacing > 0, told.kind, "--spacing",
       board.kind == Board::Kind::circles
           ? "from centre to centre, as measured on the print"
           : "from row to row (half of that within a row), as measured on the print");
  read_counts("--dots", told.dots, board);
  board.pitch = told.spacing, board.diameter = told.diameter;
  const double room = board.pitch * (board.kind == Board::Kind::circles ? 1.0 : std::sqrt(2.0));
  if (board.diameter >= room)
    throw bad_calibration(
        fmt::format("dots of {:g} overlap at a distance of {:g}", board.diameter, room),
        "--diameter and --spacing in one unit");
}

void read_squares(const ToldBoard& told, Board& board) {
  need(!told.squares.empty(), told.kind, "--squares", "how many, as 7x5: columns and rows");
  need(told.square > 0, told.kind, "--square", "its side, as measured on the print");
  read_counts("--squares", told.squares, board);
  board.pitch = told.square;
}

double length_in(const std::string& word, const std::string& words) {
  double length = 0.0;
  const auto read = std::from_chars(word.data(), word.data() + word.size(), length);
  if (read.ec != std::errc() || read.ptr != word.data() + word.size() || !(length > 0.0) ||
      !std::isfinite(length))
    throw bad_calibration(fmt::format("the board '{}' has '{}' for a length", words, word),
                          "a number above zero");
  return length;
}

}  // namespace

InputError bad_calibration(const std::string& wrong, const std::string& right) {
  return {{kCalibrate}, wrong, right};
}

void demand_board_finder() {
  if (boards_can_be_found()) return;
  throw bad_calibration("this build of hookeye finds no boards: it was made without OpenCV's aruco",
                        "a build where libopencv-contrib-dev is installed (apt-get install "
                        "libopencv-contrib-dev, then configure and build again)");
}

Board board_of(const ToldBoard& told) {
  Board board;
  const auto kind = std::ranges::find(board_kinds(), told.kind);
  if (kind == board_kinds().end())
    throw bad_calibration(fmt::format("there is no kind of board '{}'", told.kind),
                          fmt::format("--board: one of {}", fmt::join(board_kinds(), ", ")));
  board.kind = static_cast<Board::Kind>(kind - board_kinds().begin());
  const bool charuco = board.kind == Board::Kind::charuco;
  check_lengths(told);
  if (board.dots())
    read_dots(told, board);
  else
    read_squares(told, board);
  const bool others = board.dots() ? !told.squares.empty() || told.square > 0
                                   : !told.dots.empty() || told.spacing > 0 || told.diameter > 0;
  if (others || (!charuco && (told.marker > 0 || !told.dictionary.empty())))
    throw bad_calibration("these options belong to another kind of board than " + told.kind,
                          "charuco: --squares --square --marker --dictionary; chessboard: "
                          "--squares --square; circles: --dots --spacing --diameter");
  if (!charuco) return board;
  need(told.marker > 0, told.kind, "--marker", "the side of a marker, as measured on the print");
  if (told.marker >= told.square)
    throw bad_calibration(
        fmt::format("markers of {:g} do not fit into squares of {:g}", told.marker, told.square),
        "--marker smaller than --square");
  board.marker = told.marker;
  if (!told.dictionary.empty()) read_dictionary(told.dictionary, board);
  return board;
}

ToldBoard told_board(const std::string& words) {
  ToldBoard out;
  std::istringstream text(words);
  std::string counts, word;
  text >> out.kind >> counts;
  const bool dots = out.kind.find("circles") != std::string::npos;
  (dots ? out.dots : out.squares) = counts;
  double* const lengths[] = {dots ? &out.spacing : &out.square, dots ? &out.diameter : &out.marker};
  for (double* length : lengths)
    if (text >> word) *length = length_in(word, words);
  if (out.kind == "charuco") text >> out.dictionary;
  if (text.clear(), text >> word)
    throw bad_calibration(fmt::format("the board '{}' has '{}' too many", words, word),
                          "as 'charuco 7x5 20 15', 'chessboard 10x7 25' or 'circles 11x8 5 3'");
  return out;
}

const std::vector<std::string>& board_units() {
  static const std::vector<std::string> units{"mm", "cm", "m", "um"};
  return units;
}

const std::vector<int>& lens_numbers() {
  static const std::vector<int> numbers{0, 4, 5, 8};
  return numbers;
}

bool is_camera_name(const std::string& name) {
  constexpr size_t kLongest = 80;
  return !name.empty() && name.size() <= kLongest && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-';
  });
}

}  // namespace hookeye
