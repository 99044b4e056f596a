#include "distributed/parts.hpp"

#include <utility>

namespace cullhull::internal {
namespace {

/// The header of a message. Nothing follows it if the sender has failed or has no points.
struct Notice {
  std::uint64_t failed = 0, count = 0, seen = 0, merged = 0;
};

void resize(NumberedPoints& points, std::uint64_t count) {
  points.ids.resize(count);
  points.rows.resize(count * points.row_bytes());
}

/// Sends a part: the header, then, if the receiver answers that it has room, the points.
void send_part(Communicator& ranks, const Part& part, bool failed, int to) {
  const Notice notice{failed, failed ? 0 : part.points.size(), part.seen, part.merged};
  ranks.send(&notice, sizeof notice, to);
  if (notice.count == 0) return;
  std::uint64_t welcome = 0;
  ranks.receive(&welcome, sizeof welcome, to);
  if (welcome == 0) return;
  ranks.send(part.points.ids.data(), part.points.ids.size() * sizeof(std::uint64_t), to);
  ranks.send(part.points.rows.data(), part.points.rows.size(), to);
}

/// Receives the part of another rank and appends it to `part`. If this rank has failed or fails
/// here, it answers that it has no room, and stores the exception in `failure`.
void receive_part(Communicator& ranks, Part& part, const Room& room, std::exception_ptr& failure,
                  int from) {
  Notice notice;
  ranks.receive(&notice, sizeof notice, from);
  if (notice.failed != 0) return;  // the sender reports its failure in agree()
  Part other{{part.points.dimension, part.points.scalar, {}, {}}, notice.seen, notice.merged};
  if (notice.count > 0) {
    if (!failure) try {
        // Memory for both parts and for both joined.
        room(2 * (part.points.size() + notice.count) * part.points.point_bytes());
        resize(other.points, notice.count);
      } catch (...) {
        failure = std::current_exception();
      }
    const std::uint64_t welcome = failure ? 0 : 1;
    ranks.send(&welcome, sizeof welcome, from);
    if (failure) return;
    ranks.receive(other.points.ids.data(), notice.count * sizeof(std::uint64_t), from);
    ranks.receive(other.points.rows.data(), other.points.rows.size(), from);
  }
  if (!failure) try {
      part.append(other);
    } catch (...) {
      failure = std::current_exception();
    }
}

}  // namespace

void gather(Communicator& ranks, int root, Part& part, const std::function<void(Part&)>& reduce,
            const Room& room, std::exception_ptr failure) {
  const int size = ranks.size(), me = (ranks.rank() - root + size) % size;
  const auto real = [&](int place) { return (place + root) % size; };
  const std::uint64_t own = part.seen;
  int step = 1;
  for (; step < size && (me & step) == 0; step *= 2)
    if (me + step < size) receive_part(ranks, part, room, failure, real(me + step));
  if (me != 0) {
    if (!failure && part.seen > own) try {
        reduce(part);
      } catch (...) {
        failure = std::current_exception();
      }
    send_part(ranks, part, failure != nullptr, real(me - step));
    part = {{part.points.dimension, part.points.scalar, {}, {}}, 0};
  }
  ranks.agree(failure);
}

void broadcast(Communicator& ranks, int root, Part& part, const Room& room) {
  std::uint64_t head[2] = {part.points.size(), part.seen};
  ranks.broadcast(head, sizeof head, root);
  ranks.together([&] {
    if (ranks.rank() == root) return;
    room(head[0] * part.points.point_bytes());
    resize(part.points, head[0]);
    part.seen = head[1];
  });
  ranks.broadcast(part.points.ids.data(), head[0] * sizeof(std::uint64_t), root);
  ranks.broadcast(part.points.rows.data(), part.points.rows.size(), root);
}

}  // namespace cullhull::internal
