/* A program written for Qhull: prints what it finds in the lists of a hull or of a triangulation,
   sorted, so that two libraries can be compared.
     client DIMENSION POINTS SEED GRID COMMAND [triangulate]
   GRID: 0 for numbers between -0.5 and 0.5, else for integers below it; -1: a NaN among them, -2:
   all on a line. */
#include <libqhull_r/qhull_ra.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int by_text(const void* a, const void* b) {
  return strcmp(*(char* const*)a, *(char* const*)b);
}

/* Sorts ids; whether by an odd permutation. */
static int sorted(int* ids, int k) {
  int i, j, odd = 0;
  for (i = 1; i < k; ++i)
    for (j = i; j > 0 && ids[j - 1] > ids[j]; --j) {
      const int id = ids[j];
      ids[j] = ids[j - 1];
      ids[j - 1] = id;
      odd ^= 1;
    }
  return odd;
}

/* Neighbour k of a simplicial facet has all its vertices but the k-th. */
static int wrong_neighbours(qhT* qh, facetT* facet) {
  int k, j, wrong = 0;
  for (k = 0; k < qh_setsize(qh, facet->neighbors); ++k) {
    facetT* across = SETelemt_(facet->neighbors, k, facetT);
    if (across->upperdelaunay || !across->simplicial) continue;
    for (j = 0; j < qh_setsize(qh, across->vertices); ++j)
      wrong += SETelem_(across->vertices, j) == SETelem_(facet->vertices, k);
  }
  return wrong;
}

static int line_of(qhT* qh, facetT* facet, char* out) {
  vertexT *vertex, **vertexp;
  facetT *neighbor, **neighborp;
  int ids[256], k = 0, i, upper = 0, odd, at = 0;
  FOREACHvertex_(facet->vertices) ids[k++] = qh_pointid(qh, vertex->point);
  odd = sorted(ids, k);
  for (i = 0; i < k; ++i) at += sprintf(out + at, "%d ", ids[i]);
  if (facet->simplicial)
    at += sprintf(out + at, "%c wrong %d", odd ^ facet->toporient ? '+' : '-',
                  wrong_neighbours(qh, facet));
  FOREACHneighbor_(facet) upper += neighbor->upperdelaunay;
  at += sprintf(out + at, " neighbours %d", qh_setsize(qh, facet->neighbors));
  if (qh->DELAUNAY) at += sprintf(out + at, " upper %d", upper > 0);
  if (qh->hull_dim == 3) {
    setT* ring = qh_facet3vertex(qh, facet);
    int lowest = 0;
    k = 0;
    FOREACHvertex_(ring) ids[k++] = qh_pointid(qh, vertex->point);
    for (i = 0; i < k; ++i)
      if (ids[i] < ids[lowest]) lowest = i;
    at += sprintf(out + at, " ring");
    for (i = 0; i < k; ++i) at += sprintf(out + at, " %d", ids[(lowest + i) % k]);
    qh_settempfree(qh, &ring);
  }
  if (strstr(qh->qhull_command, "Qbb")) return at; /* of scaled points */
  at += sprintf(out + at, " plane");
  for (i = 0; i < qh->hull_dim; ++i) at += sprintf(out + at, " %.6f", facet->normal[i] + 0.0);
  at += sprintf(out + at, " %.6f", facet->offset + 0.0);
  if (qh->DELAUNAY) return at;
  return at + sprintf(out + at, " area %.6f", qh_facetarea(qh, facet));
}

/* Facets and their ridges: each ridge is one, of the two facets that have it. */
static void ridges(qhT* qh) {
  facetT* facet;
  ridgeT *ridge, **ridgep;
  int entries = 0, twice = 0, others = 0;
  if (qh->hull_dim > 3 || qh->DELAUNAY) return; /* of merged facets */
  FORALLfacets qh_makeridges(qh, facet);
  FORALLfacets {
    FOREACHridge_(facet->ridges) {
      ++entries;
      twice += ridge->seen;
      ridge->seen = !ridge->seen;
      others += ridge->top != facet && ridge->bottom != facet;
      others += qh_setsize(qh, ridge->vertices) != qh->hull_dim - 1;
    }
  }
  printf("ridges %d, %d of them met again, wrong %d\n", entries, twice, others);
}

int main(int argc, char** argv) {
  static qhT one, another;
  qhT *qh = &one, *other = &another;
  facetT* facet;
  char** lines;
  int d, n, grid, i, code, count = 0, kept, kept_bytes, of[6];
  unsigned largest = 0;
  unsigned long state;
  double *points, few[8] = {0, 0, 1, 0, 0, 1, 1, 1};
  if (argc < 6) return 2;
  d = atoi(argv[1]), n = atoi(argv[2]), grid = atoi(argv[4]);
  state = strtoul(argv[3], NULL, 10);
  points = malloc(sizeof(double) * (size_t)(d * n + 1));
  for (i = 0; i < n * d; ++i) {
    state = (state * 1103515245UL + 12345UL) & 0x7fffffffUL;
    points[i] = grid > 0 ? (double)(state >> 8) / 8388608.0 * grid : state / 2147483648.0 - 0.5;
    if (grid > 0) points[i] = (double)(long)points[i];
    if (grid == -2) points[i] = i / d;
  }
  if (grid == -1) points[n] = 0.0 / 0.0;
  QHULL_LIB_CHECK
  qh_zero(qh, stderr);
  qh_zero(other, stderr);
  /* A second one lives at the same time. */
  if (qh_new_qhull(other, 2, 4, few, False, (char*)"qhull", NULL, stderr)) return 3;
  code = qh_new_qhull(qh, d, n, points, True, argv[5], NULL, stderr);
  printf("code %d\n", code);
  if (code == 0) {
    if (argc > 6) qh_triangulate(qh);
    lines = malloc(sizeof(char*) * (size_t)(qh->num_facets + 1));
    FORALLfacets {
      if (facet->upperdelaunay) continue;
      lines[count] = malloc(8192);
      line_of(qh, facet, lines[count++]);
    }
    qsort(lines, (size_t)count, sizeof(char*), by_text);
    for (i = 0; i < count; ++i) {
      puts(lines[i]);
      free(lines[i]);
    }
    free(lines);
    if (!qh->DELAUNAY) {
      qh_getarea(qh, qh->facet_list);
      printf("vertices %d area %.9g volume %.9g\n", qh->num_vertices, qh->totarea, qh->totvol);
    }
    ridges(qh);
    qh_countfacets(qh, qh->facet_list, NULL, !qh_ALL, of, of + 1, of + 2, of + 3, of + 4, of + 5);
    printf("facets %d, %d of them simplices", of[0], of[1]);
    FORALLfacets largest = facet->visitid > largest ? facet->visitid : largest;
    printf(", the last is %u, neighbours %d, ridges %d\n", largest, of[2], of[3]);
  }
  printf("another %d\n", other->num_facets);
  qh_freeqhull(qh, !qh_ALL);
  qh_memfreeshort(qh, &kept, &kept_bytes);
  qh_freeqhull(other, !qh_ALL);
  qh_memfreeshort(other, &kept, &kept_bytes);
  return 0;
}
