#include "filter/ways.hpp"

namespace cullhull::internal {
namespace {

std::string dimensions_of(const WayRow& r) {
  std::string text = std::to_string(r.least_dimension) + "D";
  if (r.most_dimension == ~0U) return text + " and more";
  if (r.most_dimension > r.least_dimension) text += " to " + std::to_string(r.most_dimension) + "D";
  return text;
}

}  // namespace

std::string why_not(Way way, const WayQuestion& q) {
  const WayRow& r = row_of(way);
  switch (refusal(way, q)) {
    case Refusal::none:
      return "";
    case Refusal::off:
      return "switched off";
    case Refusal::dimension:
      return "the " + std::string(r.name) + " is for " + dimensions_of(r);
    case Refusal::options:
      if (q.cull == CullMethod::none) return "no filter, as asked";
      if (way == Way::pseudo_hull) return "only if it is asked for";
      return q.cull == CullMethod::automatic ? "a device is asked for" : "a filter is asked for";
    case Refusal::too_few:
      if (way == Way::pseudo_hull || way == Way::gauge)
        return "too few points for the filter to pay (" + std::to_string(q.count) + ")";
      return "needs " + std::to_string(r.least) + " points";
    case Refusal::too_many:
      return "takes at most " + std::to_string(q.left ? r.most_left : r.most) + " points";
    case Refusal::budget:
      return "needs a budget of " + std::to_string(r.bytes >> 20) + " MiB";
  }
  return "";
}

}  // namespace cullhull::internal
