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
    // what x86-64-v3 and -v4 mean for a kernel; clang does not know these names
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return nullptr;
    const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                        __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512vl");
    return avx512 ? "SkylakeX" : "Haswell";
#else
    return nullptr;
#endif
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
