#include "base/command.hpp"

#include "base/words.hpp"

namespace tchat {

Command words_of(std::initializer_list<Command> parts) {
  Command all;
  for (const Command& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::string shell_words(const Command& words) {
  std::string text;
  for (const std::string& word : words) text += " " + quoted_for_shell(word);
  return text;
}

std::string shell_line(const Command& command) { return "tchat" + shell_words(command); }

std::string shell_line(const Commands& commands) {
  std::string text;
  for (const Command& command : commands) text += (text.empty() ? "" : " && ") + shell_line(command);
  return text;
}

}  // namespace tchat
