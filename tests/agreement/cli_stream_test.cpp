// The program over points in many files and blocks: the bytes that one file in memory gives.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

#include "agreement/expect_json.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"
#include "cullhull/point_blocks.hpp"

namespace cullhull::cli_stream_test {

using namespace testing;

void write_npy(const std::string& path, const std::vector<double>& rows, std::uint32_t d,
               ScalarType type = ScalarType::f64) {
  write_npy_points(path, rows.data(), rows.size() / d, d, type);
}

std::vector<double> part(const std::vector<double>& rows, std::uint32_t d, std::size_t from,
                         std::size_t to) {
  return {rows.begin() + static_cast<std::ptrdiff_t>(from * d),
          rows.begin() + static_cast<std::ptrdiff_t>(to * d)};
}

std::vector<std::uint64_t> all_ids(std::size_t n) {
  std::vector<std::uint64_t> ids(n);
  for (std::size_t i = 0; i < n; ++i) ids[i] = i;
  return ids;
}

/// Tiles of unequal size, one of them of one point, in a format of points.
std::vector<std::string> write_tiles(const Folder& f, const std::vector<double>& rows,
                                     std::uint32_t d, const std::string& ending) {
  std::vector<std::string> names;
  const std::size_t n = rows.size() / d;
  std::size_t at = 0;
  for (std::size_t k = 0; at < n; ++k) {
    const std::size_t to = std::min(n, at + (k == 3 ? 1 : 1 + 37 * k * k));
    const std::vector<double> tile = part(rows, d, at, to);
    const std::string name = f / ("tile" + std::to_string(k) + ending);
    if (ending == ".raw")
      write_file(name, {reinterpret_cast<const char*>(tile.data()), tile.size() * 8});
    else
      write_points(name, PointView::row_major(tile.data(), to - at, d), all_ids(to - at));
    names.push_back(name);
    at = to;
  }
  return names;
}

/// Runs and expects success; what was written with -o.
std::string hull_bytes(const Folder& f, std::vector<std::string> arguments,
                       const std::string& input = "/dev/null") {
  const std::string out = f / "out.json";
  std::filesystem::remove(out);
  arguments.insert(arguments.begin(), "hull");
  arguments.insert(arguments.end(), {"-o", out});
  const Ran ran = run_well(arguments, input);
  return read_file(out);
}

TEST(CliStream, TilesGiveTheBytesOfTheWhole) {
  for (const std::uint32_t d : {2U, 3U}) {
    const Folder f;
    const std::vector<double> rows = generate("ball", 30000, d, 5);
    write_npy(f / "whole.npy", rows, d);
    const std::string expected = hull_bytes(f, {f / "whole.npy"});
    ASSERT_FALSE(expected.empty());
    EXPECT_EQ(hull_bytes(f, {f / "whole.npy", "--stream", "on"}), expected);
    EXPECT_EQ(hull_bytes(f, {"-", "--stream", "on"}, f / "whole.npy"), expected);
    for (const std::string ending : {".npy", ".ply", ".csv", ".xyz", ".raw"}) {
      SCOPED_TRACE(ending);
      const Folder tiles_folder;
      std::vector<std::string> tiles = write_tiles(tiles_folder, rows, d, ending), raw;
      ASSERT_GT(tiles.size(), 8U);
      if (ending == ".raw") raw = {"--type", "f64", "--dim", std::to_string(d)};
      const auto with_raw = [&](std::vector<std::string> words) {
        words.insert(words.end(), raw.begin(), raw.end());
        return words;
      };
      EXPECT_EQ(hull_bytes(f, with_raw(tiles)), expected);
      EXPECT_EQ(hull_bytes(f, with_raw({tiles_folder / ("tile*" + ending)})), expected);
      std::string list = "# tiles in order\n\n";
      for (const std::string& tile : tiles) list += tile + "\n";
      write_file(f / "list.txt", list);
      EXPECT_EQ(hull_bytes(f, with_raw({"@" + (f / "list.txt")})), expected);
      tiles.insert(tiles.end(), {"--stream", "off"});
      EXPECT_EQ(hull_bytes(f, with_raw(tiles)), expected);
    }
  }
}

TEST(CliStream, PartsAsStatesPutTogether) {
  const Folder f;
  const std::vector<double> rows = generate("ball", 20000, 3, 6);
  write_npy(f / "whole.npy", rows, 3);
  write_npy(f / "a.npy", part(rows, 3, 0, 7000), 3);
  write_npy(f / "b.npy", part(rows, 3, 7000, 20000), 3);
  const std::string expected = hull_bytes(f, {f / "whole.npy"});
  for (const std::string name : {"a", "b"}) {
    const Ran ran =
        run_well({"hull", f / (name + ".npy"), "--partial", f / (name + ".hullstate"), "--quiet"});
    EXPECT_EQ(ran.out, "");
  }
  EXPECT_EQ(hull_bytes(f, {f / "a.hullstate", f / "b.hullstate"}), expected);
  EXPECT_EQ(hull_bytes(f, {f / "a.hullstate", f / "b.npy"}), expected);
  EXPECT_EQ(hull_bytes(f, {f / "a.npy", "-"}, f / "b.hullstate"), expected);

  // The same with ids that are the whole's from the start.
  run_well({"hull", f / "b.npy", "--partial", f / "g.hullstate", "--first-id", "7000"});
  EXPECT_EQ(hull_bytes(f, {f / "g.hullstate", f / "a.hullstate", "--global-ids"}), expected);
  EXPECT_EQ(hull_bytes(f, {f / "g.hullstate", f / "a.hullstate"}), expected);
  const Ran mixed = run_app({"hull", f / "g.hullstate", f / "a.npy"});
  EXPECT_EQ(mixed.status, 2);
  EXPECT_NE(mixed.err.find("--global-ids"), std::string::npos) << mixed.err;

  const HullState state = read_state(f / "a.hullstate");
  EXPECT_EQ(state.point_count(), 7000U);
  std::string broken = read_file(f / "a.hullstate");
  broken[200] = static_cast<char>(broken[200] ^ 1);
  write_file(f / "broken.hullstate", broken);
  expect_error({"hull", f / "broken.hullstate"}, 1, "broken.hullstate: hull state: its check sum");

  run_well({"hull", f / "a.npy", "--partial", f / "a.npz"});
  EXPECT_EQ(read_file(f / "a.npz").substr(0, 2), "PK");
}

/// The states that so many processes make of the inputs, all at once.
std::vector<std::string> states_of_parts(const Folder& f, const std::vector<std::string>& inputs,
                                         std::size_t parts) {
  std::vector<std::string> states;
  std::vector<std::thread> jobs;
  for (std::size_t k = parts; k > 0; --k) states.push_back(f / (std::to_string(k) + ".hullstate"));
  for (std::size_t k = 1; k <= parts; ++k)
    jobs.emplace_back([&, k] {
      std::vector<std::string> words{"hull"};
      words.insert(words.end(), inputs.begin(), inputs.end());
      for (const std::string& word :
           {std::string("--part"), std::to_string(k) + "/" + std::to_string(parts),
            std::string("-o"), states[parts - k], std::string("-q")})
        words.push_back(word);
      const Ran ran = run_app(words);
      EXPECT_EQ(ran.status, 0) << ran.err;
    });
  for (std::thread& job : jobs) job.join();
  return states;
}

TEST(CliStream, PartsOfJobsHaveTheBitsOfTheWhole) {
  const Folder f;
  const auto points = [&](const char* name, const char* shape, const char* count) {
    EXPECT_EQ(run_app({"generate", shape, "-n", count, "-d", "3", "-q", "-o", f / name}).status, 0);
    return f / name;
  };
  const std::string npy = points("a.npy", "ball", "40001"), csv = points("b.csv", "sphere", "1003"),
                    txt = points("c.txt", "ball", "30000"), obj = points("d.obj", "sphere", "77"),
                    ply = points("e.ply", "ball", "5000");
  const std::vector<std::string> all{npy, csv, txt, obj, ply};
  const std::string expected = hull_bytes(f, all);
  for (const std::size_t parts : {1, 2, 5, 16})
    EXPECT_EQ(hull_bytes(f, states_of_parts(f, all, parts)), expected) << parts;
  for (const std::string& one : all)
    EXPECT_EQ(hull_bytes(f, states_of_parts(f, {one}, 16)), hull_bytes(f, {one})) << one;
  EXPECT_EQ(hull_bytes(f, states_of_parts(f, {obj}, 77)), hull_bytes(f, {obj}));
  // Also where a block of a text, 64 KiB here, lies in one part or in several.
  EXPECT_EQ(hull_bytes(f, states_of_parts(f, {txt, "--memory", "12M"}, 7)), hull_bytes(f, {txt}));

  // A bad line is of one part, or of the counting.
  write_file(f / "bad.txt", "0 0\n1 0\n0 1\nnan 1\n");
  EXPECT_EQ(run_app({"hull", f / "bad.txt", "--part", "1/2", "-q"}).status, 0);
  const Ran bad = run_app({"hull", f / "bad.txt", "--part", "2/2", "-q"});
  EXPECT_EQ(bad.status, 1);
  EXPECT_NE(bad.err.find("bad.txt:4: point 3, "), std::string::npos) << bad.err;
  write_file(f / "short.txt", "2\n5\n0 0\n1 0\n0 1\n");
  const Ran short_of = run_app({"hull", f / "short.txt", "--part", "1/2", "-q"});
  EXPECT_EQ(short_of.status, 1);
  EXPECT_NE(short_of.err.find("promises 5 points"), std::string::npos) << short_of.err;
}

TEST(CliStream, PartsThatCannotBeAreRefused) {
  const Folder f;
  write_file(f / "a.txt", "0 0\n1 0\n0 1\n");
  write_state(f / "s.hullstate", HullState(2));
  const std::string a = f / "a.txt";
  const struct {
    std::vector<std::string> words;
    const char* say;
  } cases[] = {
      {{a, "--part", "0/3"}, "K from 1 to N"},
      {{a, "--part", "4/3"}, "K from 1 to N"},
      {{a, "--part", "1/0"}, "K from 1 to N"},
      {{a, "--part", "1/-2"}, "K from 1 to N"},
      {{a, "--part", "2"}, "K from 1 to N"},
      {{a, "--part", "1/2/3"}, "K from 1 to N"},
      {{a, "--part", "1/4"}, "4 parts of 3 rows: some would be empty"},
      {{a, "--part", "1/2", "--certify"}, "certify the merged"},
      {{a, "--part", "1/2", "--stream", "off"}, "--part reads in blocks"},
      {{a, "--part", "1/2", "-o", f / "p.hullstate", "--partial", f / "p.npz"}, "one state"},
      {{f / "s.hullstate", "--part", "1/2"}, "no rows to divide"},
      {{"-", "--part", "1/2"}, "can be read only once"},
  };
  for (const auto& c : cases) {
    std::vector<std::string> words{"hull"};
    words.insert(words.end(), c.words.begin(), c.words.end());
    const Ran ran = run_app(words, "/dev/null");
    EXPECT_EQ(ran.status, 2) << c.say;
    EXPECT_TRUE(one_line(ran.err));
    EXPECT_NE(ran.err.find(c.say), std::string::npos) << ran.err;
  }
}

TEST(CliStream, CertifiesInBlocks) {
  const Folder f;
  const std::vector<double> rows = generate("ball", 20000, 3, 7);
  write_npy(f / "a.npy", part(rows, 3, 0, 7000), 3);
  write_npy(f / "b.npy", part(rows, 3, 7000, 20000), 3);
  const std::string a = f / "a.npy", b = f / "b.npy", hull = f / "hull.json";
  run_well({"hull", a, b, "-o", hull, "--certify"});
  run_well({"certify", a, b, hull});
  run_well({"certify", a, b, hull, "--stream", "off"});
  for (const auto& wrong : command_lines(f, {"@b.npy @a.npy", "@a.npy", "@a.npy @b.npy @a.npy"})) {
    std::vector<std::string> words = joined({"certify"}, wrong);
    words.insert(words.end(), {hull, "--stream", "on"});
    expect_error(words, 3, "");
  }
  // A point beyond the hull, and one that has left its vertex, both far into the second file.
  for (const double far : {5.0, 0.0}) {
    std::vector<double> changed = rows;
    const auto result = json_in(hull);
    const std::size_t vertex = result["vertices"].back();
    for (int j = 0; j < 3; ++j) changed[3 * vertex + static_cast<std::size_t>(j)] = far;
    write_npy(f / "c.npy", part(changed, 3, 7000, 20000), 3);
    const Ran ran = run_app({"certify", a, f / "c.npy", hull});
    EXPECT_EQ(ran.status, 3) << far;
    // A point far outside is named; one that lies inside is only missed.
    const std::string say = far > 0 ? std::to_string(vertex) : "are among the points";
    EXPECT_TRUE(has(ran.err, say));
  }
}

TEST(CliStream, CullKeepsDuplicatesInMemoryAlone) {
  const Folder f;
  write_file(f / "a.csv", "0,0\n4,0\n0,4\n0,0\n4,0\n2,0\n");
  const auto kept = [&](const char* stream) {
    run_well({"cull", f / "a.csv", "--stream", stream, "-o", f / "ids.csv"});
    return read_file(f / "ids.csv");
  };
  EXPECT_EQ(kept("off"), "id\n0\n1\n2\n3\n4\n5\n");
  EXPECT_EQ(kept("on"), "id\n0\n1\n2\n");
  std::string help = run_app({"cull", "--help"}).out;
  std::replace(help.begin(), help.end(), '\n', ' ');
  EXPECT_TRUE(has(help, "every extreme point survives, with its duplicates"));
  EXPECT_TRUE(has(help, "in blocks (--stream), only the extreme points survive"));
}

TEST(CliStream, ErrorsNameTheFileAndThePoint) {
  const Folder f;
  std::vector<double> rows = generate("ball", 3000, 3, 9);
  write_npy(f / "a.npy", rows, 3);
  write_npy(f / "flat.npy", generate("ball", 10, 2, 9), 2);
  rows[3 * 1234 + 1] = std::nan("");
  write_npy(f / "b.npy", rows, 3);
  write_file(f / "lines.csv", "x,y,z\n1,2,3\n4,5\n");
  write_file(f / "short.npy", read_file(f / "a.npy").substr(0, 5000));
  const struct {
    std::vector<std::string> words;
    const char* say;
  } cases[] = {
      {{f / "a.npy", f / "b.npy"}, "b.npy: point 4234, coordinate 1 is NaN"},
      {{f / "a.npy", f / "flat.npy"}, "flat.npy: points of dimension 2, but of 3 in"},
      {{f / "a.npy", f / "lines.csv"}, "lines.csv:3: "},
      {{f / "a.npy", f / "short.npy"}, "short.npy: byte 128: shape"},
      {{f / "a.npy", f / "none.npy"}, "none.npy: cannot open"},
      {{"@" + (f / "none.txt")}, "none.txt: cannot open the list"},
  };
  for (const auto& c : cases) {
    expect_error(joined({"hull", "--stream", "on"}, c.words), 1, c.say);
  }
  for (const std::vector<std::string>& words :
       command_lines(f, {"--stream on --repeat 2", "--stream off --partial @p.hullstate",
                         "--stream on --format o", "--partial @p.npy", "--checkpoint @a.npy"})) {
    expect_error(joined({"hull", f / "a.npy"}, words), 2, "");
  }
}

TEST(CliStream, BudgetIsToldInOneLine) {
  const Folder f;
  write_npy(f / "sphere.npy", generate("sphere", 300000, 3, 1), 3, ScalarType::f32);
  expect_error({"hull", f / "sphere.npy", "--stream", "on", "--memory", "8MiB"}, 4,
               "the stream holds ");
}

TEST(CliStream, AFileLargerThanTheAddressSpace) {
  if (testing::sanitized) GTEST_SKIP() << "a sanitizer needs more addresses than that";
  const Folder f;
  std::vector<double> rows = generate("ball", 1 << 20, 3, 2);
  const std::vector<double> once = rows;
  for (int k = 0; k < 11; ++k) rows.insert(rows.end(), once.begin(), once.end());
  write_npy(f / "big.npy", rows, 3);  // 288 MiB
  write_npy(f / "once.npy", once, 3);
  const Ran ran = run_limited(
      {"hull", f / "big.npy", "--vertices", f / "ids.csv", "--threads", "2", "--quiet"}, [] {
        const rlimit limit{200 << 20, 200 << 20};
        ::setrlimit(RLIMIT_AS, &limit);
      });
  EXPECT_EQ(ran.status, 0) << ran.err;
  run_well({"hull", f / "once.npy", "--vertices", f / "once.csv"});
  EXPECT_EQ(read_file(f / "ids.csv"), read_file(f / "once.csv"));
}

// ------------------------------------------------------------------------------- checkpoints

/// Many tiles of points that are all extreme: opening them takes longer than several looks at the
/// clock, so that a run can be cut off at any moment.
void write_slow_input(const Folder& f) {
  for (int tile = 1000; tile < 9000; ++tile)
    write_npy(f / ("tile-" + std::to_string(tile) + ".npy"), generate("sphere", 15, 3, tile), 3);
}

std::vector<std::string> checkpointed(const Folder& f) {
  return {"hull", f / "tile-*.npy", "--checkpoint", f / "run.checkpoint", "--checkpoint-every", "0",
          "-o",   f / "hull.json",  "--quiet"};
}

pid_t start_quietly(const std::vector<std::string>& words) {
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  const pid_t child = testing::start_app(words, null, null, null);
  ::close(null);
  return child;
}

/// How long a run takes here and now: what moments in its middle are taken from.
std::chrono::microseconds time_of_whole(const std::vector<std::string>& words) {
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(testing::wait_for(start_quietly(words)), 0);
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() -
                                                               start);
}

/// Kills runs as soon as their first checkpoint is seen, until one has stayed: a run that comes to
/// its end before the signal does removes it.
void leave_a_checkpoint(const Folder& f) {
  const std::string checkpoint = f / "run.checkpoint";
  for (int round = 0; round < 100 && !std::filesystem::exists(checkpoint); ++round) {
    const pid_t child = start_quietly(checkpointed(f));
    siginfo_t ended{};
    while (!std::filesystem::exists(checkpoint) && ended.si_pid == 0)
      if (::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOHANG | WNOWAIT) != 0)
        break;
    testing::send(child, SIGKILL);
    testing::wait_for(child);
  }
  ASSERT_TRUE(std::filesystem::exists(checkpoint));
}

TEST(CliStream, KilledAtAnyMomentAndResumed) {
  const Folder f;
  write_slow_input(f);
  const std::string expected = hull_bytes(f, {f / "tile-*.npy"});
  const auto whole = time_of_whole(checkpointed(f));
  std::mt19937 random(3);
  int killed = 0, resumed = 0;
  for (int round = 0; round < 200; ++round) {
    const bool going_on = std::filesystem::exists(f / "run.checkpoint");
    const pid_t child = start_quietly(checkpointed(f));
    if (killed < 20) {
      std::this_thread::sleep_for(whole * static_cast<int>(random() % 100) / 100);
      testing::send(child, SIGKILL);
    }
    const int status = testing::wait_for(child);
    if (status == 1000 + SIGKILL) {
      ++killed;
      resumed += going_on;
      continue;
    }
    ASSERT_EQ(status, 0);
    EXPECT_EQ(read_file(f / "hull.json"), expected) << killed << " times killed";
    EXPECT_FALSE(std::filesystem::exists(f / "run.checkpoint"));
    if (killed >= 20) break;
  }
  EXPECT_GE(killed, 20);
  EXPECT_GT(resumed, 0);
}

TEST(CliStream, InterruptedAndResumed) {
  const Folder f;
  write_slow_input(f);
  const std::string expected = hull_bytes(f, {f / "tile-*.npy"});
  std::vector<std::string> words = checkpointed(f);
  *std::find(words.begin(), words.end(), "0") = "1000";  // on Ctrl-C alone
  const auto whole = time_of_whole(words);
  std::mt19937 random(5);
  int interrupted = 0;
  for (int round = 0; round < 100 && interrupted < 3; ++round) {
    const pid_t child = start_quietly(words);
    std::this_thread::sleep_for(whole * static_cast<int>(random() % 100) / 100);
    testing::send(child, SIGINT);
    if (testing::wait_for(child) != 130) continue;
    if (std::filesystem::exists(f / "run.checkpoint")) ++interrupted;
  }
  EXPECT_GT(interrupted, 0);
  run_well(words);
  EXPECT_EQ(read_file(f / "hull.json"), expected);
}

TEST(CliStream, AFullDiskLeavesTheCheckpointBefore) {
  const Folder f;
  write_slow_input(f);
  // What is still to be read takes several looks at the clock.
  write_npy(f / "tile-9999.npy", generate("ball", 3000000, 3, 9), 3);
  ASSERT_NO_FATAL_FAILURE(leave_a_checkpoint(f));
  const std::string before = read_file(f / "run.checkpoint");
  const Ran ran = run_limited(checkpointed(f), [] {
    const rlimit limit{1000, 1000};  // bytes a file may have, as on a full disk
    ::setrlimit(RLIMIT_FSIZE, &limit);
  });
  EXPECT_EQ(ran.status, 1);
  EXPECT_TRUE(one_line(ran.err));
  EXPECT_TRUE(has(ran.err, "run.checkpoint: cannot write"));
  EXPECT_EQ(read_file(f / "run.checkpoint"), before);
}

TEST(CliStream, ACheckpointOfOtherInputsOrEditedIsRefused) {
  const Folder f;
  write_slow_input(f);
  ASSERT_NO_FATAL_FAILURE(leave_a_checkpoint(f));
  expect_error({"hull", f / "tile-1000.npy", "--checkpoint", f / "run.checkpoint"}, 2,
               "is of other inputs");
  const std::string text = read_file(f / "run.checkpoint");
  const std::size_t place = text.find("\"file_points\":");
  ASSERT_NE(place, std::string::npos);
  std::string edited = text;
  edited[place + 14] = edited[place + 14] == '9' ? '8' : '9';
  for (const auto& [changed, why] : {std::pair(edited, "its check sum is wrong"),
                                     {text.substr(0, text.size() - 1), "its check sum is wrong"},
                                     {"cullhull checkpoint 1\n{}\n", "another version"}}) {
    write_file(f / "run.checkpoint", changed);
    expect_error(checkpointed(f), 1, why);
  }
  write_file(f / "broken", "something else");
  const Ran broken = run_app({"hull", f / "tile-1000.npy", "--checkpoint", f / "broken"});
  EXPECT_EQ(broken.status, 1);
  EXPECT_TRUE(one_line(broken.err));
  EXPECT_EQ(read_file(f / "broken"), "something else");
}

}  // namespace cullhull::cli_stream_test
