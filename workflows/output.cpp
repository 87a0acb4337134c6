#include "workflows/output.h"

#include "engine/error.h"

#include <iostream>

namespace sigmaflow::workflows {

void print_result(std::string_view text)
{
    std::cout << text << std::flush;
    if (!std::cout) throw Error(ErrorKind::file, "standard output", "cannot be written");
}

}
