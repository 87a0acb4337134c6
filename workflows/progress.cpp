#include "workflows/progress.h"

#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace sigmaflow::workflows {

namespace {

double seconds_between(std::chrono::steady_clock::time_point from,
                       std::chrono::steady_clock::time_point to)
{
    return std::chrono::duration<double>(to - from).count();
}

void print(const std::string& text)
{
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

}

std::string duration_text(double seconds)
{
    const long total = std::lround(std::clamp(seconds, 0., 1e9));
    char text[48];
    if (total < 60)
        std::snprintf(text, sizeof text, "%ld s", total);
    else if (total < 3600)
        std::snprintf(text, sizeof text, "%ld min %02ld s", total / 60, total % 60);
    else
        std::snprintf(text, sizeof text, "%ld h %02ld min", total / 3600, total / 60 % 60);
    return text;
}

Progress Progress::for_stderr(bool quiet)
{
    if (quiet) return Progress(Style::quiet);
    // NO_COLOR (no-color.org) asks for no escape sequences, and the bar needs one
    const char* no_colour = std::getenv("NO_COLOR");
    const char* terminal = std::getenv("TERM");
    const bool plain = (no_colour && *no_colour) || (terminal && !std::strcmp(terminal, "dumb"));
    return Progress(isatty(STDERR_FILENO) && !plain ? Style::bar : Style::lines);
}

void Progress::begin(const std::string& task)
{
    task_ = task;
    started_ = shown_ = told_ = Clock::now();
    shown_fraction_ = 0;
    first_fraction_ = -1;
}

void Progress::update(double fraction, const std::string& details)
{
    if (style_ == Style::quiet && !listener_) return;
    fraction = std::isfinite(fraction) ? std::clamp(fraction, 0., 1.) : 0;
    const Clock::time_point now = Clock::now();
    if (first_fraction_ < 0) first_fraction_ = fraction;
    const double elapsed = seconds_between(started_, now), gained = fraction - first_fraction_;
    const double left = gained > 0.01 && elapsed > 1 ? elapsed * (1 - fraction) / gained : -1;
    if (listener_ && seconds_between(told_, now) >= 1) {
        listener_("progress", details, fraction, left);
        told_ = now;
    }
    show(fraction, left >= 0 ? ", " + duration_text(left) + " left" : "", details);
}

void Progress::show(double fraction, const std::string& left, const std::string& details)
{
    if (style_ == Style::quiet) return;
    const Clock::time_point now = Clock::now();
    const double since = seconds_between(shown_, now);
    char percent[16];
    std::snprintf(percent, sizeof percent, "%3.0f %%", 100 * fraction);
    if (style_ == Style::lines) {
        const bool due = since >= 10 || (since >= 1 && fraction >= shown_fraction_ + 0.1);
        if (!due) return;
        print(task_ + ": " + percent + left + "; " + details + "\n");
    } else {
        if (since < 0.1) return;
        constexpr int width = 24;
        const int full = static_cast<int>(fraction * width);
        print("\r\033[K" + task_ + " [" + std::string(full, '#') + std::string(width - full, '.') +
              "] " + percent + left + "; " + details);
        bar_drawn_ = true;
    }
    shown_ = now;
    shown_fraction_ = fraction;
}

void Progress::end(const std::string& result)
{
    clear();
    if (style_ == Style::quiet) return;
    print(task_ + ": " + result + " (" + duration_text(seconds_between(started_, Clock::now())) +
          ")\n");
}

void Progress::note(const std::string& text)
{
    clear();
    if (listener_) listener_("note", text, 0, -1);
    if (style_ != Style::quiet) print(text + "\n");
}

void Progress::warn(const std::string& text)
{
    clear();
    if (listener_) listener_("warning", text, 0, -1);
    print("sigmaflow: warning: " + text + "\n");
}

void Progress::clear()
{
    if (bar_drawn_) print("\r\033[K");
    bar_drawn_ = false;
}

}
