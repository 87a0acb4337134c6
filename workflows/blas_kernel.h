// workflows/blas_kernel.h -- the kernel of OpenBLAS, which the direct solver spends its time in.
//
// OpenBLAS chooses its kernel when the program is loaded. Debian 12's 0.3.21 does not know newer
// processors and falls back to SSE3 ("Prescott"), up to three times slower.
#pragma once
#include <string>

namespace sigmaflow::workflows {

/// e.g. "OpenBLAS SkylakeX", or "not OpenBLAS". Another kernel gives other last bits.
std::string blas_kernel();

/// Starts this program again with a better kernel if the fall-back was taken and the processor can
/// do more. Does nothing if OPENBLAS_CORETYPE is set. Returns if there is nothing to gain.
void choose_blas_kernel(char** argv);

}
