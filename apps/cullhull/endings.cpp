#include "endings.hpp"

#include <exception>
#include <new>
#include <utility>

#include "commands.hpp"
#include "cullhull/error.hpp"
#include "terminal.hpp"
#include "words.hpp"

namespace app {
namespace {

int exit_status(cullhull::ErrorCode code) {
  switch (code) {
    case cullhull::ErrorCode::invalid_argument:
      return bad_usage;
    case cullhull::ErrorCode::not_finite:
    case cullhull::ErrorCode::bad_file:
    case cullhull::ErrorCode::io:
      return bad_input;
    case cullhull::ErrorCode::out_of_budget:
      return over_budget;
    case cullhull::ErrorCode::backend_unavailable:
      return no_backend;
    case cullhull::ErrorCode::cancelled:
      return cancelled;
    case cullhull::ErrorCode::not_exact:
    case cullhull::ErrorCode::internal:
      return not_certified;
  }
  return bad_input;
}

/// Adds the budget as it was given, since the library's message has it in MiB.
std::string with_memory(std::string message, const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].starts_with("--memory=")) return message + " (" + words[i] + ")";
    if (words[i] == "--memory" && i + 1 < words.size())
      return message + " (--memory " + words[i + 1] + ")";
  }
  return message;
}

/// Names the option that leaves out points with a NaN, which all commands have that read points but
/// for the one that takes Qhull's words.
std::string with_skip_nan(std::string message, const std::vector<std::string>& words) {
  constexpr std::string_view advice = " is NaN; remove or repair such points first";
  const std::size_t at = message.find(advice);
  if (at == std::string::npos || (!words.empty() && words[0] == "qconvex")) return message;
  return message.replace(at, advice.size(), " is NaN; --skip-nan leaves such points out");
}

/// Explains a file that is not there where the words before it make it one by mistake: `--json
/// FILE` and `--columns x y`.
std::string with_hint(std::string message, const std::vector<std::string>& words) {
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (!message.starts_with(words[i] + ": cannot open")) continue;
    if (words[i - 1] == "--json") return message + " (--json=" + words[i] + " writes it)";
    if (i > 1 && words[i - 2] == "--columns")
      return message + " (--columns " + words[i - 1] + "," + words[i] + " takes both columns)";
  }
  return message;
}

}  // namespace

std::string usage_line(const Parsed& outcome, const std::vector<std::string>& given,
                       const std::vector<std::string>& words, const Parser& parser) {
  const Parser& command = parser.innermost();
  std::string why = outcome.text;
  if (outcome.kind == Parsed::Kind::unexpected && !words.empty())
    why = unexpected_words({words.begin() + 1, words.end()}, command);
  return with_arguments_cut(why + " (see " + command.full_name() + " --help)", given);
}

Ending ending_of_exception(const std::vector<std::string>& words) {
  try {
    throw;
  } catch (const cullhull::Error& e) {
    std::string message = e.what();
    if (e.code() == cullhull::ErrorCode::out_of_budget)
      message = with_memory(std::move(message), words);
    if (e.code() == cullhull::ErrorCode::not_finite)
      message = with_skip_nan(std::move(message), words);
    if (e.code() == cullhull::ErrorCode::io) message = with_hint(std::move(message), words);
    return {exit_status(e.code()), with_arguments_cut(std::move(message), words)};
  } catch (const std::bad_alloc&) {
    return {over_budget, out_of_memory};
  } catch (const std::exception& e) {
    return {bad_input, with_arguments_cut(e.what(), words)};
  }
}

}  // namespace app
