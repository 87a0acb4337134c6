// Memory of a step: a program of its own, because it replaces the allocation functions.
#include "engine/step.h"
#include "tests/support/random_state.h"

#include <gtest/gtest.h>
#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<long> allocations{0};

void* allocated(std::size_t size, std::size_t alignment)
{
    ++allocations;
    void* memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}

void* operator new(std::size_t size)
{
    return allocated(size, alignof(std::max_align_t));
}
void* operator new(std::size_t size, std::align_val_t alignment)
{
    return allocated(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept
{
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept
{
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept
{
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept
{
    std::free(memory);
}

namespace sigmaflow {

class EveryScheme : public testing::TestWithParam<Scheme> {};

// Neighbour lists are made anew several times on the way. Contacts may become more numerous than
// ever before, which takes memory once: most steps, not all, are asked to do without.
TEST_P(EveryScheme, AStepTakesNoMemoryOnceWarm)
{
    State s = support::dense_state(150, 0.56, 0.3, 3);
    Workspace workspace({SolverKind::pcg, 1e-3});
    const Stepping stepping{GetParam(), GetParam() == Scheme::implicit ? 1e-2 : 2e-3};
    const auto advance_once = [&] {
        recycle(advance(s, {}, ImposedStress{5}, stepping, {}, workspace), workspace);
    };
    for (int k = 0; k < 2500; ++k) advance_once();
    int without = 0;
    for (int k = 0; k < 100; ++k) {
        const long before = allocations;
        advance_once();
        without += allocations == before;
    }
    EXPECT_GE(without, 90);
}

INSTANTIATE_TEST_SUITE_P(Schemes, EveryScheme,
                         testing::Values(Scheme::euler, Scheme::heun, Scheme::implicit),
                         [](const auto& scheme) {
                             return scheme.param == Scheme::euler  ? "euler"
                                    : scheme.param == Scheme::heun ? "heun"
                                                                   : "implicit";
                         });

}
