#include "parser.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <sstream>
#include <type_traits>

namespace app {
// --------------------------------------------------------------------------------- Option

Option* Option::type_name(const std::string& name) {
  option_->type_name(name);
  return this;
}

Option* Option::required() {
  option_->required();
  return this;
}

Option* Option::allow_extra_args(bool several) {
  option_->allow_extra_args(several);
  return this;
}

Option* Option::offers(std::vector<std::string> words) {
  words_ = std::move(words);
  return this;
}

Option& needs_value(Option& option) {
  const auto check = [](const std::string& word) {
    return word.empty() ? std::string("needs a value, not an empty word") : std::string();
  };
  option.option_->check(check);
  return option;
}

void allow_words(Option& option, const std::vector<std::string>& words) {
  std::string joined;
  for (const std::string& word : words) joined += (joined.empty() ? "" : "|") + word;
  option.words_ = words;
  option.option_->type_name(joined)->check(CLI::IsMember(words).description(""));
}

void allow_range(Option& option, std::uint32_t least, std::uint32_t greatest) {
  option.option_->type_name("N")->check(CLI::Range(least, greatest).description(""));
}

void allow_real_range(Option& option, double least, double greatest) {
  // CLI::Range would write its limits with all their digits, up to 309.
  option.option_->check([least, greatest](const std::string& text) {
    double value = 0;
    if (!CLI::detail::lexical_cast(text, value) || std::isnan(value))
      return text + " is not a number";
    if (value >= least && value <= greatest) return std::string();
    return greatest < std::numeric_limits<double>::max()
               ? fmt::format("Value {} not in range {:g} to {:g}", text, least, greatest)
               : fmt::format("Value {} is not a finite number from {:g} on", text, least);
  });
}

// --------------------------------------------------------------------------------- Parser

namespace {

/// Sections of options with one blank line between them. A command's own sections stand between
/// those for input and output and those that several commands share.
class Sections : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    const std::string footer = app->get_footer();  // CLI11 2.4 puts more lines around it
    return make_description(app) + make_usage(app, std::move(name)) + make_positionals(app) +
           sections(app) + make_subcommands(app, mode) + '\n' +
           (footer.empty() ? footer : footer + '\n');
  }

  /// "..." means several values; an option that may be repeated takes one at a time.
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_opts(option);
    constexpr std::string_view several = " ...";
    if (const std::size_t at = text.find(several);
        at != std::string::npos && option->nonpositional() && !option->get_allow_extra_args())
      text.erase(at, several.size());
    return text;
  }

  static std::vector<const CLI::Option*> options_of(const CLI::App* app, const std::string& group) {
    return app->get_options([&](const CLI::Option* option) {
      return option->get_group() == group && option->nonpositional();
    });
  }
  /// Those with options, in the order of the help.
  static std::vector<std::string> groups_of(const CLI::App* app) {
    std::vector<std::string> groups = app->get_groups();
    std::erase_if(groups, [&](const std::string& group) {
      return group.empty() || options_of(app, group).empty();
    });
    std::stable_sort(groups.begin(), groups.end(),
                     [](const auto& a, const auto& b) { return rank(a) < rank(b); });
    return groups;
  }

 private:
  std::string sections(const CLI::App* app) const {
    std::string text;
    for (const std::string& group : groups_of(app))
      text += make_group(group, false, options_of(app, group));
    return text;
  }

  static int rank(std::string_view group) {
    constexpr std::string_view first[] = {"Input", "Output"};
    constexpr std::string_view last[] = {"Filter", "Verification and timing",
                                         "Streaming and partial results", "Limits", "Other"};
    const auto in = [&](const auto& list) {
      return static_cast<int>(std::find(std::begin(list), std::end(list), group) -
                              std::begin(list));
    };
    constexpr int between = 100;
    const int early = in(first), late = in(last);
    if (early < static_cast<int>(std::size(first))) return early;
    return late < static_cast<int>(std::size(last)) ? between + 1 + late : between;
  }
};

}  // namespace

Parser::Parser(const std::string& name, const std::string& description)
    : name_(name), owned_(std::make_unique<CLI::App>(description, name)), app_(owned_.get()) {
  app_->set_help_flag();  // added when all other options are there
  app_->formatter(std::make_shared<Sections>());
  app_->allow_windows_style_options(false);  // a word that begins with / is a file on each system
}

Parser::Parser(Parser& parent, const std::string& name, const std::string& description)
    : name_(name), parent_(&parent), app_(parent.app_->add_subcommand(name, description)) {}

Parser::~Parser() = default;

Parser* Parser::add_subcommand(const std::string& name, const std::string& description) {
  subcommands_.emplace_back(new Parser(*this, name, description));
  return last_subcommand();
}

Parser* Parser::last_subcommand() { return subcommands_.back().get(); }

void Parser::require_subcommand(std::uint32_t least, std::uint32_t most) {
  app_->require_subcommand(least, most);
}

void Parser::group(const std::string& title) { group_ = title; }

void Parser::footer(const std::string& text) { app_->footer(text); }

void Parser::set_version(const std::string& version) {
  app_->set_version_flag("-V,--version", version, "Print the version and exit")->group("Other");
}

void Parser::add_help() {
  app_->set_help_flag("-h,--help", "Print this help and exit")->group("Other");
  for (const auto& subcommand : subcommands_) subcommand->add_help();
}

void Parser::set_licenses(std::string_view text) {
  app_->add_flag_callback(
      "--licenses", [text] { throw CLI::CallForVersion(std::string(text), 0); },
      "Print the licences of cullhull and of the libraries in it");
}

Option* Parser::keep(CLI::Option* option) {
  option->group(group_);
  options_.emplace_back(new Option(option));
  return options_.back().get();
}

namespace {

/// CLI11 takes a sign for the other end of the range, and a leading 0 for octal.
const CLI::Validator& decimal_digits() {
  static const CLI::Validator digits(
      [](std::string& text) {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    if (read.ec == std::errc::result_out_of_range)
      return "'" + text + "' is more than " +
             std::to_string(std::numeric_limits<std::uint64_t>::max());
    if (read.ec != std::errc() || read.ptr != end) return "'" + text + "' is not a whole number";
    text = std::to_string(value);
    return std::string();
      },
      "");
  return digits;
}

}  // namespace

template <class Value>
Option* Parser::add_option(const std::string& names, Value& value, const std::string& description) {
  CLI::Option* const option = app_->add_option(names, value, description);
  if constexpr (std::is_unsigned_v<Value> || std::is_same_v<Value, std::vector<std::uint32_t>>)
    option->transform(decimal_digits());
  return keep(option);
}

template Option* Parser::add_option(const std::string&, std::string&, const std::string&);
template Option* Parser::add_option(const std::string&, std::uint32_t&, const std::string&);
template Option* Parser::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option* Parser::add_option(const std::string&, double&, const std::string&);
template Option* Parser::add_option(const std::string&, std::vector<std::string>&,
                                    const std::string&);
template Option* Parser::add_option(const std::string&, std::vector<std::uint32_t>&,
                                    const std::string&);

Option* Parser::add_flag(const std::string& names, bool& value, const std::string& description) {
  return keep(app_->add_flag(names, value, description));
}

Parsed Parser::parse(const std::vector<std::string>& words) {
  add_help();
  try {
    // CLI11 takes words from the back.
    app_->parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError& error) {
    const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
    if (code == CLI::ExitCodes::ExtrasError) return {Parsed::Kind::unexpected, error.what()};
    if (code != CLI::ExitCodes::Success) {
      std::string why = error.what();
      if (code == CLI::ExitCodes::ArgumentMismatch && why.ends_with(" missing"))
        why = why.substr(0, why.find(':')) + " needs a value";
      return {Parsed::Kind::usage, why};
    }
    std::ostringstream text, unused;
    app_->exit(error, text, unused);
    return {Parsed::Kind::help, text.str()};
  }
  return {};
}

bool Parser::parsed() const { return app_->parsed(); }

const Parser& Parser::innermost() const {
  for (const auto& subcommand : subcommands_)
    if (subcommand->parsed()) return subcommand->innermost();
  return *this;
}

std::vector<std::string> Parser::remaining() const { return app_->remaining(); }

std::string Parser::full_name() const {
  return parent_ == nullptr ? name_ : parent_->full_name() + " " + name_;
}

std::vector<std::string> Parser::command_names() const {
  std::vector<std::string> names;
  for (const auto& subcommand : subcommands_) names.push_back(subcommand->name());
  return names;
}

std::vector<const Parser*> Parser::subcommands() const {
  std::vector<const Parser*> all;
  for (const auto& subcommand : subcommands_) all.push_back(subcommand.get());
  return all;
}

std::string Parser::description() const { return app_->get_description(); }

std::string Parser::footer_text() const { return app_->get_footer(); }

std::string Parser::usage() const {
  constexpr std::string_view mark = "Usage: ";
  // App::help would show that of the command that was named.
  const std::string help = Sections().make_usage(app_, full_name());
  const std::size_t begin = help.find(mark);
  if (begin == std::string::npos) return full_name();
  const std::size_t from = begin + mark.size();
  return help.substr(from, help.find('\n', from) - from);
}

std::vector<std::string> Parser::sections() const { return Sections::groups_of(app_); }

std::vector<OptionText> Parser::option_texts() const {
  const Sections sections;
  std::vector<OptionText> all;
  for (const CLI::Option* option : static_cast<const CLI::App*>(app_)->get_options()) {
    OptionText text;
    text.positional = !option->nonpositional();
    if (text.positional) text.names.push_back(option->get_name(true));
    for (const std::string& name : option->get_snames()) text.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) text.names.push_back("--" + name);
    text.value = sections.make_option_opts(option);
    text.value.erase(0, text.value.find_first_not_of(' '));
    text.about = option->get_description();
    text.section = option->get_group();
    for (const auto& own : options_)
      if (own->option_ == option) text.words = own->words_;
    all.push_back(std::move(text));
  }
  return all;
}

std::vector<std::string> Parser::option_names() const {
  std::vector<std::string> names;
  for (const CLI::Option* option : app_->get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

}  // namespace app
