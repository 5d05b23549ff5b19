#include "plugin/compiler.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <future>
#include <sstream>

#include "base/messages.hpp"
#include "base/words.hpp"
#include "plugin/build_stamp.hpp"
#include "plugin/compiler_process.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

/// The program that `word` would start, searched along PATH; empty when there is none.
std::string find_program(const std::string& word) {
  std::error_code failed;
  if (word.find('/') != std::string::npos) return access(word.c_str(), X_OK) == 0 ? word : "";
  std::istringstream folders(environment("PATH"));
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string path = folder + "/" + word;
    if (fs::is_regular_file(path, failed) && access(path.c_str(), X_OK) == 0) return path;
  }
  return "";
}

/// The first lines of a compiler's output: one mistake in a template can give hundreds.
std::string first_lines(const std::string& text, int count) {
  std::size_t end = 0;
  for (int line = 0; line < count && end != std::string::npos; ++line) end = text.find('\n', end == 0 ? 0 : end + 1);
  if (end == std::string::npos || end + 1 >= text.size()) return text;
  return text.substr(0, end + 1) + "[the rest of the compiler's output is left out]\n";
}

/// What differs between the two compilers in messages.
struct CompilerWords {
  const char* language;
  const char* variable;  // of the environment that names another one
  const char* usual;     // its command
  const char* package;   // of Debian
};

const CompilerWords& words_of(Language language) {
  static constexpr CompilerWords cpp = {"C++", "CXX", "c++", "g++"};
  static constexpr CompilerWords fortran = {"Fortran", "FC", "gfortran", "gfortran"};
  return language == Language::fortran ? fortran : cpp;
}

[[noreturn]] void refuse_missing_compiler(Language language, const std::string& command, const std::string& source,
                                          int error) {
  const CompilerWords& words = words_of(language);
  throw UserError(
      fmt::format("no {} compiler to compile {}: '{}' cannot be started ({}).\n"
                  "  Install one (Debian: apt install {}), or name yours in the environment variable {}, or compile "
                  "the plugin on another computer and give the .so file.",
                  words.language, source, command, std::strerror(error), words.package, words.variable));
}

/// A command that shows all that the compiler says; what was compiled to is gone.
std::string whole_text_command(const std::vector<std::string>& command, const Compilation& what) {
  return fmt::format("{} -std=c++20 -fsyntax-only -I{} {}", fmt::join(command, " "), what.include_folder, what.source);
}

void require_success(const ProcessResult& result, const std::vector<std::string>& compiler, const Compilation& what,
                     Language language) {
  if (WIFEXITED(result.status) && WEXITSTATUS(result.status) == 0) return;
  if (const std::string errors =
          language == Language::cpp ? short_errors(result.output, what.include_folder) : std::string();
      !errors.empty())
    throw UserError(fmt::format("{}  All that the compiler says: {}", errors, whole_text_command(compiler, what)));
  const std::string ending = WIFSIGNALED(result.status)
                                 ? fmt::format("it was ended by signal {}", WTERMSIG(result.status))
                                 : fmt::format("exit status {}", WEXITSTATUS(result.status));
  throw UserError(fmt::format("the compiler {} refused {} ({}). It says:\n\n{}", fmt::join(compiler, " "), what.source,
                              ending, first_lines(result.output, 60)));
}

/// -fno-gnu-unique keeps a reloaded plugin from sharing its statics with an earlier one; only g++ knows it.
bool is_clang(const std::vector<std::string>& command) {
  std::vector<std::string> words = command;
  words.emplace_back("--version");
  return run_process(words).output.find("clang") != std::string::npos;
}

bool has_interface(const std::string& folder) {
  std::error_code failed;
  return !folder.empty() && fs::exists(folder + "/tchat/problem.hpp", failed);
}

}  // namespace

Compiler::Compiler(const PluginBuildOptions& options, Language language) : language_(language) {
  const CompilerWords& words = words_of(language);
  const std::string& given = language == Language::fortran ? options.fortran_compiler : options.compiler;
  for (const std::string& command : {given, environment(words.variable), std::string(words.usual)}) {
    const std::vector<std::string_view> parts = split_words(command);
    command_.assign(parts.begin(), parts.end());
    if (!command_.empty()) return;
  }
}

std::string Compiler::identity() const {
  if (find_program(command_[0]).empty()) return "";
  std::string text;
  for (const std::string& word : command_) {
    text += word + "\n";
    const std::string program = word[0] == '-' ? "" : find_program(word);
    if (program.empty()) continue;
    std::error_code failed;
    const fs::path file = fs::canonical(program, failed);
    text += fmt::format("{} {} {}\n", file.string(), fs::file_size(file, failed),
                        fs::last_write_time(file, failed).time_since_epoch().count());
  }
  return text + instructions();
}

/// The option for this processor's instructions, unless the command says which ones there are.
std::string Compiler::instructions() const {
  const auto says = [](const std::string& word) { return word.starts_with("-march=") || word.starts_with("-mno-avx"); };
  const bool said = std::any_of(command_.begin(), command_.end(), says);
  return said || language_ == Language::fortran ? "" : std::string(instruction_option());
}

/// The options that a plugin and the precompiled header must have in common.
std::vector<std::string> Compiler::options(const Compilation& what, bool is_gnu) const {
  std::vector<std::string> words = command_;
  for (const char* word : {"-O2", "-fPIC"}) words.emplace_back(word);
  // Lines of fixed form may be longer than 72 columns: cutting them there would be a silent mistake.
  if (language_ == Language::fortran) {
    for (const std::string& word :
         {std::string("-std=legacy"), std::string("-ffixed-line-length-none"), "-J" + what.scratch_folder,
          "-I" + what.include_folder + "/tchat", "-I" + what.scratch_folder})
      words.push_back(word);
    return words;
  }
  // Loops over derivatives take a third of the time that they take with -O2.
  for (const std::string& word :
       {std::string("-O3"), std::string("-std=c++20"), std::string("-fvisibility=hidden"), "-I" + what.include_folder})
    words.push_back(word);
  // Formulas of hundreds of states make g++ look for partial redundancies for minutes, and it finds next to none.
  if (is_gnu) words.insert(words.end(), {"-fno-gnu-unique", "-mtune=native", "-fno-tree-pre"});
  return words;
}

ProcessResult Compiler::compile_with(std::vector<std::string> words, const Compilation& what,
                                     const std::vector<std::string>& precompiled) const {
  words.insert(words.end(), precompiled.begin(), precompiled.end());
  if (language_ != Language::fortran) words.insert(words.end(), {"-MMD", "-MF", what.dependencies});
  words.insert(words.end(), {"-shared", "-o", what.library, what.source});
  return run_process(words);
}

void Compiler::compile(const Compilation& what) const {
  const bool is_gnu = language_ != Language::fortran && !is_clang(command_);
  const std::vector<std::string> words = options(what, is_gnu);
  // Four numbers in a register; products and sums are still rounded one by one. A problem that cannot be compiled so
  // (its own functions may be for numbers one by one) is compiled without.
  std::vector<std::string> with_instructions = words;
  if (const std::string option = instructions(); !option.empty()) with_instructions.push_back(option);
  const PrecompiledHeader header(is_gnu ? identity() : "", with_instructions, what.include_folder);
  const std::vector<std::string> precompiled = header.options_for(what.source);
  std::future<void> for_later;
  if (precompiled.empty()) for_later = std::async(std::launch::async, [&header] { header.make(); });
  ProcessResult result = compile_with(with_instructions, what, precompiled);
  // Without it once more: a mistake is told as if there were none, and a broken one is in nobody's way.
  if (!precompiled.empty() && result.status != 0) {
    if (result.output.find("internal compiler error") != std::string::npos) header.remove();
    result = compile_with(with_instructions, what, {});
  }
  const bool failed = result.spawn_error != 0 || result.status != 0;
  if (failed && with_instructions.size() > words.size()) result = compile_with(words, what, {});
  if (result.spawn_error != 0) refuse_missing_compiler(language_, command_[0], what.source, result.spawn_error);
  require_success(result, command_, what, language_);
}

std::string find_include_folder(const PluginBuildOptions& options) {
  const std::string wanted = !options.include_folder.empty() ? options.include_folder : environment("TCHAT_INCLUDE");
  if (has_interface(wanted)) return wanted;
  if (!wanted.empty())
    throw UserError(
        fmt::format("there is no tchat/problem.hpp in {}, the folder that TCHAT_INCLUDE names.\n"
                    "  Set it to the folder that contains tchat/problem.hpp, or unset it.",
                    wanted));
  std::error_code failed;
  const fs::path program = fs::read_symlink("/proc/self/exe", failed);
  const std::string installed = (program.parent_path().parent_path() / "include").string();
  if (has_interface(installed)) return installed;
  if (has_interface(TCHAT_SOURCE_INCLUDE)) return TCHAT_SOURCE_INCLUDE;
  throw UserError(
      fmt::format("the header tchat/problem.hpp that plugins are compiled with is not at {}.\n"
                  "  Set the environment variable TCHAT_INCLUDE to the folder that contains "
                  "tchat/problem.hpp, or install tchat again.",
                  installed));
}

}  // namespace tchat
