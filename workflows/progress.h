// workflows/progress.h -- tells on stderr how far the work is.
//
// On a terminal: one line that is redrawn, with a bar, the time left and what is going on.
// Elsewhere: a plain line every 10 s or 10 %. Nothing when quiet. No control characters without a
// terminal, no colours at all.
#pragma once
#include <chrono>
#include <functional>
#include <string>
#include <string_view>

namespace sigmaflow::workflows {

class Progress {
public:
    enum class Style { quiet, lines, bar };

    explicit Progress(Style style) : style_(style) {}
    /// bar on a terminal, lines elsewhere.
    static Progress for_stderr(bool quiet);

    /// Is told everything, also when quiet: "progress" with the fraction and the seconds left (-1:
    /// not known yet) at most once a second, "note" and "warning" with their text.
    using Listener = std::function<void(std::string_view what, const std::string& text,
                                        double fraction, double seconds_left)>;
    void tell(Listener listener) { listener_ = std::move(listener); }

    /// A new task begins, e.g. a step.
    void begin(const std::string& task);
    /// `fraction` in [0, 1] of the task is done.
    void update(double fraction, const std::string& details);
    void end(const std::string& result);
    /// A line that stays.
    void note(const std::string& text);
    /// A line that stays, even when quiet.
    void warn(const std::string& text);
    /// Forgets a half-drawn bar, before an error message.
    void clear();

private:
    using Clock = std::chrono::steady_clock;

    void show(double fraction, const std::string& left, const std::string& details);

    Style style_;
    Listener listener_;
    std::string task_;
    Clock::time_point started_, shown_, told_;
    double shown_fraction_ = 0;
    double first_fraction_ = -1;  // a run that goes on does not begin at 0; -1: not known yet
    bool bar_drawn_ = false;
};

/// "42 s", "3 min 05 s", "2 h 11 min"
std::string duration_text(double seconds);

}
