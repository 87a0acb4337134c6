#include "io/run_schema.h"

#include "io/model_fields.h"

namespace sigmaflow::io {

void RunParameters::describe(Fields& fields)
{
    io::describe(fields, model);
    fields("stress", stress, any_number(), "sigma0", "imposed shear stress");
    fields("rate", rate, any_number(), "rate0", "imposed shear rate");
}

}
