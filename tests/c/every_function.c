/* Calls every function of the C interface once, as a program in C11 would. */
#include <cullhull.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void must(int holds, const char* what, int line) {
  if (holds) return;
  fprintf(stderr, "line %d: %s: %s\n", line, what, cullhull_last_error());
  exit(1);
}
#define CHECK(x) must((x) != 0, #x, __LINE__)
#define OK(call) must((call) == CULLHULL_OK, #call, __LINE__)

static int asked = 0;
static int never(void* user) {
  ++*(int*)user;
  return 0;
}
static int look(void* user, const char* phase, double share) {
  ++*(int*)user;
  return phase == NULL || share < 0 || share > 1;
}

static void hulls(const cullhull_points* p, const cullhull_options* o) {
  cullhull_hull *hull = NULL, *of_set = NULL;
  cullhull_hull_info info = {sizeof info, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  cullhull_array array;
  cullhull_certificate proof;
  cullhull_query* query = NULL;
  cullhull_batch* batch = NULL;
  const uint64_t offsets[] = {0, 8, 9};
  const double centre[] = {0.5, 0.5, 0.5};
  const cullhull_points one = {sizeof one, centre, 1, 3, CULLHULL_F64, 0, 0};
  cullhull_points halfspaces = {sizeof halfspaces, NULL, 6, 4, CULLHULL_F64, 0, 0};
  uint64_t *ids = NULL, count = 0, farthest = 0;
  double* corners = NULL;
  int8_t side = 1;
  double distance = 0;

  OK(cullhull_hull_new(p, o, &hull));
  OK(cullhull_hull_get_info(hull, &info));
  CHECK(info.vertex_count == 8 && info.facet_count == 6 && info.simplex_count == 12);
  CHECK(info.volume == 1 && info.area == 6 && info.affine_dimension == 3);
  OK(cullhull_hull_get(hull, CULLHULL_HULL_SIMPLICES, &array));
  CHECK(array.count == 12 && array.columns == 3 && array.type == CULLHULL_U64);
  OK(cullhull_hull_get(hull, CULLHULL_HULL_CENTROID, &array));
  CHECK(array.count == 1 && fabs(((const double*)array.data)[2] - 0.5) < 1e-15);

  memset(&proof, 0, sizeof proof);
  proof.size = sizeof proof;
  OK(cullhull_hull_certify(hull, p, o, &proof));
  CHECK(proof.valid && proof.points_checked == 9 && proof.reason[0] == 0);

  OK(cullhull_query_new(hull, NULL, o, &query)); /* by the coordinates that the hull carries */
  OK(cullhull_query_sides(query, &one, o, &side));
  OK(cullhull_query_supports(query, &one, o, &farthest));
  OK(cullhull_query_signed_distances(query, &one, o, &distance));
  CHECK(side == -1 && farthest == 7 && fabs(distance + 0.5) < 1e-12);

  OK(cullhull_extreme_points(p, o, &ids, &count));
  CHECK(count == 8 && ids[7] == 7);
  cullhull_free(ids);
  OK(cullhull_cull(p, o, &ids, &count));
  CHECK(count >= 8 && count <= 9);
  cullhull_free(ids);

  OK(cullhull_hull_get(hull, CULLHULL_HULL_PLANES, &array));
  halfspaces.data = array.data;
  OK(cullhull_intersect_halfspaces(&halfspaces, centre, o, &corners, &count));
  CHECK(count == 8 && fabs(corners[0] * (1 - corners[0])) < 1e-15);
  cullhull_free(corners);

  OK(cullhull_batch_new(p, offsets, 2, o, &batch));
  OK(cullhull_batch_get(batch, CULLHULL_BATCH_VOLUMES, &array));
  CHECK(array.count == 2 && ((const double*)array.data)[0] == 1);
  OK(cullhull_batch_hull(batch, 1, &of_set));
  OK(cullhull_hull_get_info(of_set, &info));
  CHECK(info.affine_dimension == 0 && info.point_count == 1);

  cullhull_hull_free(of_set);
  cullhull_batch_free(batch);
  cullhull_query_free(query);
  cullhull_hull_free(hull);
}

static void pieces(const cullhull_points* p, const cullhull_options* o) {
  cullhull_state *state = NULL, *other = NULL, *of_stream = NULL;
  cullhull_stream* stream = NULL;
  cullhull_hull *hull = NULL, *of_state = NULL;
  cullhull_hull_info info = {sizeof info, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  cullhull_points half = *p, held = {sizeof held, NULL, 0, 0, 0, 0, 0};
  cullhull_array ids;
  uint8_t* bytes = NULL;
  uint64_t size = 0;

  half.count = 5;
  OK(cullhull_state_new(&half, 0, o, &state));
  half.data = (const double*)p->data + 15;
  half.count = 4;
  OK(cullhull_state_new(&half, 5, o, &other));
  OK(cullhull_state_merge(state, other, o));
  OK(cullhull_state_save(state, &bytes, &size));
  cullhull_state_free(other);
  OK(cullhull_state_load(bytes, size, &other));
  OK(cullhull_state_get(other, &ids, &held));
  CHECK(ids.count == 8 && held.count == 8 && held.dimension == 3);
  bytes[size / 2] ^= 1;
  cullhull_state_free(state);
  CHECK(cullhull_state_load(bytes, size, &state) == CULLHULL_BAD_DATA && state == NULL);
  cullhull_free(bytes);
  OK(cullhull_state_hull(other, o, &of_state));

  OK(cullhull_stream_new(o, &stream));
  OK(cullhull_stream_push(stream, p, 0));
  OK(cullhull_stream_state(stream, &of_stream));
  OK(cullhull_stream_hull(stream, &hull));
  OK(cullhull_hull_get_info(hull, &info));
  CHECK(info.vertex_count == 8 && info.point_count == 9);

  cullhull_hull_free(hull);
  cullhull_hull_free(of_state);
  cullhull_state_free(of_stream);
  cullhull_state_free(other);
  cullhull_stream_free(stream);
}

static void triangulations(const cullhull_points* p, const cullhull_options* o) {
  cullhull_triangulation* t = NULL;
  cullhull_locator* locator = NULL;
  cullhull_voronoi* voronoi = NULL;
  cullhull_array cells, regions;
  cullhull_certificate proof;
  const double far_away[] = {2, 2, 2};
  const cullhull_points one = {sizeof one, far_away, 1, 3, CULLHULL_F64, 0, 0};
  uint32_t cell = 0, nearest = 0;
  double parts[4];

  OK(cullhull_triangulation_new(p, NULL, o, &t));
  OK(cullhull_triangulation_get(t, CULLHULL_CELLS, &cells));
  CHECK(cells.count == 12 && cells.columns == 4 && cells.type == CULLHULL_U32);
  memset(&proof, 0, sizeof proof);
  proof.size = sizeof proof;
  OK(cullhull_triangulation_certify(t, p, NULL, o, &proof));
  CHECK(proof.valid);
  OK(cullhull_locator_new(t, p, NULL, o, &locator));
  OK(cullhull_locator_find(locator, &one, o, &cell, parts));
  OK(cullhull_locator_nearest(locator, &one, o, &nearest));
  CHECK(cell == CULLHULL_NO_INDEX && parts[0] != parts[0] && nearest == 7);
  OK(cullhull_voronoi_new(t, p, NULL, o, &voronoi));
  OK(cullhull_voronoi_get(voronoi, CULLHULL_VORONOI_REGION_OFFSETS, &regions));
  CHECK(regions.count == p->count + 1 && ((const uint64_t*)regions.data)[0] == 0);

  cullhull_voronoi_free(voronoi);
  cullhull_locator_free(locator);
  cullhull_triangulation_free(t);
}

int main(void) {
  /* The corners of a cube, and its centre. */
  double cube[9][3];
  cullhull_points p = {sizeof p, NULL, 9, 3, CULLHULL_F64, 0, 0};
  cullhull_options o;
  int i, j;
  for (i = 0; i < 9; ++i)
    for (j = 0; j < 3; ++j) cube[i][j] = i == 8 ? 0.5 : (i >> j) & 1;
  p.data = cube;
  memset(&o, 0, sizeof o);
  o.size = sizeof o;
  o.threads = 2;
  o.with_coordinates = 1;
  o.progress = look;
  o.cancelled = never;
  o.user = &asked;

  CHECK(strcmp(cullhull_last_error(), "") == 0);
  CHECK(strlen(cullhull_version()) >= 5);
  CHECK(strcmp(cullhull_status_name(CULLHULL_CANCELLED), "cancelled") == 0);
  CHECK(strcmp(cullhull_status_name(-1), "unknown") == 0);
  hulls(&p, &o);
  pieces(&p, &o);
  triangulations(&p, &o);
  CHECK(asked > 0);
  return 0;
}
