// engine/team.h -- a few threads that work through the same phases.
//
// Every phase divides its slices among the members; a barrier ends it. What a member computes does
// not depend on how many there are, and sums are taken over all slices in one order: results are
// bitwise the same for any number of threads.
#pragma once
#include <omp.h>

namespace sigmaflow {

struct Range {
    int begin, end;
};

struct Team {
    int rank = 0, size = 1;

    Range share(int begin, int end) const
    {
        const long count = end - begin;
        return {begin + static_cast<int>(count * rank / size),
                begin + static_cast<int>(count * (rank + 1) / size)};
    }
    Range share(int count) const { return share(0, count); }

    void barrier() const
    {
        if (size > 1) {
#pragma omp barrier
        }
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
#pragma omp parallel num_threads(threads)
    work(Team{omp_get_thread_num(), omp_get_num_threads()});
}

}
