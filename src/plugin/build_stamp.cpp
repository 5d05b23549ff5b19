#include "plugin/build_stamp.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>

namespace tchat {

namespace {

constexpr std::string_view stamp_head = "\n#tchat-plugin-stamp 1\n";
constexpr std::string_view stamp_foot = "#tchat-plugin-stamp-end\n";
constexpr std::streamoff longest_stamp = 1 << 16;

constexpr std::uint64_t hash_start = 14695981039346656037ULL;

/// FNV-1a, continued from `hash`.
std::uint64_t hash_bytes(std::string_view bytes, std::uint64_t hash) {
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211ULL;
  return hash;
}

std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// The last bytes of a file, at most longest_stamp of them.
std::string read_tail(const std::string& path) {
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  if (!in) return "";
  const std::streamoff size = in.tellg();
  in.seekg(std::max<std::streamoff>(0, size - longest_stamp));
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace

std::string hash_text(const std::string& text) { return fmt::format("{:016x}", hash_bytes(text, hash_start)); }

std::string hash_files(const std::vector<std::string>& files) {
  std::uint64_t hash = hash_start;
  for (const std::string& file : files) {
    const bool readable = static_cast<bool>(std::ifstream(file));
    hash = hash_bytes(readable ? "+" : "-", hash_bytes(file, hash));
    hash = hash_bytes(read_file(file), hash);
  }
  return fmt::format("{:016x}", hash);
}

std::vector<std::string> read_dependencies(const std::string& path) {
  const std::string text = read_file(path);
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
  out << stamp_head << stamp.compiler << '\n' << stamp.contents << '\n';
  for (const std::string& file : stamp.files) out << file << '\n';
  out << stamp_foot;
  out.close();
  return static_cast<bool>(out);
}

std::optional<BuildStamp> read_stamp(const std::string& library) {
  const std::string tail = read_tail(library);
  const std::size_t head = tail.rfind(stamp_head);
  if (head == std::string::npos || !tail.ends_with(stamp_foot)) return std::nullopt;
  const std::size_t begin = head + stamp_head.size();
  std::istringstream lines(tail.substr(begin, tail.size() - stamp_foot.size() - begin));
  BuildStamp stamp;
  std::getline(lines, stamp.compiler);
  std::getline(lines, stamp.contents);
  for (std::string file; std::getline(lines, file);) stamp.files.push_back(file);
  return stamp;
}

}  // namespace tchat
