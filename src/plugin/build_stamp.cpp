#include "plugin/build_stamp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include "base/text_file.hpp"

namespace tchat {

namespace {

constexpr std::string_view stamp_mark = "\n#tchat-plugin-stamp ";
constexpr std::string_view stamp_version = "2\n";
constexpr std::string_view stamp_foot = "#tchat-plugin-stamp-end\n";
constexpr std::streamoff longest_stamp = 1 << 16;

constexpr std::uint64_t hash_start = 14695981039346656037ULL;

/// FNV-1a, continued from `hash`.
std::uint64_t hash_bytes(std::string_view bytes, std::uint64_t hash) {
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211ULL;
  return hash;
}

/// All that can be read of a file from `begin` on.
std::string read_rest(std::ifstream& in) {
  std::ostringstream text;
  text << in.rdbuf();  // an error while reading ends it
  return text.str();
}

/// The last bytes of a file, at most longest_stamp of them.
std::string read_tail(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) return "";
  const std::streamoff size = in.tellg();
  in.seekg(std::max<std::streamoff>(0, size - longest_stamp));
  return read_rest(in);
}

/// What follows `folder`/ in a path; "" when the path does not lie there.
std::string below(const std::string& folder, const std::string& path) {
  const std::string begin = folder.ends_with('/') ? folder : folder + "/";
  return path.starts_with(begin) ? path.substr(begin.size()) : "";
}

}  // namespace

std::string BuildInput::found_from(const BuildPlaces& places) const {
  if (root == Root::elsewhere) return path;
  return (root == Root::source ? places.source_folder : places.include_folder) + "/" + path;
}

BuildInput place_of(const std::string& file, const BuildPlaces& places) {
  if (std::string path = below(places.include_folder, file); path.starts_with("tchat/"))
    return {BuildInput::Root::interface, path};
  if (std::string path = below(places.source_folder, file); !path.empty()) return {BuildInput::Root::source, path};
  return {BuildInput::Root::elsewhere, file};
}

std::string hash_text(const std::string& text) { return fmt::format("{:016x}", hash_bytes(text, hash_start)); }

std::string hash_files(const std::vector<BuildInput>& files, const BuildPlaces& places) {
  std::uint64_t hash = hash_start;
  for (const BuildInput& input : files) {
    const std::string file = input.found_from(places);
    const std::optional<std::string> text = read_text_if_there(file, "source of the plugin");
    hash = hash_bytes(text ? "+" : "-", hash_bytes(input.path, hash));
    hash = hash_bytes(text.value_or(""), hash);
  }
  return fmt::format("{:016x}", hash);
}

std::vector<std::string> read_dependencies(const std::string& path) {
  const std::string text = read_text_if_there(path, "dependencies of the plugin").value_or("");
  std::vector<std::string> files;
  std::string word;
  const auto end_word = [&] {
    if (!word.empty() && word.back() != ':') files.push_back(std::filesystem::absolute(word).string());
    word.clear();
  };
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char next = k + 1 < text.size() ? text[k + 1] : '\n';
    if (text[k] == '\\' && (next == ' ' || next == '#' || next == '\\')) {
      word += text[++k];
    } else if (text[k] == '$' && next == '$') {
      word += text[++k];
    } else if (text[k] == '\\' && next == '\n') {
      end_word();
    } else if (std::isspace(static_cast<unsigned char>(text[k])) != 0) {
      end_word();
    } else {
      word += text[k];
    }
  }
  end_word();
  return files;
}

bool append_stamp(const std::string& library, const BuildStamp& stamp) {
  std::ofstream out(library, std::ios::binary | std::ios::app);
  out << stamp_mark << stamp_version << stamp.compiler << '\n' << stamp.contents << '\n';
  for (const BuildInput& file : stamp.files) out << static_cast<char>(file.root) << file.path << '\n';
  out << stamp_foot;
  out.close();
  return static_cast<bool>(out);
}

std::optional<BuildStamp> read_stamp(const std::string& library) {
  const std::string tail = read_tail(library);
  const std::size_t mark = tail.rfind(stamp_mark);
  if (mark == std::string::npos || !tail.ends_with(stamp_foot)) return std::nullopt;
  std::string text = tail.substr(mark + stamp_mark.size());
  if (!text.starts_with(stamp_version)) return BuildStamp{};
  text.resize(text.size() - stamp_foot.size());
  std::istringstream lines(text.substr(stamp_version.size()));
  BuildStamp stamp;
  std::getline(lines, stamp.compiler);
  std::getline(lines, stamp.contents);
  for (std::string file; std::getline(lines, file) && !file.empty();)
    stamp.files.push_back({static_cast<BuildInput::Root>(file[0]), file.substr(1)});
  return stamp;
}

}  // namespace tchat
