// The page of `cullhull view`: points, hull and figures of one set, or of each frame of a moving
// set, small enough for browsers to load at once.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/cull.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/triangulation.hpp"

namespace cullhull::viewer {

/// False in builds without three.js.
bool available();

/// The contents of a page for one frame.
struct SceneFrame {
  std::uint64_t index = 0;  ///< index of the frame in its sequence
  const Hull* hull = nullptr;
  /// Rows of hull->dimension in the order of hull->vertices.
  std::vector<double> vertex_rows;
  /// The whole input; empty if only the hull is known.
  PointView points;
  /// The number of points with a NaN coordinate, which are not drawn.
  std::uint64_t skipped = 0;
  /// The points' colours (u8 red, green, blue), or empty.
  PointView colours;
  /// Numbers of the points that are no coordinates, a column for each name, or none.
  PointView attributes;
  std::vector<std::string> attribute_names;
  /// Used only if there are points.
  const Survivors* survivors = nullptr;
  /// How to triangulate the points that are drawn, in 2D and 3D; null: no cells.
  const TriangulationOptions* triangulate = nullptr;
  bool outline = false;  ///< only the cells of the alpha shape of one region, and their boundary
  /// A JSON object: the figures to show (hull_to_json).
  std::string report;
};

/// Collects frames, then writes the page.
///
/// Each point drawn is a row: id and exact coordinates. The rows are, in this order: vertices,
/// survivors that are not vertices, discarded points; the latter two (and a hull that is too large)
/// are uniform samples. The page holds one JSON object (id "scene", which refers to arrays by
/// [offset in bytes, length, type]) and one block of bytes in base64 (id "bytes"), little-endian.
class Scene {
 public:
  /// `shown_frames` of `frames` will be added; they share the bytes of the page.
  Scene(std::string title, std::uint64_t frames, std::uint64_t shown_frames);
  void add(const SceneFrame& frame);
  /// Throws Error{backend_unavailable} unless available().
  std::string page() const;

  /// With more frames, each would have too few points to be useful.
  static constexpr std::uint64_t most_frames = 120;

 private:
  struct Rows;
  template <class T>
  std::string array(const char* name, const char* type, const std::vector<T>& items);
  std::string indices(const char* name, const std::vector<std::uint32_t>& items,
                      std::uint64_t rows);
  Rows choose_rows(const SceneFrame& frame, std::uint64_t row_bytes, std::uint64_t bytes) const;
  void write_rows(const SceneFrame& frame, const Rows& rows, std::string& json);
  void write_cells(const SceneFrame& frame, const std::vector<double>& ids,
                   const std::vector<double>& coordinates, std::string& json);
  void write_attributes(const SceneFrame& frame, const std::vector<double>& ids, std::string& json);
  void write_colours(const PointView& colours, const std::vector<double>& ids, std::string& json);
  void write_shadows(const Rows& rows, std::string& json);

  /// Bytes of a frame that are reserved for its cells.
  std::uint64_t cell_bytes() const { return frame_bytes_ / 2; }

  std::string title_;
  std::uint64_t frames_;
  std::uint64_t frame_bytes_;
  std::uint32_t dimension_ = 0;
  std::uint32_t axes_ = 0;  ///< coordinates per row, at most most_axes
  std::string frames_json_;
  std::string bytes_;
};

/// The vertex_rows of a hull, from its points.
std::vector<double> vertex_rows(const PointView& points, const Hull& hull);

}  // namespace cullhull::viewer
