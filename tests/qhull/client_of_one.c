/* A program written for libqhull, whose one hull is a global: prints facets and vertices.
     client_of_one DIMENSION POINTS SEED COMMAND */
#include <libqhull/qhull_a.h>
#include <stdio.h>
#include <stdlib.h>

static int by_number(const void* a, const void* b) { return *(const int*)a - *(const int*)b; }

int main(int argc, char** argv) {
  facetT* facet;
  vertexT *vertex, **vertexp;
  setT* vertices;
  int d, n, i, k, code, again, kept, kept_bytes, ids[256];
  unsigned long state;
  double* points;
  if (argc < 5) return 2;
  d = atoi(argv[1]), n = atoi(argv[2]);
  state = strtoul(argv[3], NULL, 10);
  points = malloc(sizeof(double) * (size_t)(d * n + 1));
  for (again = 0; again < 2; ++again) { /* the second hull in the same place */
    for (i = 0; i < n * d; ++i) {
      state = (state * 1103515245UL + 12345UL) & 0x7fffffffUL;
      points[i] = state / 2147483648.0 - 0.5;
    }
    code = qh_new_qhull(d, n, points, False, argv[4], NULL, stderr);
    printf("code %d\n", code);
    if (code == 0) {
      qh_triangulate();
      FORALLfacets {
        if (facet->upperdelaunay) continue;
        k = 0;
        FOREACHvertex_(facet->vertices) ids[k++] = qh_pointid(vertex->point);
        qsort(ids, (size_t)k, sizeof(int), by_number);
        printf("facet");
        for (i = 0; i < k; ++i) printf(" %d", ids[i]);
        printf(" of %d neighbours\n", qh_setsize(facet->neighbors));
      }
      FORALLvertices printf("vertex %d\n", qh_pointid(vertex->point));
      vertices = qh_facetvertices(qh facet_list, NULL, !qh_ALL);
      k = qh_setsize(vertices);
      printf("%d vertices, another %d\n", k, qh_setunique(&vertices, SETfirst_(vertices)));
      qh_settempfree(&vertices);
    }
    qh_freeqhull(!qh_ALL);
    qh_memfreeshort(&kept, &kept_bytes);
  }
  free(points);
  return 0;
}
