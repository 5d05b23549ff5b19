#include "plot/picture_output.hpp"

#include <fmt/format.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <memory>

#include "base/messages.hpp"
#include "base/text_file.hpp"
#include "files/replaced_file.hpp"
#include "plot/gnuplot.hpp"
#include "plot/gnuplot_script.hpp"

namespace tchat {

namespace {

namespace fs = std::filesystem;

/// Throws UserError when no file can be made beside `path`.
std::unique_ptr<TemporaryFile> begin_file(const std::string& path) {
  try {
    return std::make_unique<TemporaryFile>(path);
  } catch (const ComputationError& error) {
    throw UserError(fmt::format("{}; give a file in a folder that is there and writable, or make it", error.what()));
  }
}

void write_text(const std::string& path, const std::string& text) {
  const auto file = begin_file(path);
  file->write(text);
  file->close();
  file->put_in_place();
}

/// A PDF says when it was made: digits of these dates become a fixed day, so that lengths stay.
void remove_dates(const std::string& path) {
  std::string text = read_text_if_there(path, "a picture").value_or("");
  for (const std::string key : {"/CreationDate", "/ModDate"}) {
    const std::size_t at = text.find(key);
    if (at == std::string::npos) continue;
    const std::string day = "20000101000000";
    std::size_t digit = 0;
    for (std::size_t k = text.find('(', at); k < text.size() && text[k] != ')'; ++k)
      if (std::isdigit(static_cast<unsigned char>(text[k])) != 0) text[k] = digit < day.size() ? day[digit++] : '0';
  }
  std::ofstream(path, std::ios::binary) << text;
}

void draw_to_file(const SheetLayout& layout, const std::string& path) {
  const PictureFormat format = picture_format(path);
  const auto file = begin_file(path);
  file->close();
  run_gnuplot(gnuplot_script(layout, {format, file->name(), ""}));
  std::error_code error;
  if (fs::file_size(file->name(), error) == 0 || error)
    throw ComputationError(fmt::format("{}: gnuplot drew nothing; is the disk full?", path));
  if (format == PictureFormat::pdf) remove_dates(file->name());
  file->put_in_place();
}

}  // namespace

std::string output_picture(const Sheet& sheet, const PictureWish& wish) {
  const SheetLayout layout = lay_out(sheet);
  const auto keep_script = [&](const PictureTarget& target) {
    if (!wish.script.empty()) write_text(wish.script, gnuplot_script(layout, target));
  };
  if (!wish.output.empty() && picture_format(wish.output) == PictureFormat::html) {
    if (!wish.script.empty())
      throw UserError(
          "--script: a page is drawn by the browser, not by gnuplot; leave --script out, or give -o FILE.png");
    write_text(wish.output, page_html(layout, wish.page));
    return "";
  }
  if (!wish.output.empty()) {
    keep_script({picture_format(wish.output), wish.output, ""});
    draw_to_file(layout, wish.output);
    return "";
  }
  const std::string window = has_display() ? window_terminal(gnuplot_terminals()) : "";
  if (!window.empty()) {
    const PictureTarget target{PictureFormat::window, "", window};
    keep_script(target);
    run_gnuplot(gnuplot_script(layout, target), true);
    return "";
  }
  const std::string path = wish.name + ".png";
  keep_script({PictureFormat::png, path, ""});
  draw_to_file(layout, path);
  return fmt::format("{} (no window: {}; -o FILE chooses another name or form)", path,
                     has_display() ? "this gnuplot has none, those of Debian's packages gnuplot-qt and gnuplot-x11 have"
                                   : "there is no display");
}

}  // namespace tchat
