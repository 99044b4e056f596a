// A hull's cells of directions in the memory of the current device.
#pragma once

#include <algorithm>
#include <vector>

#include "cuda/kernels/hull_questions_kernel.hpp"
#include "cuda/runtime.hpp"

namespace cullhull::internal {

class CellsOnDevice {
 public:
  CellsOnDevice(const CellTables& cells, cudaStream_t stream)
      : normals_(cells.normals.size() / cells.dimension * normal_stride(cells.dimension), stream),
        starts_(cells.starts.size(), stream),
        facets_(cells.facets.size(), stream) {
    const unsigned d = cells.dimension, stride = normal_stride(d);
    std::vector<double> normals(normals_.size());
    for (std::size_t i = 0; i < cells.normals.size(); ++i)
      normals[i / d * stride + i % d] = cells.normals[i];
    upload(normals_.data(), normals.data(), normals.size(), stream);
    upload(starts_.data(), cells.starts.data(), cells.starts.size(), stream);
    upload(facets_.data(), cells.facets.data(), cells.facets.size(), stream);
    std::copy_n(cells.low, CellTables::most_dimensions, tables_.low);
    std::copy_n(cells.high, CellTables::most_dimensions, tables_.high);
    std::copy_n(cells.factor, CellTables::most_dimensions, tables_.factor);
    std::copy_n(cells.centre, CellTables::most_dimensions, tables_.centre);
    tables_.resolution = cells.resolution;
    tables_.error_factor = cells.error_factor;
    tables_.value_tiny = cells.value_tiny;
    tables_.least_reach = cells.least_reach;
    tables_.normals = normals_.data();
    tables_.starts = starts_.data();
    tables_.facets = facets_.data();
  }

  const CellsThere& tables() const { return tables_; }

 private:
  DeviceArray<double> normals_;
  DeviceArray<std::uint32_t> starts_, facets_;
  CellsThere tables_ = {};
};

}  // namespace cullhull::internal
