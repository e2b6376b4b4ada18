// What a long step shows while it runs: a bar with the remaining time on a terminal, plain lines elsewhere.
#pragma once

#include <chrono>
#include <iosfwd>
#include <string>

namespace tact::bench {

/// Where and how often progress is shown.
struct ProgressStyle {
    std::ostream* out;  ///< not owned
    bool terminal;      ///< redraw one line, or append lines
    double quiet = 2;   ///< s before the first line appears where there is no terminal
    double every = 2;   ///< s between lines, .1 s on a terminal
    /// On standard error.
    static ProgressStyle standard();
};

/// The progress of one step of a study. Throws bench::Interrupted from `at` once a signal has come.
class Progress {
public:
    Progress(std::string label, double total, ProgressStyle style = ProgressStyle::standard());
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    /// Clears the bar; where lines were shown, adds one with the time taken.
    ~Progress();

    /// `done` of the total, which the remaining time is reckoned from.
    void at(double done);
    void add(double done) { at(done_ + done); }
    void label(const std::string& text);

private:
    void show(double elapsed);
    std::string label_;
    double total_, done_ = 0, shown_at_;
    bool shown_ = false;
    ProgressStyle style_;
    std::chrono::steady_clock::time_point start_;
};

/// From now on this process shows no bar; they still end with Interrupted.
void hide_progress();

/// While it lives, every bar says what part of a longer work it belongs to.
class ProgressPart {
public:
    explicit ProgressPart(std::string name);
    ProgressPart(const ProgressPart&) = delete;
    ProgressPart& operator=(const ProgressPart&) = delete;
    ~ProgressPart();
};

/// "41 s", "2 min 5 s".
std::string duration(double seconds);

}  // namespace tact::bench
