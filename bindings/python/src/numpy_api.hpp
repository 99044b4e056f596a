// NumPy's C functions; module.cpp imports their table once.
#pragma once

#define PY_ARRAY_UNIQUE_SYMBOL cullhull_numpy_api
#define NPY_NO_DEPRECATED_API NPY_1_23_API_VERSION
#define NPY_TARGET_VERSION NPY_1_23_API_VERSION
#ifndef CULLHULL_IMPORTS_NUMPY
#define NO_IMPORT_ARRAY
#endif
#include <nanobind/nanobind.h>  // before Python.h
#include <numpy/arrayobject.h>
