#include "app/compiled_texts.hpp"

#include "commit.hpp"  // written at every build

namespace tchat {

std::string version_text() {
  return "tchat " TCHAT_VERSION "\ncommit " TCHAT_COMMIT "\nbuilt with " TCHAT_COMPILER ", " TCHAT_LIBRARIES "\n";
}

}  // namespace tchat
