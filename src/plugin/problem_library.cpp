#include "plugin/problem_library.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include "base/messages.hpp"
#include "plugin/compiler_process.hpp"

namespace tchat {

bool lacks_sections(const HybridSystem& system) {
  const bool has_index_vectors = system.count(FunctionKind::event) > 0 && system.count(FunctionKind::jump) > 0;
  return !has_index_vectors && !system.has_modes() && system.count(FunctionKind::field) == 1 &&
         system.boundary_conditions() == 0;
}

struct SectionedProblem::Calls {
  static const SectionedProblem& object(const void* self) { return *static_cast<const SectionedProblem*>(self); }
  static bool is_section(const SectionedProblem& own, int kind, int index) {
    return kind == TCHAT_EVENT && index > own.plain_.events;
  }
  static bool is_identity(const SectionedProblem& own, int kind, int index) {
    return kind == TCHAT_JUMP && index > own.plain_.jumps;
  }

  static void value(const void* self, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                    double* out) {
    const SectionedProblem& own = object(self);
    const tchat_problem& plain = own.plain_;
    if (is_identity(own, kind, index)) {
      std::copy_n(x, plain.dimension, out);
      return;
    }
    if (!is_section(own, kind, index)) return plain.value(plain.self, kind, index, x, par, out);
    std::vector<double> f(static_cast<std::size_t>(plain.dimension));
    plain.value(plain.self, TCHAT_FIELD, 1, x, par, f.data());
    *out = f.front();
  }

  static void first(const void* self, std::int32_t kind, std::int32_t index, const double* x, const double* par,
                    const std::int32_t* active, std::int32_t count, double* out, double* dx, double* dp) {
    const SectionedProblem& own = object(self);
    const tchat_problem& plain = own.plain_;
    const int n = plain.dimension;
    if (is_identity(own, kind, index)) {
      std::copy_n(x, n, out);
      std::fill_n(dx, n * n, 0.0);
      for (int i = 0; i < n; ++i) dx[i * (n + 1)] = 1.0;
      std::fill_n(dp, n * count, 0.0);
      return;
    }
    if (!is_section(own, kind, index)) return plain.first(plain.self, kind, index, x, par, active, count, out, dx, dp);
    std::vector<double> f(static_cast<std::size_t>(n)), fx(static_cast<std::size_t>(n * n)),
        fp(static_cast<std::size_t>(n * count));
    plain.first(plain.self, TCHAT_FIELD, 1, x, par, active, count, f.data(), fx.data(), fp.data());
    *out = f.front();
    for (int i = 0; i < n; ++i) dx[i] = fx[static_cast<std::size_t>(i * n)];
    for (int k = 0; k < count; ++k) dp[k] = fp[static_cast<std::size_t>(k * n)];
  }

  static std::int32_t successors(const void* self, const std::int32_t*, const double*, const double*, std::int32_t* to,
                                 std::int32_t capacity) {
    if (capacity < 1) return 0;
    const tchat_problem& table = object(self).table_;
    to[0] = 1, to[1] = table.events, to[2] = table.jumps;
    return 1;
  }
};

SectionedProblem::SectionedProblem(const tchat_problem& plain) : plain_(plain), table_(plain) {
  const HybridSystem system(plain);
  for (int j = 1; j <= plain.events; ++j) names_.push_back(system.function_name(FunctionKind::event, j));
  names_.push_back("maximum of " + system.state_name(1));
  for (int k = 1; k <= plain.jumps; ++k) names_.push_back(system.function_name(FunctionKind::jump, k));
  names_.emplace_back("identity");
  for (const std::string& name : names_)
    (std::ssize(event_names_) <= plain.events ? event_names_ : jump_names_).push_back(name.c_str());
  table_.events = plain.events + 1;
  table_.jumps = plain.jumps + 1;
  table_.event_names = event_names_.data();
  table_.jump_names = jump_names_.data();
  table_.derivative_order = std::min(plain.derivative_order, 1);
  table_.self = this;
  table_.value = &Calls::value;
  table_.first = plain.derivative_order >= 1 ? &Calls::first : nullptr;
  table_.second = nullptr;
  table_.third = nullptr;
  table_.third_at_points = nullptr;
  table_.successors = &Calls::successors;
  table_.user_values = 0;
  table_.output_parameters = nullptr;
  table_.integral_conditions = 0;
  table_.first_at_points = nullptr;
  table_.second_at_points = nullptr;
  table_.first_in_lanes = nullptr;
}

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& what, const std::string& cure) {
  throw UserError(fmt::format("plugin {}: {}.\n  {}", path, what, cure));
}

std::string load_cure(std::string_view said) {
  if (said.find("undefined symbol") != std::string_view::npos)
    return "Something it calls is declared but not defined: define it in the source, or link the library that has it.";
  if (said.find("invalid ELF header") != std::string_view::npos ||
      said.find("file too short") != std::string_view::npos)
    return "It is not a shared library: give the .cpp source, or delete the file so that it is compiled again.";
  if (said.find("wrong ELF class") != std::string_view::npos || said.find("cannot open") != std::string_view::npos)
    return "It, or a library it needs, is missing, unreadable or for another machine: compile it here.";
  if (said.find("failed to map segment") != std::string_view::npos)
    return "Programs may not be run from the disk it is on (mount option noexec): copy it to another one.";
  return "Compile it again from its source; a shared library is made with -shared -fPIC.";
}

void require_file(const std::string& path) {
  std::error_code failed;
  const fs::file_status status = fs::status(path, failed);
  if (!fs::exists(status))
    refuse(path, "there is no such file",
           "Give the path of P.so or P.cpp with -p, or run tchat in the plugin's folder.");
  if (fs::is_directory(status))
    refuse(path, "this is a folder", "Give the plugin inside it: the path of its .so or .cpp file.");
  if (!fs::is_regular_file(status)) refuse(path, "this is not a regular file", "Give the path of a .so or .cpp file.");
}

/// True when a 64-bit ELF file ends before the parts that its header announces. The loader maps such a file and dies
/// by a signal when it touches the missing part.
bool is_truncated(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  Elf64_Ehdr header{};
  in.seekg(0);
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) return false;  // no ELF file, the loader says so
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64) return false;
  in.seekg(static_cast<std::streamoff>(header.e_phoff));
  for (int k = 0; k < header.e_phnum; ++k) {
    Elf64_Phdr segment{};
    if (!in.read(reinterpret_cast<char*>(&segment), sizeof segment)) return true;
    const Elf64_Off room = static_cast<Elf64_Off>(size);
    if (segment.p_type == PT_LOAD && (segment.p_filesz > room || segment.p_offset > room - segment.p_filesz))
      return true;
  }
  return false;
}

bool is_on_noexec_disk(const std::string& path) {
  struct statvfs disk {};
  return ::statvfs(path.c_str(), &disk) == 0 && (disk.f_flag & ST_NOEXEC) != 0;
}

/// The loader gives no reason where a part of the file cannot be mapped: no memory, or no right to run it.
bool lacks_memory(std::string_view said, const std::string& path) {
  const auto has = [said](std::string_view part) { return said.find(part) != std::string_view::npos; };
  if (has("failed to map segment")) return !is_on_noexec_disk(path);
  return (has("annot allocate") && !has("static TLS")) || has("out of memory");
}

/// `file`, another name of the library at `path`.
void* open_library(const std::string& path, const std::string& file) {
  require_file(path);
  if (is_truncated(path))
    refuse(path, "the file is incomplete", "Delete it, so that it is compiled again, or copy it again.");
  const PluginCall call(path.c_str(), "while it was loaded");
  // An absolute path keeps dlopen from searching the system's library folders for a name without a slash.
  void* const handle = dlopen(fs::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle != nullptr) return handle;
  const char* const said = dlerror();
  const std::string text = said != nullptr ? said : "no reason was given";
  if (text.find("cannot read file data") != std::string::npos)
    throw ComputationError(
        fmt::format("plugin {}: reading fails; the loader says: {}.\n"
                    "  The disk or the connection to it is at fault; copy the source elsewhere.",
                    path, text));
  if (lacks_memory(text, path))
    throw ComputationError(
        fmt::format("plugin {}: there is no memory to load it; the loader says: {}.\n"
                    "  End other programs, or raise the limit (ulimit -v).",
                    path, text));
  refuse(path, fmt::format("it cannot be loaded; the loader says: {}", text), load_cure(text));
}

/// The bytes of the library as a file in memory, which the loader takes for another library.
class MemoryCopy {
 public:
  explicit MemoryCopy(const std::string& path) : descriptor_(::memfd_create("tchat", MFD_CLOEXEC)) {
    require_file(path);
    std::ifstream in(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    std::size_t written = 0;
    while (descriptor_ >= 0 && written < bytes.size()) {
      const ssize_t count = ::write(descriptor_, bytes.data() + written, bytes.size() - written);
      if (count <= 0) break;
      written += static_cast<std::size_t>(count);
    }
    if (bytes.empty() || written < bytes.size())
      throw ComputationError(
          fmt::format("plugin {}: there is no memory for a copy of it, one for each worker; use fewer (-j)", path));
  }
  ~MemoryCopy() { ::close(descriptor_); }
  MemoryCopy(const MemoryCopy&) = delete;
  MemoryCopy& operator=(const MemoryCopy&) = delete;

  std::string name() const { return fmt::format("/proc/self/fd/{}", descriptor_); }

 private:
  int descriptor_;
};

/// Calls the entry point, which runs the problem class's constructor.
const tchat_problem* call_entry(const std::string& path, tchat_problem_entry entry) {
  const std::string cure = "The problem class's constructor must not fail: open no files there, compute only.";
  const PluginCall call(path.c_str(), "in the problem class's constructor");
  try {
    return entry();
  } catch (const std::exception& error) {
    refuse(path, fmt::format("its entry point threw an exception: {}", error.what()), cure);
  } catch (...) {
    refuse(path, "its entry point threw an exception", cure);
  }
}

/// The plugin's Fortran subroutines as a problem; nothing when it has a table of its own.
std::unique_ptr<FortranProblem> wrap_fortran(const std::string& path, void* handle,
                                             const ProblemLibrary::Sizes& sizes) {
  if (dlsym(handle, TCHAT_PROBLEM_ENTRY) != nullptr || !is_fortran_problem(handle)) return nullptr;
  if (!sizes)
    refuse(path, "a Fortran plugin does not say how many states and functions it has", "Give its constants file too.");
  const ProblemSizes known = sizes();
  const PluginCall call(path.c_str(), "in GCSTPNT, or in a first call of GCFUNC, GCBOUND or JUMPMAP");
  return std::make_unique<FortranProblem>(path, handle, known);
}

/// A library that was compiled on another machine would end this process at its first instruction that is not there.
void require_instructions(const std::string& path, void* handle) {
  const auto* const needed = static_cast<const char*>(dlsym(handle, "tchat_problem_instructions"));
  if (needed != nullptr && !runs_instructions(needed))
    refuse(path, fmt::format("it was compiled for processors with {} instructions, which this one has not", needed),
           "Delete it and give its source, which is then compiled for this machine.");
}

/// The table of a C++ or C plugin.
const tchat_problem* find_table(const std::string& path, void* handle) {
  require_instructions(path, handle);
  void* const symbol = dlsym(handle, TCHAT_PROBLEM_ENTRY);
  if (symbol == nullptr)
    refuse(path, "it does not export " TCHAT_PROBLEM_ENTRY " nor the Fortran subroutines GCFUNC, GCBOUND, JUMPMAP",
           "End a C++ source with TCHAT_PROBLEM(YourClass), once, outside any namespace.");
  const tchat_problem* const table = call_entry(path, reinterpret_cast<tchat_problem_entry>(symbol));
  if (table == nullptr)
    refuse(path, TCHAT_PROBLEM_ENTRY " returned no table",
           "The entry point must return the address of a tchat_problem that lives as long as the library.");
  return table;
}

/// A table made before boundary value problems, sliding modes, many points at once, for first derivatives or for second
/// ones or side by side, modes of different dimension, third derivatives, at one point or many, or chatter has none of
/// their members.
tchat_problem completed(const tchat_problem& table) {
  const std::array<std::size_t, 9> earlier = {
      TCHAT_PROBLEM_FIRST_SIZE,   TCHAT_PROBLEM_SECOND_SIZE, TCHAT_PROBLEM_THIRD_SIZE,
      TCHAT_PROBLEM_FOURTH_SIZE,  TCHAT_PROBLEM_FIFTH_SIZE,  TCHAT_PROBLEM_SIXTH_SIZE,
      TCHAT_PROBLEM_SEVENTH_SIZE, TCHAT_PROBLEM_EIGHTH_SIZE, TCHAT_PROBLEM_NINTH_SIZE};
  if (std::find(earlier.begin(), earlier.end(), table.struct_size) == earlier.end()) return table;
  tchat_problem whole{};
  std::memcpy(&whole, &table, table.struct_size);
  whole.struct_size = sizeof(tchat_problem);
  return whole;
}

std::unique_ptr<GuardedProblem> guarded(const std::string& path, void* handle, const FortranProblem* fortran) {
  const tchat_problem* const table = fortran != nullptr ? &fortran->table() : find_table(path, handle);
  try {
    const tchat_problem whole = completed(*table);
    const HybridSystem checked(whole);
    return std::make_unique<GuardedProblem>(checked.table(), path);
  } catch (const std::invalid_argument& error) {
    const bool version = table->abi_version != TCHAT_PROBLEM_ABI || table->struct_size != sizeof(tchat_problem);
    refuse(path, fmt::format("its problem table cannot be used: {}", error.what()),
           version ? "It was compiled for another tchat: delete it and give its source, which is then compiled anew."
                   : "Correct the numbers of the problem class (or of the table) and compile it again.");
  }
}

}  // namespace

void ProblemLibrary::Close::operator()(void* handle) const {
  const PluginCall call(path.c_str(), "while it was unloaded");
  dlclose(handle);
}

ProblemLibrary::ProblemLibrary(const std::string& path, const Sizes& sizes) : ProblemLibrary(path, path, sizes) {}

std::unique_ptr<ProblemLibrary> ProblemLibrary::copy_of(const std::string& path, const Sizes& sizes) {
  const MemoryCopy copy(path);
  return std::unique_ptr<ProblemLibrary>(new ProblemLibrary(path, copy.name(), sizes));
}

ProblemLibrary::ProblemLibrary(const std::string& path, const std::string& file, const Sizes& sizes)
    : path_(path),
      guard_(path),
      handle_(open_library(path, file), Close{path}),
      fortran_(wrap_fortran(path, handle_.get(), sizes)),
      problem_(guarded(path, handle_.get(), fortran_.get())),
      system_(problem_->table()) {}

void ProblemLibrary::add_section() {
  if (sectioned_ || !lacks_sections(system_)) return;
  sectioned_ = std::make_unique<SectionedProblem>(problem_->table());
  system_ = HybridSystem(sectioned_->table());
}

std::string ProblemLibrary::complaint() const {
  if (problem_->thrown().empty()) return "";
  return fmt::format("plugin {}: an exception of {}\n  Its values are 1e99 in the files where it threw.", path_,
                     problem_->thrown());
}

std::vector<std::string> ProblemLibrary::derivative_notes() const {
  std::vector<std::string> notes;
  const int order = system_.table().derivative_order;
  if (order == 0) notes.emplace_back("All derivatives are central differences: the problem supplies values only.");
  if (order == 1)
    notes.emplace_back("Second derivatives are central differences of the first ones that the problem supplies.");
  if (order == 2 && fortran_ != nullptr)
    notes.emplace_back("Second derivatives of jumps and by two parameters are central differences of first ones.");
  if (order >= 1 && fortran_ != nullptr)
    notes.emplace_back("Parameter derivatives of jumps that JUMPMAP leaves at zero are central differences.");
  return notes;
}

bool shares_data_of_copies(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto read = [&](std::size_t at, auto& out) {
    if (at > bytes.size() || bytes.size() - at < sizeof out) return false;
    std::memcpy(&out, bytes.data() + at, sizeof out);
    return true;
  };
  Elf64_Ehdr header{};
  if (!read(0, header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64)
    return false;
  const auto section = [&](std::size_t k, Elf64_Shdr& out) {
    return k < header.e_shnum && read(header.e_shoff + k * sizeof out, out);
  };
  for (std::size_t k = 0; k < header.e_shnum; ++k) {
    Elf64_Shdr table{}, place{};
    if (!section(k, table) || table.sh_type != SHT_DYNSYM) continue;
    Elf64_Sym symbol{};
    for (std::size_t at = 0; at + sizeof symbol <= table.sh_size && read(table.sh_offset + at, symbol);
         at += sizeof symbol)
      if (ELF64_ST_BIND(symbol.st_info) == STB_GNU_UNIQUE && section(symbol.st_shndx, place) &&
          (place.sh_flags & SHF_WRITE) != 0)
        return true;
  }
  return false;
}

}  // namespace tchat
