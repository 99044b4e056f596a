// The normals of many simplices, one after another: computed in blocks, with the bits that
// FacetPlane::normal gives for each.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <type_traits>
#include <vector>

#include "result/facets/facet_plane.hpp"
#include "result/facets/normal_block.hpp"
#include "result/measures/measure_frame.hpp"
#include "result/measures/totals.hpp"

namespace cullhull::internal {

/// Up to 8D: of simplices that are requested in ascending order. `simplices`: the ids of the
/// corners of `count` simplices. In 2D and 3D nothing is computed ahead.
template <unsigned K>
class FewNormals {
 public:
  FewNormals(const Frame& frame, const FacetPlane<K>& plane, const std::uint32_t* simplices,
             std::uint64_t count)
      : frame_(frame), plane_(plane), simplices_(simplices), count_(count) {}
  /// The same as FacetPlane::normal.
  double of(std::uint64_t i, double* n, std::vector<double>& scratch, bool* reliable,
            double* error) {
    if constexpr (K >= 4) {
      constexpr unsigned lanes = FacetBlock<K>::lanes;
      if (i < first_ || i >= first_ + lanes) load(i);
      const auto lane = static_cast<unsigned>(i - first_);
      const double size = block_.length[lane];
      if (size > conditioned * block_.edges[lane]) {
        for (unsigned c = 0; c < K; ++c) n[c] = block_.normal[c][lane];
        *reliable = true;
        *error = size;
        return size;
      }
    }
    return plane_.normal(simplices_ + i * K, n, scratch, reliable, error);
  }

 private:
  struct Nothing {};
  void load(std::uint64_t i) {
    if constexpr (K >= 4) {
      first_ = i;
      for (unsigned lane = 0; lane < FacetBlock<K>::lanes; ++lane) {
        const std::uint32_t* v = simplices_ + std::min(i + lane, count_ - 1) * K;
        for (unsigned j = 0; j < K; ++j)
          for (unsigned c = 0; c < K; ++c)
            block_.corner[j][c][lane] = frame_.at(v[j])[frame_.axes[c]];
      }
      for (auto& row : block_.origin) std::fill(std::begin(row), std::end(row), 0.0);
      facet_block(block_);
    }
  }

  const Frame& frame_;
  const FacetPlane<K>& plane_;
  const std::uint32_t* simplices_;
  std::uint64_t count_;
  std::uint64_t first_ = ~std::uint64_t{0} - FacetBlock<4>::lanes;
  std::conditional_t<(K >= 4), FacetBlock<K>, Nothing> block_;
};

/// The same in any dimension: the normals of `window` simplices at once. Those that doubles are not
/// enough for are collected and computed in double-doubles, also in blocks.
class ManyNormals {
 public:
  ManyNormals(const Frame& frame, const FacetPlane<0>& plane, const std::uint32_t* simplices,
              std::uint64_t count)
      : frame_(frame),
        plane_(plane),
        simplices_(simplices),
        count_(count),
        k_(frame.k),
        in_blocks_(k_ <= NormalBlock::most_dimensions),
        block_(in_blocks_ ? k_ : 2) {
    if (!in_blocks_) return;
    const auto most = std::min<std::uint64_t>(window, count_);
    normals_.resize(most * k_);
    facts_.resize(most);
  }
  double of(std::uint64_t i, double* n, std::vector<double>& scratch, bool* reliable,
            double* error) {
    if (!in_blocks_) return plane_.normal(simplex(i), n, scratch, reliable, error);
    if (i < first_ || i >= end_) load(i);
    std::copy_n(normals_.data() + (i - first_) * k_, k_, n);
    const Facts& f = facts_[i - first_];
    *reliable = f.reliable;
    *error = f.error;
    return f.length;
  }

 private:
  static constexpr unsigned lanes = NormalBlock::lanes;
  static constexpr std::uint64_t window = 256;
  static_assert(measure_chunk % window == 0);  // a chunk's windows begin with it
  struct Facts {
    double length, edges, error;
    bool reliable;
  };

  void load(std::uint64_t first) {
    first_ = first;
    end_ = std::min(first + window, count_);
    thin_.clear();
    for (std::uint64_t begin = first_; begin < end_; begin += lanes) {
      const auto used = static_cast<unsigned>(std::min<std::uint64_t>(lanes, end_ - begin));
      set_corners([&](unsigned lane) { return begin + std::min(lane, used - 1); });
      block_.compute();
      for (unsigned lane = 0; lane < used; ++lane) {
        const std::uint64_t at = begin + lane - first_;
        const double length = block_.length(lane), edges = block_.edges(lane);
        facts_[at] = {length, edges, length, true};
        if (plane_.well_conditioned(length, edges))
          copy_normal(lane, at);
        else
          thin_.push_back(at);
      }
    }
    for (std::size_t begin = 0; begin < thin_.size(); begin += lanes) {
      const auto used = static_cast<unsigned>(std::min<std::size_t>(lanes, thin_.size() - begin));
      set_corners([&](unsigned lane) {
        return first_ + thin_[begin + std::min<std::size_t>(lane, used - 1)];
      });
      block_.compute_carefully();
      for (unsigned lane = 0; lane < used; ++lane) {
        const std::uint64_t at = thin_[begin + lane];
        copy_normal(lane, at);
        Facts& f = facts_[at];
        f.length = block_.length(lane);
        plane_.judge_careful(f.length, f.edges, &f.reliable, &f.error);
      }
    }
  }
  /// Loads simplex number(lane) into each lane.
  template <class Number>
  void set_corners(const Number& number) {
    const std::uint32_t* v[lanes];
    for (unsigned lane = 0; lane < lanes; ++lane) v[lane] = simplex(number(lane));
    for (unsigned j = 0; j < k_; ++j) {
      const double* p[lanes];
      for (unsigned lane = 0; lane < lanes; ++lane) p[lane] = frame_.at(v[lane][j]);
      for (unsigned c = 0; c < k_; ++c) {
        const unsigned axis = frame_.axes[c];
        double* const row = block_.corner(j, c);
        for (unsigned lane = 0; lane < lanes; ++lane) row[lane] = p[lane][axis];
      }
    }
  }
  void copy_normal(unsigned lane, std::uint64_t at) {
    for (unsigned c = 0; c < k_; ++c) normals_[at * k_ + c] = block_.normal(lane, c);
  }

  const std::uint32_t* simplex(std::uint64_t i) const { return simplices_ + i * k_; }

  const Frame& frame_;
  const FacetPlane<0>& plane_;
  const std::uint32_t* simplices_;
  const std::uint64_t count_;
  const unsigned k_;
  const bool in_blocks_;
  NormalBlock block_;
  std::uint64_t first_ = 0, end_ = 0;
  std::vector<double> normals_;
  std::vector<Facts> facts_;
  std::vector<std::uint64_t> thin_;
};

}  // namespace cullhull::internal
