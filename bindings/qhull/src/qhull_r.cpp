// The functions of libqhull_r that programs import, over our hulls and triangulations.
#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <numeric>
#include <sstream>

#include "built.hpp"

using namespace cullhull;         // NOLINT: the functions of Qhull's header follow
using namespace cullhull::qhull;  // NOLINT

namespace {

Built* built(const qhT* qh) { return static_cast<Built*>(qh->cpp_other); }

int refuse(qhT* qh, int code, const char* line) {
  // libqhullcpp has a qh_fprintf of its own, which keeps the line for an exception.
  qh_fprintf(qh, qh->ferr, MSG_ERROR, "cullhull in Qhull's place: %s\n", line);
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

void clear(qhT* qh, FILE* errfile) {
  std::memset(static_cast<void*>(qh), 0, offsetof(qhT, qhmem));
  qh->NOerrexit = True;
  qh->ferr = errfile;
}

void take_command(qhT* qh, const char* text) {
  const Command command = parse(text);
  if (std::strlen(text) >= sizeof qh->qhull_command)
    throw Error(ErrorCode::invalid_argument, "a command of ", std::strlen(text), " characters");
  std::strcpy(qh->qhull_command, text);  // NOLINT: its length was looked at
  qh->DELAUNAY = qh->PROJECTdelaunay = command.delaunay;
  qh->VORONOI = command.voronoi;
  qh->UPPERdelaunay = command.furthest_site;
  qh->TRIangulate = qh->hasTriangulation = command.triangulated;
}

void take_points(qhT* qh, coordT* points, int count, int dimension, boolT is_malloc) {
  qh->input_points = qh->first_point = points;
  qh->input_malloc = is_malloc;
  if (dimension < 2 || count < 0 || points == nullptr)
    throw Error(ErrorCode::invalid_argument, "points of dimension ", dimension);
  if (count <= dimension)
    throw Error(ErrorCode::invalid_argument, count, " points in ", dimension, " dimensions");
  qh->input_dim = dimension;
  qh->hull_dim = dimension + (qh->DELAUNAY ? 1 : 0);
  qh->num_points = count;
  qh->normal_size = static_cast<int>(sizeof(coordT)) * qh->hull_dim;
  qh->center_size = static_cast<int>(sizeof(coordT)) * dimension;
}

void build(qhT* qh) {
  const Command command = parse(qh->qhull_command);
  qh->CENTERtype = qh_ASnone;
  qh->visit_id = qh->vertex_visit = 1;  // of no facet and no vertex yet
  qh->ridge_id = 1;
  qh->cpp_other = new Built(qh, command, static_cast<unsigned>(qh->input_dim),
                            static_cast<std::uint64_t>(qh->num_points), qh->first_point);
  if (command.voronoi) {
    built(qh)->vertex_neighbours(qh);
    built(qh)->centres(qh);
  }
  if (command.area) qh_getarea(qh, qh->facet_list);
  qh->QHULLfinished = True;
}

/// Does `step`; a fault is told in a line and returned as Qhull's code.
template <class Step>
int attempt(qhT* qh, const Step& step) {
  try {
    step();
    return qh_ERRnone;
  } catch (const Error& e) {
    return refuse(qh, exit_code(e.code()), e.what());
  } catch (const std::bad_alloc&) {
    return refuse(qh, qh_ERRmem, "out of memory");
  } catch (const std::exception& e) {
    return refuse(qh, qh_ERRqhull, e.what());
  }
}

/// Calls body(facet) for the facets of a list and of a set, those that are good or all.
void each_facet(qhT* qh, facetT* list, setT* facets, bool all, const auto& body) {
  for (facetT* f = list; f != nullptr && f->next != nullptr; f = f->next)
    if (all || f->good) body(f);
  for (int i = 0; i < qh_setsize(qh, facets); ++i)
    if (auto* const f = static_cast<facetT*>(facets->e[i].p); all || f->good) body(f);
}

void fault_ends(qhT* qh, int code) {
  if (code != qh_ERRnone) qh_errexit(qh, code, nullptr, nullptr);
}

}  // namespace

namespace cullhull::qhull {

Command parse(const char* text) {
  // Exact arithmetic needs none of these, and no facet is wide, narrow or merged by tolerance.
  static const char* const needless[] = {"Pp",  "Qx",  "Qbb", "Qz", "Qc",  "Qi", "Qs", "Q0", "Q3",
                                         "Q11", "Q12", "Q8",  "Qa", "C-0", "Tc", "Tv", "Tcv"};
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
  clear(qh, errfile);
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
  // As in Qhull, the caller may have cleared nothing, and ends an earlier hull himself.
  clear(qh, errfile == nullptr ? stderr : errfile);
  qh->input_malloc = ismalloc;  // ended with the hull, also where there is none
  qh->input_points = points;
  return attempt(qh, [&] {
    take_command(qh, qhull_cmd);
    take_points(qh, points, numpoints, dim, ismalloc);
    build(qh);
  });
}

// The same step by step: MuJoCo's and libqhullcpp's way. A fault ends in the caller's setjmp.
CULLHULL_QHULL void qh_initqhull_start2(qhT* qh, FILE* infile, FILE* outfile, FILE* errfile) {
  clear(qh, errfile == nullptr ? stderr : errfile);
  qh->fin = infile;
  qh->fout = outfile;
}
CULLHULL_QHULL void qh_init_A(qhT* qh, FILE* infile, FILE* outfile, FILE* errfile, int, char**) {
  qh_initqhull_start2(qh, infile, outfile, errfile);
}
CULLHULL_QHULL void qh_initflags(qhT* qh, char* command) {
  fault_ends(qh, attempt(qh, [&] { take_command(qh, command); }));
}
CULLHULL_QHULL void qh_init_B(qhT* qh, coordT* points, int numpoints, int dim, boolT ismalloc) {
  fault_ends(qh, attempt(qh, [&] { take_points(qh, points, numpoints, dim, ismalloc); }));
}
CULLHULL_QHULL void qh_qhull(qhT* qh) {
  fault_ends(qh, attempt(qh, [&] { build(qh); }));
}

CULLHULL_QHULL void qh_errexit(qhT* qh, int exitcode, facetT*, ridgeT*) {
  if (qh->NOerrexit) std::exit(exitcode);
  qh->NOerrexit = True;
  std::longjmp(qh->errexit, exitcode == 0 ? qh_ERRqhull : exitcode);
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

// Nothing is left to do for these: every hull is exact, and memory ends with it.
CULLHULL_QHULL void qh_findgood_all(qhT*, facetT*) {}
CULLHULL_QHULL void qh_prepare_output(qhT*) {}
CULLHULL_QHULL void qh_check_output(qhT*) {}
CULLHULL_QHULL void qh_check_points(qhT*) {}
CULLHULL_QHULL void qh_checkflags(qhT*, char*, char*) {}
CULLHULL_QHULL void qh_initqhull_outputflags(qhT*) {}
CULLHULL_QHULL void qh_initstatistics(qhT*) {}
CULLHULL_QHULL void qh_meminit(qhT*, FILE*) {}
CULLHULL_QHULL void qh_memcheck(qhT*) {}
CULLHULL_QHULL void* qh_malloc(size_t size) { return std::malloc(size); }
CULLHULL_QHULL void qh_exit(int exitcode) { std::exit(exitcode); }

// libqhullcpp is linked to these, too; what needs them ends with a line: output formats, rbox,
// halfspaces, centres and planes of merged facets, and walks around a facet, which get no qhT.
static void refuse_call(qhT* qh) {
  qh_errexit(qh, refuse(qh, qh_ERRqhull, "this function of Qhull is not here"), nullptr, nullptr);
}
static void refuse_walk() {
  std::fputs("cullhull in Qhull's place: this function of Qhull is not here\n", stderr);
  std::exit(qh_ERRqhull);
}
#define CULLHULL_REFUSED(name, refuse)                        \
  CULLHULL_QHULL void refused_##name(qhT* qh) __asm__(#name); \
  void refused_##name([[maybe_unused]] qhT* qh) { refuse; }   \
  static_assert(true)
CULLHULL_REFUSED(qh_clear_outputflags, refuse_call(qh));
CULLHULL_REFUSED(qh_errexit_rbox, refuse_call(qh));
CULLHULL_REFUSED(qh_facetcenter, refuse_call(qh));
CULLHULL_REFUSED(qh_getcentrum, refuse_call(qh));
CULLHULL_REFUSED(qh_markvoronoi, refuse_call(qh));
CULLHULL_REFUSED(qh_outerinner, refuse_call(qh));
CULLHULL_REFUSED(qh_produce_output2, refuse_call(qh));
CULLHULL_REFUSED(qh_rboxpoints, refuse_call(qh));
CULLHULL_REFUSED(qh_setfeasible, refuse_call(qh));
CULLHULL_REFUSED(qh_sethalfspace_all, refuse_call(qh));
CULLHULL_REFUSED(qh_nextfacet2d, refuse_walk());
CULLHULL_REFUSED(qh_nextridge3d, refuse_walk());

CULLHULL_QHULL int qh_setsize(qhT*, setT* set) {
  if (set == nullptr) return 0;
  const int size = set->e[set->maxsize].i;
  return size == 0 ? set->maxsize : size - 1;
}

CULLHULL_QHULL void** qh_setendpointer(setT* set) { return &set->e[qh_setsize(nullptr, set)].p; }

CULLHULL_QHULL int qh_setin(setT* set, void* item) {
  for (int i = 0, n = qh_setsize(nullptr, set); i < n; ++i)
    if (set->e[i].p == item) return 1;
  return 0;
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

CULLHULL_QHULL int qh_setunique(qhT* qh, setT** set, void* item) {
  if (qh_setin(*set, item)) return 0;
  qh_setappend(qh, set, item);
  return 1;
}

CULLHULL_QHULL setT* qh_facetvertices(qhT* qh, facetT* facetlist, setT* facets, boolT allfacets) {
  setT* vertices = qh_settemp(qh, 4);
  ++qh->vertex_visit;
  each_facet(qh, facetlist, facets, allfacets, [&](const facetT* f) {
    for (int i = 0; i < qh_setsize(qh, f->vertices); ++i) {
      auto* const v = static_cast<vertexT*>(f->vertices->e[i].p);
      if (v->visitid != qh->vertex_visit) qh_setappend(qh, &vertices, v);
      v->visitid = qh->vertex_visit;
    }
  });
  return vertices;
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

CULLHULL_QHULL void qh_countfacets(qhT* qh, facetT* facetlist, setT* facets, boolT printall,
                                   int* count, int* simplicial, int* neighbours, int* ridges,
                                   int* coplanar, int* of_polygons) {
  *count = *simplicial = *neighbours = *ridges = *coplanar = *of_polygons = 0;
  each_facet(qh, facetlist, facets, true, [](facetT* f) { f->visitid = 0; });
  each_facet(qh, facetlist, facets, printall, [&](facetT* f) {
    f->visitid = static_cast<unsigned>(++*count);  // clients number their triangles by it
    *neighbours += qh_setsize(qh, f->neighbors);
    if (f->simplicial) {
      ++*simplicial;
      *of_polygons += f->tricoplanar;
    } else {
      *ridges += qh_setsize(qh, f->ridges);
    }
  });
}

CULLHULL_QHULL realT qh_getangle(qhT* qh, pointT* vect1, pointT* vect2) {
  return std::inner_product(vect1, vect1 + qh->hull_dim, vect2, 0.0);
}

CULLHULL_QHULL void qh_fprintf(qhT*, FILE* fp, int, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  if (fp != nullptr) std::vfprintf(fp == qh_FILEstderr ? stderr : fp, format, arguments);
  va_end(arguments);
}

CULLHULL_QHULL void qh_fprintf_stderr(int, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  std::vfprintf(stderr, format, arguments);
  va_end(arguments);
}

}  // extern "C"
