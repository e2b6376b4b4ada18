#include "progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "interrupt.hpp"

namespace tact::bench {

ProgressStyle ProgressStyle::standard() {
    if (isatty(STDERR_FILENO)) return {.out = &std::cerr, .terminal = true, .quiet = 0.3, .every = 0.1};
    return {.out = &std::cerr, .terminal = false};
}

std::string duration(double seconds) {
    const long s = std::lround(std::max(seconds, 0.0));
    if (s < 60) return std::to_string(s) + " s";
    return std::to_string(s / 60) + " min " + std::to_string(s % 60) + " s";
}

namespace {

std::string& part_name() {
    static std::string name;
    return name;
}

bool hidden = false;

}  // namespace

ProgressPart::ProgressPart(std::string name) { part_name() = std::move(name) + ": "; }
ProgressPart::~ProgressPart() { part_name().clear(); }

Progress::Progress(std::string label, double total, ProgressStyle style)
    : label_(part_name() + label),
      total_(total),
      shown_at_(style.quiet - style.every),
      style_(style),
      start_(std::chrono::steady_clock::now()) {}

void hide_progress() { hidden = true; }

void Progress::label(const std::string& text) { label_ = part_name() + text; }

void Progress::at(double done) {
    throw_if_interrupted();
    done_ = done;
    if (hidden) return;
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (elapsed < shown_at_ + style_.every) return;
    shown_at_ = elapsed;
    show(elapsed);
}

void Progress::show(double elapsed) {
    const double part = total_ > 0 ? std::clamp(done_ / total_, 0.0, 1.0) : 0.0;
    const std::string remaining = part > 0 ? duration(elapsed * (1 - part) / part) + " left" : "";
    const std::string percent = std::to_string(static_cast<int>(100 * part)) + " %";
    std::ostream& out = *style_.out;
    if (style_.terminal) {
        constexpr int width = 30;
        const auto full = static_cast<std::size_t>(std::lround(width * part));
        out << "\r\033[K[" << std::string(full, '#') << std::string(width - full, '.') << "] " << percent << "  "
            << label_ << "  " << remaining << std::flush;
    } else {
        out << label_ << ": " << percent << (remaining.empty() ? "" : ", ") << remaining << std::endl;
    }
    shown_ = true;
}

Progress::~Progress() {
    if (!shown_) return;
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (style_.terminal) *style_.out << "\r\033[K";
    if (!interrupted()) *style_.out << label_ << ": " << duration(elapsed) << std::endl;
}

}  // namespace tact::bench
