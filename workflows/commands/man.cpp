// sigmaflow man
#include "workflows/commands.h"
#include "workflows/man_page.h"

#include <CLI/CLI.hpp>

namespace sigmaflow::workflows {

namespace {

Work declare(CLI::App& app)
{
    return [&app] { print_result(man_page(*app.get_parent())); };
}

}

Command man_command()
{
    return {"man", "the manual page, made from the declared options",
            R"(  sigmaflow man | man -l -                            read it
  sigmaflow man > sigmaflow.1)",
            declare};
}

}
