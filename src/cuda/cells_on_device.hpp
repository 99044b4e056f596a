// A hull's cells of directions in the memory of the current device.
#pragma once

#include <vector>

#include "cuda/kernels/hull_questions_kernel.hpp"
#include "cuda/runtime.hpp"

namespace cullhull::internal {

class CellsOnDevice {
 public:
  CellsOnDevice(const FacetCellTable& cells, cudaStream_t stream)
      : normals_(uploaded(spread(cells), stream)),
        starts_(uploaded(cells.starts, stream)),
        facets_(uploaded(cells.facets, stream)),
        tables_{cells, normals_.data(), starts_.data(), facets_.data()} {}

  const CellsThere& tables() const { return tables_; }

 private:
  /// The normals, normal_stride() doubles apart.
  static std::vector<double> spread(const FacetCellTable& cells) {
    const unsigned d = cells.k, stride = normal_stride(d);
    std::vector<double> normals(cells.normals.size() / d * stride);
    for (std::size_t i = 0; i < cells.normals.size(); ++i)
      normals[i / d * stride + i % d] = cells.normals[i];
    return normals;
  }

  DeviceArray<double> normals_;
  DeviceArray<std::uint32_t> starts_, facets_;
  CellsThere tables_;
};

}  // namespace cullhull::internal
