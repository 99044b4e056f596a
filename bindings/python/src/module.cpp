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
  binding::bind_call(m);
  binding::bind_hull(m);
  binding::bind_many(m);
  binding::bind_state(m);
  binding::bind_halfspaces(m);
  binding::bind_device(m);
  binding::bind_device_batch(m);
  binding::bind_tracker(m);
  binding::bind_simplify(m);
  binding::bind_stream(m);
  binding::bind_files(m);
  binding::bind_triangulation(m);
  binding::bind_voronoi(m);
  binding::bind_cells(m);
  binding::bind_save(m);
}
