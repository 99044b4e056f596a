// cullhull completion, cullhull man: what a shell and man know of the program, from any artifact.
#include <filesystem>
#include <memory>

#include "commands.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "pages.hpp"
#include "parallel/paths.hpp"
#include "terminal.hpp"
#include "topics.hpp"
#include "words.hpp"

namespace app {
namespace {

using cullhull::Error;
using cullhull::ErrorCode;

constexpr const char* completion_footer =
    "Where the script has its place for your user; a new shell then completes commands, options,\n"
    "their values and files:\n"
    "  bash    ~/.local/share/bash-completion/completions/cullhull\n"
    "  fish    ~/.config/fish/completions/cullhull.fish\n"
    "  zsh     the file _cullhull in a folder of $fpath; or, in ~/.zshrc after compinit,\n"
    "          source <(cullhull completion zsh)\n"
    "\n"
    "Examples:\n"
    "  source <(cullhull completion bash)          for this shell alone\n"
    "  mkdir -p ~/.config/fish/completions\n"
    "  cullhull completion fish > ~/.config/fish/completions/cullhull.fish\n"
    "\n"
    "Exit status: 0 success; 1 system error; 2 bad usage.";

constexpr const char* man_footer =
    "Pages are in the language of man (roff). Without --folder one page goes to standard output.\n"
    "\n"
    "Examples:\n"
    "  cullhull man hull | man -l -                       read the page of a command\n"
    "  cullhull man --folder ~/.local/share/man           install all pages for your user\n"
    "\n"
    "Exit status: 0 success; 1 system error; 2 bad usage.";

void write_pages(const Parser& program, const std::string& folder) {
  for (const ManPage& page : man_pages(program, topics())) {
    const std::filesystem::path place =
        cullhull::internal::native_path(folder) / (std::string("man") + page.section);
    std::error_code failed;
    std::filesystem::create_directories(place, failed);
    if (failed)
      throw Error(ErrorCode::io, cullhull::internal::utf8_name(place), ": ", failed.message());
    cullhull::write_text(cullhull::internal::utf8_name(place / (page.name + "." + page.section)),
                         page.text);
  }
}

int run_man(const Parser& program, const std::string& name, const std::string& folder) {
  if (!folder.empty()) {
    if (!name.empty())
      throw Error(ErrorCode::invalid_argument, "--folder writes all pages; leave '", name, "' out");
    write_pages(program, folder);
    return 0;
  }
  const std::string wanted = name.empty() ? program.name() : program.name() + "-" + name;
  for (const ManPage& page : man_pages(program, topics()))
    if (page.name == wanted) {
      write_stdout(page.text);
      return 0;
    }
  std::vector<std::string> known = program.command_names();
  for (const Topic& topic : topics()) known.emplace_back(topic.name);
  throw Error(ErrorCode::invalid_argument, unknown_topic(name, known, program));
}

}  // namespace

Command add_completion(Parser& parent) {
  auto shell = std::make_shared<std::string>();
  Parser& command = *parent.add_subcommand(
      "completion", "Print a script that completes cullhull's words in a shell");
  allow_words(*command.add_option("SHELL", *shell, "The shell")->required(),
              {"bash", "zsh", "fish"});
  command.footer(completion_footer);
  return [shell, &parent] {
    write_stdout(completion_script(parent, topics(), *shell));
    return 0;
  };
}

Command add_man(Parser& parent) {
  struct Arguments {
    std::string name, folder;
  };
  auto a = std::make_shared<Arguments>();
  Parser& command = *parent.add_subcommand("man", "Print man pages, or write them to a folder");
  command
      .add_option("NAME", a->name,
                  "A command or a topic of 'cullhull help'; default: the program's\nown page")
      ->type_name("");
  command.group("Output");
  needs_value(
      *command.add_option("--folder", a->folder, "Write all pages to FOLDER/man1 and FOLDER/man7"))
      .type_name("FOLDER");
  command.footer(man_footer);
  return [a, &parent] { return run_man(parent, a->name, a->folder); };
}

}  // namespace app
