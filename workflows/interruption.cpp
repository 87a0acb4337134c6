#include "workflows/interruption.h"

#include "workflows/progress.h"

#include <signal.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <utility>

namespace sigmaflow::workflows {

namespace {

constexpr std::array<std::pair<int, const char*>, 5> requests{{{SIGTERM, "SIGTERM"},
                                                               {SIGINT, "SIGINT"},
                                                               {SIGHUP, "SIGHUP"},
                                                               {SIGUSR1, "SIGUSR1"},
                                                               {SIGXCPU, "SIGXCPU"}}};

constexpr int interrupted_code = 3;
constexpr double longest_reserve = 60;  // [s] of the wall time
constexpr double reserve_share = 0.1;   // of the wall time

volatile std::sig_atomic_t received = 0;
volatile std::sig_atomic_t interrupts = 0;

// Only what may be done in a handler.
void note(int signal_number)
{
    if (signal_number == SIGINT) {
        interrupts = interrupts + 1;
        if (interrupts > 1) _exit(interrupted_code);
    }
    received = signal_number;
}

void handle(int signal_number, void (*handler)(int))
{
    struct sigaction old {};
    sigaction(signal_number, nullptr, &old);
    if (old.sa_handler == SIG_IGN) return;
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(signal_number, &action, nullptr);
}

}

std::optional<double> seconds_of(const std::string& text)
{
    int days = 0, hours = 0, minutes = 0, seconds = 0, used = 0;
    const auto all_read = [&] { return used == static_cast<int>(text.size()); };
    const auto positive = [](double value) -> std::optional<double> {
        if (value > 0 && value < 1e9) return value;
        return std::nullopt;
    };
    if (text.empty() || text.find_first_not_of("0123456789.:-smhd") != std::string::npos)
        return std::nullopt;
    if (std::sscanf(text.c_str(), "%4d-%2d:%2d:%2d%n", &days, &hours, &minutes, &seconds, &used) ==
            4 &&
        all_read())
        return positive(((days * 24. + hours) * 60 + minutes) * 60 + seconds);
    if (std::sscanf(text.c_str(), "%4d:%2d:%2d%n", &hours, &minutes, &seconds, &used) == 3 &&
        all_read())
        return positive((hours * 60. + minutes) * 60 + seconds);
    double value = 0;
    char unit = 's';
    if (std::sscanf(text.c_str(), "%lf%n", &value, &used) == 1 && all_read())
        return positive(value);
    if (std::sscanf(text.c_str(), "%lf%c%n", &value, &unit, &used) == 2 && all_read())
        for (const auto& [name, factor] :
             {std::pair{'s', 1.}, {'m', 60.}, {'h', 3600.}, {'d', 86400.}})
            if (unit == name) return positive(value * factor);
    return std::nullopt;
}

Interruption::Interruption(std::optional<double> wall_time) : wall_time_(wall_time)
{
    for (const auto& [signal_number, name] : requests) handle(signal_number, note);
    handle(SIGPIPE, SIG_IGN);
    handle(SIGXFSZ, SIG_IGN);
}

std::optional<std::string> Interruption::asked(double needed) const
{
    for (const auto& [signal_number, name] : requests)
        if (received == signal_number) return name;
    if (!wall_time_) return std::nullopt;
    const std::chrono::duration<double> passed = Clock::now() - started_;
    const double reserve = std::min(longest_reserve, reserve_share * *wall_time_) + 2 * needed;
    if (passed.count() + reserve < *wall_time_) return std::nullopt;
    return "the wall time of " + duration_text(*wall_time_) + " is nearly over";
}

}
