// libqhull, the library with one hull in a global: its functions are those of libqhull_r on a hull
// of its own, whose fields go to and fro. MeshLab, GetFEM and Tulip are linked to it. The functions
// of libqhull_r have other names here (CMakeLists.txt).
#include <cstddef>
#include <cstdio>
#include <cstring>

#include "built.hpp"

#define CULLHULL_QHULL __attribute__((visibility("default")))
/// What the structure of libqhull has as that of libqhull_r has it: all but its last three fields.
constexpr std::size_t same = offsetof(qhT, old_tempstack);

extern "C" {

CULLHULL_QHULL extern const char one_version[] __asm__("qh_version");
const char one_version[] = "cullhull " CULLHULL_VERSION " in Qhull's place";

CULLHULL_QHULL extern std::byte one_qh[] __asm__("qh_qh");
alignas(qhT) std::byte one_qh[same + 3 * sizeof(void*)];

}  // extern "C"

namespace {

qhT hull;

/// Calls body(&hull), between two copies of the fields.
auto with_hull(const auto& body) {
  struct Given {
    Given() { std::memcpy(static_cast<void*>(&hull), one_qh, same); }
    ~Given() { std::memcpy(one_qh, static_cast<void*>(&hull), same); }
  } given;
  return body(&hull);
}

}  // namespace

extern "C" {

#define CULLHULL_ONE(type, name, parameters, ...)                                               \
  CULLHULL_QHULL type one_##name parameters __asm__("qh_" #name);                               \
  type one_##name parameters {                                                                  \
    return with_hull([&]([[maybe_unused]] qhT* qh) -> type { return qh_##name(__VA_ARGS__); }); \
  }                                                                                             \
  static_assert(true)

CULLHULL_ONE(int, new_qhull,
             (int dim, int n, coordT* points, boolT is_malloc, char* command, FILE* out, FILE* err),
             qh, dim, n, points, is_malloc, command, out, err);
CULLHULL_ONE(void, freeqhull, (boolT all), qh, all);
CULLHULL_ONE(void, memfreeshort, (int* count, int* bytes), qh, count, bytes);
CULLHULL_ONE(int, pointid, (pointT * point), qh, point);
CULLHULL_ONE(coordT, pointdist, (pointT * a, pointT* b, int dim), a, b, dim);
CULLHULL_ONE(void, triangulate, (), qh);
CULLHULL_ONE(setT*, facetvertices, (facetT * list, setT* facets, boolT all), qh, list, facets, all);
CULLHULL_ONE(void, makeridges, (facetT * facet), qh, facet);
CULLHULL_ONE(void, order_vertexneighbors, (vertexT * vertex), qh, vertex);
CULLHULL_ONE(void, setvoronoi_all, (), qh);
CULLHULL_ONE(int, setsize, (setT * set), qh, set);
CULLHULL_ONE(setT*, settemp, (int size), qh, size);
CULLHULL_ONE(void, settempfree, (setT * *set), qh, set);
CULLHULL_ONE(void, setappend, (setT * *set, void* item), qh, set, item);
CULLHULL_ONE(int, setunique, (setT * *set, void* item), qh, set, item);

}  // extern "C"
