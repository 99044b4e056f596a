// Points that come in pieces.
#include "cullhull/stream.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/point_blocks.hpp"
#include "points.hpp"
#include "solid.hpp"

namespace binding {

using cullhull::HullState;
using cullhull::HullStream;
using cullhull::Options;

namespace {

nb::bytes bytes_of(const void* data, std::size_t size) { return nb::bytes(data, size); }

std::unique_ptr<Solid> solid_of(const HullState& state, const Settings* settings) {
  return computed(settings, length_of(state.points()), [&](const Options& options) {
    return std::make_unique<Solid>(state.hull(options), state.ids(), state.points());
  });
}

/// Runs to its end, then raises a pending signal's exception: a push is done completely or not at
/// all.
template <class Work>
void run_whole(const Settings* settings, const cullhull::PointView& points, const Work& work) {
  run(settings, length_of(points), [&](const Options&) { work(); });
}

class Stream {
 public:
  explicit Stream(const Settings* settings) : stream_(settings_or_default(settings).options) {}

  void push(nb::handle array, std::optional<std::uint64_t> first_id) {
    const Points points(array);
    run_whole(nullptr, points.view(), [&] {
      if (first_id)
        stream_.push(points.view(), *first_id);
      else
        stream_.push(points.view());
    });
  }
  void push_state(const HullState& state) {
    run_whole(nullptr, state.points(), [&] { stream_.push(state); });
  }
  HullState state() {
    return computed(nullptr, Length::long_, [&](const Options&) { return stream_.state(); });
  }
  nb::typed<nb::dict, nb::str, nb::int_> report() const {
    const cullhull::StreamReport r = stream_.report();
    nb::typed<nb::dict, nb::str, nb::int_> all;
    all["point_count"] = r.point_count;
    all["extreme"] = r.extreme;
    all["waiting"] = r.waiting;
    all["reductions"] = r.reductions;
    all["maps"] = r.maps;
    return all;
  }

 private:
  HullStream stream_;
};

HullState state_of(nb::handle array, std::uint64_t first_id, const Settings* settings) {
  const Points points(array);
  return computed(settings, length_of(points.view()), [&](const Options& options) {
    return HullState(points.view(), first_id, options);
  });
}

HullState merged(const HullState& a, const HullState& b, const Settings* settings) {
  HullState state = a;
  run(settings, length_of(b.points()), [&](const Options& options) { state.merge(b, options); });
  return state;
}

}  // namespace

void bind_stream(nb::module_& m) {
  nb::class_<HullState>(m, "State", "Extreme points of a part: cullhull.HullState wraps it.")
      .def(nb::init<>())
      .def_prop_ro("dimension", &HullState::dimension)
      .def_prop_ro("scalar", [](const HullState& s) { return cullhull::scalar_name(s.scalar()); })
      .def_prop_ro("point_count", &HullState::point_count)
      .def_prop_ro("count", [](const HullState& s) { return s.ids().size(); })
      .def("ids", [](const HullState& s) { return bytes_of(s.ids().data(), 8 * s.ids().size()); })
      .def(
          "rows",
          [](const HullState& s) {
    const cullhull::PointView p = s.points();
    return bytes_of(p.data, p.count * p.dimension * cullhull::scalar_size(p.scalar));
          })
      .def(
          "to_bytes",
          [](const HullState& s) {
    const std::vector<std::byte> bytes = s.to_bytes();
    return bytes_of(bytes.data(), bytes.size());
          })
      .def_static(
          "from_bytes",
          [](const nb::bytes& bytes) {
    return HullState::from_bytes({static_cast<const std::byte*>(bytes.data()), bytes.size()});
          })
      .def(
          "shifted",
          [](const HullState& s, std::uint64_t offset) {
    HullState state = s;
    state.shift_ids(offset);
    return state;
          })
      .def("merged", merged, nb::arg("other"), nb::arg("settings").none())
      .def("solid", solid_of, nb::arg("settings").none())
      .def("same", [](const HullState& a, const HullState& b) { return a == b; })
      .def(
          "save",
          [](const HullState& s, const std::string& path) {
    const nb::gil_scoped_release release;
    cullhull::write_state(path, s);
          })
      .def_static("load", [](const std::string& path) {
        const nb::gil_scoped_release release;
        return cullhull::read_state(path);
      });
  m.def("state_of", state_of, nb::arg("points"), nb::arg("first_id"), nb::arg("settings").none());
  nb::class_<Stream>(m, "Stream", "Points in pieces: cullhull.HullStream wraps it.")
      .def(nb::init<const Settings*>(), nb::arg("settings").none())
      .def("push", &Stream::push, nb::arg("points"), nb::arg("first_id").none())
      .def("push_state", &Stream::push_state, nb::arg("state"))
      .def("state", &Stream::state)
      .def_prop_ro("report", &Stream::report);
}

}  // namespace binding
