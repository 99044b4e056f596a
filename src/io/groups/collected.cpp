#include "io/groups/collected.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "io/text/text_scan.hpp"
#include "parallel/memory/memory.hpp"

namespace cullhull::internal {

std::uint32_t WordNumbers::number(std::string_view word) {
  if (2 * words_.size() >= slots_.size()) grow();
  const std::size_t hash = std::hash<std::string_view>{}(word);
  const auto high = static_cast<std::uint32_t>(hash >> 32);
  for (std::size_t at = hash & (slots_.size() - 1);; at = (at + 1) & (slots_.size() - 1)) {
    Slot& slot = slots_[at];
    if (slot.number == free) {
      if (words_.size() == free)
        throw Error(ErrorCode::out_of_budget, "more than 4,294,967,294 groups");
      slot = {high, static_cast<std::uint32_t>(words_.size())};
      words_.add(word);
      return slot.number;
    }
    if (slot.hash == high && words_[slot.number] == word) return slot.number;
  }
}

void WordNumbers::grow() {
  std::vector<Slot> larger(std::max<std::size_t>(1024, 2 * slots_.size()));
  for (std::uint32_t i = 0; i < words_.size(); ++i) {
    const std::size_t hash = std::hash<std::string_view>{}(words_[i]);
    std::size_t at = hash & (larger.size() - 1);
    while (larger[at].number != free) at = (at + 1) & (larger.size() - 1);
    larger[at] = {static_cast<std::uint32_t>(hash >> 32), i};
  }
  slots_.swap(larger);
}

void CollectedPoints::add(const PointView& block, std::uint64_t first_id, const PointKeys& keys) {
  const std::uint32_t d = block.dimension;
  Block kept{first_id, block.count, std::vector<std::uint32_t>(block.count),
             std::vector<double>(block.count * d)};
  double* out = kept.rows.data();
  for (std::uint64_t i = 0; i < block.count; ++i)
    for (std::uint32_t j = 0; j < d; ++j, ++out) {
      *out = block.at(i, j);
      if (!std::isfinite(*out))
        throw Error(ErrorCode::not_finite, "point ", first_id + i, ", coordinate ", j, " is ",
                    (std::isnan(*out) ? "NaN" : "infinite"),
                    "; remove or repair such points first");
    }
  const std::lock_guard lock(mutex_);
  dimension_ = d;
  for (std::uint64_t i = 0; i < block.count; ++i) kept.groups[i] = words_.number(keys[i]);
  // While they are sorted the rows exist twice.
  bytes_ += block.count * (16 * d + 4);
  require_budget(budget_, bytes_ + words_.bytes(), "the points that are sorted by group");
  blocks_.push_back(std::move(kept));
}

BlockSummary CollectedPoints::read(const std::vector<std::string>& files,
                                   const BlockOptions& reading) {
  if (reading.read.key.empty())
    throw Error(ErrorCode::invalid_argument, "groups need a column that tells them apart");
  BlockVisitor visitor;
  visitor.keyed = [this](const PointView& block, std::uint64_t first, const PointKeys& keys) {
    add(block, first, keys);
  };
  return visit_blocks(files, visitor, reading);
}

bool is_json_number(std::string_view word) {
  const std::size_t sign = word.starts_with('-') ? 1 : 0;
  if (word.size() == sign || !is_digit(word[sign]) || !is_digit(word.back())) return false;
  if (word[sign] == '0' && word.size() > sign + 1 && is_digit(word[sign + 1])) return false;
  for (std::size_t i = 0; i + 1 < word.size(); ++i)
    if (word[i] == '.' && !is_digit(word[i + 1])) return false;
  const char* p = word.data();
  double value;
  return scan_number(p, p + word.size(), value) == Scan::ok && p == word.data() + word.size();
}

KeyOrder::KeyOrder(const PointKeys& keys) : order(keys.size()) {
  std::iota(order.begin(), order.end(), 0U);
  std::vector<double> values;
  for (std::uint32_t i = 0; i < keys.size() && numeric; ++i) {
    numeric = is_json_number(keys[i]);
    const char* p = keys[i].data();
    double value = 0;
    if (numeric) (void)scan_number(p, p + keys[i].size(), value);
    values.push_back(value);
  }
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    if (numeric && values[a] != values[b]) return values[a] < values[b];
    return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
  });
}

/// `order`: the numbers of the groups, as they are listed.
PointColumn CollectedPoints::in_common(const PointColumn& column,
                                       const std::vector<std::uint32_t>& order) const {
  std::vector<std::string_view> values(order.size());
  std::vector<bool> seen(order.size()), differ(order.size());
  for (const Block& block : blocks_)
    for (std::uint64_t i = 0; i < block.count; ++i) {
      const std::uint32_t g = block.groups[i];
      const std::string_view value = column.values[block.first_id + i];
      if (!seen[g]) values[g] = value;
      seen[g] = true;
      differ[g] = differ[g] || values[g] != value;
    }
  PointColumn out{column.name, {}, column.numeric};
  for (const std::uint32_t g : order) out.values.add(differ[g] ? std::string_view() : values[g]);
  return out;
}

SortedGroups CollectedPoints::sort(const std::vector<PointColumn>& columns) {
  SortedGroups sorted{
      .dimension = dimension_, .keys = KeyOrder(words()), .coordinates = {}, .columns = {}};
  for (const PointColumn& column : columns)
    sorted.columns.push_back(in_common(column, sorted.keys.order));
  std::vector<std::uint32_t> rank(words_.size());
  for (std::uint32_t i = 0; i < rank.size(); ++i) rank[sorted.keys.order[i]] = i;
  std::sort(blocks_.begin(), blocks_.end(),
            [](const Block& a, const Block& b) { return a.first_id < b.first_id; });
  sorted.offsets.assign(rank.size() + 1, 0);
  for (const Block& block : blocks_)
    for (const std::uint32_t g : block.groups) ++sorted.offsets[rank[g] + 1];
  std::partial_sum(sorted.offsets.begin(), sorted.offsets.end(), sorted.offsets.begin());
  sorted.coordinates = Buffer(sorted.offsets.back() * dimension_ * sizeof(double));
  double* const rows = sorted.coordinates.as<double>();
  std::vector<std::uint64_t> next(sorted.offsets.begin(), sorted.offsets.end() - 1);
  for (Block& block : blocks_) {
    for (std::uint64_t i = 0; i < block.count; ++i)
      std::copy_n(block.rows.data() + i * dimension_, dimension_,
                  rows + next[rank[block.groups[i]]]++ * dimension_);
    block = {};  // frees the block's memory as the sorted rows' memory fills
  }
  blocks_.clear();
  return sorted;
}

}  // namespace cullhull::internal
