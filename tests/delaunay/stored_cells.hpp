// All that a store of growing cells says, whatever its cells are numbered.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <set>

#include "delaunay/cell_store.hpp"

namespace cullhull::testing_support {

using internal::CellStore;

/// Corners of each cell, ghosts among them, and what lies across the facet without each corner.
template <unsigned K>
std::map<std::set<std::uint32_t>, std::map<std::uint32_t, std::set<std::uint32_t>>> cells_of(
    CellStore<K>& store) {
  const auto corners = [&](std::uint32_t c) {
    return std::set<std::uint32_t>(store.vertices(c), store.vertices(c) + K + 1);
  };
  std::map<std::set<std::uint32_t>, std::map<std::uint32_t, std::set<std::uint32_t>>> cells;
  for (std::uint32_t c = 0; c < store.count(); ++c) {
    if (store.dead(c)) continue;
    auto& across = cells[corners(c)];
    for (unsigned j = 0; j <= K; ++j) {
      const std::uint32_t code = store.neighbours(c)[j];
      EXPECT_EQ(store.neighbours(store.cell_of(code))[store.slot_of(code)], store.code(c, j));
      across[store.vertices(c)[j]] = corners(store.cell_of(code));
    }
  }
  return cells;
}

}  // namespace cullhull::testing_support
