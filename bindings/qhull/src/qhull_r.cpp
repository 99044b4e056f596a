// The functions of libqhull_r that programs import, over our hulls and triangulations.
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <sstream>

#include "built.hpp"

using namespace cullhull;         // NOLINT: the functions of Qhull's header follow
using namespace cullhull::qhull;  // NOLINT

namespace {

Built* built(const qhT* qh) { return static_cast<Built*>(qh->cpp_other); }

int refuse(FILE* to, int code, const char* line) {
  if (to != nullptr) std::fprintf(to, "cullhull in Qhull's place: %s\n", line);
  return code;
}

int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::invalid_argument:
    case ErrorCode::not_finite:
      return qh_ERRinput;
    case ErrorCode::not_exact:
      return qh_ERRsingular;
    case ErrorCode::out_of_budget:
      return qh_ERRmem;
    default:
      return qh_ERRqhull;
  }
}

}  // namespace

namespace cullhull::qhull {

Command parse(const char* text) {
  // Exact arithmetic needs none of these, and no facet is wide, narrow or merged by tolerance.
  static const char* const needless[] = {"Pp", "Qx",  "Qbb", "Qz", "Qc", "Qi",  "Qs", "Q0",
                                         "Q3", "Q11", "Q12", "Q8", "Qa", "C-0", "Tc", "Tv"};
  Command command;
  std::istringstream words(text == nullptr ? "" : text);
  std::string word;
  if (!(words >> word) || word != "qhull")
    throw Error(ErrorCode::invalid_argument, "a command begins with 'qhull'");
  while (words >> word) {
    if (word == "d") {
      command.delaunay = true;
    } else if (word == "v") {
      command.delaunay = command.voronoi = true;
    } else if (word == "Qu") {
      command.furthest_site = true;
    } else if (word == "Qt" || word.rfind("QJ", 0) == 0) {
      command.triangulated = true;
    } else if (word == "FA") {
      command.area = true;
    } else if (std::find(std::begin(needless), std::end(needless), word) == std::end(needless)) {
      throw Error(ErrorCode::invalid_argument, "option '", word, "' has no meaning here");
    }
  }
  if (command.furthest_site && !command.delaunay)
    throw Error(ErrorCode::invalid_argument, "option 'Qu' is for 'd' and 'v'");
  return command;
}

}  // namespace cullhull::qhull

extern "C" {

#define CULLHULL_QHULL __attribute__((visibility("default")))

CULLHULL_QHULL extern const char qh_version[] = "cullhull " CULLHULL_VERSION " in Qhull's place";

CULLHULL_QHULL void qh_zero(qhT* qh, FILE* errfile) {
  std::memset(static_cast<void*>(qh), 0, sizeof *qh);
  qh->NOerrexit = True;
  qh->ferr = errfile;
}

CULLHULL_QHULL void qh_lib_check(int type, int qh_size, int vertex_size, int ridge_size,
                                 int facet_size, int set_size, int) {
  if (type != QHULL_LIB_TYPE || qh_size != static_cast<int>(sizeof(qhT)) ||
      vertex_size != static_cast<int>(sizeof(vertexT)) ||
      ridge_size != static_cast<int>(sizeof(ridgeT)) ||
      facet_size != static_cast<int>(sizeof(facetT)) ||
      (set_size != 0 && set_size != static_cast<int>(sizeof(setT)))) {
    std::fputs("cullhull in Qhull's place: the program was built for another Qhull\n", stderr);
    std::exit(qh_ERRqhull);
  }
}

CULLHULL_QHULL int qh_new_qhull(qhT* qh, int dim, int numpoints, coordT* points, boolT ismalloc,
                                char* qhull_cmd, FILE*, FILE* errfile) {
  FILE* const err = errfile == nullptr ? stderr : errfile;
  // As in Qhull, the caller may have cleared nothing, and ends an earlier hull himself.
  std::memset(static_cast<void*>(qh), 0, offsetof(qhT, qhmem));
  qh->NOerrexit = True;
  qh->ferr = err;
  qh->input_points = points;
  qh->input_malloc = ismalloc;  // ended with the hull, also where there is none
  try {
    const Command command = parse(qhull_cmd);
    if (dim < 2 || numpoints < 0 || points == nullptr)
      throw Error(ErrorCode::invalid_argument, "points of dimension ", dim);
    qh->DELAUNAY = qh->PROJECTdelaunay = command.delaunay;
    qh->VORONOI = command.voronoi;
    qh->UPPERdelaunay = command.furthest_site;
    qh->TRIangulate = qh->hasTriangulation = command.triangulated;
    qh->input_dim = dim;
    qh->hull_dim = dim + (command.delaunay ? 1 : 0);
    qh->first_point = points;
    qh->num_points = numpoints;
    qh->normal_size = static_cast<int>(sizeof(coordT)) * qh->hull_dim;
    qh->center_size = static_cast<int>(sizeof(coordT)) * dim;
    qh->VERTEXneighbors = False;
    qh->CENTERtype = qh_ASnone;
    qh->visit_id = qh->vertex_visit = 1;  // of no facet and no vertex yet
    qh->ridge_id = 1;
    std::strncpy(qh->qhull_command, qhull_cmd == nullptr ? "" : qhull_cmd,
                 sizeof qh->qhull_command - 1);
    qh->cpp_other = new Built(qh, command, static_cast<unsigned>(dim),
                              static_cast<std::uint64_t>(numpoints), points);
    if (command.voronoi) {
      built(qh)->vertex_neighbours(qh);
      built(qh)->centres(qh);
    }
    if (command.area) qh_getarea(qh, qh->facet_list);
    qh->QHULLfinished = True;
    return qh_ERRnone;
  } catch (const Error& e) {
    return refuse(err, exit_code(e.code()), e.what());
  } catch (const std::bad_alloc&) {
    return refuse(err, qh_ERRmem, "out of memory");
  } catch (const std::exception& e) {
    return refuse(err, qh_ERRqhull, e.what());
  }
}

CULLHULL_QHULL void qh_freeqhull(qhT* qh, boolT) {
  delete built(qh);
  coordT* const points = qh->input_malloc ? qh->input_points : nullptr;
  std::memset(static_cast<void*>(qh), 0, sizeof *qh);
  qh->NOerrexit = True;
  std::free(points);
}

CULLHULL_QHULL void qh_memfreeshort(qhT*, int* curlong, int* totlong) { *curlong = *totlong = 0; }

CULLHULL_QHULL int qh_pointid(qhT* qh, pointT* point) {
  if (point == nullptr) return qh_IDnone;
  if (point == qh->interior_point) return qh_IDinterior;
  const std::ptrdiff_t id = (point - qh->first_point) / qh->hull_dim;
  return id >= 0 && id < qh->num_points ? static_cast<int>(id) : qh_IDunknown;
}

CULLHULL_QHULL void qh_triangulate(qhT* qh) { built(qh)->triangulate(qh); }

CULLHULL_QHULL void qh_vertexneighbors(qhT* qh) { built(qh)->vertex_neighbours(qh); }

CULLHULL_QHULL void qh_order_vertexneighbors(qhT* qh, vertexT* vertex) {
  built(qh)->vertex_neighbours(qh);
  built(qh)->order_neighbours(vertex);
}

CULLHULL_QHULL void qh_setvoronoi_all(qhT* qh) {
  built(qh)->centres(qh);
  built(qh)->vertex_neighbours(qh);
}

// Nothing is left to do for these.
CULLHULL_QHULL void qh_findgood_all(qhT*, facetT*) {}
CULLHULL_QHULL void qh_prepare_output(qhT*) {}
CULLHULL_QHULL void qh_meminit(qhT*, FILE*) {}

CULLHULL_QHULL int qh_setsize(qhT*, setT* set) {
  if (set == nullptr) return 0;
  const int size = set->e[set->maxsize].i;
  return size == 0 ? set->maxsize : size - 1;
}

CULLHULL_QHULL setT* qh_settemp(qhT* qh, int size) { return built(qh)->temporary(size); }

CULLHULL_QHULL void qh_settempfree(qhT* qh, setT** set) {
  built(qh)->end_temporary(*set);
  *set = nullptr;
}

CULLHULL_QHULL void qh_setappend(qhT* qh, setT** set, void* item) {
  if (item == nullptr) return;
  const int size = qh_setsize(qh, *set);
  if (*set == nullptr || size == (*set)->maxsize) {  // twice the room
    setT* const larger = qh_settemp(qh, 2 * size + 4);
    for (int i = 0; i < size; ++i) larger->e[i] = (*set)->e[i];
    if (*set != nullptr) built(qh)->end_temporary(*set);
    *set = larger;
  }
  (*set)->e[size].p = item;
  if (size + 1 < (*set)->maxsize) {
    (*set)->e[size + 1].p = nullptr;
    (*set)->e[(*set)->maxsize].i = size + 2;
  } else {
    (*set)->e[(*set)->maxsize].p = nullptr;
  }
}

CULLHULL_QHULL setT* qh_facet3vertex(qhT* qh, facetT* facet) {
  setT* const set = qh_settemp(qh, qh_setsize(qh, facet->vertices));
  set->e[set->maxsize].p = nullptr;  // full
  built(qh)->polygon(facet, set);
  return set;
}

CULLHULL_QHULL void qh_makeridges(qhT* qh, facetT* facet) { built(qh)->ridges(qh, facet); }

CULLHULL_QHULL void qh_distplane(qhT* qh, pointT* point, facetT* facet, realT* dist) {
  *dist = facet->offset;
  for (int j = 0; j < qh->hull_dim; ++j) *dist += facet->normal[j] * point[j];
}

CULLHULL_QHULL realT qh_facetarea(qhT* qh, facetT* facet) { return built(qh)->area(facet); }

CULLHULL_QHULL void qh_getarea(qhT* qh, facetT* facetlist) {
  qh->totarea = qh->totvol = 0;
  for (facetT* f = facetlist; f != nullptr && f->next != nullptr; f = f->next) {
    if (f->upperdelaunay != qh->UPPERdelaunay) continue;
    f->f.area = built(qh)->area(f);
    f->isarea = True;
    qh->totarea += f->f.area;
  }
  qh->totvol = built(qh)->volume();
  qh->hasAreaVolume = True;
}

CULLHULL_QHULL coordT qh_pointdist(pointT* point1, pointT* point2, int dim) {
  double sum = 0;
  for (int j = 0; j < std::abs(dim); ++j) sum += (point1[j] - point2[j]) * (point1[j] - point2[j]);
  return dim > 0 ? std::sqrt(sum) : sum;
}

CULLHULL_QHULL void qh_fprintf(qhT*, FILE* fp, int, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  if (fp != nullptr) std::vfprintf(fp, format, arguments);
  va_end(arguments);
}

}  // extern "C"
