// The extension module cullhull._core: complete and private. The public interface is the Python
// code around it (bindings/python/cullhull), which converts arguments and wraps results.
#define CULLHULL_IMPORTS_NUMPY
#include <nanobind/nanobind.h>

#include "call.hpp"
#include "cullhull/version.hpp"
#include "numpy_api.hpp"
#include "solid.hpp"

NB_MODULE(_core, m) {
  if (PyArray_ImportNumPyAPI() < 0) throw nanobind::python_error();
  // Packages that keep modules' globals until the end (PyTorch's custom operators do) also keep the
  // hulls in them; nanobind would report these as leaks of ours.
  nanobind::set_leak_warnings(false);
  m.attr("version") = CULLHULL_VERSION;
  for (const auto bind : {binding::bind_call, binding::bind_hull, binding::bind_many,
                          binding::bind_state, binding::bind_halfspaces, binding::bind_device,
                          binding::bind_device_batch, binding::bind_tracker, binding::bind_simplify,
                          binding::bind_stream, binding::bind_files, binding::bind_triangulation,
                          binding::bind_voronoi, binding::bind_cells, binding::bind_save})
    bind(m);
}
