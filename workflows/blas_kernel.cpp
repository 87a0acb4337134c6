#include "workflows/blas_kernel.h"

#include <dlfcn.h>
#include <unistd.h>
#include <cstdlib>

namespace sigmaflow::workflows {

namespace {

constexpr const char* variable = "OPENBLAS_CORETYPE";

const char* best_kernel()
{
#if defined(__x86_64__)
    if (__builtin_cpu_supports("x86-64-v4")) return "SkylakeX";
    if (__builtin_cpu_supports("x86-64-v3")) return "Haswell";
#endif
    return nullptr;
}

}

std::string blas_kernel()
{
    using Name = const char* (*)();
    const auto name = reinterpret_cast<Name>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
    return name ? std::string("OpenBLAS ") + name() : "not OpenBLAS";
}

void choose_blas_kernel(char** argv)
{
    if (std::getenv(variable) || blas_kernel() != "OpenBLAS Prescott") return;
    const char* better = best_kernel();
    if (!better || setenv(variable, better, 0) != 0) return;
    execv("/proc/self/exe", argv);  // on failure the slow kernel does as well
    unsetenv(variable);
}

}
