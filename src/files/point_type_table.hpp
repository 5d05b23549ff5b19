/// The types of points as a table: letters, number and kind in files, meaning.
#pragma once

#include "files/table_writer.hpp"

namespace tchat {

void write_point_types(TableWriter& out);

}  // namespace tchat
