// Preprocessing of the command line: short forms, suggestions, and how much of it a message
// repeats.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "parser.hpp"

namespace app {

bool is_command(const Parser& parser, const std::string& word);

/// The words as the parser takes them: `--json` alone gets its value, `help COMMAND` becomes
/// `COMMAND --help`, and a file in the place of a command becomes `hull FILE` if there is that
/// command.
std::vector<std::string> spell_out(const std::vector<std::string>& words, const Parser& parser);

/// The message for a second name after -o, which would be taken for one more input: `hull a.npy -o
/// a.ply b.ply`. Empty for other command lines. Inputs after -o FILE are accepted where none stands
/// before it.
std::string second_output(const std::vector<std::string>& words);

/// The known word nearest to a mistyped one; empty if no word is near.
std::string nearest(std::string_view word, const std::vector<std::string>& known);

/// The message for a first word that is neither a command nor a file.
std::string unknown_command(const std::string& word, const Parser& parser);

/// The message for `help WORD` where `known`, commands and topics, do not have the word.
std::string unknown_topic(const std::string& word, const std::vector<std::string>& known,
                          const Parser& parser);

/// The message for words that `command` does not take: which, and what may have been meant. `words`
/// are the whole command line.
std::string unexpected_words(const std::vector<std::string>& words, const Parser& command);

/// `message` without the advice (a part behind ";" or ", or") to use an option that the command
/// lacks: readers and engines, which serve all commands, name the options that most of them have.
std::string without_foreign_options(const std::string& message, const Parser& command);

/// `message` with every argument longer than some 200 characters shortened in the middle.
std::string with_arguments_cut(std::string message, const std::vector<std::string>& arguments);

}  // namespace app
