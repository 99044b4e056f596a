/* What R calls: hulls, triangulations and questions over the C interface. R's matrices are read in
   place, column by column; rows of results become columns, and ids count from 1. */
#include <R_ext/Memory.h>
#include <R_ext/Rdynload.h>
#include <R_ext/Utils.h>
#include <Rinternals.h>
#include <cullhull.h>
#include <limits.h>
#include <setjmp.h>
#include <stddef.h>
#include <string.h>

/* A call from R: its arguments, and what must end with it, also where R leaves it by a jump. */
typedef struct call {
  SEXP (*body)(struct call*);
  SEXP argument[4], jump;
  jmp_buf stop;
  uint64_t asked; /* search(): how many points, */
  int* cell;      /* the cell of each from 1 on, NA at first, */
  double* parts;  /* and its barycentric coordinates, column by column */
  cullhull_options options;
  cullhull_hull* hull;
  cullhull_query* query;
  cullhull_batch* batch;
  cullhull_triangulation* triangulation;
  cullhull_locator* locator;
  double* vertices;
} call;

static void finish(void* data) {
  call* c = data;
  cullhull_locator_free(c->locator);
  cullhull_triangulation_free(c->triangulation);
  cullhull_batch_free(c->batch);
  cullhull_query_free(c->query);
  cullhull_hull_free(c->hull);
  cullhull_free(c->vertices);
  memset(&c->hull, 0, sizeof *c - offsetof(call, hull));
}

static SEXP enter(void* data) { return ((call*)data)->body(data); }

/* Ctrl-C and time limits: R leaves its check by a jump, which ends here, since none may cross the
   library. must() goes on with it. */
static SEXP check(void* unused) {
  (void)unused;
  R_CheckUserInterrupt();
  return R_NilValue;
}
static void stop_jump(void* data, Rboolean jumps) {
  if (jumps) longjmp(((call*)data)->stop, 1);
}
static int interrupted(void* data, const char* phase, double share) {
  call* c = data;
  (void)phase, (void)share;
  if (setjmp(c->stop)) return 1;
  R_UnwindProtect(check, NULL, stop_jump, c, c->jump);
  return 0;
}

static SEXP run(SEXP (*body)(call*), SEXP a, SEXP b, SEXP d, SEXP e) {
  call c = {.body = body, .argument = {a, b, d, e}};
  c.options.size = sizeof c.options;
  c.options.progress = interrupted;
  c.options.user = &c;
  c.jump = PROTECT(R_MakeUnwindCont());
  c.options.threads = (uint32_t)Rf_asInteger(Rf_GetOption1(Rf_install("cullhull.threads")));
  if (c.options.threads > 1024) c.options.threads = 0; /* not set: all */
  SEXP out = R_ExecWithCleanup(enter, &c, finish, &c);
  UNPROTECT(1);
  return out;
}

static void must(const call* c, cullhull_status status) {
  if (status == CULLHULL_CANCELLED) R_ContinueUnwind(c->jump);
  if (status == CULLHULL_NOT_FINITE) Rf_error("the points have values that are not finite");
  if (status != CULLHULL_OK) Rf_error("%s", cullhull_last_error());
}

static cullhull_points points_of(SEXP matrix) {
  const int64_t n = Rf_nrows(matrix);
  const cullhull_points p = {
      sizeof p, REAL(matrix), (uint64_t)n, (uint32_t)Rf_ncols(matrix), CULLHULL_F64, 8, 8 * n};
  return p;
}

/* An id of R's; -1, as Qhull has a negative number, where there is none. */
static int id(const cullhull_array* a, uint64_t item) {
  if (a->type == CULLHULL_U64) return (int)((const uint64_t*)a->data)[item] + 1;
  const uint32_t value = ((const uint32_t*)a->data)[item];
  return value == CULLHULL_NO_INDEX ? -1 : (int)value + 1;
}

static SEXP matrix_of(const cullhull_array* a) {
  if (a->count > INT_MAX) Rf_error("the result has more rows than a matrix of R");
  const int real = a->type == CULLHULL_F64;
  SEXP m = Rf_allocMatrix(real ? REALSXP : INTSXP, (int)a->count, (int)a->columns);
  double* numbers = real ? REAL(m) : NULL;
  int* ids = real ? NULL : INTEGER(m);
  for (uint64_t i = 0, from = 0; i < a->count; ++i)
    for (uint64_t to = i; to < a->count * a->columns; to += a->count, ++from)
      if (real)
        numbers[to] = ((const double*)a->data)[from];
      else
        ids[to] = id(a, from);
  return m;
}

/* Later questions need the points: a result keeps them behind a pointer. */
static void keep_points(const call* c, SEXP result, const char* name) {
  SEXP pointer = PROTECT(R_MakeExternalPtr(NULL, Rf_install("cullhull"), c->argument[0]));
  Rf_setAttrib(result, Rf_install(name), pointer);
  UNPROTECT(1);
}

/* The points that a result keeps; NULL if it is none of ours. */
static SEXP kept(SEXP pointer) {
  const int ours =
      TYPEOF(pointer) == EXTPTRSXP && R_ExternalPtrTag(pointer) == Rf_install("cullhull");
  return ours ? R_ExternalPtrProtected(pointer) : R_NilValue;
}

/* hull(points, numbers of parts): area and volume, and these parts, of which the first keeps the
   points. NULL if the points lie in a flat. */
static SEXP hull(call* c) {
  const cullhull_points p = points_of(c->argument[0]);
  const R_xlen_t parts = Rf_xlength(c->argument[1]);
  cullhull_hull_info info = {sizeof info};
  must(c, cullhull_hull_new(&p, &c->options, &c->hull));
  must(c, cullhull_hull_get_info(c->hull, &info));
  if (info.affine_dimension < (int)p.dimension) return R_NilValue;
  SEXP out = PROTECT(Rf_allocVector(VECSXP, parts + 2));
  SET_VECTOR_ELT(out, 0, Rf_ScalarReal(info.area));
  SET_VECTOR_ELT(out, 1, Rf_ScalarReal(info.volume));
  for (R_xlen_t i = 0; i < parts; ++i) {
    cullhull_array a;
    must(c, cullhull_hull_get(c->hull, INTEGER(c->argument[1])[i], &a));
    SET_VECTOR_ELT(out, i + 2, matrix_of(&a));
  }
  if (parts > 0) keep_points(c, VECTOR_ELT(out, 2), "convhulln");
  UNPROTECT(1);
  return out;
}

static void end_query(SEXP pointer) {
  cullhull_query_free(R_ExternalPtrAddr(pointer));
  R_ClearExternalPtr(pointer);
}

/* inside(pointer of a hull, points). The first question prepares the hull; what was saved, loaded
   or sent to another process has its points still. */
static SEXP inside(call* c) {
  SEXP pointer = c->argument[0];
  const cullhull_points p = points_of(c->argument[1]);
  if (R_ExternalPtrAddr(pointer) == NULL) {
    const cullhull_points own = points_of(R_ExternalPtrProtected(pointer));
    must(c, cullhull_hull_new(&own, &c->options, &c->hull));
    R_RegisterCFinalizer(pointer, end_query);
    must(c, cullhull_query_new(c->hull, &own, &c->options, &c->query));
    R_SetExternalPtrAddr(pointer, c->query);
    c->query = NULL; /* the pointer's now */
  }
  SEXP out = PROTECT(Rf_allocVector(LGLSXP, (R_xlen_t)p.count));
  int8_t* sides = (int8_t*)R_alloc(p.count + 1, 1);
  must(c, cullhull_query_sides(R_ExternalPtrAddr(pointer), &p, &c->options, sides));
  for (uint64_t i = 0; i < p.count; ++i) LOGICAL(out)[i] = sides[i] <= 0;
  UNPROTECT(1);
  return out;
}

/* The cells of the triangulation that the call has; none if the points lie in a flat. */
static cullhull_array cells_of(const call* c, uint32_t corners) {
  cullhull_array a;
  must(c, cullhull_triangulation_get(c->triangulation, CULLHULL_CELLS, &a));
  if (a.columns != corners) a.count = 0;
  a.columns = corners;
  return a;
}

/* The volume of each cell: that of the hull of its corners. */
static SEXP volumes(call* c, const cullhull_points* p, const cullhull_array* cells) {
  const uint64_t d = p->dimension, corners = cells->count * (d + 1);
  double* rows = (double*)R_alloc(corners * d + 1, sizeof *rows);
  uint64_t* offsets = (uint64_t*)R_alloc(cells->count + 1, sizeof *offsets);
  for (uint64_t i = 0; i < corners; ++i)
    for (uint64_t j = 0; j < d; ++j)
      rows[i * d + j] = ((const double*)p->data)[((const uint32_t*)cells->data)[i] + j * p->count];
  for (uint64_t i = 0; i <= cells->count; ++i) offsets[i] = i * (d + 1);
  const cullhull_points q = {sizeof q, rows, corners, p->dimension, CULLHULL_F64, 0, 0};
  cullhull_array a;
  must(c, cullhull_batch_new(&q, offsets, cells->count, &c->options, &c->batch));
  must(c, cullhull_batch_get(c->batch, CULLHULL_BATCH_VOLUMES, &a));
  return matrix_of(&a);
}

/* delaunay(points, furthest site, whether neighbours, whether volumes) */
static SEXP delaunay(call* c) {
  const cullhull_points p = points_of(c->argument[0]);
  c->options.furthest_site = Rf_asLogical(c->argument[1]);
  must(c, cullhull_triangulation_new(&p, NULL, &c->options, &c->triangulation));
  const cullhull_array cells = cells_of(c, p.dimension + 1);
  cullhull_array across = cells;
  SEXP out = PROTECT(Rf_allocVector(VECSXP, 3));
  SET_VECTOR_ELT(out, 0, matrix_of(&cells));
  keep_points(c, VECTOR_ELT(out, 0), "delaunayn");
  if (cells.count > 0)
    must(c, cullhull_triangulation_get(c->triangulation, CULLHULL_CELL_NEIGHBOURS, &across));
  if (Rf_asLogical(c->argument[2])) SET_VECTOR_ELT(out, 1, matrix_of(&across));
  if (Rf_asLogical(c->argument[3])) SET_VECTOR_ELT(out, 2, volumes(c, &p, &cells));
  UNPROTECT(1);
  return out;
}

/* Asks the locator of the call for these points, those numbered by `which` (NULL: all). The cells
   it finds are cell `of` (0: themselves), whose corner j is corner order[j] of the locator's. */
static void locate(call* c, const cullhull_points* p, const int* which, int of,
                   const uint32_t* order) {
  const uint64_t corners = p->dimension + 1;
  const void* mark = vmaxget();
  uint32_t* cells = (uint32_t*)R_alloc(p->count + 1, sizeof *cells);
  double* parts = (double*)R_alloc((p->count + 1) * corners, sizeof *parts);
  must(c, cullhull_locator_find(c->locator, p, &c->options, cells, parts));
  for (uint64_t i = 0; i < p->count; ++i) {
    const uint64_t row = which == NULL ? i : (uint64_t)which[i];
    if (cells[i] == CULLHULL_NO_INDEX) continue;
    c->cell[row] = of == 0 ? (int)cells[i] + 1 : of;
    for (uint64_t j = 0; j < corners; ++j)
      c->parts[row + j * c->asked] = parts[i * corners + (order == NULL ? j : order[j])];
  }
  vmaxset(mark);
}

/* Whether the mesh is the Delaunay triangulation of the points, which the call has then. */
static int is_delaunay(call* c, const cullhull_points* p, SEXP mesh) {
  must(c, cullhull_triangulation_new(p, NULL, &c->options, &c->triangulation));
  const cullhull_array cells = cells_of(c, p->dimension + 1);
  const uint64_t rows = (uint64_t)Rf_nrows(mesh);
  int same = rows == cells.count;
  for (uint64_t i = 0; same && i < rows; ++i)
    for (uint32_t j = 0; j < cells.columns; ++j)
      same &= INTEGER(mesh)[i + j * rows] == id(&cells, i * cells.columns + j);
  return same;
}

/* Any mesh: each simplex is a triangulation of its own, asked for the points in its box. The first
   simplex that has a point keeps it; a flat one has none. */
static void search_mesh(call* c, const cullhull_points* p, SEXP mesh, const cullhull_points* q) {
  const uint64_t d = p->dimension, corners = d + 1, n = q->count;
  const int *corner = INTEGER(mesh), rows = Rf_nrows(mesh);
  const double *x = p->data, *y = q->data;
  double* key = (double*)R_alloc(n + 1, sizeof *key); /* the points by their first coordinate */
  int *by_key = (int*)R_alloc(n + 1, sizeof *by_key), *which = (int*)R_alloc(n + 1, sizeof *which);
  double* inner = (double*)R_alloc((n + 1) * d, sizeof *inner);
  double* simplex = (double*)R_alloc(corners * d, sizeof *simplex);
  uint32_t* order = (uint32_t*)R_alloc(corners, sizeof *order);
  double* box = (double*)R_alloc(2 * d, sizeof *box);
  for (uint64_t i = 0; i < n; ++i) key[i] = y[i], by_key[i] = (int)i;
  rsort_with_index(key, by_key, (int)n);
  c->options.threads = 1;
  for (int s = 0; s < rows; ++s) {
    if (s % 1024 == 0) R_CheckUserInterrupt();
    for (uint64_t i = 0; i < corners * d; ++i) {
      const uint64_t k = i / d, j = i % d;
      const double v = simplex[i] = x[corner[s + k * rows] - 1 + j * p->count];
      if (k == 0 || v < box[2 * j]) box[2 * j] = v;
      if (k == 0 || v > box[2 * j + 1]) box[2 * j + 1] = v;
    }
    uint64_t count = 0, begin = 0;
    for (uint64_t end = n, middle; begin < end;)
      if (key[middle = (begin + end) / 2] < box[0])
        begin = middle + 1;
      else
        end = middle;
    for (uint64_t i = begin; i < n && key[i] <= box[1]; ++i) {
      int in_box = c->cell[by_key[i]] == NA_INTEGER;
      for (uint64_t j = 0; in_box && j < d; ++j) {
        const double v = inner[count * d + j] = y[by_key[i] + j * n];
        in_box = box[2 * j] <= v && v <= box[2 * j + 1];
      }
      if (in_box) which[count++] = by_key[i];
    }
    if (count == 0) continue;
    const cullhull_points own = {sizeof own, simplex, corners, p->dimension, CULLHULL_F64, 0, 0};
    const cullhull_points in = {sizeof in, inner, count, p->dimension, CULLHULL_F64, 0, 0};
    must(c, cullhull_triangulation_new(&own, NULL, &c->options, &c->triangulation));
    const cullhull_array cell = cells_of(c, p->dimension + 1);
    if (cell.count == 1) {
      for (uint32_t k = 0; k < corners; ++k) order[((const uint32_t*)cell.data)[k]] = k;
      must(c, cullhull_locator_new(c->triangulation, &own, NULL, &c->options, &c->locator));
      locate(c, &in, which, s + 1, order);
    }
    finish(c);
  }
}

/* search(points, mesh, pointer of a triangulation or NULL, points that are searched) */
static SEXP search(call* c) {
  const cullhull_points p = points_of(c->argument[0]), q = points_of(c->argument[3]);
  SEXP mesh = c->argument[1], pointer = c->argument[2];
  const char* names[] = {"idx", "p", ""};
  SEXP out = PROTECT(Rf_mkNamed(VECSXP, names));
  SET_VECTOR_ELT(out, 0, Rf_allocVector(INTSXP, (R_xlen_t)q.count));
  SET_VECTOR_ELT(out, 1, Rf_allocMatrix(REALSXP, (int)q.count, (int)p.dimension + 1));
  c->asked = q.count;
  c->cell = INTEGER(VECTOR_ELT(out, 0));
  c->parts = REAL(VECTOR_ELT(out, 1));
  for (uint64_t i = 0; i < q.count; ++i) c->cell[i] = NA_INTEGER;
  for (uint64_t i = 0; i < q.count * (p.dimension + 1); ++i) c->parts[i] = NA_REAL;
  SEXP points = kept(pointer);
  const int own = points != R_NilValue && Rf_nrows(points) == Rf_nrows(c->argument[0]) &&
                  Rf_ncols(points) == (int)p.dimension &&
                  memcmp(REAL(points), p.data, p.count * p.dimension * sizeof(double)) == 0;
  if (own && is_delaunay(c, &p, mesh)) {
    must(c, cullhull_locator_new(c->triangulation, &p, NULL, &c->options, &c->locator));
    locate(c, &q, NULL, 0, NULL);
  } else {
    finish(c);
    search_mesh(c, &p, mesh, &q);
  }
  UNPROTECT(1);
  return out;
}

/* halfspaces(rows a_1, ..., a_d, b; a point inside or NULL): vertices. NULL if no point was given
   and none is inside. */
static SEXP halfspaces(call* c) {
  const cullhull_points p = points_of(c->argument[0]);
  const double* inside = Rf_isNull(c->argument[1]) ? NULL : REAL(c->argument[1]);
  uint64_t count;
  const cullhull_status status =
      cullhull_intersect_halfspaces(&p, inside, &c->options, &c->vertices, &count);
  if (status == CULLHULL_INVALID_ARGUMENT && inside == NULL) return R_NilValue;
  must(c, status);
  const cullhull_array a = {c->vertices, count, p.dimension - 1, CULLHULL_F64};
  return matrix_of(&a);
}

static SEXP hull_entry(SEXP p, SEXP facets) { return run(hull, p, facets, NULL, NULL); }
static SEXP inside_entry(SEXP hull, SEXP p) { return run(inside, hull, p, NULL, NULL); }
static SEXP delaunay_entry(SEXP p, SEXP furthest, SEXP neighbours, SEXP areas) {
  return run(delaunay, p, furthest, neighbours, areas);
}
static SEXP search_entry(SEXP p, SEXP mesh, SEXP pointer, SEXP q) {
  return run(search, p, mesh, pointer, q);
}
static SEXP halfspaces_entry(SEXP p, SEXP inside) { return run(halfspaces, p, inside, NULL, NULL); }

void R_init_cullhull(DllInfo* dll) {
  static const R_CallMethodDef entries[] = {{"hull", (DL_FUNC)&hull_entry, 2},
                                            {"inside", (DL_FUNC)&inside_entry, 2},
                                            {"delaunay", (DL_FUNC)&delaunay_entry, 4},
                                            {"search", (DL_FUNC)&search_entry, 4},
                                            {"halfspaces", (DL_FUNC)&halfspaces_entry, 2},
                                            {"kept", (DL_FUNC)&kept, 1},
                                            {NULL, NULL, 0}};
  R_registerRoutines(dll, NULL, entries, NULL, NULL);
  R_useDynamicSymbols(dll, FALSE);
}
