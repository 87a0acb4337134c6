// workflows/man_page.h -- the manual page of the program, made from the declared options.
#pragma once
#include <string>

namespace CLI {
class App;
}

namespace sigmaflow::workflows {

/// sigmaflow(1) in the language of man(7); `app` has all commands declared.
std::string man_page(const CLI::App& app);

}
