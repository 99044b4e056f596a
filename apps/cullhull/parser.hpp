// The command line's parser, as the commands see it. What parses is CLI11, whose headers take
// seconds to compile: parser.cpp alone includes them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace app {

/// An option or a positional argument; its functions return it, to be chained.
class Option {
 public:
  /// What the help calls its value: "FILE", "N"; empty for nothing.
  Option* type_name(const std::string& name);
  Option* required();
  /// Whether one mention takes several words; as given, an option of a vector does.
  Option* allow_extra_args(bool several);

 private:
  friend class Parser;
  friend Option& needs_value(Option& option);
  friend void allow_words(Option& option, const std::vector<std::string>& words);
  friend void allow_range(Option& option, std::uint32_t least, std::uint32_t greatest);
  friend void allow_real_range(Option& option, double least, double greatest);

  explicit Option(CLI::Option* option) : option_(option) {}
  CLI::Option* option_;
};

/// Refuses the empty word, which a script gives where its variable is not set.
Option& needs_value(Option& option);

/// Limits an option to some words or to a range, and says so in the help without CLI11's jargon.
void allow_words(Option& option, const std::vector<std::string>& words);
void allow_range(Option& option, std::uint32_t least, std::uint32_t greatest);
void allow_real_range(Option& option, double least, double greatest);

/// How the words were understood.
struct Parsed {
  enum class Kind {
    command,     ///< parsed() of a subcommand tells which
    help,        ///< `text` is to be shown, and nothing is to be run
    usage,       ///< `text` says why the words make no sense
    unexpected,  ///< some words are more than the command takes
  };
  Kind kind = Kind::command;
  std::string text;
};

/// A command and its subcommands. Options write into variables of the caller, which must outlive
/// parse().
class Parser {
 public:
  Parser(const std::string& name, const std::string& description);
  ~Parser();
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  /// Lives as long as this.
  Parser* add_subcommand(const std::string& name, const std::string& description);
  /// The subcommand that was added last.
  Parser* last_subcommand();
  void require_subcommand(std::uint32_t least, std::uint32_t most);
  /// What the help ends with.
  void footer(const std::string& text);
  void set_version(const std::string& version);

  /// `names`: "-o,--output", or one word in capitals for a positional argument.
  template <class Value>
  Option* add_option(const std::string& names, Value& value, const std::string& description);
  Option* add_flag(const std::string& names, bool& value, const std::string& description);

  /// Words as a shell gives them, without the program's name.
  Parsed parse(const std::vector<std::string>& words);

  // Valid after parse():
  bool parsed() const;
  /// The innermost subcommand that was named.
  const Parser& innermost() const;
  /// Words that nothing took.
  std::vector<std::string> remaining() const;

  const std::string& name() const { return name_; }
  /// With the names of the commands around it: "cullhull bench rivals".
  std::string full_name() const;
  std::vector<std::string> command_names() const;
  /// "--output", "-o", ...
  std::vector<std::string> option_names() const;

 private:
  Parser(Parser& parent, const std::string& name, const std::string& description);
  Option* keep(CLI::Option* option);

  std::string name_;
  Parser* parent_ = nullptr;
  std::unique_ptr<CLI::App> owned_;  ///< of the outermost parser
  CLI::App* app_;
  std::vector<std::unique_ptr<Parser>> subcommands_;
  std::vector<std::unique_ptr<Option>> options_;
};

// The types an option may have.
extern template Option* Parser::add_option(const std::string&, std::string&, const std::string&);
extern template Option* Parser::add_option(const std::string&, std::uint32_t&, const std::string&);
extern template Option* Parser::add_option(const std::string&, std::uint64_t&, const std::string&);
extern template Option* Parser::add_option(const std::string&, double&, const std::string&);
extern template Option* Parser::add_option(const std::string&, std::vector<std::string>&,
                                           const std::string&);
extern template Option* Parser::add_option(const std::string&, std::vector<std::uint32_t>&,
                                           const std::string&);

}  // namespace app
