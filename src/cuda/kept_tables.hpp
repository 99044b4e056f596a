// A query's tables in the memory of the current device.
#pragma once

#include <type_traits>
#include <vector>

#include "cuda/kernels/hull_questions_kernel.hpp"
#include "cuda/runtime.hpp"

namespace cullhull::internal {

/// The table on the current device; where it is not there yet, the numbers of make() are uploaded.
template <class Table, class Make>
auto* kept_there(KeptTables& kept, const Table& table, cudaStream_t stream, const Make& make) {
  using Number = std::remove_cvref_t<decltype(table[0])>;
  const std::lock_guard lock(kept.mutex);
  std::shared_ptr<std::byte>& there = kept.there[{this_device().ordinal, table.data()}];
  if (there == nullptr) {
    const auto& numbers = make();
    std::shared_ptr<std::byte> memory = result_memory(numbers.size() * sizeof(Number), stream);
    upload(reinterpret_cast<Number*>(memory.get()), numbers.data(), numbers.size(), stream);
    there = std::move(memory);  // complete: calls on other streams may read it
  }
  return reinterpret_cast<const Number*>(there.get());
}
template <class Table>
auto* kept_there(KeptTables& kept, const Table& table, cudaStream_t stream) {
  return kept_there(kept, table, stream, [&]() -> const Table& { return table; });
}

/// A hull's cells of directions there, their normals normal_stride() doubles apart.
inline CellsThere kept_there(KeptTables& kept, const FacetCellTable& cells, cudaStream_t stream) {
  const auto spread = [&] {
    const unsigned d = cells.k, stride = normal_stride(d);
    std::vector<double> normals(cells.normals.size() / d * stride);
    for (std::size_t i = 0; i < cells.normals.size(); ++i)
      normals[i / d * stride + i % d] = cells.normals[i];
    return normals;
  };
  return {cells, kept_there(kept, cells.normals, stream, spread),
          kept_there(kept, cells.starts, stream), kept_there(kept, cells.facets, stream)};
}

}  // namespace cullhull::internal
