// Whether points lie in a flat, exactly.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {

/// A flat in R^d of dimension k, which projects to `axes` one to one. A point is in it if on these
/// axes together with any other one the simplex of the basis and the point is degenerate.
class FlatTest {
 public:
  /// `basis`: k + 1 independent points of the flat. `axes`: ascending.
  FlatTest(unsigned d, const std::vector<unsigned>& axes, const std::vector<const double*>& basis)
      : axes_(axes) {
    for (unsigned c = 0; c < d; ++c) {
      if (std::binary_search(axes.begin(), axes.end(), c)) continue;
      Column column{c, true, basis[0][c], {}};
      for (const double* p : basis) {
        column.constant &= p[c] == column.value;
        for (const unsigned a : axes) column.rows.push_back(p[a]);
        column.rows.push_back(p[c]);
      }
      columns_.push_back(std::move(column));
    }
  }

  /// `exact`, if given, is raised by the number of signs that exact arithmetic decided.
  bool contains(const double* x, std::uint64_t* exact = nullptr) const {
    const auto k = static_cast<unsigned>(axes_.size());
    std::vector<double> row(k + 1);
    std::vector<const double*> rows(k + 2);
    for (const Column& column : columns_) {
      if (column.constant) {
        if (x[column.axis] != column.value) return false;
        continue;
      }
      for (unsigned j = 0; j < k; ++j) row[j] = x[axes_[j]];
      row[k] = x[column.axis];
      for (unsigned i = 0; i <= k; ++i) rows[i] = column.rows.data() + std::size_t{i} * (k + 1);
      rows[k + 1] = row.data();
      Rung rung = Rung::filter;
      const Sign sign = orientation(k + 1, rows.data(), &rung);
      if (exact != nullptr) *exact += rung == Rung::exact;
      if (sign != Sign::zero) return false;
    }
    return true;
  }

 private:
  struct Column {
    unsigned axis;
    bool constant;  ///< the flat is orthogonal to the axis, at `value`
    double value;
    std::vector<double> rows;
  };
  std::vector<unsigned> axes_;
  std::vector<Column> columns_;
};

}  // namespace cullhull::internal
