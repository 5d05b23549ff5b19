// A main for fuzz targets where libFuzzer is not: every file of the given folders, then texts made of them by random
// changes, the same ones every time. Not guided by coverage, but it runs in every build and finds what has come back.
//
//     fuzz_TARGET MUTATIONS FOLDER|FILE...

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

#include "fuzz_target.hpp"

namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// In the order of their names, whatever the file system's is.
std::vector<std::string> texts_in(const std::vector<fs::path>& places) {
  std::vector<fs::path> files;
  for (const fs::path& place : places)
    if (fs::is_directory(place))
      std::copy_if(fs::directory_iterator(place), {}, std::back_inserter(files),
                   [](const fs::path& path) { return fs::is_regular_file(path); });
    else
      files.push_back(place);
  std::sort(files.begin(), files.end());
  std::vector<std::string> texts;
  for (const fs::path& file : files) texts.push_back(contents(file));
  return texts;
}

void run(const std::string& text) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

class Mutations {
 public:
  explicit Mutations(const std::vector<std::string>& texts) : texts_(texts) {}

  std::string next() {
    std::string text = texts_[below(texts_.size())];
    for (std::size_t change = 0; change <= below(4); ++change) alter(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

  void alter(std::string& text) {
    static const std::vector<std::string> words{"-1",      "0",   "2147483647", "-2147483648", "99999999999", "1e308",
                                                "1.0-400", "nan", "3*",         "/",           ",,",          "[",
                                                "}",       "\r",  "\n",         "= ",          "#",           "\""};
    const std::size_t at = below(text.size() + 1);
    switch (below(6)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(random_() % 256);
        break;
      case 1:
        text.erase(at, below(20));
        break;
      case 2:
        text.insert(at, words[below(words.size())]);
        break;
      case 3:
        text.resize(at);
        break;
      case 4: {  // another number or word in the place of one
        const std::size_t begin = std::min(text.find_first_not_of(" \t\n", at), text.size());
        const std::size_t end = std::min(text.find_first_of(" \t\n,", begin), text.size());
        text.replace(begin, end - begin, words[below(words.size())]);
        break;
      }
      default: {  // a part of another text
        const std::string& other = texts_[below(texts_.size())];
        const std::size_t from = below(other.size() + 1);
        text.insert(at, other.substr(from, below(200)));
      }
    }
  }

  const std::vector<std::string>& texts_;
  std::mt19937_64 random_{1};
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: " << argv[0] << " MUTATIONS FOLDER|FILE...\n";
    return 2;
  }
  const std::vector<std::string> texts = texts_in({argv + 2, argv + argc});
  if (texts.empty()) {
    std::cerr << "no texts to begin with\n";
    return 2;
  }
  for (const std::string& text : texts) run(text);
  Mutations mutations(texts);
  const int count = std::atoi(argv[1]);
  for (int i = 0; i < count; ++i) run(mutations.next());
  std::cout << texts.size() << " texts and " << count << " changed ones read\n";
}
