#include "calibration/dictionary.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "calibration/detection.h"
#include "core/interrupted.h"

namespace hookeye {
namespace {

/// A photo is looked at with all dictionaries, which takes ten times as long as with one.
constexpr size_t kLooks = 5;

/// All photos; first some that are spread over the list.
std::vector<size_t> order_of_looks(size_t count) {
  std::vector<size_t> order;
  for (size_t k = 0; k < kLooks && k < count; ++k)
    order.push_back(k * (count - 1) / std::max<size_t>(std::min(kLooks, count) - 1, 1));
  for (size_t i = 0; i < count; ++i)
    if (std::ranges::count(order, i) == 0) order.push_back(i);
  return order;
}

struct Tally {
  std::map<std::string, size_t> markers;  ///< in their places, by dictionary
  size_t photos = 0, shown = 0;           ///< looked at; that show the board
};

/// The few first; of the others as many as it takes to see the board once.
Tally tally_of(const Board& board, const PhotoList& list, const CalibrateOptions& options) {
  Tally tally;
  for (const size_t i : order_of_looks(list.photos.size())) {
    if (tally.photos >= kLooks && tally.shown > 0) break;
    if (options.stopped()) throw Interrupted{};
    const std::filesystem::path& file = list.photos[i].file;
    bool shown = false;
    for (const DictionaryFit& fit : try_dictionaries(read_image(file), board, file.string()))
      if (fit.corners >= kFewestCorners) tally.markers[fit.dictionary] += fit.markers, shown = true;
    ++tally.photos, tally.shown += shown;
  }
  return tally;
}

/// What the photos show instead: the board the other way round, or markers in other places.
[[noreturn]] void refuse_unknown(const Board& board, const PhotoList& list, const Tally& tally) {
  std::string right =
      "the board as it is printed (squares are counted, not corners), flat, sharp, with a white "
      "rim, and markers of a dictionary that OpenCV predefines";
  const auto looks = order_of_looks(list.photos.size());
  for (size_t k = 0; k < std::min(kLooks, looks.size()); ++k) {
    const std::filesystem::path& file = list.photos[looks[k]].file;
    Board turned = board;
    std::swap(turned.columns, turned.rows);
    const Image photo = read_image(file);
    const auto fits = try_dictionaries(photo, turned, file.string());
    const auto best = std::ranges::max_element(fits, {}, &DictionaryFit::markers);
    if (turned.columns != board.columns && best != fits.end() && best->corners >= kFewestCorners)
      right = fmt::format("a {} with markers of {} is in {}: --squares {}x{}", turned.title(),
                          best->dictionary, file.filename().string(), turned.columns, turned.rows);
    else if (const std::string other = markers_seen(photo, board, file.string()); !other.empty())
      right = fmt::format("{} in {}, but not in the places of this board: count its squares again",
                          other, file.filename().string());
    else
      continue;
    break;
  }
  throw InputError(
      {list.photos.front().file.string()},
      fmt::format("no dictionary of markers is known by which any of {} photos shows a {}",
                  tally.photos, board.title()),
      right);
}

}  // namespace

std::string find_dictionary(Board& board, const PhotoList& list, const CalibrateOptions& options) {
  const Tally tally = tally_of(board, list, options);
  if (tally.markers.empty()) refuse_unknown(board, list, tally);
  std::vector<std::pair<std::string, size_t>> ranked(tally.markers.begin(), tally.markers.end());
  std::ranges::stable_sort(ranked, std::greater(), &std::pair<std::string, size_t>::second);
  if (ranked.size() > 1 && ranked[0].second == ranked[1].second)
    throw InputError({list.photos.front().file.string()},
                     fmt::format("the photos show {} markers of {} and as many of {}, all in their "
                                 "places on a {}",
                                 ranked[0].second, ranked[0].first, ranked[1].first, board.title()),
                     fmt::format("tell which board counts: --dictionary {} or --dictionary {}",
                                 ranked[0].first, ranked[1].first));
  board.dictionary = ranked[0].first;
  std::string said =
      fmt::format("its markers are of {}, found in {} of {} photos that were looked at",
                  board.dictionary, tally.shown, tally.photos);
  if (ranked.size() > 1)
    said += fmt::format(": {} markers in their places, against {} of {}", ranked[0].second,
                        ranked[1].second, ranked[1].first);
  return said;
}

}  // namespace hookeye
