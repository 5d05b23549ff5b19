#include "files/table_writer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "base/messages.hpp"

namespace tchat {

namespace {

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

/// Whatever bytes a name in a file has, the result is valid.
std::string json_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : printable(text)) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c == '\n' ? std::string("\\n") : std::string(1, static_cast<unsigned char>(c) < 0x80 ? c : '_');
  }
  return quoted + '"';
}

/// What follows for each alternative of a cell.
template <class... Functions>
struct Cases : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Cases(Functions...) -> Cases<Functions...>;

}  // namespace

std::string csv_field(const TableCell& cell) {
  return std::visit(
      Cases{[](std::monostate) { return std::string(); }, [](bool value) { return std::string(value ? "1" : "0"); },
            [](int value) { return fmt::format("{}", value); },
            [](double value) { return std::isnan(value) ? std::string() : fmt::format("{}", value); },
            [](const std::string& text) { return csv_text(text); }},
      cell);
}

std::string json_value(const TableCell& cell) {
  return std::visit(
      Cases{[](std::monostate) { return std::string("null"); },
            [](bool value) { return std::string(value ? "true" : "false"); },
            [](int value) { return fmt::format("{}", value); },
            [](double value) { return std::isfinite(value) ? fmt::format("{}", value) : std::string("null"); },
            [](const std::string& text) { return json_text(text); }},
      cell);
}

std::string csv_line(const std::vector<std::string>& fields) { return fmt::format("{}\n", fmt::join(fields, ",")); }

std::vector<std::string> distinct_headings(const std::vector<std::string>& headings) {
  std::set<std::string> taken;
  std::vector<std::string> distinct;
  for (const std::string& heading : headings) {
    std::string name = heading;
    for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{} ({})", heading, k);
    distinct.push_back(name);
  }
  return distinct;
}

std::string own_heading(std::string name, const std::vector<std::string>& given) {
  while (std::find(given.begin(), given.end(), name) != given.end()) name += '_';
  return name;
}

namespace {

/// Lists have two fields for each number, the real and the imaginary part.
class CsvWriter final : public TableWriter {
 public:
  explicit CsvWriter(std::ostream& out) : out_(out) {}

  void begin(const std::vector<TableColumn>& columns) override {
    columns_ = columns;
    std::vector<std::string> fields;
    for (const TableColumn& column : columns) {
      if (column.element.empty()) fields.push_back(csv_field(column.name));
      for (std::size_t k = 1; k <= column.most; ++k)
        fields.insert(fields.end(),
                      {fmt::format("{}{}_re", column.element, k), fmt::format("{}{}_im", column.element, k)});
    }
    out_ << csv_line(fields);
  }

  void row(const std::vector<TableValue>& values) override {
    std::vector<std::string> fields;
    for (std::size_t c = 0; c < values.size(); ++c) {
      if (const auto* cell = std::get_if<TableCell>(&values[c])) {
        fields.push_back(csv_field(*cell));
        continue;
      }
      const auto& list = std::get<ComplexList>(values[c]);
      for (std::size_t k = 0; k < columns_[c].most; ++k) {
        fields.push_back(k < list.size() ? csv_field(list[k].real()) : "");
        fields.push_back(k < list.size() ? csv_field(list[k].imag()) : "");
      }
    }
    out_ << csv_line(fields);
  }

 private:
  std::ostream& out_;
  std::vector<TableColumn> columns_;
};

/// An array of objects; lists are arrays of pairs [re, im].
class JsonWriter final : public TableWriter {
 public:
  explicit JsonWriter(std::ostream& out) : out_(out) {}

  void begin(const std::vector<TableColumn>& columns) override {
    for (const TableColumn& column : columns) keys_.push_back(json_value(column.name));
  }

  void row(const std::vector<TableValue>& values) override {
    std::vector<std::string> members;
    for (std::size_t c = 0; c < values.size(); ++c)
      members.push_back(
          fmt::format("{}: {}", keys_[c], std::visit([](const auto& value) { return json(value); }, values[c])));
    out_ << (is_first_ ? "[\n" : ",\n") << fmt::format("{{{}}}", fmt::join(members, ", "));
    is_first_ = false;
  }

  void end() override { out_ << (is_first_ ? "[\n]\n" : "\n]\n"); }

 private:
  static std::string json(const TableCell& cell) { return json_value(cell); }
  static std::string json(const ComplexList& list) {
    if (list.empty()) return "null";
    std::vector<std::string> pairs;
    for (const std::complex<double>& value : list)
      pairs.push_back(fmt::format("[{}, {}]", json_value(value.real()), json_value(value.imag())));
    return fmt::format("[{}]", fmt::join(pairs, ", "));
  }

  std::ostream& out_;
  std::vector<std::string> keys_;
  bool is_first_ = true;
};

template <class Writer>
std::unique_ptr<TableWriter> make(std::ostream& out) {
  return std::make_unique<Writer>(out);
}

}  // namespace

std::span<const TableFormatName> table_formats() {
  static constexpr std::array formats{
      TableFormatName{"csv", "CSV", make<CsvWriter>},
      TableFormatName{"json", "JSON: an array of objects, one a row", make<JsonWriter>}};
  return formats;
}

}  // namespace tchat
