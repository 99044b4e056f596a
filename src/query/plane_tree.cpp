#include <algorithm>
#include <numeric>

#include "query/facet_search.hpp"

namespace cullhull::internal {

PlaneTree::PlaneTree(const std::vector<double>& planes, unsigned d, const Control& control)
    : d_(d), planes_(planes) {
  order_.resize(planes.size() / (d + 1));
  std::iota(order_.begin(), order_.end(), 0U);
  grow(0, static_cast<std::uint32_t>(order_.size()), control);
}

std::uint32_t PlaneTree::grow(std::uint32_t begin, std::uint32_t end, const Control& control) {
  control.check();
  const unsigned w = d_ + 1;
  const auto node = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({begin, end, 0});
  std::vector<double> low(planes_.begin() + std::size_t{order_[begin]} * w,
                          planes_.begin() + (std::size_t{order_[begin]} + 1) * w),
      high = low;
  for (std::uint32_t i = begin; i < end; ++i)
    for (unsigned j = 0; j < w; ++j) {
      const double v = planes_[std::size_t{order_[i]} * w + j];
      low[j] = std::min(low[j], v);
      high[j] = std::max(high[j], v);
    }
  boxes_.insert(boxes_.end(), low.begin(), low.end());
  boxes_.insert(boxes_.end(), high.begin(), high.end());
  if (end - begin <= leaf) return node;
  unsigned widest = 0;  // by the normal's axes, as offsets have another unit
  for (unsigned j = 1; j < d_; ++j)
    if (high[j] - low[j] > high[widest] - low[widest]) widest = j;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
    return planes_[std::size_t{a} * w + widest] < planes_[std::size_t{b} * w + widest];
  });
  grow(begin, middle, control);
  const std::uint32_t right = grow(middle, end, control);
  nodes_[node].right = right;
  return node;
}

double PlaneTree::plane_value(std::uint32_t i, const double* x) const {
  const double* p = planes_.data() + std::size_t{i} * (d_ + 1);
  double sum = p[d_];
  for (unsigned j = 0; j < d_; ++j) sum += p[j] * x[j];
  return sum;
}

double PlaneTree::bound(std::uint32_t node, const double* x) const {
  const double* low = boxes_.data() + std::size_t{node} * 2 * (d_ + 1);
  const double* high = low + d_ + 1;
  double sum = high[d_];
  for (unsigned j = 0; j < d_; ++j) sum += std::max(low[j] * x[j], high[j] * x[j]);
  return sum;
}

void PlaneTree::search(std::uint32_t node, const double* x, std::uint32_t& best,
                       double& value) const {
  const Node& n = nodes_[node];
  if (n.right == 0) {
    for (std::uint32_t i = n.begin; i < n.end; ++i) {
      const double v = plane_value(order_[i], x);
      if (v > value || (v == value && order_[i] < best)) {
        value = v;
        best = order_[i];
      }
    }
    return;
  }
  std::uint32_t near = node + 1, far = n.right;
  double near_bound = bound(near, x), far_bound = bound(far, x);
  if (far_bound > near_bound) {
    std::swap(near, far);
    std::swap(near_bound, far_bound);
  }
  if (near_bound >= value) search(near, x, best, value);
  if (far_bound >= value) search(far, x, best, value);
}

std::uint32_t PlaneTree::largest(const double* x, std::uint32_t start, double& value) const {
  std::uint32_t best = start;
  value = plane_value(start, x);
  search(0, x, best, value);
  return best;
}

}  // namespace cullhull::internal
