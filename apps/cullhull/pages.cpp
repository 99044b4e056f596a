#include "pages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>

#include "cullhull/version.hpp"

namespace app {
namespace {

using Words = std::vector<std::string>;

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

std::string in_one_line(const std::string& text) { return replaced(text, "\n", " "); }

bool takes_file(const OptionText& option) {
  for (const char* word : {"FILE", "FOLDER", "PAGE", "IDS", "OUT"})
    if (option.value.find(word) != std::string::npos) return true;
  return false;
}

/// A value of its own word: --json=FILE takes none.
bool needs_value(const OptionText& option) {
  return !option.value.empty() && !option.value.starts_with("[=");
}

std::vector<OptionText> options_of(const Parser& command, bool positional) {
  std::vector<OptionText> found;
  for (const OptionText& option : command.option_texts())
    if (option.positional == positional) found.push_back(option);
  return found;
}

/// The program and its commands, and their commands.
void add_commands(const Parser& command, std::vector<const Parser*>& all) {
  all.push_back(&command);
  for (const Parser* sub : command.subcommands()) add_commands(*sub, all);
}

std::vector<const Parser*> commands_of(const Parser& program) {
  std::vector<const Parser*> all;
  add_commands(program, all);
  return all;
}

/// "hull" of "cullhull hull"; empty for the program.
std::string path_of(const Parser& command) {
  const std::string name = command.full_name();
  const std::size_t blank = name.find(' ');
  return blank == std::string::npos ? "" : name.substr(blank + 1);
}

Words help_words(const Parser& program, const std::vector<Topic>& topics) {
  Words words = program.command_names();
  for (const Topic& topic : topics) words.emplace_back(topic.name);
  return words;
}

// ------------------------------------------------------------------------------- man pages

std::string roff(const std::string& text) {
  std::string out = replaced(text, "\\", "\\e");
  out = replaced(replaced(out, "-", "\\-"), "'", "\\(aq");
  if (out.starts_with('.')) out.insert(0, "\\&");
  return replaced(out, "\n.", "\n\\&.");
}

struct Footer {
  std::string notes, examples, status;
};

Footer parts_of(const std::string& text) {
  Footer parts;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find("\n\n"), rest.size());
    std::string block(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 2, rest.size()));
    std::string* to = &parts.notes;
    for (const auto& [begin, part] :
         {std::pair{"Examples:\n", &parts.examples}, std::pair{"Exit status: ", &parts.status}})
      if (block.starts_with(begin)) {
        block.erase(0, std::strlen(begin));
        to = part;
      }
    if (block.starts_with("Topics:\n")) continue;  // they have a section of their own
    if (!to->empty()) *to += "\n\n";
    while (block.ends_with('\n')) block.pop_back();
    *to += block;
  }
  return parts;
}

/// Terms and their texts, each of which has a page of its own.
void add_listed(std::string& out, const std::string& title, const std::string& parent,
                const std::vector<std::pair<std::string, std::string>>& listed, char section) {
  if (listed.empty()) return;
  out += ".SH " + title + "\n";
  for (const auto& [name, about] : listed)
    out += fmt::format(".TP\n\\fB{}\\fR\n{} (\\fB{}\\fR({}))\n", roff(name), roff(about),
                       roff(parent + "-" + name), section);
}

void add_options(std::string& out, const std::vector<OptionText>& options) {
  for (const OptionText& option : options) {
    std::string names;
    for (const std::string& name : option.names)
      names += (names.empty() ? "" : ", ") + ("\\fB" + roff(name) + "\\fR");
    // A line may end behind each bar: "npy|ply|..." is longer than one.
    if (!option.value.empty()) names += " " + replaced(roff(option.value), "|", "|\\:");
    out += ".TP\n" + names + "\n" + roff(in_one_line(option.about)) + "\n";
  }
}

std::string upper(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string command_page(const Parser& command, const Parser& program,
                         const std::vector<Topic>& topics) {
  const std::string page = replaced(command.full_name(), " ", "-");
  const std::string own = command.description();
  std::string first = own.substr(0, own.find('\n'));
  const std::string prefix = program.name() + ": ";
  if (first.starts_with(prefix)) first.erase(0, prefix.size());
  if (first.ends_with('.')) first.pop_back();
  if (!first.empty())
    first[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(first[0])));
  std::string out = fmt::format(
      ".TH \"{}\" 1 \"\" \"{} {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n{}\n"
      ".SH DESCRIPTION\n{}\n",
      upper(page), program.name(), CULLHULL_VERSION, roff(page), roff(first), roff(command.usage()),
      roff(own));
  if (const auto arguments = options_of(command, true); !arguments.empty()) {
    out += ".SH ARGUMENTS\n";
    add_options(out, arguments);
  }
  out += ".SH OPTIONS\n";
  const auto options = options_of(command, false);
  for (const std::string& section : command.sections()) {
    out += ".SS " + section + "\n";
    std::vector<OptionText> some;
    for (const OptionText& option : options)
      if (option.section == section) some.push_back(option);
    add_options(out, some);
  }
  std::vector<std::pair<std::string, std::string>> listed;
  for (const Parser* sub : command.subcommands())
    listed.emplace_back(sub->name(), in_one_line(sub->description()));
  add_listed(out, "COMMANDS", page, listed, '1');
  listed.clear();
  if (&command == &program)
    for (const Topic& topic : topics) listed.emplace_back(topic.name, topic.about);
  add_listed(out, "TOPICS", page, listed, '7');
  const Footer end = parts_of(command.footer_text());
  if (!end.notes.empty()) out += ".SH NOTES\n.nf\n" + roff(end.notes) + "\n.fi\n";
  if (!end.examples.empty()) out += ".SH EXAMPLES\n.nf\n" + roff(end.examples) + "\n.fi\n";
  if (!end.status.empty()) out += ".SH EXIT STATUS\n" + roff(end.status) + "\n";
  if (&command == &program) return out;
  out += ".SH SEE ALSO\n\\fB" + roff(program.name()) + "\\fR(1)";
  for (const Topic& topic : topics)
    out += ",\n\\fB" + roff(program.name() + "-" + topic.name) + "\\fR(7)";
  return out + "\n";
}

std::string topic_page(const Topic& topic, const std::string& program) {
  const std::string page = program + "-" + topic.name;
  std::string about = topic.about;
  about[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(about[0])));
  return fmt::format(
      ".TH \"{}\" 7 \"\" \"{} {}\" \"Miscellaneous\"\n.SH NAME\n{} \\- {}\n.SH DESCRIPTION\n.nf\n"
      "{}\n.fi\n.SH SEE ALSO\n\\fB{}\\fR(1)\n",
      upper(page), program, CULLHULL_VERSION, roff(page), roff(about), roff(topic.text),
      roff(program));
}

// ------------------------------------------------------------------------------- completions

std::string joined(const Words& words) { return fmt::format("{}", fmt::join(words, " ")); }

/// The cases of bash's script: "PATH OPTION" or "PATH" and what is offered there.
struct BashCases {
  std::string options, values, arguments;
  Words files, others, paths;

  explicit BashCases(const Parser& program) {
    for (const Parser* command : commands_of(program)) {
      const std::string path = path_of(*command);
      if (!path.empty()) paths.push_back("\"" + path + "\"");
      Words names;
      for (const OptionText& option : options_of(*command, false)) {
        Words patterns;
        for (const std::string& name : option.names) {
          names.push_back(name);
          patterns.push_back("\"" + path + " " + name + "\"");
        }
        const std::string pattern = fmt::format("{}", fmt::join(patterns, "|"));
        if (!option.words.empty())
          values += fmt::format("    {}) words=\"{}\" ;;\n", pattern, joined(option.words));
        else if (needs_value(option))
          (takes_file(option) ? files : others).push_back(pattern);
      }
      options += fmt::format("      \"{}\") known=\"{}\" ;;\n", path, joined(names));
      Words first = command->command_names();
      if (!first.empty()) first.emplace_back("help");
      for (const OptionText& argument : options_of(*command, true))
        first.insert(first.end(), argument.words.begin(), argument.words.end());
      if (!first.empty())
        arguments += fmt::format("    \"{}\") words=\"{}\" ;;\n", path, joined(first));
    }
  }
};

/// Values of an option, or files where it takes one; options after a dash; else commands, the
/// values of an argument, and files.
std::string bash_script(const Parser& program, const std::vector<Topic>& topics) {
  const BashCases cases(program);
  return fmt::format(
      R"(# bash completion of {0}
_{1}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
  local path="" known="" words="" prefix="" i
  # --cull=g is one word, or the three words --cull, = and g.
  if [[ $word == "=" ]]; then
    word=""
  elif [[ $before == "=" ]]; then
    before=${{COMP_WORDS[COMP_CWORD-2]}}
  elif [[ $word == --*=* ]]; then
    before=${{word%%=*}} prefix=${{word%%=*}}= word=${{word#*=}}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "${{path:+$path }}${{COMP_WORDS[i]}}" in
    {2}|"help") path="${{path:+$path }}${{COMP_WORDS[i]}}" ;;
    esac
  done
  # A file in the place of a command means the hull of this file.
  if [[ -z $path && $COMP_CWORD -gt 1 && ${{COMP_WORDS[1]}} != -* ]]; then path=hull; fi
  case "$path $before" in
{3}    {4})
      mapfile -t COMPREPLY < <(compgen -P "$prefix" -f -- "$word")
      return
      ;;
    {5})
      COMPREPLY=()
      return
      ;;
  esac
  if [[ -n $words ]]; then
    mapfile -t COMPREPLY < <(compgen -P "$prefix" -W "$words" -- "$word")
    return
  fi
  if [[ $word == -* ]]; then
    case "$path" in
{6}    esac
    mapfile -t COMPREPLY < <(compgen -W "$known" -- "$word")
    return
  fi
  case "$path" in
{7}    "help") words="{8}" ;;
  esac
  mapfile -t COMPREPLY < <(
    [[ -z $words ]] || compgen -W "$words" -- "$word"
    [[ $path == help ]] || compgen -f -- "$word"
  )
}}
complete -o filenames -o nosort -F _{1} {0}
)",
      program.name(), replaced(program.name(), "-", "_"), fmt::join(cases.paths, "|"), cases.values,
      fmt::join(cases.files, "|"), fmt::join(cases.others, "|"), cases.options, cases.arguments,
      joined(help_words(program, topics)));
}

std::string quoted(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

std::string fish_quoted(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

/// What follows `complete -c PROGRAM -n WHEN` for an option.
std::string fish_option(const OptionText& option) {
  std::string out;
  for (const std::string& name : option.names)
    out += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  if (!option.words.empty())
    out += " -x -a " + fish_quoted(joined(option.words));
  else if (needs_value(option))
    out += takes_file(option) ? " -r -F" : " -x";
  return out + " -d " + fish_quoted(in_one_line(option.about));
}

std::string fish_script(const Parser& program, const std::vector<Topic>& topics) {
  std::string out = "# fish completion of " + program.name() + "\n";
  const auto add = [&](const std::string& when, const std::string& what) {
    out += "complete -c " + program.name() + " -n " + fish_quoted(when) + " " + what + "\n";
  };
  for (const Parser* command : commands_of(program)) {
    const std::string path = path_of(*command);
    if (path.find(' ') != std::string::npos) continue;
    const std::string when =
        path.empty() ? "__fish_use_subcommand" : "__fish_seen_subcommand_from " + path;
    for (const Parser* sub : command->subcommands())
      add(when, "-a " + sub->name() + " -d " + fish_quoted(in_one_line(sub->description())));
    if (path.empty()) {
      add(when, "-a help -d " + fish_quoted("Help of a command or a topic"));
      add("__fish_seen_subcommand_from help",
          "-x -a " + fish_quoted(joined(help_words(program, topics))));
    }
    for (const OptionText& argument : options_of(*command, true))
      if (!argument.words.empty())
        add(when, "-a " + fish_quoted(joined(argument.words)) + " -d " +
                      fish_quoted(in_one_line(argument.about)));
    for (const OptionText& option : options_of(*command, false)) add(when, fish_option(option));
  }
  return replaced(out, "'  -", "' -");
}

std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : in_one_line(text)) {
    if (std::strchr("[]:", c) != nullptr) out += '\\';
    out += c;
  }
  return out;
}

Words zsh_specs(const Parser& command) {
  Words specs;
  for (const OptionText& option : options_of(command, false)) {
    std::string action;
    if (!option.words.empty())
      action = ":value:(" + joined(option.words) + ")";
    else if (needs_value(option))
      action = ":" + zsh_text(option.value.substr(0, option.value.find(' '))) + ":" +
               (takes_file(option) ? "_files" : "");
    for (const std::string& name : option.names)
      specs.push_back(quoted("*" + name + (name.starts_with("--") && !action.empty() ? "=" : "") +
                             "[" + zsh_text(option.about) + "]" + action));
  }
  for (const OptionText& argument : options_of(command, true))
    if (!argument.words.empty()) {
      std::string name = argument.names[0];
      for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      specs.push_back(quoted("1:" + name + ":(" + joined(argument.words) + ")"));
    }
  specs.emplace_back("'*:file:_files'");
  return specs;
}

std::string zsh_script(const Parser& program, const std::vector<Topic>& topics) {
  const std::string own = "_" + replaced(program.name(), "-", "_");
  std::string functions, listed, cases;
  for (const Parser* command : commands_of(program)) {
    const std::string path = path_of(*command);
    if (path.empty() || path.find(' ') != std::string::npos) continue;
    const std::string function = own + "_" + replaced(path, "-", "_");
    functions += fmt::format("{}() {{\n  _arguments -s \\\n    {}\n}}\n\n", function,
                             fmt::join(zsh_specs(*command), " \\\n    "));
    listed += "    " + quoted(path + ":" + zsh_text(command->description())) + "\n";
    cases += "    " + path + ") " + function + " ;;\n";
  }
  return fmt::format(
      R"(#compdef {0}
# zsh completion of {0}

{2}{1}() {{
  local -a commands=(
{3}  )
  if ((CURRENT == 2)); then
    _describe command commands
    _files
    return
  fi
  local command=$words[2]
  shift words
  ((CURRENT--))
  case $command in
{4}    help) _arguments '1:topic:({5})' ;;
    *) _files ;;
  esac
}}

if [[ $funcstack[1] == {1} ]]; then
  {1} "$@"
else
  compdef {1} {0}
fi
)",
      program.name(), own, functions, listed, cases, joined(help_words(program, topics)));
}

}  // namespace

std::string completion_script(const Parser& program, const std::vector<Topic>& topics,
                              const std::string& shell) {
  if (shell == "bash") return bash_script(program, topics);
  return shell == "zsh" ? zsh_script(program, topics) : fish_script(program, topics);
}

std::vector<ManPage> man_pages(const Parser& program, const std::vector<Topic>& topics) {
  std::vector<ManPage> pages;
  for (const Parser* command : commands_of(program))
    pages.push_back(
        {replaced(command->full_name(), " ", "-"), '1', command_page(*command, program, topics)});
  for (const Topic& topic : topics)
    pages.push_back({program.name() + "-" + topic.name, '7', topic_page(topic, program.name())});
  return pages;
}

}  // namespace app
