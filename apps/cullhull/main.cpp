// cullhull: exact convex hulls of very large point sets.
#include "commands.hpp"
#include "program.hpp"
#include "topics.hpp"

namespace {

constexpr const char* description =
    "cullhull: exact convex hulls of very large point sets, in any dimension.\n"
    "It first discards every point that is provably inside, then computes the hull of the few\n"
    "points that remain with exact predicates. There is no tolerance and nothing to tune.";

constexpr const char* footer =
    "Examples:\n"
    "  cullhull generate ball -n 1M -d 3 -o ball.npy    generate a million points\n"
    "  cullhull hull ball.npy -o hull.ply --certify     their hull as a mesh, verified\n"
    "  cullhull ball.npy                                the same as cullhull hull ball.npy\n"
    "  cullhull track frames.npy --json                 hulls of moving points, frame by frame\n"
    "  cullhull delaunay disk.npy -o mesh.ply           Delaunay triangulation\n"
    "  cullhull info ball.npy                           format, points and ranges of a file\n"
    "\n"
    "'cullhull help COMMAND' or 'cullhull help TOPIC' has more.\n"
    "\n"
    "Exit status: 0 success; 1 bad input or system error; 2 bad usage; 3 not certified; 4 memory\n"
    "limit exceeded; 5 backend not available; 130 cancelled. An error is one line on\n"
    "standard error.";

}  // namespace

int main(int argc, char** argv) {
  return app::run_program(
      {.name = "cullhull",
       .description = description,
       .footer = footer,
       .commands = {app::add_hull, app::add_cull, app::add_track, app::add_delaunay,
                    app::add_voronoi, app::add_alpha, app::add_certify, app::add_generate,
                    app::add_info, app::add_view, app::add_qconvex, app::add_completion,
                    app::add_man},
       .topics = app::topics()},
      argc, argv);
}
