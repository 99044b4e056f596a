// Points in blocks from several threads, sorted by their keys.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/point_blocks.hpp"
#include "io/source.hpp"

namespace cullhull::internal {

/// Numbers words in the order in which they come. Open addressing: 20 bytes a word, and the word.
class WordNumbers {
 public:
  std::uint32_t number(std::string_view word);
  std::size_t size() const { return words_.size(); }
  const PointKeys& words() const { return words_; }
  std::uint64_t bytes() const { return words_.text.size() + 8 * words_.size() + 8 * slots_.size(); }

 private:
  struct Slot {
    std::uint32_t hash = 0, number = free;
  };
  static constexpr std::uint32_t free = 0xFFFFFFFF;
  void grow();
  PointKeys words_;
  std::vector<Slot> slots_;
};

/// Groups by their keys: by value if all keys are JSON numbers, else by bytes; equal keys by
/// number.
struct KeyOrder {
  explicit KeyOrder(const PointKeys& keys);
  bool numeric = true;               ///< whether all keys are JSON numbers
  std::vector<std::uint32_t> order;  ///< the numbers of the keys
};

/// The points of a group are consecutive, ordered by id.
struct SortedGroups {
  std::uint32_t dimension = 0;
  std::vector<std::uint64_t> offsets{0};  ///< of each group's points
  KeyOrder keys;
  Buffer coordinates;                ///< rows of doubles
  std::vector<PointColumn> columns;  ///< the values that the points of a group have in common
};

class CollectedPoints {
 public:
  explicit CollectedPoints(std::uint64_t budget) : budget_(budget) {}
  /// From any thread. Throws Error{not_finite}, Error{out_of_budget}.
  void add(const PointView& block, std::uint64_t first_id, const PointKeys& keys);
  /// Adds the points of all files with their keys. Throws Error{invalid_argument} where the options
  /// name no column of keys.
  BlockSummary read(const std::vector<std::string>& files, const BlockOptions& reading);
  /// Sorts and hands over all points. `columns`: values of the points, by their ids.
  SortedGroups sort(const std::vector<PointColumn>& columns);
  const PointKeys& words() const { return words_.words(); }

 private:
  struct Block {
    std::uint64_t first_id = 0, count = 0;
    std::vector<std::uint32_t> groups;
    std::vector<double> rows;
  };

  PointColumn in_common(const PointColumn& column, const std::vector<std::uint32_t>& order) const;

  std::uint64_t budget_, bytes_ = 0;
  std::uint32_t dimension_ = 0;
  std::mutex mutex_;
  std::vector<Block> blocks_;
  WordNumbers words_;
};

/// Whether a key is a valid JSON number, and so need not be written as a string.
bool is_json_number(std::string_view word);

}  // namespace cullhull::internal
