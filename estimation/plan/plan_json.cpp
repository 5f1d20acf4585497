#include "estimation/plan/plan_json.h"

namespace hookeye {

using nlohmann::json;

json to_json(const Plan& plan) {
  auto separation = [](const Separation& s) -> json {
    if (s.effect.empty()) return {};
    return {{"effect", s.effect},
            {"rival", s.rival},
            {"cosine", s.cosine},
            {"angle_deg", s.angle_deg()},
            {"evidence", s.margin}};
  };
  json ratings = json::array();
  for (const auto& rating : plan.ratings) {
    const bool load = rating.candidate.kind == PlanCandidate::Kind::load;
    json one = {{"name", rating.candidate.name},
                {"kind", load ? "load" : "view"},
                {"words", rating.candidate.words},
                {"told", rating.candidate.told},
                {"capture", capture_lines(rating.candidate)}};
    if (!rating.why_not.empty()) {
      one["why_not"] = rating.why_not;
    } else {
      one["photos"] = rating.photos;
      one["worst_pair"] = separation(rating.worst);
      one["difference"] = {{"px", rating.px}, {"chi", rating.chi}, {"most", rating.most}};
      one["makes_testable"] = rating.makes_testable;
      one["sentence"] = rating.sentence;
    }
    ratings.push_back(std::move(one));
  }
  return {{"hookeye", 1},
          {"confused", plan.confused},
          {"now", separation(plan.now)},
          {"untestable", plan.untestable},
          {"candidates", std::move(ratings)},
          {"sentence", plan.sentence}};
}

}  // namespace hookeye
