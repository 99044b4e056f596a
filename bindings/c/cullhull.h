/* The C interface of cullhull: exact convex hulls, triangulations and diagrams, for C11 and for
   every language that calls C. Library: libcullhull_c. What the results mean is told by the C++
   headers of the same names (hull.hpp, triangulation.hpp, ...); here are the rules of this door.

   - A function returns a status, 0 for success; what went wrong is cullhull_last_error().
   - What a `..._new`, `..._of`, `..._load` or `..._hull` function gives is a handle of the caller,
     who ends it by its `..._free`, which takes NULL, too. A use of one of the last 1,024 handles
     that were freed is an error, not a crash.
   - Arrays are borrowed: they live as long as the handle, and no call changes them. Four functions
     give memory of the caller's instead (extreme points, cull, halfspaces, state_save):
     cullhull_free ends it.
   - Structs begin with their size, which the caller sets; fields left zero have the default:
     `cullhull_points p = {sizeof p, data, count, 3};`. Programs built with an older or a newer
     header go on to work.
   - Options, where they are taken, may be NULL. They never change a result, but for furthest_site.
   - All functions may be called from any threads at once. A handle that is only read may be shared
     by them; a state, and any handle that is being freed, may not.
   - No exception and no signal leaves the library. A callback must not jump out (longjmp). */
#ifndef CULLHULL_H
#define CULLHULL_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(CULLHULL_C_BUILD)
#define CULLHULL_API __declspec(dllexport)
#elif defined(_WIN32)
#define CULLHULL_API __declspec(dllimport)
#else
#define CULLHULL_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Errors, memory ---------------------------------------------------------------------- */

typedef enum cullhull_status {
  CULLHULL_OK = 0,
  CULLHULL_INVALID_ARGUMENT = 1,    /* a caller's mistake: null data, another dimension, ... */
  CULLHULL_NOT_FINITE = 2,          /* a NaN or an infinity; the message names the first */
  CULLHULL_BAD_DATA = 3,            /* the bytes of a state are damaged */
  CULLHULL_OUT_OF_BUDGET = 4,       /* the result would exceed memory_budget or 32-bit numbers */
  CULLHULL_BACKEND_UNAVAILABLE = 5, /* no device, or built without CUDA */
  CULLHULL_CANCELLED = 6,           /* a callback said so, or threw */
  CULLHULL_OUT_OF_MEMORY = 7,
  CULLHULL_INTERNAL = 8 /* a bug of the library: please report it */
} cullhull_status;

/* One line: the last failure of the calling thread, "" if there was none. Valid until the thread's
   next failure. Successful calls do not change it. */
CULLHULL_API const char* cullhull_last_error(void);
/* "ok", "invalid_argument", ...; "unknown" for other numbers. Static storage. */
CULLHULL_API const char* cullhull_status_name(int status);
/* The library's version, "1.2.3". Static storage. */
CULLHULL_API const char* cullhull_version(void);
/* Frees what a function gave as memory of the caller's. NULL is fine. */
CULLHULL_API void cullhull_free(void* memory);

/* ---- Points and options ------------------------------------------------------------------ */

typedef enum cullhull_type {
  CULLHULL_F64 = 0,
  CULLHULL_F32 = 1,
  CULLHULL_I8 = 2,
  CULLHULL_U8 = 3,
  CULLHULL_I16 = 4,
  CULLHULL_U16 = 5,
  CULLHULL_I32 = 6,
  CULLHULL_U32 = 7,
  CULLHULL_U64 = 8 /* of results alone: no type of coordinates */
} cullhull_type;

/* Points in the caller's memory, read in place: coordinate j of point i is at
   data + i * point_stride + j * coordinate_stride. Strides are bytes, of any sign. Both zero: rows
   without gaps. Columns of n doubles each: strides 8 and 8 * n. */
typedef struct cullhull_points {
  size_t size; /* sizeof(cullhull_points) */
  const void* data;
  uint64_t count;
  uint32_t dimension;
  int32_t type; /* cullhull_type */
  int64_t point_stride, coordinate_stride;
} cullhull_points;

typedef enum cullhull_backend {
  CULLHULL_BACKEND_AUTO = 0,
  CULLHULL_BACKEND_CPU = 1,
  CULLHULL_BACKEND_CUDA = 2
} cullhull_backend;

typedef enum cullhull_filter {
  CULLHULL_CULL_AUTO = 0,
  CULLHULL_CULL_GAUGE = 1,
  CULLHULL_CULL_PSEUDO_HULL = 2,
  CULLHULL_CULL_NONE = 3
} cullhull_filter;

typedef struct cullhull_options {
  size_t size;            /* sizeof(cullhull_options) */
  uint64_t memory_budget; /* bytes beyond the input; 0: half of what the process may use */
  uint32_t threads;       /* 0: all; at most 1024 */
  int32_t backend;        /* cullhull_backend */
  int32_t cull;           /* cullhull_filter */
  int32_t
      with_coordinates;  /* hulls carry their vertices' coordinates (CULLHULL_HULL_COORDINATES) */
  int32_t furthest_site; /* triangulations: the furthest-site one */
  /* Called from the calling thread: `progress` now and then, with a short phase name and a share in
     [0, 1]; `cancelled` often, so it must be quick. A result that is not 0 cancels the call. */
  int (*progress)(void* user, const char* phase, double share);
  int (*cancelled)(void* user);
  void* user;
} cullhull_options;

/* An array of a result: `count` rows of `columns` items of `type` (cullhull_type: F64, U32, U64 or
   I8, I32), without gaps. `data` is not NULL, also if there are no items. */
typedef struct cullhull_array {
  const void* data;
  uint64_t count;
  uint32_t columns;
  int32_t type;
} cullhull_array;

/* ---- Hulls ------------------------------------------------------------------------------- */

typedef struct cullhull_hull cullhull_hull;

/* The exact hull of the points, as convex_hull of hull.hpp:
     cullhull_points p = {sizeof p, xyz, n, 3};
     cullhull_hull* hull = NULL;
     if (cullhull_hull_new(&p, NULL, &hull)) puts(cullhull_last_error());
   The points need not outlive the call. */
CULLHULL_API cullhull_status cullhull_hull_new(const cullhull_points* points,
                                               const cullhull_options* options,
                                               cullhull_hull** hull);
CULLHULL_API void cullhull_hull_free(cullhull_hull* hull);

typedef struct cullhull_hull_info {
  size_t size; /* sizeof(cullhull_hull_info), set by the caller */
  uint32_t dimension;
  int32_t affine_dimension; /* k below: of the flat that the points span; -1: no points */
  uint64_t point_count, vertex_count, facet_count, simplex_count;
  uint64_t survivors; /* points that the filter kept */
  double volume, area;
} cullhull_hull_info;
CULLHULL_API cullhull_status cullhull_hull_get_info(const cullhull_hull* hull,
                                                    cullhull_hull_info* info);

typedef enum cullhull_hull_part {
  CULLHULL_HULL_VERTICES = 0,           /* U64 ids */
  CULLHULL_HULL_SIMPLICES = 1,          /* U64 ids, k columns, oriented outward */
  CULLHULL_HULL_SIMPLEX_NEIGHBOURS = 2, /* U32, k columns: across the ridge opposite to the id */
  CULLHULL_HULL_SIMPLEX_FACETS = 3,     /* U32: the facet of each simplex */
  CULLHULL_HULL_FACETS = 4,             /* U64 ids of all facets, one list after the other: */
  CULLHULL_HULL_FACET_OFFSETS = 5,      /* U64, facets + 1: facet i is [offset[i], offset[i + 1]) */
  CULLHULL_HULL_FACET_NEIGHBOURS = 6,   /* U32, in lists, too: */
  CULLHULL_HULL_FACET_NEIGHBOUR_OFFSETS = 7, /* U64 */
  CULLHULL_HULL_PLANES = 8,      /* F64, dimension + 1 columns: outward normal, then offset */
  CULLHULL_HULL_CENTROID = 9,    /* F64, one row, or none where undefined */
  CULLHULL_HULL_COORDINATES = 10 /* F64, a row for each vertex; empty without with_coordinates */
} cullhull_hull_part;
/* Borrows an array of the hull:
     cullhull_array simplices;
     cullhull_hull_get(hull, CULLHULL_HULL_SIMPLICES, &simplices);
     const uint64_t* ids = simplices.data;
   `part`: cullhull_hull_part. */
CULLHULL_API cullhull_status cullhull_hull_get(const cullhull_hull* hull, int part,
                                               cullhull_array* array);

/* The ids of the extreme points alone, ascending (extreme_points.hpp), and of what the filter
   leaves, for another hull code (cull.hpp): `ids` is memory of the caller's (cullhull_free).
     uint64_t *ids, count;
     cullhull_extreme_points(&p, NULL, &ids, &count); */
CULLHULL_API cullhull_status cullhull_extreme_points(const cullhull_points* points,
                                                     const cullhull_options* options,
                                                     uint64_t** ids, uint64_t* count);
CULLHULL_API cullhull_status cullhull_cull(const cullhull_points* points,
                                           const cullhull_options* options, uint64_t** ids,
                                           uint64_t* count);

/* The vertices of the intersection of halfspaces a . x + b <= 0 (halfspaces.hpp): `halfspaces` has
   a row (a_1, ..., a_d, b) for each, so d + 1 columns, as CULLHULL_HULL_PLANES has them.
   `interior`: d doubles strictly inside, or NULL to search for such a point; where there is none:
   CULLHULL_INVALID_ARGUMENT. `vertices`: count rows of d doubles, memory of the caller's
   (cullhull_free); a row of NaN: unbounded there. Rounded, as the planes are. */
CULLHULL_API cullhull_status cullhull_intersect_halfspaces(const cullhull_points* halfspaces,
                                                           const double* interior,
                                                           const cullhull_options* options,
                                                           double** vertices, uint64_t* count);

typedef struct cullhull_certificate {
  size_t size;   /* sizeof(cullhull_certificate), set by the caller */
  int32_t valid; /* 1: proven */
  uint64_t ridges_checked, points_checked, exact_decisions;
  char reason[256]; /* where it is not valid: the first fault, one line */
} cullhull_certificate;
/* Proves the hull anew, by code that shares nothing with what computed it (certify.hpp). A hull
   that is not that of the points is no error of the call: see `valid`. `points` NULL: a hull with
   coordinates is checked against these alone. */
CULLHULL_API cullhull_status cullhull_hull_certify(const cullhull_hull* hull,
                                                   const cullhull_points* points,
                                                   const cullhull_options* options,
                                                   cullhull_certificate* certificate);

/* ---- Many small hulls in one call -------------------------------------------------------- */

typedef struct cullhull_batch cullhull_batch;

/* The hulls of `sets` sets: set i is the points [offsets[i], offsets[i + 1]). `offsets`: sets + 1
   entries, ascending. Ids count from each set's first point. As batch.hpp. */
CULLHULL_API cullhull_status cullhull_batch_new(const cullhull_points* points,
                                                const uint64_t* offsets, uint64_t sets,
                                                const cullhull_options* options,
                                                cullhull_batch** batch);
CULLHULL_API void cullhull_batch_free(cullhull_batch* batch);
typedef enum cullhull_batch_part {
  CULLHULL_BATCH_VOLUMES = 0, /* F64, a row for each set, as the next two */
  CULLHULL_BATCH_AREAS = 1,
  CULLHULL_BATCH_AFFINE_DIMENSIONS = 2, /* I32 */
  CULLHULL_BATCH_CENTROIDS = 3,         /* F64, dimension columns */
  CULLHULL_BATCH_VERTICES = 4,          /* U64 ids, set after set: */
  CULLHULL_BATCH_VERTEX_OFFSETS = 5,    /* U64, sets + 1 */
  CULLHULL_BATCH_SIMPLICES = 6,         /* U64 ids, set after set: */
  CULLHULL_BATCH_SIMPLEX_OFFSETS = 7    /* U64, sets + 1: into the ids */
} cullhull_batch_part;
CULLHULL_API cullhull_status cullhull_batch_get(const cullhull_batch* batch, int part,
                                                cullhull_array* array);
/* Everything of one set, as a hull of its own: a handle of the caller's. */
CULLHULL_API cullhull_status cullhull_batch_hull(const cullhull_batch* batch, uint64_t set,
                                                 cullhull_hull** hull);

/* ---- Questions to a hull ----------------------------------------------------------------- */

typedef struct cullhull_query cullhull_query;

/* `points`: those of the hull, or NULL for a hull with coordinates. Neither must outlive the
   call. As query.hpp: sides and supports are exact. */
CULLHULL_API cullhull_status cullhull_query_new(const cullhull_hull* hull,
                                                const cullhull_points* points,
                                                const cullhull_options* options,
                                                cullhull_query** query);
CULLHULL_API void cullhull_query_free(cullhull_query* query);
/* For each point -1 inside, 0 on the boundary, 1 outside. `out`: points->count items, as below. */
CULLHULL_API cullhull_status cullhull_query_sides(const cullhull_query* query,
                                                  const cullhull_points* points,
                                                  const cullhull_options* options, int8_t* out);
/* For each direction the id of the vertex that is farthest that way. */
CULLHULL_API cullhull_status cullhull_query_supports(const cullhull_query* query,
                                                     const cullhull_points* directions,
                                                     const cullhull_options* options,
                                                     uint64_t* out);
/* For each point the distance to the boundary, negative inside. */
CULLHULL_API cullhull_status cullhull_query_signed_distances(const cullhull_query* query,
                                                             const cullhull_points* points,
                                                             const cullhull_options* options,
                                                             double* out);

/* ---- Points in pieces -------------------------------------------------------------------- */

/* What points contribute to any hull: their extreme points with ids and coordinates. States are
   computed anywhere, saved, sent, merged in any order; the hull of the whole has the same bits as
   one call. As HullState of stream.hpp. */
typedef struct cullhull_state cullhull_state;

/* Of points with the ids first_id, first_id + 1, ... */
CULLHULL_API cullhull_status cullhull_state_new(const cullhull_points* points, uint64_t first_id,
                                                const cullhull_options* options,
                                                cullhull_state** state);
CULLHULL_API void cullhull_state_free(cullhull_state* state);
/* Adds the points of another state to `state`, which an error leaves as it was. */
CULLHULL_API cullhull_status cullhull_state_merge(cullhull_state* state,
                                                  const cullhull_state* other,
                                                  const cullhull_options* options);
/* The state as the bytes of a .hullstate file, with a checksum: memory of the caller's
   (cullhull_free). cullhull_state_load reads them, CULLHULL_BAD_DATA if they are damaged. */
CULLHULL_API cullhull_status cullhull_state_save(const cullhull_state* state, uint8_t** bytes,
                                                 uint64_t* count);
CULLHULL_API cullhull_status cullhull_state_load(const uint8_t* bytes, uint64_t count,
                                                 cullhull_state** state);
/* Borrows ids (U64, ascending) and coordinates of its extreme points; `points` can be passed to
   other functions. Valid until the state changes. Each may be NULL. */
CULLHULL_API cullhull_status cullhull_state_get(const cullhull_state* state, cullhull_array* ids,
                                                cullhull_points* points);
CULLHULL_API cullhull_status cullhull_state_hull(const cullhull_state* state,
                                                 const cullhull_options* options,
                                                 cullhull_hull** hull);

/* A hull of points that arrive block by block, from any threads (HullStream of stream.hpp). The
   options hold for every call, a cancellation as well; what callbacks need must outlive it. */
typedef struct cullhull_stream cullhull_stream;

CULLHULL_API cullhull_status cullhull_stream_new(const cullhull_options* options,
                                                 cullhull_stream** stream);
CULLHULL_API void cullhull_stream_free(cullhull_stream* stream);
/* Adds points with the ids first_id, first_id + 1, ...; each id once, blocks in any order. */
CULLHULL_API cullhull_status cullhull_stream_push(cullhull_stream* stream,
                                                  const cullhull_points* block, uint64_t first_id);
/* Of all points that were pushed so far; pushing may go on. */
CULLHULL_API cullhull_status cullhull_stream_state(cullhull_stream* stream, cullhull_state** state);
CULLHULL_API cullhull_status cullhull_stream_hull(cullhull_stream* stream, cullhull_hull** hull);

/* ---- Triangulations and diagrams --------------------------------------------------------- */

typedef struct cullhull_triangulation cullhull_triangulation;

/* The exact Delaunay triangulation, in any dimension; with `weights` (an entry for each point, else
   NULL) the regular one. As triangulation.hpp. */
CULLHULL_API cullhull_status cullhull_triangulation_new(const cullhull_points* points,
                                                        const double* weights,
                                                        const cullhull_options* options,
                                                        cullhull_triangulation** triangulation);
CULLHULL_API void cullhull_triangulation_free(cullhull_triangulation* triangulation);
typedef enum cullhull_triangulation_part {
  CULLHULL_CELLS = 0,            /* U32 ids, k + 1 columns, oriented positively */
  CULLHULL_CELL_NEIGHBOURS = 1,  /* U32, k + 1 columns: across the facet opposite to the id */
  CULLHULL_CELL_GROUPS = 2,      /* U32: cells with one circumsphere; empty if each is its own */
  CULLHULL_CELL_HULL_FACETS = 3, /* U32 ids, k columns: facets without a neighbour */
  CULLHULL_CELL_HULL_CELLS = 4,  /* U32: the cell of each */
  CULLHULL_CELL_DUPLICATES = 5,  /* U32, 2 columns: an id, and that of the equal point that stands
                                    for it */
  CULLHULL_CELL_HIDDEN = 6       /* U32 ids: neither vertices nor duplicates */
} cullhull_triangulation_part;
CULLHULL_API cullhull_status cullhull_triangulation_get(const cullhull_triangulation* triangulation,
                                                        int part, cullhull_array* array);
/* As cullhull_hull_certify. */
CULLHULL_API cullhull_status cullhull_triangulation_certify(
    const cullhull_triangulation* triangulation, const cullhull_points* points,
    const double* weights, const cullhull_options* options, cullhull_certificate* certificate);

/* In place of a cell's or a vertex' number: none, outside, at infinity. */
#define CULLHULL_NO_INDEX 0xffffffffU

/* A triangulation prepared for questions. As triangulation_query.hpp; points, weights and
   triangulation need not outlive the call. */
typedef struct cullhull_locator cullhull_locator;

CULLHULL_API cullhull_status cullhull_locator_new(const cullhull_triangulation* triangulation,
                                                  const cullhull_points* points,
                                                  const double* weights,
                                                  const cullhull_options* options,
                                                  cullhull_locator** locator);
CULLHULL_API void cullhull_locator_free(cullhull_locator* locator);
/* For each point the cell that contains it, or CULLHULL_NO_INDEX; and, unless `barycentric` is
   NULL, its k + 1 barycentric coordinates there (NaN outside). */
CULLHULL_API cullhull_status cullhull_locator_find(const cullhull_locator* locator,
                                                   const cullhull_points* points,
                                                   const cullhull_options* options, uint32_t* cells,
                                                   double* barycentric);
/* For each point the id of the nearest vertex; of several, the lowest. */
CULLHULL_API cullhull_status cullhull_locator_nearest(const cullhull_locator* locator,
                                                      const cullhull_points* points,
                                                      const cullhull_options* options,
                                                      uint32_t* ids);

typedef struct cullhull_voronoi cullhull_voronoi;

/* The diagram dual to a triangulation of these points and weights. As voronoi.hpp. */
CULLHULL_API cullhull_status cullhull_voronoi_new(const cullhull_triangulation* triangulation,
                                                  const cullhull_points* points,
                                                  const double* weights,
                                                  const cullhull_options* options,
                                                  cullhull_voronoi** voronoi);
CULLHULL_API void cullhull_voronoi_free(cullhull_voronoi* voronoi);
typedef enum cullhull_voronoi_part {
  CULLHULL_VORONOI_VERTICES = 0,       /* F64, dimension columns */
  CULLHULL_VORONOI_RIDGE_POINTS = 1,   /* U32, 2 columns */
  CULLHULL_VORONOI_RIDGES = 2,         /* U32 vertices of all ridges, one list after the other: */
  CULLHULL_VORONOI_RIDGE_OFFSETS = 3,  /* U64, ridges + 1 */
  CULLHULL_VORONOI_REGIONS = 4,        /* U32 vertices of the regions of the points, likewise: */
  CULLHULL_VORONOI_REGION_OFFSETS = 5, /* U64, points + 1 */
  CULLHULL_VORONOI_RAY_VERTICES = 6,   /* U32: where each unbounded edge begins, and */
  CULLHULL_VORONOI_RAY_DIRECTIONS = 7  /* F64, dimension columns: its direction */
} cullhull_voronoi_part;
CULLHULL_API cullhull_status cullhull_voronoi_get(const cullhull_voronoi* voronoi, int part,
                                                  cullhull_array* array);

#ifdef __cplusplus
}
#endif

#endif
