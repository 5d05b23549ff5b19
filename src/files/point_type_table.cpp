#include "files/point_type_table.hpp"

#include "settings/point_type.hpp"

namespace tchat {

void write_point_types(TableWriter& out) {
  out.begin({{"type"}, {"number"}, {"kind"}, {"codimension_two"}, {"meaning"}});
  for (const PointTypeFacts& row : point_types())
    out.row({TableCell(std::string(row.name)), TableCell(row.number), TableCell(row.kind), TableCell(row.is_whole),
             TableCell(std::string(row.meaning))});
  out.end();
}

}  // namespace tchat
