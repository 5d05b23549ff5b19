#include "plugin/plugin_build.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "base/words.hpp"
#include "plugin/build_stamp.hpp"
#include "plugin/cpp_writer.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

/// The file of a line "      INCLUDE 'file'", in any case and with either kind of quote.
std::optional<std::string> included_file(std::string_view line) {
  constexpr std::string_view word = "include";
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos || line.size() < begin + word.size()) return std::nullopt;
  line.remove_prefix(begin);
  if (strncasecmp(line.data(), word.data(), word.size()) != 0) return std::nullopt;
  const std::size_t open = line.find_first_not_of(" \t", word.size());
  if (open == std::string_view::npos || (line[open] != '\'' && line[open] != '"')) return std::nullopt;
  const std::size_t close = line.find(line[open], open + 1);
  if (close == std::string_view::npos) return std::nullopt;
  return std::string(line.substr(open + 1, close - open - 1));
}

std::optional<std::string> locate(const std::string& file, const fs::path& beside,
                                  const std::vector<std::string>& folders) {
  std::vector<fs::path> candidates = {beside / file};
  for (const std::string& folder : folders) candidates.push_back(fs::path(folder) / file);
  std::error_code failed;
  for (const fs::path& candidate : candidates)
    if (fs::is_regular_file(candidate, failed)) return fs::absolute(candidate).string();
  return std::nullopt;
}

}  // namespace

FortranFiles fortran_files(const std::string& source, const std::vector<std::string>& folders) {
  FortranFiles files;
  files.found.push_back(fs::absolute(source).string());
  files.own_header = fs::path(source).stem().string() + ".h";
  for (std::size_t k = 0; k < files.found.size(); ++k) {  // the list grows while it is read
    const fs::path folder = fs::path(files.found[k]).parent_path();
    TextLines in(files.found[k], "source of the plugin");
    for (std::string line; in.next(line);) {
      const std::optional<std::string> file = included_file(line);
      if (!file) continue;
      const std::optional<std::string> path = locate(*file, folder, folders);
      if (!path)
        files.lacks_own_header = files.lacks_own_header || *file == files.own_header;
      else if (std::find(files.found.begin(), files.found.end(), *path) == files.found.end())
        files.found.push_back(*path);
    }
  }
  return files;
}

namespace {

struct SourceSuffix {
  const char* text;
  Language language;
};
constexpr std::array<SourceSuffix, 7> source_suffixes = {{{".cpp", Language::cpp},
                                                          {".cc", Language::cpp},
                                                          {".cxx", Language::cpp},
                                                          {".f90", Language::fortran},
                                                          {".f", Language::fortran},
                                                          {".for", Language::fortran},
                                                          {".tch", Language::formulas}}};

/// Nothing when the suffix is that of no source.
std::optional<Language> language_of(const fs::path& path) {
  for (const SourceSuffix& suffix : source_suffixes)
    if (path.extension() == suffix.text) return suffix.language;
  return std::nullopt;
}

bool is_file(const fs::path& path) {
  std::error_code failed;
  return fs::is_regular_file(path, failed);
}

/// A folder of our own beside the library, with a name that nobody can foresee, .LIBRARY.XXXXXX, which is removed with
/// all that is in it. Those that killed processes have left are removed too: who makes one holds the library's lock.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const fs::path& library) {
    const std::string begin = fmt::format(".{}.", library.filename().string());
    remove_abandoned(library.parent_path(), begin);
    path_ = (library.parent_path() / (begin + std::string(random_part))).string();
    if (::mkdtemp(path_.data()) == nullptr)
      throw UserError(fmt::format("the plugin cannot be compiled to {}: {}.\n  Make room, or make the folder writable.",
                                  library.string(), std::strerror(errno)));
  }
  ~TemporaryFolder() { fs::remove_all(path_, ignored_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }
  std::string file(const std::string& name) const { return path_ + "/" + name; }

 private:
  static constexpr std::string_view random_part = "XXXXXX";

  static void remove_abandoned(const fs::path& folder, const std::string& begin) {
    std::error_code error;
    std::vector<fs::path> found;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
      const std::string name = at->path().filename().string();
      if (name.starts_with(begin) && name.size() == begin.size() + random_part.size() && at->is_directory(error))
        found.push_back(at->path());
    }
    for (const fs::path& one : found) fs::remove_all(one, error);
  }

  std::string path_;
  std::error_code ignored_;
};

bool not_newer(const std::string& file, const timespec& time) {
  struct stat at {};
  if (stat(file.c_str(), &at) != 0) return false;
  return at.st_mtim.tv_sec < time.tv_sec || (at.st_mtim.tv_sec == time.tv_sec && at.st_mtim.tv_nsec <= time.tv_nsec);
}

/// One source and everything that decides whether its library is up to date.
struct Build {
  fs::path source;
  Language language;
  std::string include_folder;
  Compiler compiler;
  std::string translation = {};  ///< C++ of formulas

  FortranFiles fortran() const { return fortran_files(source.string(), {include_folder + "/tchat"}); }

  BuildPlaces places() const {
    return {fs::absolute(source).parent_path().lexically_normal().string(),
            fs::absolute(include_folder).lexically_normal().string()};
  }

  /// Files by their place. The compiler's paths begin as the source or a folder of headers was given to it.
  std::vector<BuildInput> placed(const std::vector<std::string>& files) const {
    const BuildPlaces as_given = {fs::absolute(source).parent_path().string(), fs::absolute(include_folder).string()};
    const BuildPlaces normal = places();
    std::vector<BuildInput> inputs;
    for (const std::string& file : files) {
      inputs.push_back(place_of(file, as_given));
      if (inputs.back().root == BuildInput::Root::elsewhere) inputs.back() = place_of(file, normal);
    }
    return inputs;
  }

  /// The files that a library compiled elsewhere is compared with.
  std::vector<BuildInput> known_inputs() const {
    if (language == Language::fortran) return placed(fortran().found);
    std::vector<std::string> files = {fs::absolute(source).string()};
    for (const char* header : {"chatter.hpp", "dual.hpp", "gauss_flight.hpp", "impact_flight.hpp", "lanes.hpp",
                               "problem.h", "problem.hpp", "sliding.hpp"})
      files.push_back(fs::absolute(include_folder).string() + "/tchat/" + header);
    return placed(files);
  }

  /// Options such as -I may mean other files for a source that lies elsewhere. What formulas are translated to belongs
  /// to it: another version of tchat may translate them otherwise.
  std::string compiler_identity() const {
    const std::string identity = compiler.identity();
    if (identity.empty()) return "";
    const bool options = std::any_of(compiler.command().begin(), compiler.command().end(),
                                     [](const std::string& word) { return word.starts_with('-'); });
    return identity + (options ? places().source_folder : "") + translation;
  }

  bool same_compiler(const BuildStamp& stamp) const {
    const std::string identity = compiler_identity();
    return identity.empty() || stamp.compiler == hash_text(identity);  // without a compiler, what there is must do
  }

  bool is_current(const fs::path& library) const {
    struct stat at {};
    if (stat(library.c_str(), &at) != 0 || !S_ISREG(at.st_mode)) return false;
    const std::optional<BuildStamp> stamp = read_stamp(library.string());
    if (stamp && !is_from_source(*stamp)) return false;
    // A file that was missing when the library was compiled counts by its absence, in the hash.
    for (const BuildInput& input : stamp ? stamp->files : known_inputs())
      if (const std::string file = input.found_from(places());
          !not_newer(file, at.st_mtim) && !(stamp && !is_file(file)))
        return false;
    if (!stamp) return true;
    return same_compiler(*stamp) && stamp->contents == hash_files(stamp->files, places());
  }

  /// False for the library of NAME.cpp when the source is NAME.f.
  bool is_from_source(const BuildStamp& stamp) const {
    return std::any_of(stamp.files.begin(), stamp.files.end(), [&](const BuildInput& file) {
      return file.root == BuildInput::Root::source && file.path == source.filename();
    });
  }

  /// Compiles to a temporary name in the library's folder and renames. The lock is the caller's.
  void make(const fs::path& library) const {
    // A device that fails is no fault of the source, as which the compiler would report it.
    static_cast<void>(read_text_if_there(source.string(), "source of the plugin"));
    const TemporaryFolder scratch(library);
    const std::string made = scratch.file(library.filename().string());
    timespec begun{};
    timespec_get(&begun, TIME_UTC);
    const std::vector<BuildInput> files = placed(compile(made, scratch));
    const BuildStamp stamp{hash_text(compiler_identity()), hash_files(files, places()), files};
    const bool written = append_stamp(made, stamp);
    // The library is as old as the begin of its compilation: a source saved meanwhile is newer.
    const std::array<timespec, 2> times = {begun, begun};
    utimensat(AT_FDCWD, made.c_str(), times.data(), 0);
    if (!written || std::rename(made.c_str(), library.c_str()) != 0)
      throw UserError(
          fmt::format("the compiled plugin cannot be stored as {} ({}).\n"
                      "  Make room, or make the folder writable.",
                      library.string(), std::strerror(errno)));
  }

  /// All compile to a file and return what decides whether it is up to date.
  std::vector<std::string> compile(const std::string& library, const TemporaryFolder& scratch) const {
    switch (language) {
      case Language::fortran:
        return compile_fortran(library, scratch);
      case Language::formulas:
        return compile_formulas(library, scratch);
      default:
        return compile_cpp(library, scratch);
    }
  }

  std::vector<std::string> compile_formulas(const std::string& library, const TemporaryFolder& scratch) const {
    const std::string translated = scratch.file(source.stem().string() + ".cpp");
    std::ofstream(translated) << translation;
    const std::string dependencies = scratch.file("dependencies");
    compiler.compile({translated, library, include_folder, dependencies, ""});
    std::vector<std::string> files = read_dependencies(dependencies);
    // The compiler leaves out a ./ at the begin of a path.
    const auto is_translated = [&](const std::string& file) {
      return fs::path(file).lexically_normal() == fs::absolute(translated).lexically_normal();
    };
    std::replace_if(files.begin(), files.end(), is_translated, fs::absolute(source).string());
    return files;
  }

  std::vector<std::string> compile_cpp(const std::string& library, const TemporaryFolder& scratch) const {
    const std::string dependencies = scratch.file("dependencies");
    compiler.compile({source.string(), library, include_folder, dependencies, ""});
    return read_dependencies(dependencies);
  }

  std::vector<std::string> compile_fortran(const std::string& library, const TemporaryFolder& scratch) const {
    FortranFiles files = fortran();
    if (files.lacks_own_header) {
      const std::ofstream empty(scratch.file(files.own_header));
      files.found.push_back((fs::absolute(source).parent_path() / files.own_header).string());
    }
    compiler.compile({source.string(), library, include_folder, "", scratch.path()});
    return files.found;
  }
};

/// In the cache folder, created; file names carry the source's path so that equal names differ.
fs::path cached_library(const fs::path& source) {
  const std::optional<fs::path> cache = cache_folder();
  if (!cache)
    throw UserError(
        fmt::format("{} must be compiled, but its folder cannot be written and there is no cache folder.\n"
                    "  Copy the source to a folder of your own, or set XDG_CACHE_HOME or HOME.",
                    source.string()));
  const fs::path& folder = *cache;
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed)
    throw UserError(
        fmt::format("{} must be compiled, but its folder cannot be written, and neither can the cache "
                    "folder {} be made ({}).\n  Copy the source to a folder of your own, or set "
                    "XDG_CACHE_HOME to a folder that you can write.",
                    source.string(), folder.string(), failed.message()));
  return folder / fmt::format("{}-{}.so", source.stem().string(), hash_text(fs::absolute(source).string()));
}

/// Makes the library unless another process did so while we waited. Returns 0, or the errno of creating the lock file.
int make_under_lock(const Build& build, const fs::path& library, std::ostream* progress) {
  const FileLock lock(fmt::format("{}/.{}.lock", library.parent_path().string(), library.filename().string()));
  if (lock.error() != 0 || build.is_current(library)) return lock.error();
  const auto begun = std::chrono::steady_clock::now();
  if (progress != nullptr) *progress << fmt::format("compiling {} ... ", build.source.string()) << std::flush;
  try {
    build.make(library);
  } catch (...) {
    if (progress != nullptr) *progress << '\n' << std::flush;
    throw;
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun;
  if (progress != nullptr) *progress << fmt::format("done in {:.1f} s\n", taken.count()) << std::flush;
  return 0;
}

bool is_read_only(int error) { return error == EACCES || error == EROFS || error == EPERM; }

/// Formulas may lie beside the same problem in C++, whose library is another one.
fs::path library_of(const fs::path& source) {
  return language_of(source) == Language::formulas ? fs::path(source.string() + ".so")
                                                   : fs::path(source).replace_extension(".so");
}

std::string build_source(const fs::path& given, const PluginBuildOptions& options) {
  const fs::path source = given.has_parent_path() ? given : "." / given;  // messages show the path as it was given
  const Language language = language_of(source).value();
  Build build{source, language, find_include_folder(options), Compiler(options, language)};
  if (language == Language::formulas) build.translation = translate_formula_file(given.string()).cpp;
  fs::path library = library_of(source);
  if (build.is_current(library)) return library.string();

  int error = make_under_lock(build, library, options.progress);
  if (is_read_only(error)) {
    library = cached_library(source);
    if (build.is_current(library)) return library.string();
    error = make_under_lock(build, library, options.progress);
  }
  if (error != 0)
    throw UserError(fmt::format("the plugin {} cannot be compiled to {}: {}.\n  Make the folder writable.",
                                given.string(), library.string(), std::strerror(error)));
  return library.string();
}

[[noreturn]] void refuse_missing(const std::string& name) {
  std::error_code failed;
  const bool folder = fs::is_directory(name, failed);
  const std::string inside = (fs::path(name) / fs::path(name).filename()).string();
  throw UserError(
      fmt::format("there is no plugin {0}: none of {0}.cpp, {0}.f90, {0}.f, {0}.tch and {0}.so exists.\n  {1}", name,
                  folder ? fmt::format("{} is a folder, and there is no plugin {} in it either.", name, inside)
                         : "Give its path with -p: P.cpp, P.f, P.tch, P.so, or P for any of them."));
}

/// The source that a name without ending stands for; "" when there is none.
std::string source_named(const std::string& name) {
  for (const SourceSuffix& suffix : source_suffixes)
    if (is_file(name + suffix.text)) return name + suffix.text;
  return "";
}

/// The file that a name or path stands for, in the order of the header: a source or a library; "" when there is none.
std::string plugin_file(const std::string& name_or_path) {
  const fs::path given(name_or_path);
  if (given.extension() == ".so" || language_of(given)) return is_file(given) ? name_or_path : "";
  for (const std::string& name : {name_or_path, (given / given.filename()).string()}) {
    if (std::string source = source_named(name); !source.empty()) return source;
    if (is_file(name + ".so")) return name + ".so";
  }
  return "";
}

}  // namespace

NamedProblem named_problem(const std::string& given) {
  if (!language_of(given) || !is_file(given)) return {given, std::nullopt};
  const std::string name = fs::path(given).replace_extension().string();
  return {name, source_named(name) == given ? std::nullopt : std::optional(given)};
}

std::string source_of(const std::string& name_or_path) {
  std::string file = plugin_file(name_or_path);
  return language_of(file) ? file : "";
}

std::optional<std::string> formulas_of(const std::string& name_or_path) {
  const std::string source = language_of(name_or_path) ? name_or_path : source_named(name_or_path);
  if (source.empty() || language_of(source) != Language::formulas) return std::nullopt;
  return source;
}

std::string resolve_plugin(const std::string& name_or_path, const PluginBuildOptions& options) {
  if (name_or_path.empty()) throw UserError("the plugin's name is empty.\n  Give -p P for P.cpp, P.f, P.tch or P.so.");
  const fs::path given(name_or_path);
  if (given.extension() == ".so" || language_of(given)) {
    if (!is_file(given))
      throw UserError(
          fmt::format("there is no plugin file {}.\n  Give the path of an existing P.cpp, P.f, P.tch or P.so with -p.",
                      name_or_path));
    return language_of(given) ? build_source(given, options) : name_or_path;
  }
  const std::string file = plugin_file(name_or_path);
  if (file.empty()) refuse_missing(name_or_path);
  return language_of(file) ? build_source(file, options) : file;
}

std::string problem_of_run(const std::optional<std::string>& given, const std::string& run,
                           const std::optional<std::string>& recorded) {
  if (given) return *given;
  return recorded && plugin_file(run).empty() ? *recorded : run;
}

std::string resolve_plugin_of_run(const std::optional<std::string>& given, const std::string& run,
                                  const std::optional<std::string>& recorded, std::ostream& notices) {
  const std::string problem = problem_of_run(given, run, recorded);
  if (const std::string file = plugin_file(problem); !given && fs::path(problem).has_parent_path() && !file.empty())
    notices << fmt::format("plugin: {} is {}loaded, and its code is run; -p names another one\n", file,
                           language_of(file) ? "compiled where its library is not up to date, " : "")
            << std::flush;
  return resolve_plugin(problem);
}

std::vector<std::string> files_of_problem(const std::string& name_or_path, const std::string& library) {
  const std::string source = source_of(name_or_path);
  if (source.empty()) return {library};
  std::vector<std::string> files{source};
  const BuildPlaces places{fs::absolute(source).parent_path().lexically_normal().string(), ""};
  const std::optional<BuildStamp> stamp = read_stamp(library);
  for (const BuildInput& input : stamp ? stamp->files : std::vector<BuildInput>{}) {
    const fs::path file = input.found_from(places);
    if (input.root == BuildInput::Root::interface || !is_file(file) || fs::equivalent(file, source)) continue;
    const fs::path beside = file.lexically_proximate(fs::current_path());
    files.push_back((beside.native().starts_with("..") ? file : beside).string());
  }
  return files;
}

Command problem_words(const std::string& plugin) {
  const std::string name = fs::path(plugin).stem().string();
  return name == plugin ? Command{name} : Command{name, "-p", plugin};
}

}  // namespace tchat
