// The command line parser's interface for the commands. It is implemented by CLI11, whose headers
// take seconds to compile: only parser.cpp includes them.
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

/// What help, man pages and shells know of an option.
struct OptionText {
  std::vector<std::string> names;  ///< "-o", "--output"; of a positional argument "SHAPE"
  std::string value;               ///< the name of its value; empty for a flag
  std::string about;               ///< may have several lines
  std::string section;             ///< "Output"
  std::vector<std::string> words;  ///< the values it takes, where they are few words
  bool positional = false;
};

/// An option or a positional argument; its functions return it, to be chained.
class Option {
 public:
  /// The name of its value in the help: "FILE", "N"; empty if it takes no value.
  Option* type_name(const std::string& name);
  Option* required();
  /// Whether one mention takes several words; the default for options of vectors.
  Option* allow_extra_args(bool several);
  /// Words that a shell offers as values.
  Option* offers(std::vector<std::string> words);

 private:
  friend class Parser;
  friend Option& needs_value(Option& option);
  friend void allow_words(Option& option, const std::vector<std::string>& words);
  friend void allow_range(Option& option, std::uint32_t least, std::uint32_t greatest);
  friend void allow_real_range(Option& option, double least, double greatest);

  explicit Option(CLI::Option* option) : option_(option) {}
  CLI::Option* option_;
  std::vector<std::string> words_;
};

/// Refuses the empty word, as scripts pass for variables that are not set.
Option& needs_value(Option& option);

/// Limits an option to some words or to a range, and lists them in the help.
void allow_words(Option& option, const std::vector<std::string>& words);
void allow_range(Option& option, std::uint32_t least, std::uint32_t greatest);
void allow_real_range(Option& option, double least, double greatest);

/// The outcome of parsing.
struct Parsed {
  enum class Kind {
    command,     ///< parsed() returns which subcommand
    help,        ///< show `text`, run nothing
    usage,       ///< `text` describes the error
    unexpected,  ///< words that the command does not take
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

  /// Valid as long as this object.
  Parser* add_subcommand(const std::string& name, const std::string& description);
  /// The subcommand that was added last.
  Parser* last_subcommand();
  void require_subcommand(std::uint32_t least, std::uint32_t most);
  /// The section of the help that lists the options added from here on: "Output".
  void group(const std::string& title);
  /// The end of the help text.
  void footer(const std::string& text);
  void set_version(const std::string& version);
  void set_licenses(std::string_view text);

  /// `names`: "-o,--output", or one word in capitals for a positional argument.
  template <class Value>
  Option* add_option(const std::string& names, Value& value, const std::string& description);
  Option* add_flag(const std::string& names, bool& value, const std::string& description);

  /// Words as from a shell, without the program's name.
  Parsed parse(const std::vector<std::string>& words);

  // Valid after parse():
  bool parsed() const;
  /// The innermost subcommand that was named.
  const Parser& innermost() const;
  /// The words that no option took.
  std::vector<std::string> remaining() const;

  const std::string& name() const { return name_; }
  /// With the names of the commands around it: "cullhull-bench rivals".
  std::string full_name() const;
  std::vector<std::string> command_names() const;
  std::vector<const Parser*> subcommands() const;
  std::string description() const;
  std::string footer_text() const;
  /// "cullhull hull [OPTIONS] INPUT..."
  std::string usage() const;
  /// Titles of the sections of options, in the order of the help; and all options, in their order.
  std::vector<std::string> sections() const;
  std::vector<OptionText> option_texts() const;
  /// "--output", "-o", ...
  std::vector<std::string> option_names() const;

 private:
  Parser(Parser& parent, const std::string& name, const std::string& description);
  Option* keep(CLI::Option* option);
  /// The last options of a command and of its subcommands.
  void add_help();

  std::string name_;
  std::string group_ = "Options";
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
