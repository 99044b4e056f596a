// Points of a file, by the readers that the program has.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "call.hpp"
#include "cullhull/io.hpp"
#include "cullhull/point_blocks.hpp"
#include "numpy_api.hpp"
#include "solid.hpp"

namespace binding {

using cullhull::PointFile;
using cullhull::ScalarType;

namespace {

int numpy_type(ScalarType scalar) {
  for (const auto& [type, number] : scalar_types)
    if (type == scalar) return number;
  return NPY_NOTYPE;
}

/// A read-only view of the points where they lie, at any stride and alignment; keeps `file`.
nb::object points_of(nb::handle file) {
  const cullhull::PointView& points = nb::cast<const PointFile&>(file).points();
  npy_intp shape[2] = {static_cast<npy_intp>(points.count),
                       static_cast<npy_intp>(points.dimension)};
  npy_intp strides[2] = {points.point_stride, points.coordinate_stride};
  PyObject* const made =
      points.count == 0 ? PyArray_SimpleNew(2, shape, numpy_type(points.scalar))
                        : PyArray_New(&PyArray_Type, 2, shape, numpy_type(points.scalar), strides,
                                      const_cast<std::byte*>(points.data), 0, 0, nullptr);
  if (made == nullptr) throw nb::python_error();
  nb::object array = nb::steal(made);
  auto* const numpy = reinterpret_cast<PyArrayObject*>(made);
  if (points.count > 0) {
    Py_INCREF(file.ptr());
    if (PyArray_SetBaseObject(numpy, file.ptr()) != 0) throw nb::python_error();
  }
  PyArray_UpdateFlags(numpy, NPY_ARRAY_UPDATE_ALL);
  return array;
}

/// The file, and the lines it has for its user. `in_place`: the numbers stay as they are stored,
/// for a caller who makes coordinates of them.
std::pair<PointFile, std::vector<std::string>> open_file(const std::string& path,
                                                         const std::string& columns, bool raw,
                                                         bool in_place,
                                                         const std::string& decimal) {
  PointFile file;
  std::vector<std::string> remarks;
  std::mutex mutex;
  run(nullptr, Length::long_, [&](const cullhull::Options& options) {
    cullhull::ReadOptions read;
    read.columns = columns;
    if (!decimal.empty()) read.decimal = decimal[0];
    read.numbers = raw        ? cullhull::Numbers::raw
                   : in_place ? cullhull::Numbers::file
                              : cullhull::Numbers::world;
    read.stop = options.stop;
    read.remark = [&](const cullhull::Remark& remark) {
      const std::lock_guard lock(mutex);
      remarks.push_back(remark.line());
    };
    file = cullhull::open_points(path, read);
  });
  return {std::move(file), std::move(remarks)};
}

}  // namespace

void bind_files(nb::module_& m) {
  nb::class_<PointFile>(m, "PointFile", "The memory behind what cullhull.read gives.")
      .def_prop_ro("format", &PointFile::format);
  m.def(
      "read_points",
      [](const std::string& path, const std::string& columns, bool raw, bool in_place,
         const std::string& decimal) {
    auto [file, remarks] = open_file(path, columns, raw, in_place, decimal);
    cullhull::Placement placement = file.placement();
    return std::tuple(points_of(nb::cast(std::move(file))), std::move(remarks),
                      std::move(placement.scale), std::move(placement.offset));
      },
      nb::arg("path"), nb::arg("columns"), nb::arg("raw"), nb::arg("in_place"), nb::arg("decimal"),
      "The points, remarks for the user, and the scale and offset of the file's numbers.");
  m.def(
      "input_files",
      [](const std::vector<std::string>& words) { return cullhull::input_files(words); },
      nb::arg("words"),
      "The files that words of a command line stand for: folders, patterns, lists.");
  m.def("input_formats", cullhull::input_formats,
        "The names of the formats of points that need no other package.");
  m.def("coordinate_columns", cullhull::coordinate_columns, nb::arg("names"), nb::arg("series"),
        "The numbers of the columns that are coordinates by their names; empty: these do not say.");
  m.def("crs_code", cullhull::crs_code, nb::arg("text"),
        "AUTHORITY:CODE of such a text, or of an OGC URN; empty for any other.");
  m.def("crs_of_wkt", cullhull::crs_of_wkt, nb::arg("wkt"),
        "The code of the system of x and y; empty where there is none.");
  m.def(
      "common_crs",
      [](const std::vector<std::string>& files) { return cullhull::common_crs(files); },
      nb::arg("files"), "The one coordinate reference system that files state; or empty.");
  m.def(
      "grid_of",
      [](std::vector<double> scale, std::vector<double> offset) -> std::
                                                                    optional<int> {
    const cullhull::Grid grid = cullhull::common_grid({{std::move(scale), std::move(offset), ""}});
    return grid.decimals() < 0 ? std::nullopt : std::optional(grid.decimals());
      },
      nb::arg("scale"), nb::arg("offset"),
      "Decimals of the grid on which such a scan lies; None where doubles do.");
}

}  // namespace binding
