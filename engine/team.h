// engine/team.h -- a few threads that work through the same phases.
//
// Every phase divides its slices among the members; a barrier ends it. What a member computes does
// not depend on how many there are, and sums are taken over all slices in one order: results are
// bitwise the same for any number of threads. A member has the same part of space in every phase:
// what it wrote is in its own cache.
//
// The barrier spins, because phases are shorter than OpenMP's own barrier takes (0.3 against 0.04
// microseconds here), and gives way when it has waited long: more members than cores are slow, not
// stuck.
#pragma once
#include "engine/slices.h"

#include <omp.h>
#include <atomic>
#include <thread>
#include <vector>

namespace sigmaflow {

struct Range {
    int begin, end;
};

class SpinBarrier {
public:
    void wait(int members)
    {
        const int phase = phase_.load(std::memory_order_relaxed);
        if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == members) {
            arrived_.store(0, std::memory_order_relaxed);
            phase_.store(phase + 1, std::memory_order_release);
            return;
        }
        for (int spins = 0; phase_.load(std::memory_order_acquire) == phase; ++spins)
            if (spins > 2000) std::this_thread::yield();
    }

private:
    alignas(64) std::atomic<int> arrived_{0};
    alignas(64) std::atomic<int> phase_{0};
};

struct Team {
    int rank = 0, size = 1;
    SpinBarrier* meeting = nullptr;

    Range share(int begin, int end) const
    {
        const long count = end - begin;
        return {begin + static_cast<int>(count * rank / size),
                begin + static_cast<int>(count * (rank + 1) / size)};
    }

    /// work(range) for all slices of this member, in no particular order of the colours.
    template <class Work>
    void own(const Slices& slices, const Work& work) const
    {
        if (size == 1) {
            work(Range{0, slices.count});
            return;
        }
        for (std::size_t c = 0; c + 1 < slices.colour.size(); ++c)
            work(share(slices.colour[c], slices.colour[c + 1]));
    }

    /// The same, colour after colour: slices may depend on those of earlier colours, or of later
    /// ones if it goes backwards.
    template <class Work>
    void by_colours(const Slices& slices, bool forwards, const Work& work) const
    {
        if (size == 1) {
            work(Range{0, slices.count});
            return;
        }
        const int colours = static_cast<int>(slices.colour.size()) - 1;
        for (int k = 0; k < colours; ++k) {
            const int c = forwards ? k : colours - 1 - k;
            work(share(slices.colour[c], slices.colour[c + 1]));
            barrier();
        }
    }

    void barrier() const
    {
        if (size > 1) meeting->wait(size);
    }
};

/// work(team) on every member; it must not throw.
template <class Work>
void with_team(int threads, const Work& work)
{
    if (threads <= 1) {
        work(Team{});
        return;
    }
    SpinBarrier meeting;
#if defined(__SANITIZE_THREAD__)  // which cannot see inside libgomp
    std::vector<std::thread> others;
    for (int rank = 1; rank < threads; ++rank)
        others.emplace_back([&, rank] { work(Team{rank, threads, &meeting}); });
    work(Team{0, threads, &meeting});
    for (std::thread& other : others) other.join();
#else
#pragma omp parallel num_threads(threads)
    work(Team{omp_get_thread_num(), omp_get_num_threads(), &meeting});
#endif
}

/// work(k) for k = 0 ... count - 1, on every member a part; few are not worth a team.
template <class Work>
void for_each(int threads, std::size_t count, const Work& work)
{
    constexpr std::size_t few = 1000;
    with_team(count < few ? 1 : threads, [&](const Team& team) {
        const Range own = team.share(0, static_cast<int>(count));
        for (int k = own.begin; k < own.end; ++k) work(k);
    });
}

}
