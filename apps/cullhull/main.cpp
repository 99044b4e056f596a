// cullhull: exact convex hulls of very large point sets.
#include "commands.hpp"
#include "program.hpp"

namespace {

constexpr const char* description =
    "cullhull: exact convex hulls of very large point sets, in any dimension.\n"
    "It drops the points that provably lie strictly inside the hull, then computes the hull of "
    "the\n"
    "few that are left with exact predicates. No tolerance, nothing to tune.";

constexpr const char* footer =
    "Examples:\n"
    "  cullhull generate ball -n 1M -d 3 -o ball.npy    make a million points\n"
    "  cullhull hull ball.npy -o hull.ply --certify     their hull, checked, as a mesh\n"
    "  cullhull ball.npy                                the same as cullhull hull ball.npy\n"
    "  cullhull track frames.npy --json                 hulls of moving points, frame by frame\n"
    "  cullhull delaunay disk.npy -o mesh.ply           the Delaunay triangulation\n"
    "  cullhull info ball.npy                           what is in a file\n"
    "\n"
    "Exit status: 0 success; 1 bad input or the system refused; 2 bad usage; 3 not certified;\n"
    "4 out of the memory budget; 5 backend or engine not available; 130 cancelled.\n"
    "Errors are one line on standard error. 'cullhull help COMMAND' tells more.";

}  // namespace

int main(int argc, char** argv) {
  return app::run_program(
      {.name = "cullhull",
       .description = description,
       .footer = footer,
       .commands = {app::add_hull, app::add_cull, app::add_track, app::add_delaunay,
                    app::add_voronoi, app::add_alpha, app::add_certify, app::add_generate,
                    app::add_info, app::add_view, app::add_qconvex}},
      argc, argv);
}
