#include "calibration/tags.h"

#include <map>

#include "calibration/ask_boards.h"

namespace hookeye {

std::vector<SeenTag> find_tags(const Image& photo, const std::string& dictionary,
                               const std::string& file) {
  Board board;
  board.dictionary = dictionary;
  Packer what = boards_request("tags", photo, board, Grey::linear);
  return ask_boards(what, file, [](Unpacker& from) {
    const auto ids = from.take<std::vector<int>>();
    const auto pixels = from.take<Eigen::Matrix2Xd>();
    if (static_cast<size_t>(pixels.cols()) != 4 * ids.size() || !pixels.allFinite())
      throw WireFault();
    std::map<int, std::vector<Eigen::Matrix<double, 2, 4>>> by_id;
    for (size_t i = 0; i < ids.size(); ++i)
      by_id[ids[i]].emplace_back(pixels.middleCols<4>(4 * static_cast<Eigen::Index>(i)));
    std::vector<SeenTag> tags;
    for (const auto& [id, places] : by_id)
      if (places.size() == 1) tags.push_back({id, places.front()});
    return tags;
  });
}

}  // namespace hookeye
