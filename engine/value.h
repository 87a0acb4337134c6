// engine/value.h -- a number with its standard error.
#pragma once

namespace sigmaflow {

struct Value {
    double mean = 0, standard_error = 0;
};

}
